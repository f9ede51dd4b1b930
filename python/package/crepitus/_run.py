"""Runs of scenes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from . import _crepitus
from ._crepitus import Scene
from ._types import Columns, SceneLike


@dataclass(frozen=True)
class Run:
    """A run: its trace, its events, its summary.

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

    def __repr__(self) -> str:
        rows = len(self.trace["t_s"]) if self.trace else 0
        return (
            f"<Run of {self.scene.title!r}: {rows} rows, {len(self.events['t_s'])} events, "
            f"{len(self.warnings)} warnings>"
        )


def run(
    scene: SceneLike,
    *,
    solver: str | None = None,
    step: float | None = None,
    precision: str | None = None,
    as_device: bool = False,
    set: Mapping[str, Any] | None = None,
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
    checked = _scene(scene).with_(
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
