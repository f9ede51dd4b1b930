"""A joint in a loop of one's own is the joint of a run."""

from __future__ import annotations

import copy
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


def test_no_steps_are_none() -> None:
    assert len(Joint().steps([], [])["torque_nm"]) == 0


@pytest.mark.parametrize(
    ("turn", "omega", "match"),
    [
        (10.0, 1.0, r"2\.500e-3 rad in a step of 0\.00005 s.*turn of one step"),
        (1e300, 1e300, "50 rad/s"),
        (1e-5, 51.0, "omega_rad_s"),
        (-0.0026, 1.0, "dphi_rad"),
    ],
)
def test_steps_that_no_shaft_makes_are_refused(turn: float, omega: float, match: str) -> None:
    joint, many = Joint(), crepitus.Joints(count=2)
    joint.step(1e-5, 0.2)
    before = joint.torque_nm
    for step in (
        lambda: joint.step(turn, omega),
        lambda: joint.steps([1e-5, turn], [1.0, omega]),
        lambda: many.step(turn, omega),
        lambda: many.steps([1e-5, turn], [1.0, omega]),
    ):
        with pytest.raises(ValueError, match=match):
            step()
    assert joint.torque_nm == before
    # As fast as the device takes it, they are steps.
    joint.step(50.0 * STEP_S, 50.0)
    with pytest.raises(ValueError, match="50 rad/s"):
        Joint(omega_rad_s=60.0)


def test_copies_go_on_by_themselves() -> None:
    turns, omega = motion(2_000)
    joint = Joint(omega_rad_s=omega[0])
    joint.steps(turns[:1_000], omega[1:1_001])
    copies = [joint.copy(), copy.copy(joint), copy.deepcopy({"a": joint})["a"]]
    expected = joint.steps(turns[1_000:], omega[1_001:])["torque_nm"].tolist()
    for other in copies:
        assert other.steps(turns[1_000:], omega[1_001:])["torque_nm"].tolist() == expected
        assert other.events == joint.events and other.returned_j == joint.returned_j
    many = copy.deepcopy(crepitus.Joints(count=3))
    assert len(many) == 3


def test_a_shaken_joint_pushes_and_says_so_before() -> None:
    """The joint without a guard at 20 Hz and ±0.02 rad."""
    joint = Joint()
    passivity = joint.passivity()
    assert passivity.stored_j == pytest.approx(0.4**2 / 800.0)
    assert passivity.needed_damping_nms_per_rad == pytest.approx(0.5 * 400.0 * STEP_S)
    assert joint.passivity(2.0).needed_damping_nms_per_rad == pytest.approx(2.5 * 400.0 * STEP_S)
    most = passivity.most_acceleration_rad_s2
    assert most is not None and not joint.may_push(0.99 * most) and joint.may_push(1.01 * most)
    assert joint.may_push(0.6 * most, 0.6 * (passivity.most_velocity_step_rad_s or 0.0))

    def shaken_j(amplitude_rad: float, hz: float) -> tuple[float, float, float]:
        joint = Joint(omega_rad_s=amplitude_rad * 2.0 * np.pi * hz)
        time_s = np.arange(80_001) * STEP_S
        angle_rad = amplitude_rad * np.sin(2.0 * np.pi * hz * time_s)
        omega = amplitude_rad * 2.0 * np.pi * hz * np.cos(2.0 * np.pi * hz * time_s)
        turns = np.diff(angle_rad)
        torque_nm = np.concatenate([[0.0], joint.steps(turns, omega[1:])["torque_nm"][:-1]])
        work_j = np.concatenate([[0.0], np.cumsum(torque_nm * turns)])
        returned_j = (np.maximum.accumulate(work_j) - work_j).max()
        assert joint.returned_j == pytest.approx(returned_j, abs=1e-12)
        sampled_j = passivity.needed_damping_nms_per_rad * float((turns**2).sum()) / STEP_S
        return float(work_j[-1]), joint.returned_j, passivity.stored_j + sampled_j

    work_j, returned_j, bound_j = shaken_j(0.02, 20.0)
    assert joint.may_push(0.02 * (2.0 * np.pi * 20.0) ** 2)
    assert work_j == pytest.approx(-0.23, abs=0.02) and returned_j > 1.5 * bound_j
    # As far, and so slowly that no slip is left behind.
    assert not joint.may_push(0.02 * (2.0 * np.pi * 2.0) ** 2)
    work_j, returned_j, bound_j = shaken_j(0.02, 2.0)
    assert work_j > 0.0 and returned_j <= bound_j
    # One by one, too.
    alone = Joint()
    for _ in range(100):
        alone.step(1e-5, 0.2)
    for _ in range(50):
        alone.step(-1e-5, -0.2)
    assert 0.0 < alone.returned_j <= passivity.stored_j
    alone.restart()
    assert alone.returned_j == 0.0


@pytest.mark.parametrize("convention", ["paper", "physical"])
def test_where_no_limit_is_known_it_may_push(convention: str) -> None:
    joint = Joint(convention=convention)
    assert joint.passivity().most_acceleration_rad_s2 is None
    assert joint.passivity().most_velocity_step_rad_s is None and joint.may_push(0.0)


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -1.0])
def test_what_no_motion_has_is_no_question(bad: float) -> None:
    joint = Joint()
    with pytest.raises(ValueError, match="delay_steps"):
        joint.passivity(bad)
    if not np.isfinite(bad):
        with pytest.raises(ValueError, match="acceleration_rad_s2"):
            joint.may_push(bad)


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
