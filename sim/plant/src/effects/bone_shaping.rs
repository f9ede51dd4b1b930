//! `bone-shaping`: the ringing of a bone, struck by the model's events. The
//! law, its limits and its budget of energy are the firmware's:
//! `crepitus_model::render::bone_shaping`.

use crate::effect::{Effect, Need, Part, Seen, Stage, numbers};
use crepitus_model::Real;
use crepitus_model::render::bone_shaping::{BoneShaping, BoneShapingSettings};
use crepitus_model::parameters::Tabled;

/// Ticks between a sample and the torque that answers it: with a motor half a
/// tick to the next voltage, and a lag.
const DELAY_TICKS: usize = 1;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: "bone-shaping",
    adds: "a ringing of the rendered torque where cuff and tissue swallow that of the bone",
    states: &["ringing", "its rate"],
    parameters: BoneShapingSettings::TABLE,
    choices: &[],
    needs: &[Need {
        effect: "crepitus",
        why: "it rings where the model's torque jumps",
    }],
    part: Part::Stage(
        |given, context| {
            let settings = BoneShapingSettings::of(numbers(given));
            Ok(if context.single {
                Box::new(Shaping(BoneShaping::<f32>::new(
                    &settings,
                    context.tick_s,
                    DELAY_TICKS,
                )?))
            } else {
                Box::new(Shaping(BoneShaping::<f64>::new(
                    &settings,
                    context.tick_s,
                    DELAY_TICKS,
                )?))
            })
        },
        "shaping_nm",
    ),
};

struct Shaping<F>(BoneShaping<F>);

impl<F: Real> Stage for Shaping<F> {
    fn tick(&mut self, seen: &Seen) -> f64 {
        self.0.ring(F::from_f64(seen.jump_nm));
        self.0.tick(F::from_f64(seen.delta_phi_rad)).to_f64()
    }
}
