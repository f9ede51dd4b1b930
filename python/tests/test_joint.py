"""A joint in a loop of one's own is the joint of a run."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest

import crepitus
from crepitus import Joint, SceneError

STEP_S = 5e-5


def motion(count: int) -> tuple[np.ndarray, np.ndarray]:
    time_s = np.arange(count + 1) * STEP_S
    angle_rad = 0.5 * np.sin(2.0 * np.pi * 0.7 * time_s)
    omega_rad_s = np.pi * 0.7 * np.cos(2.0 * np.pi * 0.7 * time_s)
    return np.diff(angle_rad), omega_rad_s


@pytest.mark.parametrize("convention", ["frozen", "paper", "physical"])
def test_it_is_the_joint_of_a_run(convention: str) -> None:
    changes = {
        "effects.crepitus.convention": convention,
        "duration_s": 1.0,
        "output.trace_step_s": STEP_S,
    }
    run = crepitus.run("fig6-ideal-cycle", set=changes)
    omega = run.trace["omega_rad_s"]
    joint = Joint("coarse", convention=convention, step_s=STEP_S, omega_rad_s=omega[0])
    states = joint.steps(np.diff(run.trace["angle_rad"]), omega[1:])
    # The run has exact turns, not differences of rounded angles.
    assert np.abs(states["torque_nm"] - run.trace["torque_nm"][1:]).max() < 1e-9
    assert (states["phase"] == run.trace["phase"][1:]).all()
    assert joint.events == run.summary["events"]


@pytest.mark.parametrize("precision", ["f32", "f64"])
def test_one_by_one_is_the_same_as_all_at_once(precision: str) -> None:
    turns, omega = motion(4_000)
    alone = Joint(precision=precision, omega_rad_s=omega[0])
    together = Joint(precision=precision, omega_rad_s=omega[0])
    one_by_one = [alone.step(turn, w) for turn, w in zip(turns, omega[1:], strict=True)]
    states = together.steps(turns, omega[1:])
    assert states["torque_nm"].tolist() == one_by_one
    assert alone.events == together.events and alone.events["break"] > 5
    assert alone.torque_nm == states["torque_nm"][-1]
    assert alone.phase == states["phase"][-1]
    assert alone.theta_rad == states["theta_rad"][-1]
    assert alone.theta_dot_rad_s == states["theta_dot_rad_s"][-1]


def test_angles_alone_will_do() -> None:
    angle_rad = np.arange(10_001) * STEP_S
    states = Joint(omega_rad_s=1.0).follow(angle_rad)
    assert len(states["torque_nm"]) == 10_000
    assert states["torque_nm"].max() == pytest.approx(0.4, abs=0.021)


def test_a_restart_is_a_stick_where_the_shaft_is() -> None:
    joint = Joint(omega_rad_s=1.0)
    joint.steps(np.full(300, STEP_S), np.full(300, 1.0))
    joint.restart(0.1, 0.5)
    assert (joint.torque_nm, joint.phase) == (pytest.approx(0.1), 0)


@pytest.mark.parametrize("precision", ["f32", "f64"])
def test_after_a_restart_it_is_a_new_joint_at_that_speed(precision: str) -> None:
    new = Joint(convention="physical", precision=precision, omega_rad_s=0.5)
    joint = Joint(convention="physical", precision=precision, omega_rad_s=1.0)
    joint.steps(np.full(300, STEP_S), np.full(300, 1.0))
    joint.restart(new.torque_nm, 0.5)
    turns, omega = np.full(1_000, 0.5 * STEP_S), np.full(1_000, 0.5)
    expected, states = new.steps(turns, omega), joint.steps(turns, omega)
    for name, column in expected.items():
        assert states[name].tolist() == column.tolist(), name


def test_parameters_instead_of_a_preset() -> None:
    joint = Joint({"preset": "coarse", "static_torque_nm": 0.3}, restart="elastic")
    states = joint.steps(np.full(1000, STEP_S), np.full(1000, 1.0))
    assert states["torque_nm"].max() <= 0.3
    assert "static_torque_nm = 0.3" in joint.scene.toml
    assert Joint({}).scene.toml == Joint({"convention": "frozen"}).scene.toml


@pytest.mark.parametrize(
    ("joint", "options", "key"),
    [
        ("coars", {}, "effects.crepitus.preset"),
        ({"stiffness": 1}, {}, "effects.crepitus.stiffness"),
        ({"stiffness_nm_per_rad": -1}, {}, "effects.crepitus.stiffness_nm_per_rad"),
        ("coarse", {"solver": "reference"}, "solver.step_s"),
        ("coarse", {"solver": "euler"}, "solver.kind"),
        ("coarse", {"step_s": 0.0}, "solver.step_s"),
        ("coarse", {"step_s": float("nan")}, "solver.step_s"),
        ("coarse", {"convention": "froze"}, "effects.crepitus.convention"),
    ],
)
def test_what_no_joint_has_is_refused(joint: Any, options: dict[str, Any], key: str) -> None:
    with pytest.raises(SceneError) as raised:
        Joint(joint, **options)
    assert raised.value.key == key


@pytest.mark.parametrize(
    ("turns", "omega"),
    [
        ([np.nan], [1.0]),
        ([1e-5], [np.inf]),
        ([1e-5] * 10 + [np.nan], [1.0] * 11),
        ([1e-5], [1.0, 1.0]),
        ([[1e-5]], [[1.0]]),
        (["a"], [1.0]),
        (None, None),
        ([1e-5 + 1j], [1.0]),
    ],
    ids=repr,
)
def test_bad_steps_do_nothing(turns: Any, omega: Any) -> None:
    joint = Joint()
    joint.step(1e-5, 0.2)
    before = joint.torque_nm
    with pytest.raises((ValueError, TypeError)):
        joint.steps(turns, omega)
    with pytest.raises((ValueError, TypeError)):
        joint.step(float("nan"), 0.0)
    assert joint.torque_nm == before


def test_no_steps_and_huge_steps() -> None:
    joint = Joint()
    assert len(joint.steps([], [])["torque_nm"]) == 0
    torque_nm = joint.step(1e300, 1e300)
    assert abs(torque_nm) <= 0.4


def test_views_and_other_types_are_read_right() -> None:
    turns, omega = motion(1_000)
    expected = Joint(omega_rad_s=omega[0]).steps(turns, omega[1:])["torque_nm"]
    strided = np.repeat(turns, 2)[::2]
    backwards = omega[1:][::-1].copy()[::-1]
    joint = Joint(omega_rad_s=omega[0])
    assert joint.steps(strided, list(backwards))["torque_nm"].tolist() == expected.tolist()


def test_a_joint_goes_to_another_thread_but_not_to_two() -> None:
    joint = Joint()
    failures: list[BaseException] = []

    def step() -> None:
        try:
            for _ in range(5):
                joint.steps(np.full(2_000_000, STEP_S), np.full(2_000_000, 1.0))
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=step) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(failures) <= 1 and all(isinstance(f, RuntimeError) for f in failures), failures
    assert joint.events["break"] > 0
    del joint
