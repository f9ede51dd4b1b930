//! `friction-compensation`: the device's feed-forward against the gear's dry
//! friction. The law is the firmware's: `crepitus_model::render::friction_compensation`
//! has its equation, sources, and what it may give to the hand.

use crate::effect::{Effect, Need, Part, Seen, Stage, numbers};
use crepitus_model::Real;
use crepitus_model::render::friction_compensation::{FrictionCompensation, FrictionCompensationSettings};
use crepitus_model::parameters::Tabled;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: "friction-compensation",
    adds: "the device's feed-forward against a share of the gear's dry friction",
    states: &[],
    parameters: FrictionCompensationSettings::TABLE,
    choices: &[],
    needs: &[Need {
        effect: "drivetrain",
        why: "without it there is no friction to compensate",
    }],
    part: Part::Stage(
        |given, context| {
            let settings = FrictionCompensationSettings::of(numbers(given));
            Ok(if context.single {
                Box::new(Compensation(FrictionCompensation::<f32>::new(&settings)?))
            } else {
                Box::new(Compensation(FrictionCompensation::<f64>::new(&settings)?))
            })
        },
        "compensation_nm",
    ),
};

struct Compensation<F>(FrictionCompensation<F>);

impl<F: Real> Stage for Compensation<F> {
    fn tick(&mut self, seen: &Seen) -> f64 {
        self.0.torque_nm(F::from_f64(seen.omega_rad_s)).to_f64()
    }
}
