//! Estimated quantities, their keys in a scene, and the limits of their visibility.

use crate::brace::numbers::place;
use crepitus_model::parameters::ParameterSpec;
use crepitus_plant::effect::Effect;
use crepitus_plant::effects::{backlash, cuff, drivetrain, limb, motor};

crepitus_model::named! {
    /// A quantity of the brace.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Quantity {
        /// Dry friction of motor and gear.
        Friction => "dry friction",
        /// Share of the motor's torque that the gear loses.
        LoadLoss => "load-dependent friction",
        /// Viscous damping about the axis.
        Viscous => "viscous friction",
        /// Inertia of the rotor, referred to the joint.
        RotorInertia => "rotor inertia",
        /// Inertia of the brace between gear and cuffs.
        BraceInertia => "brace inertia",
        /// Lost motion of the gear.
        Backlash => "backlash",
        /// Stiffness of the cuffs.
        CuffStiffness => "cuff stiffness",
        /// Damping of the cuffs.
        CuffDamping => "cuff damping",
        /// Torque constant of the motor.
        TorqueConstant => "torque constant",
    }
}

impl Quantity {
    /// Returns the effect of a scene and its key that the quantity is a value of.
    const fn key(self) -> (&'static Effect, &'static str) {
        match self {
            Self::Friction => (&drivetrain::EFFECT, "friction_nm"),
            Self::LoadLoss => (&drivetrain::EFFECT, "load_loss"),
            Self::Viscous => (&limb::EFFECT, "damping_nms_per_rad"),
            Self::RotorInertia => (&drivetrain::EFFECT, "inertia_kg_m2"),
            Self::BraceInertia => (&cuff::EFFECT, "brace_inertia_kg_m2"),
            Self::Backlash => (&backlash::EFFECT, "gap_deg"),
            Self::CuffStiffness => (&cuff::EFFECT, "stiffness_nm_per_rad"),
            Self::CuffDamping => (&cuff::EFFECT, "damping_nms_per_rad"),
            Self::TorqueConstant => (&motor::EFFECT, "torque_constant_nm_per_a"),
        }
    }

    /// Returns the name of the effect of a scene.
    pub const fn effect(self) -> &'static str {
        self.key().0.name
    }

    /// Returns the row of the effect's parameter table: key, unit, range, meaning.
    ///
    /// # Panics
    /// If the table has no such key: a mistake in this file, which a test finds.
    pub fn spec(self) -> &'static ParameterSpec {
        let (effect, key) = self.key();
        let found = effect.parameters.iter().find(|spec| spec.key == key);
        found.expect("a key of the effect's table")
    }

    /// Returns the index among the parameters of the fit.
    pub(crate) const fn place(self) -> usize {
        match self {
            Self::Friction => place::FRICTION,
            Self::LoadLoss => place::LOAD_LOSS,
            Self::Viscous => place::VISCOUS,
            Self::RotorInertia => place::ROTOR,
            Self::BraceInertia => place::BRACE,
            Self::Backlash => place::GAP,
            Self::CuffStiffness => place::STIFFNESS,
            Self::CuffDamping => place::DAMPING,
            Self::TorqueConstant => place::TORQUE_SCALE,
        }
    }

    /// Allowance for model errors, half width of a 95 % interval at a small residual: as a share of
    /// the value, or absolute in the unit of the quantity, whichever is wider. From the second
    /// simulation of the tests, with compliant teeth and a friction that is 1.3 times as great at
    /// rest.
    pub(crate) const fn model_error(self) -> (f64, f64) {
        match self {
            Self::Friction => (0.01, 0.002),
            Self::LoadLoss => (0.03, 0.01),
            Self::Viscous => (0.02, 0.003),
            Self::Backlash => (0.015, 0.0),
            Self::RotorInertia | Self::CuffStiffness | Self::TorqueConstant => (0.02, 0.0),
            Self::BraceInertia => (0.06, 0.0),
            Self::CuffDamping => (0.04, 0.0),
        }
    }

    /// Widest half interval of a visible quantity: as a share of the value, or absolute in the unit
    /// of the quantity, whichever is wider.
    pub(crate) const fn widest(self) -> (f64, f64) {
        match self {
            Self::Friction => (0.2, 0.02),
            Self::LoadLoss => (0.0, 0.1),
            Self::Viscous => (0.25, 0.03),
            Self::RotorInertia | Self::CuffStiffness => (0.25, 0.0),
            Self::BraceInertia | Self::CuffDamping => (0.35, 0.0),
            Self::Backlash => (0.2, 0.05),
            Self::TorqueConstant => (0.06, 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_quantity_is_a_parameter_of_a_scene() {
        for quantity in Quantity::ALL {
            assert!(!quantity.spec().unit.is_empty(), "{quantity:?}");
        }
    }
}
