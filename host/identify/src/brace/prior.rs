//! Prior distribution of the parameters: of the weight as it was measured, of the brace as braces
//! are.
//!
//! The second is so wide that a recording that shows a quantity overrules it; what a
//! recording does not show stays as uncertain as it is here, and is not reported.

use crate::brace::numbers::{NUMBERS, place};
use crate::brace::recording::Weight;

/// Standard deviation of a motor's torque constant by its data sheet, as a share: ±10 %
/// are usual.
pub const TORQUE_DEVIATION: f64 = 0.05;

/// Mean and standard deviation of each parameter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prior {
    pub(crate) mean: [f64; NUMBERS],
    pub(crate) deviation: [f64; NUMBERS],
}

/// A brace with a gearmotor for a knee: means of data sheets, deviations that hold anything
/// that could be one.
const BRACE: [(usize, f64, f64); 8] = [
    (place::FRICTION, 0.5, 3.0),
    (place::LOAD_LOSS, 0.3, 0.3),
    (place::VISCOUS, 0.1, 1.0),
    (place::ROTOR, 0.05, 0.2),
    (place::BRACE, 0.01, 0.02),
    (place::GAP, 0.0175, 0.05),
    (place::STIFFNESS, 120.0, 300.0),
    (place::DAMPING, 1.0, 3.0),
];

/// Standard deviations of the imperfections about none, wide enough for nylon links and a dry gear.
const IMPERFECTIONS: [(usize, f64); 3] = [
    (place::PRESLIDING, 2e-4),
    (place::TEETH, 5e-4),
    (place::STRIBECK, 0.3),
];
const BY_ANGLE: f64 = 0.1;
const ENCODER: f64 = 0.05;

impl Prior {
    /// Returns the prior for a weight, and a torque constant with this relative standard deviation.
    pub(crate) fn of(weight: &Weight, torque_deviation: f64) -> Self {
        let mut prior = Self {
            mean: [0.0; NUMBERS],
            deviation: [1.0; NUMBERS],
        };
        for (at, mean, deviation) in BRACE {
            (prior.mean[at], prior.deviation[at]) = (mean, deviation);
        }
        for (at, deviation) in IMPERFECTIONS {
            (prior.mean[at], prior.deviation[at]) = (0.0, deviation);
        }
        for deviation in &mut prior.deviation[place::BY_ANGLE..place::ENCODER] {
            *deviation = BY_ANGLE;
        }
        prior.deviation[place::ENCODER] = ENCODER;
        for (at, measured) in [
            (place::MOMENT, weight.moment_nm),
            (place::WEIGHT, weight.inertia_kg_m2),
        ] {
            prior.mean[at] = measured.value;
            prior.deviation[at] = measured.value * measured.deviation;
        }
        prior.mean[place::TORQUE_SCALE] = 1.0;
        prior.deviation[place::TORQUE_SCALE] = torque_deviation;
        prior
    }
}
