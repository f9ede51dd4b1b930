"""Motions as arrays."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ._crepitus import Scene
from ._types import Numbers


def with_motion(scene: Scene, motion: tuple[Numbers, Numbers]) -> Scene:
    """Returns the scene with these samples as its motion, s and rad, and their duration."""
    try:
        times, angles = motion
    except (TypeError, ValueError):
        raise TypeError(
            f"motion: expected two arrays, (t_s, angle_rad), got {type(motion).__name__}"
        ) from None
    return scene.with_motion(_vector("t_s", times), _vector("angle_rad", angles))


def _vector(name: str, numbers: Numbers) -> npt.NDArray[np.float64]:
    vector = np.asarray(numbers, dtype=np.float64)
    if vector.ndim != 1:
        raise ValueError(f"motion, {name}: expected one dimension, got {vector.ndim}")
    return vector
