"""A scene's plant, for a loop of your own."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _crepitus
from ._run import _scene, _whole
from ._types import Columns, Numbers, SceneLike


class Plant:
    """Plants of a scene, side by side: motor, gear, cuff, leg and hand, with the device that renders the joint.

    A step is a tick of the scene. What comes back is the row of the trace: without torques of yours, bit by bit that
    of :func:`run`.

    >>> plant = Plant("pendulum-test", hand="torque")
    >>> for _ in range(1000):
    ...     state = plant.step(hand_torque_nm=2.0)
    >>> state["angle_rad"]
    array([0.35...])

    A plant belongs to one thread at a time; plants of several threads run at the same time, as a step releases the GIL.

    Attributes:
        scene: The scene.
        step_s: Length of a step, s.
    """

    def __init__(
        self,
        scene: SceneLike,
        n: int = 1,
        *,
        hand: Literal["scene", "torque"] = "scene",
    ) -> None:
        """Makes plants at the start of the scene's motion.

        Args:
            scene: A scene with an effect of a plant, such as ``[effects.limb]`` or ``[effects.motor]``.
            n: How many, which differ in the torques that you give them.
            hand: ``scene`` moves the leg as the scene does, up to its end; ``torque`` by a torque of yours, without end, in
                the place of the scene's motion and hand. That needs ``[effects.limb]``.

        Raises:
            SceneError: The scene has no plant, or no leg for a torque.
        """
        if hand not in ("scene", "torque"):
            raise ValueError(f"hand: expected 'scene' or 'torque', got {hand!r}")
        self.scene = _scene(scene)
        self.step_s = self.scene.step_s
        self._plant = _crepitus.Plant(self.scene, _whole("n", n), takes_torque=hand == "torque")

    def step(
        self,
        hand_torque_nm: Numbers | None = None,
        motor_torque_nm: Numbers | None = None,
        *,
        steps: int = 1,
    ) -> Columns:
        """Steps all plants.

        Args:
            hand_torque_nm: Torque of the hand on the leg, N·m, positive toward flexion: one for all or one for each.
            motor_torque_nm: Setpoint of the motor, N·m, which opposes growing angle if it is positive; the scene's device
                renders on the shaft in any case, and has its own torque back with ``None``.
            steps: Number of steps with these torques.

        Returns:
            The :attr:`state` after them.

        Raises:
            ValueError: A torque is not finite, beyond ±1000 N·m, of another length than the plants, or missing; the scene
                has fewer steps left. Then no step was made.
            RunError: A plant diverged; :meth:`restore` a snapshot.
        """
        hand = self._each("hand_torque_nm", hand_torque_nm)
        motor = self._each("motor_torque_nm", motor_torque_nm)
        return self._plant.step(hand, motor, _whole("steps", steps))

    @property
    def state(self) -> Columns:
        """Columns of the scene's trace, a row a plant: ``t_s``, ``angle_rad``, ``omega_rad_s``, ``torque_nm``, …"""
        return self._plant.state()

    @property
    def time_s(self) -> float:
        """Time since the start, s."""
        return self._plant.time_s

    def snapshot(self) -> Plant:
        """All states, for :meth:`restore`: a copy."""
        return self.copy()

    def restore(self, snapshot: Plant) -> None:
        """Goes back to a snapshot of this plant, or of a copy of it.

        Raises:
            ValueError: It is one of another scene, of another number of plants, or with another hand.
        """
        same = isinstance(snapshot, Plant) and len(snapshot) == len(self)
        if not same or snapshot.scene != self.scene or snapshot._hand != self._hand:
            raise ValueError(
                f"snapshot: expected one of {self!r}, got {snapshot!r}: restore what snapshot() of this plant returned"
            )
        self._plant.restore(snapshot._plant)

    def copy(self) -> Plant:
        """Plants with the same states, which go on by themselves."""
        other = object.__new__(Plant)
        other.scene, other.step_s = self.scene, self.step_s
        other._plant = self._plant.copy()
        return other

    __copy__ = copy

    def __deepcopy__(self, _: dict[int, Any]) -> Plant:
        return self.copy()

    def __len__(self) -> int:
        return len(self._plant)

    def __repr__(self) -> str:
        return f"<Plant of {self.scene.title!r}: {len(self)} at {self.time_s} s, hand={self._hand!r}>"

    @property
    def _hand(self) -> str:
        return "torque" if self._plant.takes_torque else "scene"

    def _each(self, name: str, numbers: Numbers | None) -> npt.NDArray[np.float64] | None:
        if numbers is None:
            return None
        each = np.asarray(numbers, dtype=np.float64)
        if each.ndim > 1:
            raise ValueError(f"{name}: expected a number or {len(self)} of them, got {each.shape}")
        return np.full(len(self), each) if each.ndim == 0 else each
