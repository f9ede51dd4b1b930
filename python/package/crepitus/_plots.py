"""Figures of results, as axes of matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _frames
from ._types import Columns

if TYPE_CHECKING:
    import matplotlib.axes

    from ._run import Run

#: Marks of events of the stick-slip object.
_MARKS = {"break": "v", "stick": "o", "reverse": "s"}

_QUANTITIES = {"t": "time", "omega": "speed"}


def run(run: Run, x: str, y: str, events: bool, ax: matplotlib.axes.Axes | None) -> matplotlib.axes.Axes:
    """A column of a trace over another one, with marks at the events."""
    for name in (x, y):
        if name not in run.trace:
            there = ", ".join(run.trace) or "nothing: the run was made with trace=False"
            raise ValueError(f"the trace has no column {name!r}: there are {there}")
    ax = ax or _axes()
    ax.plot(run.trace[x], run.trace[y], linewidth=0.7)
    if events and len(run.events["t_s"]):
        at = [_values(run, name) for name in (x, y)]
        for event in dict.fromkeys(run.events["event"].tolist()):
            of = run.events["event"] == event
            ax.plot(at[0][of], at[1][of], _MARKS.get(event, "d"), markersize=4, linestyle="", label=event)
        ax.legend()
    _label(ax, x, y)
    ax.set_title(run.scene.title)
    return ax


def sweep(rows: Columns, varied: Sequence[str], y: str, ax: matplotlib.axes.Axes | None) -> matplotlib.axes.Axes:
    """A column of a sweep over what was varied."""
    if y not in rows:
        raise ValueError(f"the sweep has no column {y!r}: its columns are {', '.join(rows)}")
    numbers = [name for name in varied if rows[name].dtype.kind in "fi"]
    texts = [name for name in varied if name not in numbers]
    if not 1 <= len(numbers) <= 2 or len(texts) > 1 or (len(numbers) == 2 and texts):
        raise ValueError(
            f"a figure shows one or two varied numbers, one with a line for each text, not {', '.join(varied)}: "
            "choose rows and columns, and plot them"
        )
    ax = ax or _axes()
    if len(numbers) == 2:
        _map(ax, rows, numbers, y)
        return ax
    (x,) = numbers
    groups = np.unique(rows[texts[0]]) if texts else [None]
    for group in groups:
        of = np.ones(len(rows[x]), bool) if group is None else rows[texts[0]] == group
        order = np.argsort(rows[x][of], kind="stable")
        ax.plot(rows[x][of][order], rows[y][of][order], ".-", label=None if group is None else str(group))
    if texts:
        ax.legend(title=texts[0])
    _label(ax, x, y)
    return ax


def _map(ax: Any, rows: Columns, axes: Sequence[str], y: str) -> None:
    first, second = axes
    (xs, across), (ys, up) = (np.unique(rows[name], return_inverse=True) for name in (first, second))
    if len(xs) * len(ys) == len(rows[y]) and min(len(xs), len(ys)) > 1:
        heights = np.full((len(ys), len(xs)), np.nan)
        heights[up, across] = rows[y]
        drawn = ax.pcolormesh(xs, ys, heights, shading="nearest")
    else:
        drawn = ax.scatter(rows[first], rows[second], c=rows[y], s=12)
    ax.figure.colorbar(drawn, ax=ax, label=_named(y))
    _label(ax, first, second)


def _values(run: Run, name: str) -> Any:
    """A column at the times of the events: their own where they have it, else between the rows."""
    of_event = {"t_s": "t_s", "torque_nm": "torque_before_nm"}.get(name)
    if of_event:
        return run.events[of_event]
    return np.interp(run.events["t_s"], run.trace["t_s"], run.trace[name])


def _axes() -> Any:
    return _frames.need("matplotlib.pyplot").subplots(layout="constrained")[1]


def _label(ax: Any, x: str, y: str) -> None:
    ax.set_xlabel(_named(x))
    ax.set_ylabel(_named(y))


def _named(name: str) -> str:
    """A name with its unit, as an axis has it: ``torque_nm`` is "torque, N·m"."""
    unit, words = _frames.unit(name), _frames.without_unit(name).replace("_", " ")
    if unit is None:
        return name
    return f"{_QUANTITIES.get(words, words)}, {unit}"
