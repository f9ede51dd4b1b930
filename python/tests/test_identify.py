"""Models from measurements: the same as the tool's, typed; what cannot be told is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import crepitus

from .conftest import Tool

STEP_S = 4e-3


def knee(friction_nm: float = 2.0) -> dict[str, np.ndarray]:
    """A rigid leg that is bent and straightened over 80°, with holds; its friction turns round over two degrees."""
    low, way = np.radians(10.0), np.radians(80.0)
    pieces = [np.full(120, low)]
    for speed in (30.0, 60.0, 120.0, 200.0, 90.0):
        lasts = 1.875 * way / np.radians(speed)
        x = np.arange(0.0, lasts, STEP_S) / lasts
        stroke = way * x**3 * (10.0 + x * (6.0 * x - 15.0))
        pieces += [low + stroke, np.full(120, low + way), low + way - stroke, np.full(120, low)]
    angle = np.concatenate(pieces)
    omega = np.gradient(angle, STEP_S)
    share, torque = 0.0, np.empty_like(angle)
    random = np.random.default_rng(3)
    for row, turn in enumerate(np.diff(angle, prepend=angle[0])):
        share = float(np.clip(share + turn / np.radians(2.0), -1.0, 1.0))
        torque[row] = friction_nm * share
    torque += 6.0 * np.cos(angle) + 0.1 * omega + 0.05 * random.uniform(-0.5, 0.5, len(angle))
    return {"t_s": np.arange(len(angle)) * STEP_S, "angle_rad": angle, "torque_nm": torque}


def save(file: Path, columns: dict[str, np.ndarray]) -> Path:
    rows = np.column_stack(list(columns.values()))
    np.savetxt(file, rows, delimiter=",", header=",".join(columns), comments="", fmt="%.17g")
    return file


def test_a_knee_is_fitted_as_the_tool_does(tool: Tool, tmp_path: Path) -> None:
    columns = knee()
    file = save(tmp_path / "knee.csv", columns)
    fitted = crepitus.fit(file)
    assert fitted.proposed.symptom == "lead-pipe rigidity" and fitted.next.symptom != fitted.proposed.symptom
    assert fitted.grade is not None and fitted.grade["preset"] in crepitus.presets()
    assert fitted.friction_nm.interval is not None and fitted.friction_nm.unit == "N·m"
    done = tool("fit", file, "--json")
    assert done.returncode == 0, done.stderr
    theirs = json.loads(done.stdout)["fit"]
    assert theirs["proposed"]["left_out_nm"] == fitted.proposed.left_out_nm
    for each in theirs["proposed"]["values"]:
        mine = fitted.proposed.values[each["key"]]
        assert (mine.value, mine.half_width, mine.unit) == (each["value"], each["half_width"], each["unit"])
    arrays = crepitus.fit(columns)
    assert arrays.proposed == fitted.proposed
    rest = fitted.curve["torque_nm"] - fitted.curve["symptom_nm"]
    assert len(rest) == len(fitted.curve["t_s"]) > 1000
    assert fitted._repr_html_().count("<table>") == 2 and "N·m" in fitted._repr_html_()
    assert crepitus.run(fitted.scene.set("duration_s", 1.0)).summary["simulated_s"] == 1.0


def test_columns_units_and_signs_are_as_the_tool_takes_them(tmp_path: Path) -> None:
    columns = knee()
    plain = crepitus.fit(columns)
    file = save(
        tmp_path / "isokinetic.csv",
        {
            "Time": 1e3 * columns["t_s"],
            "Position": 90.0 - np.degrees(columns["angle_rad"]),
            "Moment": -columns["torque_nm"] / 1.355817948,
        },
    )
    other = crepitus.fit(
        file, time="Time", time_unit="ms", angle="Position", angle_scale=-1.0, angle_offset=90.0,
        torque="Moment", torque_unit="ft-lb", torque_scale=-1.0,
    )
    assert other.proposed.symptom == plain.proposed.symptom
    for key, value in plain.proposed.values.items():
        assert value.value == pytest.approx(other.proposed.values[key].value, rel=1e-3)


def test_what_cannot_be_told_is_refused(tmp_path: Path) -> None:
    columns = {name: column[:400] for name, column in knee().items()}
    with pytest.raises(crepitus.Refusal) as caught:
        crepitus.fit(columns)
    assert isinstance(caught.value, ValueError) and len(str(caught.value)) > 20
    file = save(tmp_path / "knee.csv", {"when": columns["t_s"], "what": columns["angle_rad"]})
    with pytest.raises(ValueError, match="name it with time; the file has when, what"):
        crepitus.fit(file)
    with pytest.raises(ValueError, match="torque_nm is missing"):
        crepitus.fit({"t_s": [0.0], "angle_rad": [0.0]})
    with pytest.raises(ValueError, match="differ in length"):
        crepitus.fit({"t_s": [0.0, 1.0], "angle_rad": [0.0], "torque_nm": [0.0]})
    with pytest.raises(ValueError, match="torque_unit: expected nm"):
        crepitus.fit(columns, torque_unit="kg")
    with pytest.raises(ValueError, match='unit: expected "deg" or "rad"'):
        crepitus.fit(file, unit="grad")
    with pytest.raises(ValueError, match="time_unit: expected s, ms"):
        crepitus.fit(file, time_unit="fortnights")


@pytest.fixture(scope="module")
def swing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("swing") / "swing.crepitus"
    with crepitus.Device("sim", scene="weight-in-the-brace") as device:
        device.record(file, 8.0, title="swing")
    return file


WEIGHT = {"weight_kg": 2.44, "lever_m": 0.2477, "weight_inertia_kg_m2": 0.2202}


def test_a_brace_is_identified_as_the_tool_does(tool: Tool, swing: Path) -> None:
    found = crepitus.identify(swing, **WEIGHT)  # type: ignore[arg-type]
    seen = {key: value for key, value in found.values.items() if value.value is not None}
    assert seen and all(value.interval is not None for value in seen.values())
    assert all(value.why for key, value in found.values.items() if key not in seen)
    flags = [f"--{name.replace('_', '-')}={value}" for name, value in WEIGHT.items()]
    done = tool("identify", swing, *flags, "--json")
    assert done.returncode == 0, done.stderr
    theirs = json.loads(done.stdout)["identified"]
    assert found.residual_deg == theirs["residual_deg"] and found.notes == theirs["notes"]
    for each in theirs["values"]:
        assert found.values[f"{each['effect']}.{each['key']}"].value == each["value"]
    assert "[effects." in found.toml and "swings" in found._repr_html_()


def test_no_swing_is_refused(tmp_path: Path, swing: Path) -> None:
    with pytest.raises(crepitus.Refusal):
        still = save(tmp_path / "still.csv", {"t_s": np.arange(0.0, 10.0, 1e-3), "angle_rad": np.zeros(10_000)})
        crepitus.identify([still], **WEIGHT)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="weight_kg: expected a number above 0"):
        crepitus.identify(swing, weight_kg=-1.0, lever_m=0.2)
    with pytest.raises(ValueError, match="weight_tolerance"):
        crepitus.identify(swing, weight_kg=1.0, lever_m=0.2, weight_tolerance=90.0)
    with pytest.raises(ValueError, match="none.csv"):
        crepitus.identify(tmp_path / "none.csv", weight_kg=1.0, lever_m=0.2)


def test_a_recording_becomes_a_parquet_file_and_is_read_from_it(tmp_path: Path, swing: Path) -> None:
    import polars

    file = tmp_path / "swing.parquet"
    rows = crepitus.export_parquet(swing, file)
    plain, read = crepitus.read_recording(swing), crepitus.read_recording(file)
    assert rows == len(plain.samples["t_s"]) == polars.read_parquet(file).height
    for name, column in plain.samples.items():
        np.testing.assert_array_equal(column, read.samples[name])
    assert read.metadata["title"] == "swing"
    with pytest.raises(OSError, match="swing.parquet"):
        crepitus.export_parquet(swing, file)
    assert crepitus.export_parquet(swing, file, force=True) == rows
    with pytest.raises(OSError):
        crepitus.export_parquet(swing, swing, force=True)
    assert crepitus.identify(file, **WEIGHT).swings == crepitus.identify(swing, **WEIGHT).swings  # type: ignore[arg-type]
