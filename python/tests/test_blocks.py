"""Devices in loops: blocks while streaming, threads, and time between calls."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

import crepitus
from crepitus import Device, DeviceError

STEP_S = 5e-5


@pytest.fixture
def device() -> Iterator[Device]:
    with Device("sim") as device:
        yield device


def test_real_time_is_not_faster() -> None:
    with Device("sim", real_time=True) as device:
        begun = time.monotonic()
        device.stream(0.4)
        assert time.monotonic() - begun >= 0.39


def test_a_real_time_device_runs_on_between_calls() -> None:
    with Device("sim", real_time=True) as device:
        device.zero()
        device.arm()
        begun = device.info()["status"]["tick"]
        # Within the lease, and beyond it.
        time.sleep(0.1)
        assert device.armed
        assert device.info()["status"]["tick"] - begun >= 2_000
        time.sleep(1.0)
        info = device.info()
        assert info["status"]["state"] != "armed" and info["status"]["tick"] - begun >= 22_000
        assert any("lease" in fault for fault in info["faults"]), info["faults"]
        assert not device.armed
        # It says so once more to who arms it as it is.
        with pytest.raises(DeviceError, match="lease"):
            device.arm()
        device.clear_fault()
        device.arm()
        time.sleep(0.5)
        with pytest.raises(DeviceError, match="lease"):
            device.stream(0.1)


def test_without_real_time_the_device_stands_still_between_calls(device: Device) -> None:
    device.zero()
    device.arm()
    tick = device.info()["status"]["tick"]
    time.sleep(0.4)
    assert device.info()["status"]["tick"] - tick < 200
    assert device.armed and len(device.stream(0.01).samples["tick"]) > 0


def test_a_device_is_set_in_a_loop_over_its_blocks(device: Device) -> None:
    device.zero()
    device.arm()
    blocks: list[crepitus.Stream] = []
    for n, block in enumerate(device.blocks(0.05)):
        blocks.append(block)
        if n == 2:
            revision = device.set({"crepitus.static_torque_nm": 0.9, "crepitus.kinetic_torque_nm": 0.3})
            marked_s = device.mark("stronger")
        if n == 9:
            break
    assert device.armed
    device.disarm()
    ticks = np.concatenate([block.samples["tick"] for block in blocks]).astype(np.int64)
    assert (np.diff(ticks) == 1).all() and blocks[-1].accounting["dropped"] == 0
    assert all(len(block.samples["tick"]) == 1_000 for block in blocks)
    t_s = np.concatenate([block.samples["t_s"] for block in blocks])
    assert np.allclose(np.diff(t_s), STEP_S, atol=1e-12)
    revisions = np.concatenate([block.samples["revision"] for block in blocks])
    # It took effect a few ms after it was sent, not at the end.
    first_s = t_s[revisions == revision][0]
    assert blocks[2].samples["t_s"][-1] < first_s < blocks[2].samples["t_s"][-1] + 0.05
    assert [block.marks for block in blocks if block.marks] == [((marked_s, "stronger"),)]
    assert blocks[3].marks[0].text == "stronger"
    assert blocks[2].samples["t_s"][-1] < marked_s < blocks[3].samples["t_s"][-1]
    # It is left in order: another stream goes on in time.
    stream = device.stream(0.1)
    assert stream.samples["t_s"][0] > t_s[-1] and stream.marks == ()
    assert stream.zero_unix_s == device.zero_unix_s == blocks[0].zero_unix_s
    assert abs(device.zero_unix_s - time.time()) < 60.0


def test_blocks_end_by_time_by_stop_and_by_an_exception(device: Device) -> None:
    device.zero()
    lengths = [len(block.samples["tick"]) for block in device.blocks(0.1, seconds=0.45)]
    assert len(lengths) in (5, 6) and 8_900 <= sum(lengths) <= 9_100
    device.arm()
    count = 0
    for _ in device.blocks(0.01):
        count += 1
        if count == 3:
            device.stop()
    assert count == 3 and device.info()["status"]["state"] != "armed"
    device.arm()
    with pytest.raises(ZeroDivisionError):
        for _ in device.blocks(0.01):
            1 / 0  # noqa: B018
    device.wait(0.01)
    # Torque goes off and on within a loop, which is no error.
    for n, _ in enumerate(device.blocks(0.02, every=7)):
        if n == 1:
            device.disarm()
        if n == 3:
            device.arm()
        if n == 5:
            break
    assert device.armed
    for block_s in (0.0, -1.0, float("nan"), 1e-4):
        with pytest.raises(ValueError):
            device.blocks(block_s)


def test_a_loop_over_blocks_lets_time_pass_itself(device: Device) -> None:
    for _ in device.blocks(0.01):
        for call in (device.stream, device.wait, device.blocks):
            with pytest.raises(DeviceError, match="leave the loop"):
                call(0.01)
        break
    # One that was never begun ends where it is forgotten.
    device.blocks(0.01)
    device.wait(0.01)
    blocks = device.blocks(0.01)
    next(blocks)
    device.close()
    with pytest.raises(DeviceError, match="closed"):
        next(blocks)


def test_a_slow_loop_loses_the_torque() -> None:
    with Device("sim", real_time=True) as device:
        device.zero()
        device.arm()
        with pytest.raises(DeviceError, match="lease"):
            for n, _ in enumerate(device.blocks(0.05, seconds=3.0)):
                time.sleep(0.5 if n == 4 else 0.02)
        # One block may have been on its way.
        assert n in (4, 5)


def test_a_set_of_another_thread_does_not_wait_for_a_stream() -> None:
    with Device("sim", real_time=True) as device:
        streams: list[crepitus.Stream] = []
        holds = threading.Thread(target=lambda: streams.append(device.stream(1.4)))
        holds.start()
        time.sleep(0.2)
        took_s = []
        for torque_nm in (0.5, 0.6, 0.7):
            begun = time.monotonic()
            device.set({"crepitus.static_torque_nm": torque_nm})
            took_s.append(time.monotonic() - begun)
        device.mark("set")
        assert holds.is_alive()
        holds.join(timeout=20)
        assert min(took_s) < 0.2, took_s
        revisions = np.unique(streams[0].samples["revision"])
        assert len(revisions) == 4 and [mark.text for mark in streams[0].marks] == ["set"]
        assert streams[0].accounting["dropped"] == 0


def test_an_arm_of_another_thread_is_ended_by_a_stop() -> None:
    with Device("sim", real_time=True) as device:
        device.zero()
        holds = threading.Thread(target=lambda: device.stream(60.0))
        holds.start()
        time.sleep(0.1)
        device.arm()
        assert device.armed and holds.is_alive()
        device.stop()
        holds.join(timeout=10)
        assert not holds.is_alive()
        assert device.info()["status"]["state"] != "armed"
