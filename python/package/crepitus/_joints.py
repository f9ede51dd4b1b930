"""Many joints at once, for sweeps, ensembles and simulations in step."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _crepitus
from ._joint import effect_of, scene_of
from ._types import Columns, Numbers


class Joints:
    """Stick-slip objects that differ in their parameters, on one motion or each on its own.

    Each has the bits of a :class:`Joint` of its parameters. A value of the joint that is an array has a
    number for each joint; ``omega_rad_s`` may be one, too.

    >>> joints = Joints({"preset": "coarse", "static_torque_nm": np.linspace(0.3, 0.5, 100)})
    >>> joints.steps(np.full(1000, 5e-5), np.full(1000, 1.0))["torque_nm"].shape
    (100, 1000)
    >>> joints.step(5e-5, 1.0).shape
    (100,)
    """

    def __init__(
        self,
        joints: str | Mapping[str, Any] = "coarse",
        count: int | None = None,
        *,
        convention: str | None = None,
        restart: str | None = None,
        solver: str = "exact-events",
        step_s: float = 5e-5,
        precision: str = "f64",
        omega_rad_s: Numbers = 0.0,
    ) -> None:
        """Makes joints.

        Args:
            joints: As of :class:`Joint`, with numbers or one-dimensional arrays of one length.
            count: Number of joints; that of the arrays, if there are any.
            convention: As of :class:`Joint`, and so on.
            restart:
            solver:
            step_s:
            precision: Also of the arrays that :meth:`steps` returns.
            omega_rad_s: Speed of the shafts before the first step, rad/s: one, or one of each.

        Raises:
            SceneError: A parameter is unknown or out of its range.
            ValueError: The lengths differ, or there is no joint.
        """
        effect = effect_of(joints, convention, restart)
        omega = np.asarray(omega_rad_s, dtype=np.float64)
        arrays = {
            key: np.asarray(value, dtype=np.float64)
            for key, value in effect.items()
            if not isinstance(value, str) and np.ndim(value) > 0
        }
        sized = [*arrays.items(), *([("omega_rad_s", omega)] if omega.ndim else [])]
        for name, array in sized:
            if array.ndim != 1:
                raise ValueError(f"{name}: expected one dimension, got {array.ndim}")
            count = len(array) if count is None else count
            if len(array) != count:
                raise ValueError(f"{name}: expected {count} numbers, got {len(array)}")
        if count is None:
            count = 1
        if count < 1:
            raise ValueError(f"count: expected at least one joint, got {count}")
        # What is wrong with the first is said by its scene, with its key.
        effect.update({key: float(array[0]) for key, array in arrays.items()})
        #: The first joint, solver and step as a scene.
        self.scene = scene_of(effect, solver, step_s, precision)
        self.step_s = float(step_s)
        self._joints = _crepitus.Joints(
            self.scene, np.broadcast_to(omega, count), list(arrays.items())
        )

    def __len__(self) -> int:
        return len(self._joints)

    def step(self, dphi_rad: Numbers, omega_rad_s: Numbers) -> npt.NDArray[np.float64]:
        """One step of all joints.

        Args:
            dphi_rad: The shaft's turn, rad: one, or one of each joint.
            omega_rad_s: Its speed at the end of the step, rad/s, likewise.

        Returns:
            The torques, N·m.
        """
        turns, speeds = _pair(dphi_rad, omega_rad_s)
        if turns.ndim > 1:
            raise ValueError(f"expected a number, or one of each joint, got shape {turns.shape}")
        return self._joints.step(turns, speeds, turns.ndim == 1)

    def steps(
        self,
        dphi_rad: Numbers,
        omega_rad_s: Numbers,
        *,
        motion: bool = False,
        threads: int = 1,
    ) -> Columns:
        """Many steps of all joints in one call.

        Args:
            dphi_rad: The shaft's turn in each step, rad: one motion, or a row for each joint.
            omega_rad_s: Its speed at the end of each step, rad/s, likewise.
            motion: Return the object's motion, too.
            threads: Number of threads that share the joints.

        Returns:
            Columns ``torque_nm`` and ``phase``, with ``motion`` also ``theta_rad`` and ``theta_dot_rad_s``: a
            row for each joint, with the state after each step.

        Raises:
            ValueError: The shapes do not fit, or a number is not finite or beyond 50 rad/s; then no step was done.
        """
        turns, speeds = _pair(dphi_rad, omega_rad_s)
        if turns.ndim == 0 or turns.ndim > 2 or (turns.ndim == 2 and len(turns) != len(self)):
            raise ValueError(
                f"expected one motion or {len(self)} rows of them, got shape {turns.shape}"
            )
        if threads < 1:
            raise ValueError(f"threads: expected at least 1, got {threads}")
        columns = self._joints.steps(turns, speeds, turns.ndim == 2, motion, threads)
        shape = (len(self), turns.shape[-1])
        return {name: column.reshape(shape) for name, column in columns.items()}

    def restart(self, joint: int, torque_nm: float = 0.0, omega_rad_s: float = 0.0) -> None:
        """Puts a joint in stick where its shaft is, showing ``torque_nm`` (at most ±Ts)."""
        self._joints.restart(range(len(self))[joint], torque_nm, omega_rad_s)

    def copy(self) -> Joints:
        """A snapshot: joints with the same states, which go on by themselves."""
        other = object.__new__(Joints)
        other.scene, other.step_s = self.scene, self.step_s
        other._joints = self._joints.copy()
        return other

    __copy__ = copy

    def __deepcopy__(self, _: dict[int, Any]) -> Joints:
        return self.copy()

    @property
    def torque_nm(self) -> npt.NDArray[np.float64]:
        """The torques, N·m."""
        return self._joints.torque_nm

    @property
    def phase(self) -> npt.NDArray[np.int8]:
        """-1, 0 (stick) or +1 of each: the sense of the slip."""
        return self._joints.phase

    @property
    def theta_rad(self) -> npt.NDArray[np.float64]:
        """Angles of the objects, rad."""
        return self._joints.theta_rad

    @property
    def theta_dot_rad_s(self) -> npt.NDArray[np.float64]:
        """Velocities of the objects, rad/s."""
        return self._joints.theta_dot_rad_s

    @property
    def events(self) -> Columns:
        """Events of each since it was made, by kind: ``break``, ``stick``, ``reverse``."""
        return dict(zip(("break", "stick", "reverse"), self._joints.events, strict=True))

    def __repr__(self) -> str:
        return f"<{len(self)} Joints {self.scene.solver} at {self.step_s} s>"


def _pair(
    dphi_rad: Numbers, omega_rad_s: Numbers
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    turns = np.asarray(dphi_rad, dtype=np.float64)
    speeds = np.asarray(omega_rad_s, dtype=np.float64)
    if turns.shape != speeds.shape:
        turns, speeds = np.broadcast_arrays(turns, speeds)
    return turns, speeds
