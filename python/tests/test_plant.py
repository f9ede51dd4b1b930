"""A plant in a loop of one's own is the plant of a run."""

from __future__ import annotations

import copy
import threading
from typing import Any

import numpy as np
import pytest

import crepitus
from crepitus import Plant, RunError, Scene, SceneError

STEP_S = 5e-5


def scene(name: str, duration_s: float = 0.05, **options: Any) -> Scene:
    changes = {"duration_s": duration_s, "output.trace_step_s": STEP_S}
    return Scene(name, set=changes, **options)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("fig8", {}),
        ("fig9", {"as_device": True}),
        ("everything", {"as_device": True}),
        ("backlash-reversal", {}),
        ("pendulum-test", {}),
        ("clonus-hold", {}),
        ("catch-and-clonus", {"as_device": True}),
        ("fig8-1-motor", {"precision": "f32"}),
    ],
)
def test_it_makes_the_trace_of_a_run(name: str, options: dict[str, Any]) -> None:
    run = crepitus.run(scene(name, **options))
    plant = Plant(scene(name, **options), 2)
    states = [plant.state, *(plant.step() for _ in range(len(run.trace["t_s"]) - 1))]
    assert list(states[0]) == list(run.trace)
    for column, theirs in run.trace.items():
        ours = np.array([state[column] for state in states])
        assert ours.dtype == theirs.dtype and ours.shape == (len(theirs), 2), column
        assert (ours[:, 0] == theirs).all() and (ours[:, 1] == theirs).all(), column
    # The scene ends there.
    with pytest.raises(ValueError, match="duration_s"):
        plant.step()
    assert plant.time_s == run.trace["t_s"][-1]


def test_the_motor_takes_the_torque_of_the_run() -> None:
    mine = scene("fig8", as_device=True)
    run = crepitus.run(mine)
    plant = Plant(mine)
    for n, torque_nm in enumerate(run.trace["shown_nm"][:-1]):
        state = plant.step(motor_torque_nm=torque_nm)
        for column, theirs in run.trace.items():
            assert state[column][0] == theirs[n + 1], column


def test_many_steps_in_one_call_are_as_many_calls() -> None:
    one, many = Plant(scene("everything")), Plant(scene("everything"))
    for _ in range(300):
        state = one.step(motor_torque_nm=0.2)
    for name, column in many.step(motor_torque_nm=0.2, steps=300).items():
        assert column.tolist() == state[name].tolist(), name


def test_a_snapshot_is_gone_back_to() -> None:
    plant = Plant("everything", 3, hand="torque")
    push = np.array([0.0, 5.0, 12.0])
    plant.step(push, steps=400)
    snapshot = plant.snapshot()
    expected = plant.step(push, steps=700)
    twin = copy.deepcopy(snapshot)
    plant.step(0.0, steps=100)
    plant.restore(snapshot)
    assert plant.time_s == pytest.approx(400 * STEP_S)
    for other in (plant, twin, copy.copy(snapshot)):
        for name, column in other.step(push, steps=700).items():
            assert column.tolist() == expected[name].tolist(), name
    assert snapshot.time_s == pytest.approx(400 * STEP_S)
    for other in (Plant("everything", 2, hand="torque"), Plant("everything", 3), 3):
        with pytest.raises(ValueError, match="snapshot"):
            plant.restore(other)  # type: ignore[arg-type]


def test_plants_side_by_side_are_those_alone() -> None:
    push = [4.0, -4.0, 11.0]
    together = Plant("fig9", 3, hand="torque").step(push, [0.0, 0.1, -0.3], steps=500)
    for n, (hand, motor) in enumerate(zip(push, [0.0, 0.1, -0.3], strict=True)):
        alone = Plant("fig9", hand="torque").step(hand, motor, steps=500)
        for name, column in alone.items():
            assert column[0] == together[name][n], name
    assert together["angle_rad"][2] > together["angle_rad"][1]
    assert np.abs(together["hand_torque_nm"] - push).max() < 1e-9


def test_a_hand_that_holds_a_leg_against_its_weight() -> None:
    """At rest the hand bears weight and passive moment, which the pendulum's columns have."""
    plant = Plant("pendulum-test", hand="torque")
    hold_nm, last_rad = 0.0, plant.state["angle_rad"][0]
    for _ in range(8_000):
        state = plant.step(hold_nm, steps=10)
        speed = (state["angle_rad"][0] - last_rad) / (10 * STEP_S)
        last_rad = state["angle_rad"][0]
        hold_nm = float(np.clip(-40.0 * (last_rad - 0.6) - 5.0 * speed, -50.0, 50.0))
    assert abs(state["omega_rad_s"][0]) < 1e-6
    assert state["limb_torque_nm"][0] == pytest.approx(hold_nm, abs=1e-4)


@pytest.mark.parametrize(
    ("hand", "torques", "match"),
    [
        ("torque", {}, "0.0 for a leg that nobody holds"),
        ("torque", {"hand_torque_nm": float("nan")}, "finite"),
        ("torque", {"hand_torque_nm": [1.0, float("inf")]}, r"\[1\]"),
        ("torque", {"hand_torque_nm": 1e4}, "unit"),
        ("torque", {"hand_torque_nm": [1.0]}, "2 of them"),
        ("torque", {"hand_torque_nm": [[1.0, 2.0]]}, "2 of them"),
        ("torque", {"hand_torque_nm": 0.0, "motor_torque_nm": [0.0] * 3}, "motor_torque_nm"),
        ("torque", {"hand_torque_nm": 0.0, "steps": 0}, "steps"),
        ("scene", {"hand_torque_nm": 1.0}, "hand=\"torque\""),
        ("scene", {"motor_torque_nm": float("-inf")}, "finite"),
        ("scene", {"steps": 10**9}, "at most"),
    ],
)
def test_impossible_steps_are_refused_and_do_nothing(hand: Any, torques: dict[str, Any], match: str) -> None:
    plant = Plant("everything", 2, hand=hand)
    before = plant.state
    with pytest.raises(ValueError, match=match):
        plant.step(**torques)
    assert plant.time_s == 0.0
    for name, column in plant.state.items():
        assert column.tolist() == before[name].tolist()


def test_scenes_without_a_plant_are_refused() -> None:
    with pytest.raises(SceneError, match="crepitus.Joint"):
        Plant("fig6-ideal-cycle")
    with pytest.raises(SceneError, match="effects.limb"):
        Plant("fig8-1-motor", hand="torque")
    with pytest.raises(ValueError, match="hand"):
        Plant("everything", hand="mine")  # type: ignore[arg-type]
    for n in (0, -1, 1.5):
        with pytest.raises((ValueError, TypeError)):
            Plant("everything", n)  # type: ignore[arg-type]


def test_one_that_diverges_says_so() -> None:
    """Steps of half a second, as no device makes them."""
    unstable = Scene(
        {
            "version": 1,
            "duration_s": 6.0,
            "device": True,
            "motion": {"kind": "constant", "velocity_rad_s": 10.0},
            "solver": {"kind": "exact-events", "step_s": 0.5},
            "effects": {
                "crepitus": {},
                "spasticity": {"form": "reflex"},
                "hand": {"stiffness_n_per_m": 0.0},
                "limb": {},
            },
        }
    )
    plant = Plant(unstable)
    snapshot = plant.snapshot()
    with pytest.raises(RunError, match="plant 0.*restore a snapshot"):
        plant.step(steps=12)
    plant.restore(snapshot)
    assert np.isfinite(plant.state["angle_rad"]).all()


def test_threads_step_plants_of_their_own() -> None:
    plants = [Plant("everything", hand="torque") for _ in range(2)]
    threads = [threading.Thread(target=lambda p=p: p.step(3.0, steps=20_000)) for p in plants]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    first, second = (plant.state for plant in plants)
    assert {n: c.tolist() for n, c in first.items()} == {n: c.tolist() for n, c in second.items()}
    assert "everything" in repr(plants[0]) or "examination" in repr(plants[0])
    assert len(plants[0]) == 1
