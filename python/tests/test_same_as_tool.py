"""A run from Python is the tool's run, to the bit."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crepitus

from .conftest import Tool

PHASES = {"slip-": -1, "stick": 0, "slip+": 1}

# Of the computer or of the build, not of the run.
OF_THE_MOMENT = {"wall_s", "real_time_factor", "crepitus_commit"}
COSTS = {"ns_per_step", "ns_resolution"}

RUNS: list[tuple[str, list[str], dict[str, Any]]] = [
    ("slow-examination", [], {}),
    (
        "slow-examination",
        ["--solver", "exact", "--step", "1e-3", "--set", "effects.crepitus.preset=fine"],
        {"solver": "exact", "step": 1e-3, "set": {"effects.crepitus.preset": "fine"}},
    ),
    ("slow-examination", ["--solver", "reference"], {"solver": "reference"}),
    ("slow-examination", ["--precision", "f32"], {"precision": "f32"}),
    ("knee-pass-physical", ["--trace-every", "7"], {"trace_every": 7}),
    ("encoder", [], {}),
    (
        "passive-examination",
        ["--as-device", "--set", "duration_s=1.5"],
        {"as_device": True, "set": {"duration_s": 1.5}},
    ),
    ("everything", ["--set", "duration_s=1"], {"set": {"duration_s": 1}}),
    ("catch-and-clonus", [], {}),
    ("pendulum-mas-2", [], {}),
    ("crepitus-into-a-wall", ["--set", "output.play_events=true"], {"set": {"output.play_events": True}}),
]


def rows_of(file: Path) -> dict[str, list[str]]:
    with file.open(newline="") as text:
        names, *rows = csv.reader(text)
    return {name: [row[n] for row in rows] for n, name in enumerate(names)}


def same_bits(ours: np.ndarray, theirs: list[str], name: str) -> None:
    if ours.dtype.kind == "U":
        assert ours.tolist() == theirs, name
    elif name == "phase":
        assert ours.tolist() == [PHASES[word] for word in theirs]
    else:
        numbers = np.array([float(cell or "nan") for cell in theirs])
        assert ours.astype(np.float64).tobytes() == numbers.tobytes(), name


def of_the_run(summary: dict[str, Any]) -> dict[str, Any]:
    kept = {key: value for key, value in summary.items() if key not in OF_THE_MOMENT}
    kept["effects"] = [
        {key: value for key, value in effect.items() if key not in COSTS}
        for effect in kept["effects"]
    ]
    return kept


@pytest.mark.parametrize(("name", "flags", "changes"), RUNS)
def test_trace_events_and_summary_are_the_tools(
    name: str, flags: list[str], changes: dict[str, Any], tool: Tool, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    done = tool("run", name, "--out", out, *flags)
    assert done.returncode == 0, done.stderr
    run = crepitus.run(name, **changes)

    trace = rows_of(out / "trace.csv")
    assert list(run.trace) == list(trace)
    for column, cells in trace.items():
        same_bits(run.trace[column], cells, column)
    events = rows_of(out / "events.csv")
    assert list(run.events) == list(events)
    for column, cells in events.items():
        same_bits(run.events[column], cells, column)
    summary = json.loads((out / "summary.json").read_text())
    assert of_the_run(run.summary) == of_the_run(summary)
    assert set(run.summary) == set(summary)

    # And what the tool has written can be run again.
    again = crepitus.run(out / "summary.json", trace_every=changes.get("trace_every", 1))
    assert of_the_run(again.summary) == of_the_run(summary)
    assert again.trace["t_s"].tobytes() == run.trace["t_s"].tobytes()


def test_costs_are_measured_when_they_are_asked_for(tool: Tool, tmp_path: Path) -> None:
    tool("run", "encoder", "--costs", "--out", tmp_path / "out")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    run = crepitus.run("encoder", trace=False, costs=True)
    assert run.trace == {}
    for ours, theirs in zip(run.summary["effects"], summary["effects"], strict=True):
        assert set(ours) == set(theirs)
    assert COSTS & set(run.summary["effects"][0])
    assert not COSTS & set(crepitus.run("encoder").summary["effects"][0])


def test_what_ships_is_what_the_tool_lists(tool: Tool) -> None:
    scenes = json.loads(tool("scenes", "--json").stdout)
    assert list(crepitus.scenes()) == [scene["name"] for scene in scenes]
    for scene in scenes:
        ours = crepitus.scenes()[scene["name"]]
        assert ours == {key: scene[key] for key in ours}
    presets = json.loads(tool("presets", "--json").stdout)
    shipped = [preset for preset in presets if preset["file"] is None]
    assert list(crepitus.presets().values()) == shipped
    parameters = json.loads(tool("params", "list", "--json").stdout)
    assert list(crepitus.parameters().values()) == parameters
