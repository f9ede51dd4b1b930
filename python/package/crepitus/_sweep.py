"""Many runs of one scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Union

import numpy as np

from . import _crepitus
from ._run import _dict, _scene
from ._types import Columns, Numbers, SceneLike


def run_many(
    scene: SceneLike,
    points: Union[Mapping[str, Numbers], Sequence[Mapping[str, Any]]],
    *,
    set: Mapping[str, Any] | None = None,
    as_device: bool = False,
    threads: int | None = None,
) -> Columns:
    """Runs a scene at points of your own, on all cores: a row a run, no traces.

    Args:
        scene: As for :func:`crepitus.run`.
        points: Values at keys of the scene: a dict of arrays of one length, or a list of dicts with
            the same keys.
        set: Other values at keys of the scene in every run.
        as_device: Render as the device does.
        threads: How many; all cores if left out. Rows do not depend on it.

    Returns:
        Columns of one length: ``index``, what was varied, and every number of the run's summary,
        parameters under the key that they have in a scene. What a run does not have is NaN, or
        empty. A run that fails is a row with its reason in ``failure``; ``failure`` is always there.

    Raises:
        SceneError: None of the points that were tried is a scene.
        ValueError: The lists differ in length, or there is no point.
        KeyboardInterrupt: After Ctrl-C.
    """
    checked = _scene(scene).with_(as_device=as_device, set=_dict(set))
    return _columns(_crepitus.run_points(checked, _lists(points), threads=threads))


def sweep(
    scene: SceneLike,
    vary: Mapping[str, Union[str, Sequence[Any]]],
    *,
    latin: int | None = None,
    sobol: int | None = None,
    seed: int = 0,
    set: Mapping[str, Any] | None = None,
    as_device: bool = False,
    threads: int | None = None,
) -> Columns:
    """Runs a scene over a grid, a Latin hypercube or Sobol's sequence, as ``crepitus sweep`` does.

    Args:
        scene: As for :func:`crepitus.run`.
        vary: Keys of the scene with their values: a list, or a text such as ``"1:4:lin7"`` or
            ``"1e-6:1e-3:log4"``; with ``latin`` or ``sobol`` also ``"1:4"`` and ``"1e-6:1e-3:log"``.
        latin: Instead of a grid, this many points of a Latin hypercube.
        sobol: Instead of a grid, this many points of Sobol's sequence.
        seed: Which ones.
        set, as_device, threads: As for :func:`run_many`.

    Returns:
        As :func:`run_many`; the last key of ``vary`` changes fastest in a grid.

    Raises:
        SceneError: None of the points that were tried is a scene.
        ValueError: ``vary`` is no design.
        KeyboardInterrupt: After Ctrl-C.
    """
    checked = _scene(scene).with_(as_device=as_device, set=_dict(set))
    columns = _crepitus.run_design(
        checked,
        {path: values if isinstance(values, str) else _list(values) for path, values in vary.items()},
        latin=latin,
        sobol=sobol,
        seed=seed,
        threads=threads,
    )
    return _columns(columns)


def _lists(
    points: Union[Mapping[str, Numbers], Sequence[Mapping[str, Any]]],
) -> dict[str, list[Any]]:
    if isinstance(points, Mapping):
        return {path: _list(values) for path, values in points.items()}
    rows = list(points)
    keys = list(rows[0]) if rows else []
    for number, row in enumerate(rows):
        if list(row) != keys:
            raise ValueError(f"points: number {number} has other keys than the first: {list(row)}")
    return {path: [row[path] for row in rows] for path in keys}


def _list(values: Any) -> list[Any]:
    array = values.tolist() if hasattr(values, "tolist") else values
    if isinstance(array, (str, bytes)) or not hasattr(array, "__iter__"):
        raise TypeError(f"expected a list or an array of values, got {values!r}")
    return list(array)


def _columns(found: dict[str, Any]) -> Columns:
    columns: Columns = {
        name: column if isinstance(column, np.ndarray) else np.array(column, dtype=str)
        for name, column in found.items()
    }
    columns.setdefault("failure", np.full(len(columns["index"]), "", dtype=str))
    return columns
