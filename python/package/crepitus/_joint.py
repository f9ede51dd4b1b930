"""The joint alone, for a loop of your own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _crepitus
from ._crepitus import Scene
from ._types import Columns, Numbers


@dataclass(frozen=True)
class Passivity:
    """Energy that a :class:`Joint` can return to its shaft, and up to which motion it pushes nothing.

    Up to the limits a shaft gets back, over any stretch, at most ``stored_j`` and what sampling makes, which a damping of
    ``needed_damping_nms_per_rad`` takes: E ≤ Ts²/2kr + (½ + d)·kr·h·∫Ω² dt. The page on stability has the derivation.

    Attributes:
        stored_j: Energy of the spring at most, J.
        needed_damping_nms_per_rad: Damping of the shaft, N·m·s/rad.
        most_acceleration_rad_s2: Acceleration of the shaft up to which no slip pushes, without velocity steps, rad/s²; ``None``
            where no limit is known, under ``paper`` and ``physical``.
        most_velocity_step_rad_s: Velocity step within a slip up to which it pushes nothing, on a shaft that is not accelerated
            otherwise, rad/s; ``None`` likewise.
    """

    stored_j: float
    needed_damping_nms_per_rad: float
    most_acceleration_rad_s2: float | None
    most_velocity_step_rad_s: float | None


class Joint:
    """The stick-slip object on a shaft that you move.

    It starts in stick with no torque. A step of your loop is a turn of the shaft and the speed
    at its end; what comes back is the torque, N·m, which opposes growing angle if it is above 0.

    >>> joint = Joint("coarse", step_s=5e-5)
    >>> joint.step(5e-5, 1.0)  # 5e-5 rad in 5e-5 s: 1 rad/s
    0.02
    >>> joint.steps(np.full(1000, 5e-5), np.full(1000, 1.0))["torque_nm"].max()
    0.4

    **It may push.** A slip shows its torque for its time, also if the shaft turns back meanwhile: then it drives the shaft. A
    device has a guard against that, a joint alone has none: ``coarse``, shaken at 20 Hz by ±0.02 rad, gives away 0.2 J in 4 s.
    :meth:`may_push` says from which motion on, and :attr:`returned_j` what has come back.

    A call costs a tenth of a microsecond, a step in an array a tenth of that: use :meth:`steps` where the
    motion is known, and :class:`Joints` for many.
    """

    def __init__(
        self,
        joint: str | Mapping[str, Any] = "coarse",
        *,
        convention: str | None = None,
        restart: str | None = None,
        solver: str = "exact-events",
        step_s: float = 5e-5,
        precision: str = "f64",
        omega_rad_s: float = 0.0,
    ) -> None:
        """Makes a joint.

        Args:
            joint: The name of a preset with crepitus, or the keys of a scene's ``[effects.crepitus]``:
                ``{"stiffness_nm_per_rad": 400.0, …}``; what is left out is the paper's.
            convention: ``frozen``, ``paper`` or ``physical``.
            restart: ``elastic`` or ``from-kinetic``.
            solver: A solver with a step.
            step_s: The step, s.
            precision: ``f32`` or ``f64``, of the state.
            omega_rad_s: Speed of the shaft before the first step, rad/s.

        Raises:
            SceneError: A parameter is unknown or out of its range.
        """
        #: Joint, solver and step as a scene: its parameters are in ``scene.toml``.
        self.scene = scene_of(effect_of(joint, convention, restart), solver, step_s, precision)
        self.step_s = float(step_s)
        self._joint = _crepitus.Joint(self.scene, float(omega_rad_s))
        # One call less, for a loop that steps by hand.
        self.step = self._joint.step

    def passivity(self, delay_steps: float = 0.0) -> Passivity:
        """Energy that the joint can return, with this step and convention.

        Args:
            delay_steps: Steps between a torque and its effect on the shaft, besides the one that it is held over.
        """
        return Passivity(*self._joint.passivity(float(delay_steps)))

    def may_push(self, acceleration_rad_s2: float, velocity_step_rad_s: float = 0.0) -> bool:
        """Whether a slip can drive a shaft that turns back; ``True`` also where no limit is known.

        Args:
            acceleration_rad_s2: Largest acceleration of the shaft, rad/s²: A·(2πf)² of a shaking by A rad at f Hz.
            velocity_step_rad_s: Sum of its velocity steps in one slip, rad/s.
        """
        return self._joint.may_push(float(acceleration_rad_s2), float(velocity_step_rad_s))

    @property
    def returned_j(self) -> float:
        """Most energy that the shaft got back over any stretch since the joint was made or restarted, J.

        Each torque is taken to be held over the step that follows. Above ``passivity().stored_j`` the joint, or its sampling,
        has pushed.
        """
        return self._joint.returned_j

    def steps(self, dphi_rad: Numbers, omega_rad_s: Numbers) -> Columns:
        """Many steps in one call.

        Args:
            dphi_rad: The shaft's turn in each step, rad.
            omega_rad_s: Its speed at the end of each step, rad/s.

        Returns:
            Columns ``torque_nm``, ``phase`` (-1, 0, +1), ``theta_rad``, ``theta_dot_rad_s``: the state
            after each step.

        Raises:
            ValueError: The lengths differ, or a number is not finite or beyond 50 rad/s, as of :meth:`step`; then no step was
                done.
        """
        return self._joint.steps(_vector(dphi_rad), _vector(omega_rad_s))

    def follow(self, angle_rad: Numbers) -> Columns:
        """Moves the shaft along angles, one a step; the first is where it is now.

        The speed at the end of a step is the mean over it, as of a joint whose angle alone is
        known. Returns what :meth:`steps` returns.
        """
        turns = np.diff(_vector(angle_rad))
        return self.steps(turns, turns / self.step_s)

    def restart(self, torque_nm: float = 0.0, omega_rad_s: float = 0.0) -> None:
        """Puts the object in stick where the shaft is, showing ``torque_nm`` (at most ±Ts)."""
        self._joint.restart(torque_nm, omega_rad_s)

    def copy(self) -> Joint:
        """A joint with the same state, which goes on by itself."""
        other = object.__new__(Joint)
        other.scene, other.step_s = self.scene, self.step_s
        other._joint = self._joint.copy()
        other.step = other._joint.step
        return other

    __copy__ = copy

    def __deepcopy__(self, _: dict[int, Any]) -> Joint:
        return self.copy()

    @property
    def torque_nm(self) -> float:
        """The torque, N·m."""
        return self._joint.torque_nm

    @property
    def phase(self) -> int:
        """-1, 0 (stick) or +1: the sense of the slip."""
        return self._joint.phase

    @property
    def theta_rad(self) -> float:
        """Angle of the object, rad."""
        return self._joint.theta_rad

    @property
    def theta_dot_rad_s(self) -> float:
        """Velocity of the object, rad/s."""
        return self._joint.theta_dot_rad_s

    @property
    def events(self) -> dict[str, int]:
        """Events since the joint was made, by kind: ``break``, ``stick``, ``reverse``."""
        breaks, sticks, reverses = self._joint.events
        return {"break": breaks, "stick": sticks, "reverse": reverses}

    def __repr__(self) -> str:
        return f"<Joint {self.scene.solver} at {self.step_s} s, {self.torque_nm} N·m>"


def effect_of(
    joint: str | Mapping[str, Any], convention: str | None, restart: str | None
) -> dict[str, Any]:
    """Returns the keys of ``[effects.crepitus]``."""
    if isinstance(joint, str):
        effect: dict[str, Any] = {"preset": joint}
    elif isinstance(joint, Mapping):
        effect = dict(joint)
    else:
        raise TypeError(
            f"joint: expected the name of a preset or a dict, got {type(joint).__name__}"
        )
    if convention is not None:
        effect["convention"] = convention
    if restart is not None:
        effect["restart"] = restart
    return effect


def scene_of(effect: dict[str, Any], solver: str, step_s: float, precision: str) -> Scene:
    """Returns a scene of a joint alone."""
    return Scene(
        {
            "version": 1,
            "title": "A joint",
            "duration_s": 1.0,
            "motion": {"kind": "constant", "velocity_rad_s": 0.0},
            "solver": {"kind": solver, "step_s": step_s, "precision": precision},
            "effects": {"crepitus": effect},
        }
    )


def _vector(numbers: Numbers) -> npt.NDArray[np.float64]:
    vector = np.asarray(numbers, dtype=np.float64)
    if vector.ndim != 1:
        raise ValueError(f"expected one dimension, got {vector.ndim}")
    return vector
