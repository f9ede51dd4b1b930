"""Many joints at once are each of them by itself."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from crepitus import Joint, Joints, SceneError

STEP_S = 5e-5
STATIC_NM = np.linspace(0.3, 0.6, 5)


def motions(count: int, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """A motion of each: turns and speeds, the first of which is that before the first step."""
    time_s = np.arange(steps + 1) * STEP_S
    frequency_hz = np.linspace(0.5, 2.0, count)[:, None]
    turn = 2.0 * np.pi * frequency_hz
    return np.diff(0.4 * np.sin(turn * time_s)), 0.4 * turn * np.cos(turn * time_s)


@pytest.mark.parametrize("precision", ["f32", "f64"])
@pytest.mark.parametrize("convention", ["frozen", "paper", "physical"])
def test_each_has_the_bits_of_a_joint_alone(convention: str, precision: str) -> None:
    options: dict[str, Any] = {"convention": convention, "precision": precision}
    turns, omega = motions(len(STATIC_NM), 4_000)
    effect = {"preset": "coarse", "static_torque_nm": STATIC_NM}
    joints = Joints(effect, omega_rad_s=omega[:, 0], **options)
    snapshot = joints.copy()
    states = joints.steps(turns, omega[:, 1:], motion=True, threads=2)
    assert states["torque_nm"].dtype == {"f32": np.float32, "f64": np.float64}[precision]
    in_step = np.array(
        [
            snapshot.step(turn, speed)
            for turn, speed in zip(turns.T, omega[:, 1:].T, strict=True)
        ]
    )
    assert in_step.T.tolist() == states["torque_nm"].tolist()
    for n, static_nm in enumerate(STATIC_NM):
        alone = Joint(
            {"preset": "coarse", "static_torque_nm": float(static_nm)},
            omega_rad_s=omega[n, 0],
            **options,
        )
        expected = alone.steps(turns[n], omega[n, 1:])
        for name, column in expected.items():
            assert states[name][n].tolist() == column.tolist(), (name, n)
        assert {kind: of[n] for kind, of in joints.events.items()} == alone.events
        assert alone.events["break"] > 0
        assert joints.theta_rad[n] == snapshot.theta_rad[n] == alone.theta_rad
        assert joints.theta_dot_rad_s[n] == alone.theta_dot_rad_s
        assert joints.phase[n] == alone.phase


def test_one_motion_is_for_all() -> None:
    turns, omega = motions(1, 3_000)
    joints = Joints({"static_torque_nm": STATIC_NM}, omega_rad_s=float(omega[0, 0]))
    other = copy.copy(joints)
    states = joints.steps(turns[0], omega[0, 1:])
    assert set(states) == {"torque_nm", "phase"}
    rows = np.broadcast_to(turns[0], (5, 3_000)), np.broadcast_to(omega[0, 1:], (5, 3_000))
    assert (other.steps(*rows)["torque_nm"] == states["torque_nm"]).all()
    assert (joints.step(1e-5, 0.2) == other.step(np.full(5, 1e-5), 0.2)).all()
    assert len(joints) == 5 and len(Joints("fine", 3)) == 3 and len(Joints()) == 1


def test_a_snapshot_goes_the_same_way_again() -> None:
    joint, turns = Joint(omega_rad_s=1.0), np.full(500, STEP_S)
    joint.steps(turns, np.ones(500))
    snapshot = joint.copy()
    first = joint.steps(turns, np.ones(500))["theta_rad"]
    assert snapshot.copy().steps(turns, np.ones(500))["theta_rad"].tolist() == first.tolist()
    assert snapshot.step(STEP_S, 1.0) == joint.copy().torque_nm or snapshot.events != joint.events
    joints = Joints("coarse", 4)
    joints.restart(-1, 0.1, 0.5)
    assert joints.torque_nm.tolist() == pytest.approx([0.0, 0.0, 0.0, 0.1])
    with pytest.raises(IndexError):
        joints.restart(4)


@pytest.mark.parametrize(
    ("effect", "options", "error"),
    [
        ({"static_torque_nm": [0.4, -1.0]}, {}, SceneError),
        ({"static_torque_nm": [0.4, np.nan]}, {}, ValueError),
        ({"static_torque_nm": [0.4, 0.5], "stiffness_nm_per_rad": [1.0]}, {}, ValueError),
        ({"static_torque_nm": [[0.4]]}, {}, ValueError),
        ({"static_torque_nm": []}, {}, ValueError),
        ({"stiff": [1.0, 2.0]}, {}, SceneError),
        ({"static_torque_nm": [0.4, 0.5]}, {"omega_rad_s": [0.0] * 3}, ValueError),
        ("coarse", {"count": 0}, ValueError),
        (3, {}, TypeError),
    ],
    ids=repr,
)
def test_what_no_joints_have_is_refused(effect: Any, options: Any, error: type) -> None:
    with pytest.raises(error):
        Joints(effect, **options)


def test_steps_that_do_not_fit_are_not_made() -> None:
    joints = Joints("coarse", 3, omega_rad_s=1.0)
    for turns, omega in [(np.ones((2, 4)), np.ones((2, 4))), (1.0, 1.0), ([1e-5], [np.inf])]:
        with pytest.raises(ValueError):
            joints.steps(turns, omega)
    for turns, omega in [([1e-5] * 2, [1.0] * 2), (np.nan, 1.0), (np.ones((3, 1)), np.ones((3, 1)))]:
        with pytest.raises(ValueError):
            joints.step(turns, omega)
    with pytest.raises(ValueError):
        joints.steps([1e-5], [1.0], threads=0)
    assert joints.torque_nm.tolist() == [0.0] * 3
