//! Drive of the shaft: an actuator that makes a torque out of the device's command, or
//! the [bridge](crate::effects::motor::bridge), which knows voltages only.

use crate::boxed::cloned_in_boxes;
use crate::chain::{Push, Step, Verdict};
use crate::energy_balance::{Account, EnergyBalance};

/// Drives the shaft.
pub trait Actuator: Send {
    /// Action on the shaft over a step of `length_s`.
    fn fold(&mut self, length_s: f64) -> Push;

    /// Looks at a solution in which the shaft turns with this mean velocity,
    /// rad/s; see [`Verdict`].
    ///
    /// Only an actuator whose type is known is asked: one in a box has no
    /// modes, and costs no question.
    #[inline]
    fn check(&mut self, _: &Step, _mean_rad_s: impl FnOnce() -> f64) -> Verdict
    where
        Self: Sized,
    {
        Verdict::Holds
    }

    /// Torque that goes through the gear as the step begins, N·m.
    fn load_nm(&self) -> f64;

    /// Makes the step in which the shaft turned with `mean_rad_s`.
    fn settle(&mut self, length_s: f64, mean_rad_s: f64);

    /// Work that its torque has taken out of the mechanics so far, J.
    fn absorbed_j(&self) -> f64;

    /// Accounting where that work is.
    fn energy(&self, balance: &mut EnergyBalance);

    /// Names of the columns in a trace.
    fn columns(&self) -> &'static [&'static str];

    /// Writes them.
    fn write(&self, row: &mut Vec<f64>);
}

cloned_in_boxes!(Commanded, BoxedCommanded);

/// An actuator with a torque setpoint.
pub trait Commanded: Actuator + BoxedCommanded {
    /// Starts a tick with the torque setpoint of the device, N·m: T > 0
    /// opposes growing angle.
    fn command(&mut self, torque_nm: f64);
}

impl Actuator for Box<dyn Commanded> {
    #[inline]
    fn fold(&mut self, length_s: f64) -> Push {
        self.as_mut().fold(length_s)
    }

    #[inline]
    fn load_nm(&self) -> f64 {
        self.as_ref().load_nm()
    }

    #[inline]
    fn settle(&mut self, length_s: f64, mean_rad_s: f64) {
        self.as_mut().settle(length_s, mean_rad_s);
    }

    fn absorbed_j(&self) -> f64 {
        self.as_ref().absorbed_j()
    }

    fn energy(&self, balance: &mut EnergyBalance) {
        self.as_ref().energy(balance);
    }

    fn columns(&self) -> &'static [&'static str] {
        self.as_ref().columns()
    }

    fn write(&self, row: &mut Vec<f64>) {
        self.as_ref().write(row);
    }
}

impl Commanded for Box<dyn Commanded> {
    #[inline]
    fn command(&mut self, torque_nm: f64) {
        self.as_mut().command(torque_nm);
    }
}

/// An ideal actuator: no lag, no limit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ideal {
    torque_nm: f64,
    absorbed_j: f64,
}

impl Commanded for Ideal {
    #[inline]
    fn command(&mut self, torque_nm: f64) {
        self.torque_nm = torque_nm;
    }
}

impl Actuator for Ideal {
    #[inline]
    fn fold(&mut self, _: f64) -> Push {
        Push {
            torque_nm: -self.torque_nm,
            slope_nms: 0.0,
            held_by_nm: None,
        }
    }

    #[inline]
    fn load_nm(&self) -> f64 {
        self.torque_nm
    }

    #[inline]
    fn settle(&mut self, length_s: f64, mean_rad_s: f64) {
        self.absorbed_j += self.torque_nm * length_s * mean_rad_s;
    }

    fn absorbed_j(&self) -> f64 {
        self.absorbed_j
    }

    fn energy(&self, balance: &mut EnergyBalance) {
        balance.add("actuator", "torque", Account::Rendered, self.absorbed_j);
    }

    fn columns(&self) -> &'static [&'static str] {
        &[]
    }

    fn write(&self, _: &mut Vec<f64>) {}
}
