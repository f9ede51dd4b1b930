"""Runs of scenes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from typing import TYPE_CHECKING, Any

from . import _crepitus, _frames, _html, _plots
from ._crepitus import Scene
from ._motion import with_motion
from ._types import Columns, Numbers, SceneLike

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas
    import polars
    import xarray


#: Parts of a summary that depend on the computer and the hour.
_MEASURED = ("wall_s", "real_time_factor", "ns_per_step", "ns_resolution")


@dataclass(frozen=True, eq=False)
class Run:
    """A run: its trace, its events, its summary.

    Runs are equal if their scenes and numbers are; the time that they took does not count.

    Attributes:
        scene: The scene that was run.
        trace: Columns of the trace, a row a step: those of ``trace.csv``. ``phase`` is -1,
            0 (stick) or +1. Empty with ``trace=False``. The arrays own the simulator's memory;
            nothing was copied.
        events: Columns of the events: those of ``events.csv``; what is empty there is NaN.
        summary: What ``summary.json`` holds.
    """

    scene: Scene
    trace: Columns = field(repr=False)
    events: Columns = field(repr=False)
    summary: dict[str, Any] = field(repr=False)

    @property
    def warnings(self) -> list[str]:
        """What may be wrong with the run; worth a look before its numbers."""
        warnings: list[str] = self.summary["warnings"]
        return warnings

    def to_pandas(self, what: str = "trace") -> pandas.DataFrame:
        """``trace`` or ``events`` as a DataFrame, phases as a category. Needs pandas.

        Its ``attrs`` have ``units``, title, version, commit and the scene's hash.
        """
        return _frames.to_pandas(self._part(what), self._attributes())

    def to_polars(self, what: str = "trace") -> polars.DataFrame:
        """``trace`` or ``events`` as a DataFrame, phases as an enumeration. Needs polars.

        It keeps no metadata: units are in the names, and in :attr:`units`.
        """
        return _frames.to_polars(self._part(what))

    def to_xarray(self, what: str = "trace") -> xarray.Dataset:
        """``trace`` or ``events`` as a Dataset along ``t_s``, phases as text. Needs xarray.

        Each variable has the attribute ``units``; the Dataset has title, version, commit and the scene's hash.
        """
        return _frames.to_xarray(self._part(what), self._attributes(), "t_s")

    @property
    def units(self) -> dict[str, str]:
        """Units by column of trace and events; columns without one are left out."""
        return _frames.units([*self.trace, *self.events])

    def plot(
        self,
        x: str = "t_s",
        y: str = "torque_nm",
        *,
        events: bool = False,
        ax: matplotlib.axes.Axes | None = None,
    ) -> matplotlib.axes.Axes:
        """Draws a column of the trace over another one. Needs matplotlib.

        Args:
            x: The column across: time, s, or ``angle_rad`` for the torque-angle loop.
            y: The column upwards.
            events: Mark breaks, sticks and other events.
            ax: Axes to draw into; new ones by default.

        Returns:
            The axes.
        """
        return _plots.run(self, x, y, events, ax)

    def _part(self, what: str) -> Columns:
        if what not in ("trace", "events"):
            raise ValueError(f"expected 'trace' or 'events', got {what!r}")
        if what == "trace" and not self.trace:
            raise ValueError("this run was made with trace=False: there are its events only")
        return self.trace if what == "trace" else self.events

    def _attributes(self) -> dict[str, Any]:
        about = {name: self.summary[name] for name in ("title", "crepitus_version", "crepitus_commit")}
        about["scene_sha256"] = scene_hash(self.scene)
        return {name: value for name, value in about.items() if value is not None}

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Run):
            return NotImplemented
        return (
            self.scene == other.scene
            and _frames.same(self.trace, other.trace)
            and _frames.same(self.events, other.events)
            and _unmeasured(self.summary) == _unmeasured(other.summary)
        )

    def __hash__(self) -> int:
        return hash(self.scene)

    def _repr_html_(self) -> str:
        return _html.run(self)

    def __repr__(self) -> str:
        rows = len(self.trace["t_s"]) if self.trace else 0
        return (
            f"<Run of {self.scene.title!r}: {rows} rows, {len(self.events['t_s'])} events, "
            f"{len(self.warnings)} warnings>"
        )


def _unmeasured(summary: dict[str, Any]) -> dict[str, Any]:
    kept = {name: value for name, value in summary.items() if name not in _MEASURED}
    kept["effects"] = [
        {name: value for name, value in effect.items() if name not in _MEASURED} for effect in summary["effects"]
    ]
    return kept


def scene_hash(scene: SceneLike) -> str:
    """SHA-256 of a scene as it runs: of :attr:`Scene.toml` in UTF-8, with every default written out."""
    return sha256(_scene(scene).toml.encode()).hexdigest()


def run(
    scene: SceneLike,
    *,
    solver: str | None = None,
    step: float | None = None,
    precision: str | None = None,
    as_device: bool = False,
    set: Mapping[str, Any] | None = None,
    motion: tuple[Numbers, Numbers] | None = None,
    trace: bool = True,
    trace_every: int = 1,
    costs: bool = False,
) -> Run:
    """Simulates a scene, to the bit as ``crepitus run`` does.

    Args:
        scene: A path, the name of a scene that ships (:func:`crepitus.scenes`), a ``summary.json``, a dict,
            or a :class:`crepitus.Scene`.
        solver: Another solver: ``exact``, ``exact-events``, ``reference``, …
        step: Another solver step, s.
        precision: ``f32`` or ``f64``.
        as_device: Render as the device does: input check, turn-back guard, slew and torque limits.
        set: Other values at keys of the scene, such as ``{"effects.crepitus.preset": "fine"}``.
        motion: Times, s, and angles, rad, instead of the scene's motion: two arrays of at least 4 finite numbers,
            the times increasing. They are smoothed as a recording from a file is (``motion.cutoff_hz``), and the run lasts
            as long as they do, unless ``set`` has a ``duration_s``.
        trace: Keep the trace.
        trace_every: Keep only every n-th row of it.
        costs: Measure what each effect costs, and note it in the summary: a second or so.

    Raises:
        SceneError: The scene cannot be read.
        RunError: The run failed.
        MemoryError: The trace does not fit into memory.
        KeyboardInterrupt: After Ctrl-C, within a tenth of a second.

    Other threads run meanwhile: the GIL is released.
    """
    every = _whole("trace_every", trace_every)
    checked = _scene(scene)
    if motion is not None:
        checked = with_motion(checked, motion)
    checked = checked.with_(
        solver=solver, step=step, precision=precision, as_device=as_device, set=_dict(set)
    )
    rows, events, summary = _crepitus.simulate(
        checked, trace=bool(trace), trace_every=every, costs=bool(costs)
    )
    return Run(checked, rows or {}, events, json.loads(summary))


def reference(
    scene: SceneLike, *, set: Mapping[str, Any] | None = None, trace: bool = True
) -> Run:
    """Runs a scene with the event-driven solver, which has no step: event times to 1e-12 s.

    Effects other than the joint's symptoms (an encoder, a motor, a hand) have no such solver;
    they raise :class:`crepitus.SceneError`.
    """
    return run(scene, solver="reference", set=set, trace=trace)


def _scene(scene: SceneLike) -> Scene:
    if isinstance(scene, Scene):
        return scene
    return Scene(scene if not isinstance(scene, Mapping) else dict(scene))


def _dict(mapping: Mapping[str, Any] | None) -> dict[str, Any] | None:
    if mapping is None:
        return None
    if not isinstance(mapping, Mapping):
        raise TypeError(
            f"set: expected a dict such as {{'duration_s': 2.0}}, got {type(mapping).__name__}"
        )
    return dict(mapping)


def _whole(name: str, number: int) -> int:
    if isinstance(number, bool) or not hasattr(number, "__index__"):
        raise TypeError(f"{name}: expected a whole number, got {number!r}")
    whole = number.__index__()
    if not 1 <= whole < 2**63:
        raise ValueError(f"{name}: expected a whole number from 1 on, got {number}")
    return whole
