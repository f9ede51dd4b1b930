"""What a notebook shows of a result."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._crepitus import Scene
    from ._identify import BraceFit, Estimate, KneeFit
    from ._run import Run
    from ._sweep import Sweep

#: Rows and columns of a sweep that are shown.
_ROWS = 10


def run(run: Run) -> str:
    """The title, the numbers in brief, and warnings."""
    summary = run.summary
    rows = [
        ("solver", f"{summary['solver']}, {summary['precision']}" + _with_step(summary)),
        ("rows, events", f"{len(run.trace['t_s']) if run.trace else 0}, {len(run.events['t_s'])}"),
    ]
    for name, path, unit in (
        ("simulated", "simulated_s", "s"),
        ("torque, rms", "torque.rms_nm", "N·m"),
        ("torque, largest", "torque.max_nm", "N·m"),
        ("torque at the hand, rms", "hand_torque.rms_nm", "N·m"),
        ("cycles", "cycles.count", ""),
        ("cycles, mean frequency", "cycles.frequency_hz", "Hz"),
    ):
        value = _at(summary, path)
        if value is not None:
            rows.append((name, f"{_short(value)} {unit}".strip()))
    rows += [("warning", warning) for warning in run.warnings]
    return _titled(f"Run: {run.scene.title}", _pairs(rows))


def scene(scene: Scene) -> str:
    """The title, what it has, and its text."""
    rows = [
        ("file", scene.file),
        ("length", f"{scene.duration_s:g} s of {scene.motion}"),
        ("solver", f"{scene.solver}, steps of {scene.step_s:g} s"),
        ("effects", ", ".join(scene.effects) or "none"),
        *(("warning", warning) for warning in scene.warnings),
    ]
    text = f"<details><summary>TOML</summary><pre>{escape(scene.toml)}</pre></details>"
    about = f"<p>{escape(scene.description)}</p>" if scene.description else ""
    return _titled(f"Scene: {scene.title}", about + _pairs(rows) + text)


def sweep(rows: Sweep) -> str:
    """What is varied, and the first rows of some columns."""
    wanted = ["torque.rms_nm", "torque.max_nm", "cycles.frequency_hz", "events.break", "failure"]
    names = ["index", *rows.varied, *(name for name in wanted if name in rows and name not in rows.varied)]
    count = len(rows["index"])
    body = [[_short(rows[name][row]) for name in names] for row in range(min(count, _ROWS))]
    rest = f"<p>… {count - _ROWS} more rows, {len(rows)} columns</p>" if count > _ROWS else ""
    missing = f", {rows.missing} not run yet" if rows.missing else ""
    return _titled(
        f"Sweep: {rows.about['title']}",
        f"<p>{count} of {rows.runs} runs{missing}</p>" + table(names, body) + rest,
    )


def knee(fit: KneeFit) -> str:
    """The proposal, its values, and what is not explained."""
    best = fit.proposed
    rows = [
        ("next model", f"{fit.next.symptom}, {fit.next.left_out_nm:.4f} N·m rms in strokes left out"),
        ("this one", f"{best.left_out_nm:.4f} N·m rms in strokes left out"),
        ("friction", _estimate(fit.friction_nm)),
        ("not explained", f"{fit.unexplained['rms_nm']:.3f} N·m rms"),
        *((f"cannot be told: {symptom}", why) for symptom, why in fit.cannot_be_told.items()),
        *(("warning", warning) for warning in fit.warnings),
    ]
    if fit.grade:
        rows.insert(0, ("nearest preset", f"{fit.grade['preset']}, {fit.grade['steps']:.1f} steps away"))
    values = [[key, _estimate(value)] for key, value in best.values.items()]
    return _titled(f"Fit: {best.symptom}", table(["value", "95 %"], values) + _pairs(rows))


def brace(fit: BraceFit) -> str:
    """The values, and what the model leaves."""
    rows = [
        ("fit", f"{fit.swings} swings, {fit.swung_s:.1f} s; it leaves {fit.residual_deg:.4f}° rms"),
        *(("note", note) for note in fit.notes),
        *(("warning", warning) for warning in fit.warnings),
    ]
    values = [[key, _estimate(value)] for key, value in fit.values.items()]
    return _titled("Brace", table(["value", "95 %"], values) + _pairs(rows))


def _estimate(of: Estimate) -> str:
    if of.value is None:
        return f"not visible: {of.why}"
    if of.half_width is None:
        return f"{of.value:.4g} {of.unit}, between two strokes"
    told = "" if of.is_told else ", not told"
    return f"{of.value:.4g} ± {of.half_width:.2g} {of.unit}{told}"


def table(names: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table."""
    head = "".join(f"<th>{escape(name)}</th>" for name in names)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _pairs(rows: Iterable[tuple[str, str]]) -> str:
    body = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td style='text-align:left'>{escape(value)}</td></tr>"
        for name, value in rows
    )
    return f"<table><tbody>{body}</tbody></table>"


def _titled(title: str, content: str) -> str:
    return f"<div><p><strong>{escape(title)}</strong></p>{content}</div>"


def _with_step(summary: Mapping[str, Any]) -> str:
    return "" if summary["step_s"] is None else f", steps of {summary['step_s']:g} s"


def _at(summary: Mapping[str, Any], path: str) -> Any:
    found: Any = summary
    for key in path.split("."):
        found = found.get(key) if isinstance(found, Mapping) else None
    return found


def _short(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
