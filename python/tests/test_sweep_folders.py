"""Sweeps in a folder: resumed, repeated, shared with the tool; progress and Ctrl-C."""

from __future__ import annotations

import json
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
KR = "effects.crepitus.stiffness_nm_per_rad"
VARY = {TS: "1.6:4:lin5", KR: "20:200:log3"}
SHORT = {"duration_s": 0.3}


def sweep(**options: object) -> crepitus.Sweep:
    return crepitus.sweep("low-speed", VARY, set=SHORT, **options)  # type: ignore[arg-type]


def test_progress_counts_up_to_all_runs() -> None:
    seen: list[tuple[int, int]] = []
    rows = sweep(progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (15, 15) and seen == sorted(seen) and len(rows["index"]) == 15
    with pytest.raises(TypeError, match="progress"):
        sweep(progress=3)
    with pytest.raises(ZeroDivisionError):
        sweep(progress=lambda done, total: 1 // 0)


def test_a_bar_is_tqdm_or_a_line(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    sweep(progress=True)
    assert "15 of 15 runs\n" in capsys.readouterr().err
    monkeypatch.undo()
    pytest.importorskip("tqdm")
    sweep(progress=True)
    assert "15/15" in capsys.readouterr().err


def test_a_folder_has_the_rows(tmp_path: Path) -> None:
    plain = sweep()
    out = tmp_path / "s"
    kept = sweep(out=out)
    assert kept == plain and list(kept) == list(plain) and kept.folder == out
    assert {name: column.dtype for name, column in kept.items()} == {name: c.dtype for name, c in plain.items()}
    assert crepitus.read_sweep(out) == plain
    assert sweep(out=out) == plain
    assert crepitus.repeat(out) == plain
    again = crepitus.repeat(out, out=tmp_path / "t", threads=1)
    assert again == plain and again.missing == 0
    (table,) = out.glob("sweep.[pc]*")
    assert table.read_bytes() == (tmp_path / "t" / table.name).read_bytes()
    with pytest.raises(ValueError, match="another sweep.*force=True"):
        crepitus.sweep("low-speed", {TS: [2.0]}, set=SHORT, out=out)
    assert len(crepitus.sweep("low-speed", {TS: [2.0]}, set=SHORT, out=out, force=True)["index"]) == 1


def test_ctrl_c_keeps_the_finished_rows_and_the_same_call_goes_on(tmp_path: Path) -> None:
    counts: list[int] = []

    def stop(done: int, total: int) -> None:
        counts.append(done)
        if done >= 4:
            raise KeyboardInterrupt

    long = {TS: "1.6:4:lin300"}
    with pytest.raises(KeyboardInterrupt) as caught:
        crepitus.sweep("everything", {"duration_s": "0.1:0.3:lin300"}, threads=1, progress=stop)
    assert isinstance(caught.value, crepitus.SweepInterrupted)
    rows = caught.value.rows
    assert 4 <= len(rows["index"]) < 300 and rows.missing == 300 - len(rows["index"])
    assert "are finished" in str(caught.value)
    out = tmp_path / "s"
    settings = {"set": {"solver.kind": "exact", "duration_s": 4.0}, "out": out}
    with pytest.raises(crepitus.SweepInterrupted, match="the same call goes on"):
        crepitus.sweep("low-speed", long, threads=1, progress=stop, **settings)  # type: ignore[arg-type]
    half = crepitus.read_sweep(out)
    assert 4 <= len(half["index"]) < 300
    counts.clear()
    whole = crepitus.sweep("low-speed", long, progress=lambda done, total: counts.append(done), **settings)  # type: ignore[arg-type]
    assert counts[0] >= len(half["index"]) and counts[-1] == 300
    assert (whole["torque.rms_nm"][half["index"]] == half["torque.rms_nm"]).all()
    assert whole == crepitus.repeat(out)


def test_a_program_that_is_interrupted_says_what_is_kept(tmp_path: Path) -> None:
    script = (
        "import crepitus, sys\n"
        "print('ready', flush=True)\n"
        "crepitus.sweep('everything', {'duration_s': '1:2:lin1000'}, out=sys.argv[1])\n"
    )
    out = tmp_path / "s"
    command = [sys.executable, "-c", script, str(out)]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert child.stdout is not None
    assert child.stdout.readline() == "ready\n"
    deadline = time.monotonic() + 60
    while not list(out.glob("parts/0*.csv")) and time.monotonic() < deadline:
        time.sleep(0.05)
    os.kill(child.pid, signal.SIGINT)
    _, error = child.communicate(timeout=30)
    assert "SweepInterrupted" in error and "goes on from" in error
    assert len(crepitus.read_sweep(out)["index"]) > 0


def test_the_tool_and_the_package_read_each_others_folders(tool: Tool, tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    scene = crepitus.Scene(
        {
            "version": 1,
            "duration_s": 0.2,
            "motion": {"kind": "constant", "velocity_rad_s": 1.0},
            "solver": {"kind": "exact-events", "step_s": 5e-5},
            "effects": {"crepitus": {"preset": "coarse"}},
        }
    )
    points = {TS: [0.4, 0.35], "effects.crepitus.preset": ["coarse", "fine"]}
    rows = crepitus.run_many(scene.with_(step=1e-4), points, out=mine)
    done = tool("sweep", "--again", mine, "--out", tmp_path / "theirs")
    if "built without Parquet" not in done.stderr:
        assert done.returncode == 0, done.stderr
    assert crepitus.read_sweep(tmp_path / "theirs") == rows
    theirs = tmp_path / "tool"
    flags = ["--vary", f"{TS}=1.6:4:lin5", "--vary", f"{KR}=20:200:log3", "--set", "duration_s=0.3"]
    assert tool("sweep", "low-speed", *flags, "--out", theirs).returncode == 0
    assert crepitus.read_sweep(theirs) == sweep()
    assert crepitus.repeat(theirs) == sweep()


def test_what_is_no_folder_of_a_sweep_is_said(tmp_path: Path) -> None:
    for read in (crepitus.read_sweep, crepitus.repeat):
        with pytest.raises(OSError, match="sweep.json is missing"):
            read(tmp_path)
    (tmp_path / "sweep.json").write_text("{}")
    for read in (crepitus.read_sweep, crepitus.repeat):
        with pytest.raises(ValueError, match="not of this version"):
            read(tmp_path)


def test_another_program_is_named(tmp_path: Path) -> None:
    out = tmp_path / "s"
    rows = sweep(out=out)
    file = out / "sweep.json"
    about = json.loads(file.read_text())
    file.write_text(json.dumps({**about, "crepitus_version": "0.0.1"}))
    with pytest.warns(UserWarning, match=r"of crepitus 0\.0\.1"):
        assert crepitus.repeat(out) == rows


def test_a_preset_whose_numbers_were_changed_is_none() -> None:
    rows = crepitus.run_many("preset-coarse", {TS: [0.4, 0.35]}, set=SHORT)
    assert list(rows["preset"]) == ["coarse", ""]
    assert crepitus.run("preset-coarse", set={TS: 0.35, "duration_s": 0.1}).summary["preset"] is None


def test_rows_can_be_compared_and_copied() -> None:
    import copy
    import pickle

    rows = sweep()
    for other in (copy.deepcopy(rows), pickle.loads(pickle.dumps(rows)), dict(rows)):
        assert rows == other and not rows != other
    assert pickle.loads(pickle.dumps(rows)).varied == rows.varied
    other = sweep()
    other["torque.rms_nm"] = np.nextafter(other["torque.rms_nm"], 9.0)
    assert rows != other
