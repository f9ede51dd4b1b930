"""Many runs of one scene."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import _crepitus, _frames, _html, _plots
from ._progress import Progress, reported
from ._run import _dict, _scene
from ._types import Columns, Numbers, SceneLike

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas
    import polars
    import xarray

#: A folder.
Folder = Union[str, "os.PathLike[str]"]

_Found = tuple[dict[str, Any], str, Union[BaseException, None]]


class Sweep(Columns):
    """Rows of a sweep: a dict of columns of one length, a row a run.

    ``index`` is the number of the point; then follow what was varied, and every number of the run's
    summary, parameters under the key that they have in a scene. What a run does not have is NaN, or
    empty. A run that fails is a row with its reason in ``failure``; ``failure`` is always there.

    Attributes:
        varied: Keys that were varied.
        runs: Number of all points; :attr:`missing` of them have no row yet.
        about: Scene, title, seed, version, commit, and the digest of the sweep.
        folder: The sweep's folder, if it has one.
    """

    varied: list[str]
    runs: int
    about: dict[str, Any]
    folder: Path | None

    def __init__(self, columns: Columns, about: Mapping[str, Any]) -> None:
        super().__init__(columns)
        of = about["sweep"]
        self.varied = list(of["paths"])
        self.runs = of["runs"]
        self.about = {
            name: of[name] for name in ("scene", "title", "design_seed", "crepitus_version", "sha256")
        }
        self.about["crepitus_commit"] = about["commit"]
        self.folder = None if about["folder"] is None else Path(about["folder"])

    @property
    def missing(self) -> int:
        """Number of points without a row: above 0 after Ctrl-C."""
        return self.runs - len(self["index"])

    @property
    def units(self) -> dict[str, str]:
        """Units by column; columns without one are left out."""
        return _frames.units(self)

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame; its ``attrs`` have ``units`` and what the sweep is of. Needs pandas."""
        return _frames.to_pandas(self, self._attributes())

    def to_polars(self) -> polars.DataFrame:
        """A DataFrame. Needs polars, which keeps units in the names alone: :attr:`units` has them."""
        return _frames.to_polars(self)

    def to_xarray(self) -> xarray.Dataset:
        """A Dataset: over the varied keys if the rows are a whole grid, else along ``index``. Needs xarray."""
        return _frames.to_xarray(self, self._attributes(), "index", self.varied)

    def plot(self, y: str = "torque.rms_nm", ax: matplotlib.axes.Axes | None = None) -> matplotlib.axes.Axes:
        """Draws a column over what was varied: lines, of two numbers a heat map. Needs matplotlib.

        Args:
            y: The column.
            ax: Axes to draw into; new ones by default.

        Returns:
            The axes.
        """
        return _plots.sweep(self, self.varied, y, ax)

    def _attributes(self) -> dict[str, Any]:
        return {name: value for name, value in self.about.items() if value is not None}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mapping) and _frames.same(self, dict(other))

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = None

    def __repr__(self) -> str:
        failed = int((self["failure"] != "").sum())
        return (
            f"<Sweep of {self.about['title']!r}: {len(self['index'])} of {self.runs} runs, {failed} failed, "
            f"over {', '.join(self.varied)}>"
        )

    def _repr_html_(self) -> str:
        return _html.sweep(self)


class SweepInterrupted(KeyboardInterrupt):
    """Ctrl-C in a sweep.

    Attributes:
        rows: The finished rows; of a sweep in a folder the same call goes on from there.
    """

    def __init__(self, rows: Sweep) -> None:
        done = len(rows["index"])
        more = "" if rows.folder is None else f"; the same call goes on from {rows.folder}"
        super().__init__(f"{done} of {rows.runs} runs are finished, and in the attribute rows{more}")
        self.rows = rows


def run_many(
    scene: SceneLike,
    points: Union[Mapping[str, Numbers], Sequence[Mapping[str, Any]]],
    *,
    set: Mapping[str, Any] | None = None,
    as_device: bool = False,
    threads: int | None = None,
    progress: Progress = False,
    out: Folder | None = None,
    force: bool = False,
) -> Sweep:
    """Runs a scene at points of your own, on all cores: a row a run, no traces.

    Args:
        scene: As for :func:`crepitus.run`.
        points: Values at keys of the scene: a dict of arrays of one length, or a list of dicts with
            the same keys.
        set: Other values at keys of the scene in every run.
        as_device: Render as the device does.
        threads: How many; all cores if left out. Rows do not depend on it.
        progress: ``True`` for a bar, or a function that gets the numbers of finished runs and of all.
        out: Folder that keeps the rows, and all that :func:`repeat` needs: that of ``crepitus sweep``.
            A sweep that was stopped or killed goes on from there; one that is complete is read.
        force: Replace another sweep in that folder.

    Returns:
        The rows.

    Raises:
        SceneError: None of the points that were tried is a scene.
        ValueError: The lists differ in length, there is no point, or the folder has another sweep.
        SweepInterrupted: After Ctrl-C, with the finished rows; it is a ``KeyboardInterrupt``.
        OSError: The folder cannot be written, or another program runs this sweep in it.
    """
    checked = _scene(scene).with_(as_device=as_device, set=_dict(set))
    report, close = reported(progress)
    settings = (threads, _path(out), bool(force), report)
    try:
        return _sweep(_crepitus.run_points(checked, _lists(points), settings))
    finally:
        close()


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
    progress: Progress = False,
    out: Folder | None = None,
    force: bool = False,
) -> Sweep:
    """Runs a scene over a grid, a Latin hypercube or Sobol's sequence, as ``crepitus sweep`` does.

    Args:
        scene: As for :func:`crepitus.run`.
        vary: Keys of the scene with their values: a list, or a text such as ``"1:4:lin7"`` or
            ``"1e-6:1e-3:log4"``; with ``latin`` or ``sobol`` also ``"1:4"`` and ``"1e-6:1e-3:log"``.
        latin: Instead of a grid, this many points of a Latin hypercube.
        sobol: Instead of a grid, this many points of Sobol's sequence.
        seed: Which ones.
        set, as_device, threads, progress, out, force: As for :func:`run_many`.

    Returns:
        The rows; the last key of ``vary`` changes fastest in a grid.

    Raises:
        SceneError: None of the points that were tried is a scene.
        ValueError: ``vary`` is no design, or the folder has another sweep.
        SweepInterrupted: After Ctrl-C, with the finished rows; it is a ``KeyboardInterrupt``.
        OSError: The folder cannot be written, or another program runs this sweep in it.
    """
    checked = _scene(scene).with_(as_device=as_device, set=_dict(set))
    report, close = reported(progress)
    varied = {path: values if isinstance(values, str) else _list(values) for path, values in vary.items()}
    settings = (threads, _path(out), bool(force), report)
    try:
        return _sweep(
            _crepitus.run_design(
                checked, varied, latin=latin, sobol=sobol, seed=seed, settings=settings
            )
        )
    finally:
        close()


def repeat(
    folder: Folder,
    *,
    threads: int | None = None,
    progress: Progress = False,
    out: Folder | None = None,
    force: bool = False,
) -> Sweep:
    """Runs the sweep of a folder again, from its ``sweep.json`` alone, as ``crepitus sweep --again`` does.

    Args:
        folder: Of :func:`sweep`, :func:`run_many` or ``crepitus sweep``.
        threads, progress, out, force: As for :func:`run_many`.

    Returns:
        The rows; they equal those of :func:`read_sweep` if the same program ran them. A warning names another one.

    Raises:
        ValueError: The folder has no sweep.
        OSError: Its files or the recording are gone or changed.
    """
    report, close = reported(progress)
    settings = (threads, _path(out), bool(force), report)
    try:
        found, differences = _crepitus.repeat(os.fspath(folder), settings)
        for difference in differences:
            warnings.warn(difference, stacklevel=2)
        return _sweep(found)
    finally:
        close()


def read_sweep(folder: Folder) -> Sweep:
    """Reads the rows of a folder: those of its table, or the finished ones if it was stopped."""
    return _sweep(_crepitus.read_sweep(os.fspath(folder)))


def _sweep(found: _Found) -> Sweep:
    columns, about, raised = found
    rows = Sweep(_columns(columns), json.loads(about))
    if isinstance(raised, KeyboardInterrupt):
        raise SweepInterrupted(rows) from raised
    if raised is not None:
        raise raised
    return rows


def _path(folder: Folder | None) -> str | None:
    return None if folder is None else os.fspath(folder)


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
