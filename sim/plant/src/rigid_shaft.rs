//! A shaft that moves as prescribed, with an actuator: no chain, and nothing that could move
//! otherwise. Its step is that of a [`Plant`](crate::plant::Plant) of a
//! [`Shaft`](crate::chain::Shaft) that a [`Prescribed`](crate::boundary::Prescribed) motion holds,
//! to the bit, without what is zero there.

use crate::actuator::Commanded;
use crate::boundary::MotionStep;
use crate::chain::{Body, Impacts};
use crate::energy_balance::{Account, EnergyBalance};
use crate::mechanics::{Driven, Mechanics};

/// A prescribed shaft with its actuator.
#[derive(Clone, Debug)]
pub struct RigidShaft<A> {
    actuator: A,
    body: Body,
    /// Impulse that the hand has felt, N·m·s.
    felt_nms: f64,
    /// Work of the hand, J.
    work_j: f64,
    start: EnergyBalance,
}

impl<A: Commanded> RigidShaft<A> {
    /// A shaft that begins at `start`.
    pub fn new(actuator: A, start: Body) -> Self {
        let mut shaft = Self {
            actuator,
            body: start,
            felt_nms: 0.0,
            work_j: 0.0,
            start: EnergyBalance::default(),
        };
        shaft.start = shaft.booked();
        shaft
    }

    fn booked(&self) -> EnergyBalance {
        let mut balance = EnergyBalance::default();
        balance.add("motion", "work", Account::Given, self.work_j);
        self.actuator.energy(&mut balance);
        balance
    }
}

impl<A: Commanded> Mechanics for RigidShaft<A> {
    const IS_RIGID: bool = true;

    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of the loop, whose arguments would pass through memory"
    )]
    fn advance(&mut self, motion: &MotionStep) {
        let length_s = motion.length_s;
        let push = self.actuator.fold(length_s);
        let omega_rad_s = (motion.angle_rad(1.0) - motion.from.angle_rad) / length_s;
        let mut torque_nm = push.at(omega_rad_s);
        if let Some(limit) = push.held_by_nm {
            torque_nm -= torque_nm.max(-limit).min(limit);
        }
        let impulse_nms = torque_nm * length_s;
        self.felt_nms -= impulse_nms;
        self.work_j -= impulse_nms * omega_rad_s;
        self.body = motion.to;
        self.actuator.settle(length_s, omega_rad_s);
    }

    #[inline]
    fn jump(&mut self, omega_rad_s: f64) {
        self.body.omega_rad_s = omega_rad_s;
    }

    #[inline]
    fn shaft(&self) -> Body {
        self.body
    }

    #[inline]
    fn felt_nms(&self) -> f64 {
        self.felt_nms
    }

    #[inline]
    fn struck_nms(&self) -> f64 {
        0.0
    }

    fn impacts(&self) -> Option<Impacts> {
        None
    }

    fn absorbed_j(&self) -> f64 {
        self.actuator.absorbed_j()
    }

    fn balance(&self) -> EnergyBalance {
        self.booked().since(&self.start)
    }

    fn write(&self, row: &mut Vec<f64>) {
        self.actuator.write(row);
    }

    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}

impl<A: Commanded> Driven for RigidShaft<A> {
    #[inline]
    fn command(&mut self, torque_nm: f64, _: f64) {
        self.actuator.command(torque_nm);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::Ideal;
    use crate::boundary::Prescribed;
    use crate::chain::Shaft;
    use crate::plant::Plant;

    /// Torques and motions of all sizes, at a velocity that jumps, on a plant of the same parts.
    #[test]
    fn a_rigid_shaft_is_a_plant_without_a_chain_to_the_bit() {
        let start = Body {
            angle_rad: -0.3,
            omega_rad_s: 0.7,
        };
        let mut ours = RigidShaft::new(Ideal::default(), start);
        let motion = Prescribed::new(start);
        let mut plant = Plant::new(Ideal::default(), Shaft, motion, start);
        let mut from = start;
        for n in 0..5_000_u32 {
            let t = f64::from(n);
            let torque_nm = 3.0 * (0.37 * t).sin();
            ours.command(torque_nm, 0.0);
            plant.command(torque_nm, 0.0);
            let to = Body {
                angle_rad: (0.01 * t).sin(),
                omega_rad_s: (0.01 * t).cos() * 200.0,
            };
            let step = MotionStep {
                length_s: 5e-5,
                from,
                to,
            };
            ours.advance(&step);
            plant.advance(&step);
            from = to;
            if n % 100 == 0 {
                from.omega_rad_s = -to.omega_rad_s;
                ours.jump(from.omega_rad_s);
                plant.jump(from.omega_rad_s);
            }
            assert_eq!(ours.shaft(), plant.shaft());
            assert_eq!(ours.felt_nms().to_bits(), plant.felt_nms().to_bits());
            assert_eq!(ours.absorbed_j().to_bits(), plant.absorbed_j().to_bits());
            assert_eq!(ours.balance(), plant.balance());
        }
        assert!(ours.work_j != 0.0 && ours.warnings().is_empty());
        let mut row = Vec::new();
        ours.write(&mut row);
        plant.write(&mut row);
        assert_eq!(row, []);
    }
}
