"""Many runs: each row is a run, and the same as the tool's."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import crepitus

from .conftest import Tool

TS = "effects.crepitus.static_torque_nm"
SHORT = {"duration_s": 0.3}


def test_a_row_is_a_run() -> None:
    points = {TS: np.linspace(1.6, 4.0, 7), "solver.kind": ["exact"] * 3 + ["exact-events"] * 4}
    rows = crepitus.run_many("low-speed", points, set=SHORT)
    assert list(rows["index"]) == list(range(7))
    assert (rows[TS] == points[TS]).all()
    for number in (0, 3, 6):
        values = {path: column[number] for path, column in points.items()}
        summary = crepitus.run("low-speed", set=SHORT | values, trace=False).summary
        assert rows["torque.rms_nm"][number] == summary["torque"]["rms_nm"]
        assert rows["energy.friction_j"][number] == summary["energy"]["friction_j"]
        assert rows["events.break"][number] == summary["events"]["break"]
        assert rows["solver"][number] == summary["solver"]
    again = crepitus.run_many("low-speed", [dict(zip(points, row)) for row in zip(*points.values())], set=SHORT, threads=1)
    assert list(rows) == list(again)
    for name, column in rows.items():
        np.testing.assert_array_equal(column, again[name])


@pytest.mark.parametrize("form", ["csv", "parquet"])
def test_rows_are_those_of_the_tool(tool: Tool, tmp_path: Path, form: str) -> None:
    import polars

    vary = {"effects.cuff.stiffness_nm_per_rad": "60:300:log", "effects.crepitus.preset": ["coarse", "fine"]}
    mine = crepitus.sweep("everything", vary, latin=40, seed=9, set={"duration_s": 0.1})
    flags = ["--vary", "effects.cuff.stiffness_nm_per_rad=60:300:log", "--vary", "effects.crepitus.preset=coarse,fine"]
    out = tmp_path / "s"
    done = tool("sweep", "everything", *flags, "--latin", 40, "--seed", 9, "--set", "duration_s=0.1", "--out", out, "--format", form)
    if "built without Parquet" in done.stderr:
        pytest.skip("this tool was built without Parquet")
    assert done.returncode == 0, done.stderr
    file = out / f"sweep.{form}"
    theirs = polars.read_parquet(file) if form == "parquet" else polars.read_csv(file, infer_schema_length=None)
    assert set(theirs.columns) == set(mine)
    for name, column in mine.items():
        other = theirs[name].to_numpy()
        if column.dtype.kind == "U":
            assert list(column) == ["" if text is None else text for text in theirs[name]], name
        else:
            np.testing.assert_array_equal(column, other.astype(column.dtype), err_msg=name)


def test_a_grid_is_every_combination_and_the_last_is_fastest() -> None:
    rows = crepitus.sweep("low-speed", {TS: "2:3:lin2", "solver.step_s": "1e-5:1e-3:log3"}, set=SHORT)
    assert list(rows[TS]) == [2.0] * 3 + [3.0] * 3
    assert list(rows["solver.step_s"][:3]) == [1e-5, 1e-4, 1e-3]
    assert list(rows["failure"]) == [""] * 6


def test_a_run_that_fails_is_a_row() -> None:
    rows = crepitus.run_many("low-speed", {"effects.crepitus.kinetic_torque_nm": [0.3, 100.0]}, set=SHORT)
    assert rows["failure"][0] == "" and "kinetic_torque_nm = 100" in rows["failure"][1]
    assert np.isfinite(rows["torque.mean_nm"][0]) and np.isnan(rows["torque.mean_nm"][1])


def test_what_is_wrong_is_said() -> None:
    with pytest.raises(crepitus.SceneError, match="stifness"):
        crepitus.run_many("low-speed", {"effects.crepitus.stifness": [1.0]})
    with pytest.raises(ValueError, match="differ in length"):
        crepitus.run_many("low-speed", {TS: [1.0, 2.0], "duration_s": [1.0]})
    with pytest.raises(ValueError, match="no row"):
        crepitus.run_many("low-speed", {TS: []})
    with pytest.raises(ValueError, match="no row"):
        crepitus.run_many("low-speed", [])
    with pytest.raises(ValueError, match="other keys"):
        crepitus.run_many("low-speed", [{TS: 1.0}, {"duration_s": 1.0}])
    with pytest.raises(ValueError, match="nothing is varied"):
        crepitus.sweep("low-speed", {})
    with pytest.raises(ValueError, match="how many values"):
        crepitus.sweep("low-speed", {TS: "1:2"})
    with pytest.raises(ValueError, match="not both"):
        crepitus.sweep("low-speed", {TS: "1:2"}, latin=3, sobol=4)
    with pytest.raises(TypeError):
        crepitus.sweep("low-speed", {TS: 1.0})  # type: ignore[dict-item]
    with pytest.raises((ValueError, OverflowError)):
        crepitus.sweep("low-speed", {TS: [1.0]}, threads=0)


def test_sensitivity_through_files(tool: Tool, tmp_path: Path) -> None:
    """As docs/sweeps.md has it: SALib chooses the points, the tool runs them, SALib reads the rows."""
    import polars
    from SALib.analyze import sobol as analyze
    from SALib.sample import sobol as sample

    joint = "effects.crepitus."
    names = [joint + "stiffness_nm_per_rad", joint + "inertia_kg_m2", joint + "damping_nms_per_rad"]
    problem = {"num_vars": 3, "names": names, "bounds": [[280, 520], [0.007, 0.013], [0, 1e-6]]}
    points = tmp_path / "points.csv"
    polars.DataFrame(sample.sample(problem, 64, calc_second_order=False, seed=1), schema=names).write_csv(points)
    out = tmp_path / "s"
    done = tool("sweep", "high-speed", "--points", points, "--out", out, "--set", "effects.crepitus.convention=physical")
    assert done.returncode == 0, done.stderr
    # A tool that was built without Parquet writes CSV.
    parquet, table = out / "sweep.parquet", out / "sweep.csv"
    rows = polars.read_parquet(parquet) if parquet.exists() else polars.read_csv(table, infer_schema_length=None)
    rows = rows.sort("index")
    indices = analyze.analyze(problem, rows["cycles.frequency_hz"].to_numpy(), calc_second_order=False, seed=1)
    # f ~ sqrt(kr/J): both alike, and a damping of nothing does nothing.
    assert abs(indices["S1"][0] - 0.5) < 0.15 and abs(indices["S1"][1] - 0.5) < 0.15
    assert indices["ST"][2] < 0.01


def test_ctrl_c_ends_a_sweep() -> None:
    script = (
        "import crepitus\n"
        "print('ready', flush=True)\n"
        "crepitus.sweep('everything', {'duration_s': '100:200:lin1000'})\n"
    )
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert child.stdout is not None
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.5)
    begun = time.monotonic()
    os.kill(child.pid, signal.SIGINT)
    _, error = child.communicate(timeout=30)
    assert "KeyboardInterrupt" in error
    assert time.monotonic() - begun < 10


def test_what_is_varied_counts_more_than_what_was_changed() -> None:
    scene = crepitus.Scene("low-speed", set=SHORT).with_(solver="exact-events", step=1e-4)
    rows = crepitus.run_many(scene, {"solver.kind": ["exact", "euler"], "solver.step_s": [1e-3, 1e-3]})
    assert list(rows["solver.kind"]) == ["exact", "euler"] and "euler" in rows["failure"][1]
    expected = crepitus.run(scene.with_(solver="exact", step=1e-3)).summary["torque"]["rms_nm"]
    assert rows["torque.rms_nm"][0] == expected
