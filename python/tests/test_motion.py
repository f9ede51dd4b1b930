"""Motions as arrays are those of a file."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crepitus
from crepitus import Scene, SceneError


def samples() -> tuple[np.ndarray, np.ndarray]:
    time_s = np.arange(0.0, 3.0, 0.01) + 7.25
    random = np.random.default_rng(59)
    angle_rad = 0.6 - 0.5 * np.cos(2.0 * np.pi * 0.4 * time_s) + random.normal(0.0, 2e-3, len(time_s))
    return time_s, angle_rad


def of_file(path: Path, time_s: np.ndarray, angle_rad: np.ndarray) -> dict[str, Any]:
    rows = [f"{t!r},{a!r}" for t, a in zip(time_s.tolist(), angle_rad.tolist(), strict=True)]
    path.write_text("\n".join(["time,angle", *rows]) + "\n")
    columns = {"time_column": "time", "angle_column": "angle", "unit": "rad"}
    return {"kind": "recording", "file": str(path), **columns}


@pytest.mark.parametrize("name", ["slow-examination", "everything"])
def test_the_bits_are_those_of_a_file(name: str, tmp_path: Path) -> None:
    time_s, angle_rad = samples()
    duration_s = float(time_s[-1] - time_s[0])
    motion = of_file(tmp_path / "knee.csv", time_s, angle_rad)
    expected = crepitus.run(name, set={"motion": motion, "duration_s": duration_s})
    run = crepitus.run(name, motion=(time_s, angle_rad))
    assert run.scene.duration_s == duration_s and run.scene.motion == "recording"
    assert list(run.trace) == list(expected.trace)
    for column, theirs in expected.trace.items():
        assert run.trace[column].tobytes() == theirs.tobytes(), column
    for column, theirs in expected.events.items():
        assert run.events[column].tolist() == theirs.tolist() or theirs.dtype.kind == "f", column
    assert run.summary.get("data") is None and expected.summary["data"] is not None


def test_what_is_set_comes_on_top(tmp_path: Path) -> None:
    time_s, angle_rad = samples()
    changes = {"motion.cutoff_hz": 3.0, "duration_s": 1.0, "motion.offset_deg": 2.0}
    run = crepitus.run("slow-examination", motion=(time_s.tolist(), angle_rad.tolist()), set=changes)
    assert run.scene.duration_s == 1.0 and "cutoff_hz = 3.0" in run.scene.toml
    motion = of_file(tmp_path / "knee.csv", time_s, angle_rad)
    scene = Scene("slow-examination", set={"motion": motion, **changes})
    assert run.trace["angle_rad"].tobytes() == crepitus.run(scene).trace["angle_rad"].tobytes()
    # A scene is all of itself: pickled, and as the summary has it.
    again = pickle.loads(pickle.dumps(run.scene))
    assert again == run.scene
    repeated = crepitus.run(Scene.from_toml(run.summary["scene_as_run"]))
    assert repeated.trace["torque_nm"].tobytes() == run.trace["torque_nm"].tobytes()


@pytest.mark.parametrize(
    ("time_s", "angle_rad", "match"),
    [
        ([0, 1, 2], [0, 0.1, 0.2], "at least 4"),
        ([0, 1, 2, 3], [0, 0.1, 0.2], "as many angles"),
        ([0, 1, 1, 3], [0, 0.1, 0.2, 0.3], r"time_s`: \[2\]"),
        ([0, 2, 1, 3], [0, 0.1, 0.2, 0.3], "sort"),
        ([0, 1, 2, np.nan], [0, 0.1, 0.2, 0.3], r"time_s`: \[3\]"),
        ([0, 1, 2, 3], [0, np.inf, 0.2, 0.3], r"angle_rad`: \[1\]"),
        ([0, 1, 2, 3], [0, 20.0, 40.0, 60.0], "rad"),
        ([[0, 1, 2, 3]], [0, 0.1, 0.2, 0.3], "one dimension"),
        ([0, 1, 2, 1e12], [0, 0.1, 0.2, 0.3], "angle_rad|duration_s"),
    ],
)
def test_what_is_no_motion_is_refused(time_s: Any, angle_rad: Any, match: str) -> None:
    with pytest.raises(ValueError, match=match):
        crepitus.run("slow-examination", motion=(time_s, angle_rad))


def test_a_motion_is_two_arrays_or_a_file() -> None:
    with pytest.raises(TypeError, match="two arrays"):
        crepitus.run("slow-examination", motion=3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="two arrays"):
        crepitus.run("slow-examination", motion=(1, 2, 3))  # type: ignore[arg-type]
    here = {"kind": "recording", "cutoff_hz": 0.4, "time_s": [0.0, 1.0, 2.0, 3.0], "angle_rad": [0.0, 0.1, 0.2, 0.3]}
    for change, match in [
        ({"file": "knee.csv"}, "not both"),
        ({"unit": "deg"}, "unit"),
        ({"time_s": "0, 1"}, "numbers in brackets"),
        ({"angle_rad": [0.0, "a", 0.1, 0.2]}, "numbers in brackets"),
    ]:
        with pytest.raises(SceneError, match=match):
            Scene("slow-examination", set={"motion": {**here, **change}, "duration_s": 1.0})
    for missing in ("time_s", "angle_rad"):
        motion = {key: value for key, value in here.items() if key != missing}
        with pytest.raises(SceneError, match="missing"):
            Scene("slow-examination", set={"motion": motion, "duration_s": 1.0})
