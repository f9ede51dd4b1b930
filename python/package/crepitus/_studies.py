"""Studies: what accuracy costs, what each effect does."""

from __future__ import annotations

import json
from collections.abc import Sequence

from . import _crepitus
from ._run import _scene
from ._types import Columns, SceneLike, columns_of


def accuracy(
    scene: SceneLike | None = None,
    *,
    steps_s: Sequence[float] | None = None,
    quick: bool = True,
) -> Columns:
    """Compares every solver with the reference, in f32 and f64, and times it on this computer.

    Args:
        scene: The scene whose motion and joint are studied; four constant speeds and a hand-like
            sine by default.
        steps_s: The solver steps, s, from 1e-7 to 1; by default 1 ms to 20 µs, or to 2 µs if not quick.
        quick: Fewer steps and repeats: seconds instead of minutes.

    Returns:
        Columns of ``points.csv``, a row a solver, precision and step: errors in s and N·m,
        ``us_per_simulated_s`` of CPU time. A row with ``unmatched`` above 0 has wrong events.
    """
    studied = None if scene is None else _scene(scene)
    steps = None if steps_s is None else [float(step) for step in steps_s]
    return columns_of(json.loads(_crepitus.accuracy(studied, steps_s=steps, quick=bool(quick))))


def effects(scene: SceneLike) -> Columns:
    """Leaves out each effect of a scene, and adds each absent one.

    Returns:
        Columns of ``effects.csv``, a row a variant, the scene itself first: what the effect adds
        to the torque at the hand (N·m), to the events, and to a step (ns of CPU time).
        A variant that failed has its reason in ``failure``.
    """
    return columns_of(json.loads(_crepitus.effects(_scene(scene))), texts=("failure",))
