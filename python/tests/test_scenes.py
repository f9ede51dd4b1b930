"""Scenes: where they come from, how they change, and what is wrong with them."""

from __future__ import annotations

import copy
import pickle
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crepitus
from crepitus import Scene, SceneError

from .conftest import ROOT, Tool

JOINT: dict[str, Any] = {
    "version": 1,
    "title": "Of a dict",
    "duration_s": 0.5,
    "motion": {"kind": "constant", "velocity_rad_s": 1.0},
    "solver": {"kind": "exact-events", "step_s": 5e-5},
    "effects": {"crepitus": {"preset": "coarse"}},
}


def test_the_same_scene_from_everywhere(tmp_path: Path) -> None:
    file = ROOT / "scenes" / "slow-examination.toml"
    by_name = Scene("slow-examination")
    assert Scene(str(file)).toml == Scene(file).toml == by_name.toml
    assert Scene.from_toml(file.read_text()).toml == by_name.toml
    assert Scene.from_toml(by_name.toml).toml == by_name.toml
    assert Scene(by_name) == by_name
    assert by_name.title in repr(by_name) and "exact-events" in repr(by_name)


def test_a_dict_is_a_scene() -> None:
    scene = Scene(JOINT)
    assert (scene.title, scene.duration_s, scene.motion) == ("Of a dict", 0.5, "constant")
    assert (scene.solver, scene.step_s, scene.effects) == ("exact-events", 5e-5, ["crepitus"])
    run = crepitus.run(JOINT)
    assert len(run.trace["t_s"]) == 10_001
    # Numbers of NumPy are numbers.
    numpy = {**JOINT, "duration_s": np.float32(0.5), "version": np.int64(1)}
    assert Scene(numpy).toml == scene.toml
    knots = [{"t_s": t, "omega_rad_s": w} for t, w in zip(np.arange(3.0), np.ones(3), strict=True)]
    knotted = {**JOINT, "motion": {"kind": "velocity-knots", "knots": knots}}
    assert Scene(knotted).motion == "velocity-knots"


def test_changes_make_another_scene() -> None:
    scene = Scene("slow-examination")
    changed = scene.with_(solver="exact", step=1e-3, set={"effects.crepitus.preset": "fine"})
    assert (scene.solver, changed.solver, changed.step_s) == ("exact-events", "exact", 1e-3)
    assert 'preset = "fine"' in changed.toml and 'preset = "coarse"' in scene.toml
    # The last one counts, whichever way it was written.
    assert changed.set("solver.kind", "exact-break").solver == "exact-break"
    assert changed.set("solver.step_s", 2e-3).step_s == 2e-3
    assert changed.set("solver", {"kind": "exact", "step_s": 0.01}).step_s == 0.01
    assert changed.with_(solver="exact-events").step_s == 1e-3
    # A preset after others is a whole preset.
    assert changed.set("effects.crepitus.preset", "coarse").with_(step=5e-5, solver="exact-events") == scene
    assert changed != scene and hash(changed) != hash(scene)
    assert scene.with_(as_device=False) == scene
    device = Scene("passive-examination", as_device=True)
    assert "device = true" in device.toml
    assert "device = true" not in device.set("device", False).toml


def test_scenes_travel_to_other_processes(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text((ROOT / "scenes" / "slow-examination.toml").read_text())
    scene = Scene(file, set={"duration_s": 2.0}).with_(precision="f32")
    file.unlink()
    for other in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene)):
        assert other == scene
        # A preset still is one: not only the numbers that came of it.
        fine = other.set("effects.crepitus.preset", "fine")
        assert "inertia_kg_m2 = 0.0008" in fine.toml
    # Its text was read once.
    assert scene.with_(step=1e-3).step_s == 1e-3
    with pytest.raises(SceneError, match="no such file"):
        Scene(file)


BAD: list[tuple[str, list[str], dict[str, Any]]] = [
    ("", [], {}),
    ("version = 2", [], {}),
    ("version = [", [], {}),
    ("OK", ["--set", "solver.step_s=-1"], {"set": {"solver.step_s": -1}}),
    ("OK", ["--set", "duration_s=nan"], {"set": {"duration_s": float("nan")}}),
    ("OK", ["--set", "duration_s=inf"], {"set": {"duration_s": np.inf}}),
    ("OK", ["--solver", "exakt"], {"solver": "exakt"}),
    ("OK", ["--solver", "euler"], {"solver": "euler"}),
    ("OK", ["--step", "0.0"], {"step": 0}),
    ("OK", ["--precision", "f16"], {"precision": "f16"}),
    ("OK", ["--set", 'effects.crepitus.preset="coars"'], {"set": {"effects.crepitus.preset": "coars"}}),
    ("OK", ["--set", "effects.crepitus.static_torque_nm=0.1"], {"set": {"effects.crepitus.static_torque_nm": 0.1}}),
    ("OK", ["--set", "effects.crepitos={}"], {"set": {"effects.crepitos": {}}}),
    ("OK", ["--set", "motion=true"], {"set": {"motion": True}}),
    ("OK", ["--set", "title.x=1"], {"set": {"title.x": 1}}),
    ("OK\nnonsense = 1", [], {}),
]


@pytest.mark.parametrize(("text", "flags", "changes"), BAD)
def test_errors_are_the_tools(
    text: str, flags: list[str], changes: dict[str, Any], tool: Tool, tmp_path: Path
) -> None:
    good = (ROOT / "scenes" / "slow-examination.toml").read_text()
    file = tmp_path / "bad.toml"
    file.write_text(text.replace("OK", "", 1) + "\n" + good if text.startswith("OK") else text)
    done = tool("run", file, "--out", tmp_path / "out", *flags)
    assert done.returncode == 2, done.stderr
    with pytest.raises(SceneError) as raised:
        crepitus.run(file, **changes)
    error = raised.value
    assert f"error: {error}\n" == done.stderr
    assert isinstance(error, ValueError)
    assert error.file == str(file)
    assert error.message and error.message in str(error)
    if error.line is not None:
        assert f"line {error.line}" in str(error)
    assert pickle.loads(pickle.dumps(error)).key == error.key


def test_an_error_names_line_and_key() -> None:
    text = Scene("slow-examination").toml.replace("duration_s = 10.0", "duration_s = -1.0")
    with pytest.raises(SceneError) as raised:
        Scene.from_toml(text, file="mine.toml")
    error = raised.value
    assert (error.file, error.key) == ("mine.toml", "duration_s")
    assert text.splitlines()[(error.line or 0) - 1] == "duration_s = -1.0"
    # A dict has no lines.
    with pytest.raises(SceneError) as raised:
        Scene({**JOINT, "duration_s": -1.0})
    assert (raised.value.file, raised.value.line) == ("<dict>", None)
    assert str(raised.value).startswith("<dict>: `duration_s`: ")


def nested() -> dict[str, Any]:
    loop: dict[str, Any] = {}
    loop["again"] = loop
    return loop


@pytest.mark.parametrize(
    "bad",
    [
        None,
        b"slow-examination",
        3.0,
        ["slow-examination"],
        object(),
        {1: 2},
        {"version": None},
        {"version": {1, 2}},
        {"version": date(2020, 1, 1)},
        {"version": 1j},
        {"version": b"1"},
        {"version": np.array([1 + 2j])},
        nested(),
        {},
        {"version": []},
        {"version": 10**400},
        {"version": float("nan")},
        {"version": "1"},
        {"": 1},
        "",
        "\0",
        "scenes",
        "/",
        "/dev/null",
        "no/such/scene.toml",
        "summary.json",
    ],
    ids=repr,
)
def test_no_scene_is_an_exception(bad: Any) -> None:
    with pytest.raises((SceneError, TypeError, ValueError)) as raised:
        crepitus.run(bad)
    assert str(raised.value)


@pytest.mark.parametrize(
    "changes",
    [
        {"step": "fast"},
        {"solver": 3},
        {"set": "duration_s=1"},
        {"set": {"duration_s": None}},
        {"set": {3: 1}},
        {"set": {"": 1}},
        {"set": {"a..b": 1}},
        {"set": {"duration_s": nested()}},
        {"trace_every": 0},
        {"trace_every": -1},
        {"trace_every": 1.5},
        {"trace_every": True},
        {"trace_every": 2**64},
        {"nonsense": 1},
    ],
    ids=repr,
)
def test_no_change_is_an_exception(changes: dict[str, Any]) -> None:
    with pytest.raises((SceneError, TypeError, ValueError)) as raised:
        crepitus.run("slow-examination", **changes)
    assert str(raised.value)


def test_a_recording_is_relative_to_its_file(tmp_path: Path) -> None:
    time_s = np.linspace(0.0, 2.0, 201)
    angle_deg = 30.0 + 20.0 * np.sin(2.0 * np.pi * 0.5 * time_s)
    rows = "\n".join(f"{t},{a}" for t, a in zip(time_s, angle_deg, strict=True))
    (tmp_path / "knee.csv").write_text(f"time_s,knee_deg\n{rows}\n")
    motion = {
        "kind": "recording",
        "file": "knee.csv",
        "time_column": "time_s",
        "angle_column": "knee_deg",
        "unit": "deg",
    }
    toml = Scene({**JOINT, "motion": {**motion, "file": str(tmp_path / "knee.csv")}}).toml
    relative = toml.replace(str(tmp_path / "knee.csv"), "knee.csv")
    scene = Scene.from_toml(relative, file=tmp_path / "mine.toml")
    assert crepitus.run(scene).summary["data"]["sha256"]
    with pytest.raises(SceneError, match=r"knee\.csv"):
        Scene({**JOINT, "motion": motion})
    # A scene has read it: the file may go.
    (tmp_path / "knee.csv").unlink()
    assert len(crepitus.run(crepitus.Scene(scene), trace_every=10).trace["t_s"]) > 0
