//! Questions of a run to whatever moves its shaft: a [`Plant`], or a
//! [`RigidShaft`](crate::rigid_shaft::RigidShaft), which has nothing that could move otherwise.

use crate::actuator::{Actuator, Commanded};
use crate::boundary::{Boundary, MotionStep};
use crate::chain::{Body, Chain, Impacts};
use crate::energy_balance::EnergyBalance;
use crate::plant::Plant;

/// Mechanics that go along with a motion.
pub trait Mechanics {
    /// Whether the shaft moves as the motion does, always: then no part can strike another, either.
    const IS_RIGID: bool;

    /// One step, in which the scene's motion goes like this.
    fn advance(&mut self, motion: &MotionStep);

    /// Lets the motion's velocity jump to `omega_rad_s` between two steps.
    fn jump(&mut self, omega_rad_s: f64);

    /// The motor's shaft, referred to the joint.
    fn shaft(&self) -> Body;

    /// Impulse that the hand has felt so far, N·m·s; see [`Boundary::felt_nms`].
    fn felt_nms(&self) -> f64;

    /// The part of that which came in impacts, N·m·s.
    fn struck_nms(&self) -> f64;

    /// The impacts so far; none if no part of it can have any.
    fn impacts(&self) -> Option<Impacts>;

    /// Work that the actuator has taken out of the mechanics so far, J.
    fn absorbed_j(&self) -> f64;

    /// The energy balance since the start.
    fn balance(&self) -> EnergyBalance;

    /// Writes the columns of its parts in a trace.
    fn write(&self, row: &mut Vec<f64>);

    /// Warnings.
    fn warnings(&self) -> Vec<String>;
}

/// Mechanics whose actuator has a torque setpoint.
pub trait Driven: Mechanics {
    /// Starts a tick with the torque setpoint of the device, N·m, and the voltage that
    /// it commanded for the coil in the tick before, V.
    fn command(&mut self, torque_nm: f64, coil_v: f64);
}

impl<A: Actuator, C: Chain, B: Boundary> Mechanics for Plant<A, C, B> {
    const IS_RIGID: bool = false;

    #[inline]
    fn advance(&mut self, motion: &MotionStep) {
        Self::advance(self, motion);
    }

    fn jump(&mut self, omega_rad_s: f64) {
        Self::jump(self, omega_rad_s);
    }

    #[inline]
    fn shaft(&self) -> Body {
        Self::shaft(self)
    }

    #[inline]
    fn felt_nms(&self) -> f64 {
        Self::felt_nms(self)
    }

    #[inline]
    fn struck_nms(&self) -> f64 {
        Self::struck_nms(self)
    }

    fn impacts(&self) -> Option<Impacts> {
        Self::impacts(self)
    }

    fn absorbed_j(&self) -> f64 {
        Self::absorbed_j(self)
    }

    fn balance(&self) -> EnergyBalance {
        Self::balance(self)
    }

    fn write(&self, row: &mut Vec<f64>) {
        Self::write(self, row);
    }

    fn warnings(&self) -> Vec<String> {
        Self::warnings(self)
    }
}

impl<A: Commanded, C: Chain, B: Boundary> Driven for Plant<A, C, B> {
    #[inline]
    fn command(&mut self, torque_nm: f64, coil_v: f64) {
        Self::command(self, torque_nm, coil_v);
    }
}
