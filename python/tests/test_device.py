"""Devices: a simulated one in this process, and one that the tool serves."""

from __future__ import annotations

import csv
import io
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import crepitus
from crepitus import Device, DeviceError

from .conftest import ROOT, Tool


@pytest.fixture
def device() -> Iterator[Device]:
    with Device("sim") as device:
        yield device


@pytest.fixture
def served(program: Path, tmp_path: Path) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """A device that another process serves in real time."""
    name = f"python-{os.getpid()}-{time.monotonic_ns()}"
    words = [str(program), "serve-sim", "--name", name]
    server = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, cwd=ROOT)
    try:
        assert server.stdout is not None
        assert server.stdout.readline()
        yield name, server
    finally:
        server.send_signal(signal.SIGINT)
        server.communicate(timeout=10)


def test_a_session(device: Device) -> None:
    info = device.info()
    assert info["status"]["state"] == "disarmed" and info["faults"] == []
    device.apply("bone-on-bone")
    device.zero()
    device.arm()
    assert device.armed
    stream = device.stream(1.0)
    device.disarm()
    samples, accounting = stream.samples, stream.accounting
    assert accounting["produced"] == accounting["received"] + accounting["dropped"] == len(samples["tick"])
    assert accounting["dropped"] == 0 and len(samples["tick"]) >= 19_900
    assert (np.diff(samples["tick"].astype(np.int64)) == 1).all()
    assert np.allclose(np.diff(samples["t_s"]), 5e-5, atol=1e-12)
    assert np.abs(samples["torque_nm"]).max() <= 1.1 + 1e-6
    # The first samples are older than the answer that it is armed.
    assert set(samples["limit"]) <= {"none", "turned-back", "slew", "holding", "not-armed"}
    assert (samples["limit"] == "not-armed").sum() < 200
    assert not device.armed and device.info()["status"]["state"] == "disarmed"
    assert "Stream" in repr(stream) and "simulated" in repr(device)


def test_every_nth_sample(device: Device) -> None:
    samples = device.stream(0.5, every=20).samples
    assert (samples["tick"] % 20 == 0).all()
    assert (np.diff(samples["tick"].astype(np.int64)) == 20).all()


def test_parameters_are_set_all_or_none(device: Device) -> None:
    before = device.get()
    assert set(before) == set(crepitus.parameters())
    revision = device.set({"crepitus.static_torque_nm": 0.5, "texture.render": "on"})
    assert device.revision == revision
    assert device.get("crepitus.static_torque_nm") == 0.5 and device.get("texture.render") == "on"
    device.set({"texture.render": False, "crepitus.static_torque_nm": np.float32(0.25) * 2})
    assert device.get("texture.render") == "off"
    for bad in (
        {"crepitus.static_torque_nm": 0.6, "crepitus.kinetic_torque_nm": 0.7},
        {"crepitus.static_torque_nm": 0.6, "crepitus.kinetic": 0.1},
        {"crepitus.static_torque_nm": float("nan")},
        {"crepitus.static_torque_nm": float("inf")},
        {"crepitus.static_torque_nm": 1e99},
        {"crepitus.static_torque_nm": None},
        {"crepitus.static_torque_nm": []},
        {"texture.render": "maybe"},
        {"texture.render": 7},
    ):
        revision = device.revision
        with pytest.raises((ValueError, TypeError)):
            device.set(bad)  # type: ignore[arg-type]
        assert (device.revision, device.get("crepitus.static_torque_nm")) == (revision, 0.5), bad
    with pytest.raises(ValueError, match="did you mean"):
        device.set({"crepitus.static_torqe_nm": 0.5})
    with pytest.raises(KeyError):
        device.get("crepitus.static")
    device.reset("crepitus", "texture")
    assert device.get("crepitus.static_torque_nm") == before["crepitus.static_torque_nm"]
    with pytest.raises(ValueError, match="texture"):
        device.reset("textur")
    device.save()
    assert device.info()["status"]["saved"] == device.revision


def test_knees_are_applied_as_the_tool_does(device: Device, tmp_path: Path) -> None:
    device.apply("mas-2-catch")
    assert device.get("spasticity.render") == "on" and device.get("crepitus.render") == "off"
    # Not the preset's, so that it has to change.
    device.set({"crepitus.static_torque_nm": 0.5})
    device.apply("coarse", add=True)
    assert device.get("spasticity.render") == "on" and device.get("crepitus.render") == "on"
    assert device.get("crepitus.static_torque_nm") == 0.4
    device.apply("bone-shaping")
    assert device.get("bone-shaping.render") == "on" and device.get("spasticity.render") == "off"
    device.apply(crepitus.Scene("passive-examination").set("effects.crepitus.preset", "fine"))
    assert device.get("crepitus.static_torque_nm") == 0.14
    file = tmp_path / "mine.toml"
    file.write_text("[effects.lead-pipe]\ntorque_nm = 1.5\n")
    device.apply(file)
    assert device.get("lead-pipe.torque_nm") == 1.5
    with pytest.raises(ValueError, match="add=True needs a preset"):
        device.apply("bone-shaping", add=True)
    with pytest.raises(ValueError, match="no such"):
        device.apply("nothing")
    with pytest.raises(ValueError, match="frozen"):
        device.apply("knee-pass-physical")


def test_a_refusal_has_its_reason(device: Device) -> None:
    with pytest.raises(DeviceError, match="zero"):
        device.arm()
    device.stop()
    device.clear_fault()
    device.disarm()


def test_a_recording_is_the_tools(device: Device, tool: Tool, tmp_path: Path) -> None:
    file = tmp_path / "monday.crepitus"
    device.zero()
    device.arm()
    accounting = device.record(file, 1.0, title="Monday")
    device.disarm()
    assert accounting is not None and accounting["produced"] == accounting["received"] + accounting["dropped"]
    recording = crepitus.read_recording(file)
    assert recording.complete and recording.warnings == []
    assert recording.metadata["title"] == "Monday"
    assert recording.accounting["totals"] == accounting
    done = tool("export", file, "--format", "csv", "--out", tmp_path / "monday.csv")
    assert done.returncode == 0, done.stderr
    with (tmp_path / "monday.csv").open(newline="") as text:
        names, *rows = csv.reader(text)
    phases = {"slip-": -1, "stick": 0, "slip+": 1}
    for n, name in enumerate(names):
        if name == "notes":
            continue
        cells, ours = [row[n] for row in rows], recording.samples[name]
        if name == "phase":
            assert ours.tolist() == [phases[cell] for cell in cells]
        elif ours.dtype.kind == "U":
            assert ours.tolist() == cells
        else:
            numbers = np.array([float(cell or "nan") for cell in cells]).astype(ours.dtype)
            assert ours.tobytes() == numbers.tobytes(), name
    # It is never overwritten, and a broken one is not read.
    with pytest.raises(DeviceError, match="already exists"):
        device.record(file, 0.1)
    damaged = bytearray(file.read_bytes())
    damaged[len(damaged) // 2] ^= 0x55
    file.write_bytes(damaged)
    with pytest.raises(DeviceError, match="damaged"):
        crepitus.read_recording(file)
    with pytest.raises(DeviceError):
        crepitus.read_recording(tmp_path / "none")
    with pytest.raises(DeviceError):
        device.record(tmp_path / "no" / "folder", 0.1)


def test_nothing_recorded_leaves_no_file(device: Device, tmp_path: Path) -> None:
    assert device.record(tmp_path / "empty", 0.0) is None
    assert not (tmp_path / "empty").exists()


@pytest.mark.parametrize("seconds", [-1.0, float("nan"), float("inf"), 1e9, "1", None])
def test_no_time_is_an_exception(device: Device, seconds: object) -> None:
    for call in (device.wait, device.stream):
        with pytest.raises((ValueError, TypeError)):
            call(seconds)  # type: ignore[operator]


def test_a_closed_device_is_an_exception(device: Device) -> None:
    device.close()
    device.close()
    assert device.closed and "closed" in repr(device)
    for call in (device.info, device.arm, device.stop, device.get, lambda: device.stream(0.1)):
        with pytest.raises(DeviceError, match="closed"):
            call()
    with pytest.raises(DeviceError, match="closed"):
        _ = device.armed


def test_no_device_is_an_exception(tmp_path: Path) -> None:
    for name, text in [
        ("nobody", "unknown device"),
        (str(tmp_path / "tty"), "tty"),
        ("/dev/null", "/dev/null"),
        ("emulated", "built without the emulator"),
    ]:
        with pytest.raises(DeviceError, match=text):
            Device(name)
    with pytest.raises(crepitus.SceneError):
        Device("sim", "no-such-scene")
    with pytest.raises(DeviceError, match="no encoder|convention|effects"):
        Device("sim", "knee-pass-physical")
    with pytest.raises(TypeError):
        Device(3)  # type: ignore[arg-type]


def test_a_simulated_device_repeats_itself() -> None:
    def torque() -> bytes:
        with Device("sim", crepitus.Scene("passive-examination").set("duration_s", 5.0)) as device:
            device.zero()
            device.arm()
            return device.stream(0.5).samples["torque_nm"].tobytes()

    assert torque() == torque()


def test_an_examination_is_measured() -> None:
    with Device("sim") as device:
        device.apply("coarse")
        device.zero()
        device.arm()
        stream = device.stream(12.0)
    is_on = stream.samples["limit"] != "not-armed"
    off = crepitus.Stream({name: column[~is_on] for name, column in stream.samples.items()}, {})
    assert np.isnan(list(crepitus.examination(off).values())).all()
    measures = crepitus.examination(stream)
    angles_deg = np.degrees(stream.samples["angle_rad"][is_on])
    assert measures["range_deg"] == pytest.approx(np.ptp(angles_deg), abs=1e-6)
    assert measures["flexion_deg"] == pytest.approx(angles_deg.max(), abs=1e-6)
    assert 20.0 < measures["peak_speed_deg_s"] < 90.0 and np.isnan(measures["catch_deg"])


def test_stop_ends_what_another_thread_does() -> None:
    with Device("sim", real_time=True) as device:
        device.zero()
        device.arm()
        streams: list[object] = []
        thread = threading.Thread(target=lambda: streams.append(device.stream(60.0)))
        thread.start()
        time.sleep(0.3)
        begun = time.monotonic()
        device.stop()
        thread.join(timeout=5)
        assert not thread.is_alive() and time.monotonic() - begun < 2.0
        assert len(streams) == 1
        assert device.info()["status"]["state"] != "armed"
        # It works on.
        device.wait(0.01)


def test_threads_take_turns(device: Device) -> None:
    results: list[object] = []

    def use() -> None:
        try:
            for _ in range(20):
                device.stream(0.01)
                device.get("crepitus.static_torque_nm")
            results.append("finished")
        except Exception as error:
            # An exception in a thread ends that thread only.
            results.append(error)

    threads = [threading.Thread(target=use) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60)
    assert not any(thread.is_alive() for thread in threads)
    assert results == ["finished"] * 4
    assert device.info()["faults"] == []


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_after_a_fork_the_child_has_no_device(device: Device) -> None:
    device.zero()
    device.arm()
    child = os.fork()
    if child == 0:
        try:
            device.info()
            os._exit(1)
        except DeviceError as error:
            device.close()
            os._exit(0 if "fork" in str(error) else 2)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 0
    assert device.armed


def test_a_served_device_has_a_name(served: tuple[str, subprocess.Popen[str]]) -> None:
    name, server = served
    with Device(name) as device, Device(name) as other:
        device.zero()
        device.arm()
        # Somebody else's torque.
        with pytest.raises(DeviceError):
            other.arm()
        assert len(device.stream(0.2).samples["tick"]) > 3_000
        other.stop()
        with pytest.raises(DeviceError):
            device.stream(1.0)
        server.kill()
        with pytest.raises(DeviceError):
            device.stream(5.0)
            device.info()
    with pytest.raises(DeviceError):
        Device(name)


def test_torque_needs_the_program(served: tuple[str, subprocess.Popen[str]]) -> None:
    name, _ = served
    with Device(name) as device:
        device.zero()
        device.arm()
        device.wait(1.0)
        assert device.armed
        time.sleep(0.6)
        with pytest.raises(DeviceError, match="lease|host"):
            device.wait(1.0)
        assert device.info()["faults"] != []


def test_ctrl_c_disarms(served: tuple[str, subprocess.Popen[str]]) -> None:
    name, _ = served
    code = f"""
import crepitus
device = crepitus.Device({name!r})
device.zero()
device.arm()
print("armed", flush=True)
try:
    device.stream(60.0)
except KeyboardInterrupt:
    print(device.info()["status"]["state"], device.info()["faults"])
"""
    words = [sys.executable, "-c", code]
    child = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout is not None
        assert child.stdout.readline() == "armed\n"
        time.sleep(0.4)
        child.send_signal(signal.SIGINT)
        out, _ = child.communicate(timeout=20)
    finally:
        child.kill()
    assert (out, child.returncode) == ("disarmed []\n", 0)


def test_a_forgotten_device_disarms(served: tuple[str, subprocess.Popen[str]]) -> None:
    name, _ = served
    device = Device(name)
    device.zero()
    device.arm()
    del device
    with Device(name) as other:
        status = other.info()
        assert (status["status"]["state"], status["faults"]) == ("disarmed", [])


def test_the_stream_has_the_columns_of_the_tool(device: Device, tool: Tool) -> None:
    done = tool("stream", "--device", "sim", "--for", "10ms", "--rate", "20000")
    names = next(csv.reader(io.StringIO(done.stdout)))
    ours = list(device.stream(0.01).samples)
    assert [name for name in names if name != "notes"] == [n for n in ours if n in names]
    assert [name for name in ours if name not in names] == ["settling", "lost", "late"]
