//! What is estimated, where it stands in a scene, and from when on it counts as visible.

use crate::brace::numbers::place;
use crepitus_model::parameters::ParameterSpec;
use crepitus_plant::effect::Effect;
use crepitus_plant::effects::{backlash, cuff, drivetrain, limb, motor};

/// A quantity of the brace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Dry friction of motor and gear.
    Friction,
    /// Share of the motor's torque that the gear loses.
    LoadLoss,
    /// Viscous damping about the axis.
    Viscous,
    /// Inertia of the rotor, referred to the joint.
    RotorInertia,
    /// Inertia of the brace between gear and cuffs.
    BraceInertia,
    /// Lost motion of the gear.
    Backlash,
    /// Stiffness of the cuffs.
    CuffStiffness,
    /// Damping of the cuffs.
    CuffDamping,
    /// Torque constant of the motor.
    TorqueConstant,
}

impl Quantity {
    /// All, in the order of reports.
    pub const ALL: [Self; 9] = [
        Self::Friction,
        Self::LoadLoss,
        Self::Viscous,
        Self::RotorInertia,
        Self::BraceInertia,
        Self::Backlash,
        Self::CuffStiffness,
        Self::CuffDamping,
        Self::TorqueConstant,
    ];

    /// What it is called in sentences.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Friction => "dry friction",
            Self::LoadLoss => "load-dependent friction",
            Self::Viscous => "viscous friction",
            Self::RotorInertia => "rotor inertia",
            Self::BraceInertia => "brace inertia",
            Self::Backlash => "backlash",
            Self::CuffStiffness => "cuff stiffness",
            Self::CuffDamping => "cuff damping",
            Self::TorqueConstant => "torque constant",
        }
    }

    /// The effect of a scene, and the key, that it is a value of.
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

    /// Name of the effect of a scene.
    pub const fn effect(self) -> &'static str {
        self.key().0.name
    }

    /// Its row in that effect's table: key, unit, range, meaning.
    ///
    /// # Panics
    /// If the table has no such key: a mistake in this file, which a test finds.
    pub fn spec(self) -> &'static ParameterSpec {
        let (effect, key) = self.key();
        let found = effect.parameters.iter().find(|spec| spec.key == key);
        found.expect("a key of the effect's table")
    }

    /// Its place among the numbers.
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

    /// What a brace that is otherwise than the model does to it: 95 % are within this share of the
    /// value, or within this in its unit, whichever is wider, where the fit leaves next to nothing. From the second simulation of the
    /// tests, with teeth that give way and a friction that is 1.3 times as great at rest.
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

    /// Its 95 % interval may be ± this share of the value, or ± this in its unit, whichever is
    /// wider; else it is not visible.
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
