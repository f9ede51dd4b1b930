//! The random corpus: case n is a function of [`SEED`] and n, nothing else.
//!
//! Seed rule: the generator of case n is `fastrand::Rng::with_seed(SEED +
//! n·0x9E3779B97F4A7C15)`, wrapping; an attempt whose numbers no constructor
//! accepts is drawn again from the same generator.
//!
//! Most cases come from a physically wide core, one in seven from the whole
//! ranges of `crepitus_model::parameters`. The speed is chosen by λ = (Ts −
//! Tk)/(Ω·√(J·kr)) in most, so that both stick and slip occur,
//! and the duration in cycles of the crepitus.

mod joint;
mod knots;
mod recorded;

use crepitus_model::{Convention, Settings, Validated};
use crepitus_plant::Motion;
use crepitus_plant::motion::Strokes;
use fastrand::Rng;
use joint::Scale;

/// The seed of the corpus.
pub const SEED: u64 = 0xC0FF_EE5E_ED14_0002;

/// The most events that are compared in a case.
pub const MOST_EVENTS: usize = 200;

crepitus_model::named! {
    /// The kinds of motion.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum MotionKind {
        /// One velocity.
        Constant => "constant",
        /// A sine of the angle.
        Sine => "sine",
        /// Velocity linear between knots, with jumps.
        Knots => "velocity-knots",
        /// Minimum-jerk strokes.
        Strokes => "strokes",
        /// A smoothed recording.
        Recording => "recording",
    }
}

/// A joint and a motion to compare solvers on.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number of the case.
    pub number: u64,
    /// The joint.
    pub settings: Validated<Settings>,
    /// The kind of motion.
    pub kind: MotionKind,
    /// The motion.
    pub motion: Motion,
    /// Duration, s.
    pub duration_s: f64,
}

impl Case {
    /// Case `number` of the corpus.
    pub fn new(number: u64) -> Self {
        let mut rng = Rng::with_seed(SEED.wrapping_add(number.wrapping_mul(0x9E37_79B9_7F4A_7C15)));
        loop {
            if let Some(case) = draw(number, &mut rng) {
                return case;
            }
        }
    }
}

/// A number whose logarithm is uniform.
fn log_uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(rng.f64())
}

/// A number between two.
fn uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.f64()
}

/// A sign.
fn sign(rng: &mut Rng) -> f64 {
    if rng.bool() { 1.0 } else { -1.0 }
}

fn draw(number: u64, rng: &mut Rng) -> Option<Case> {
    let convention = *rng.choice(&Convention::ALL)?;
    let kind = match rng.u32(0..100) {
        0..15 => MotionKind::Constant,
        15..40 => MotionKind::Sine,
        40..65 => MotionKind::Knots,
        65..80 => MotionKind::Strokes,
        _ => MotionKind::Recording,
    };
    let (settings, scale) = joint::draw(rng, convention, kind)?;
    let (motion, duration_s) = motion(rng, kind, scale)?;
    Some(Case {
        number,
        settings,
        kind,
        motion,
        duration_s,
    })
}

/// A motion of this kind and how long it is followed, s.
fn motion(rng: &mut Rng, kind: MotionKind, scale: Scale) -> Option<(Motion, f64)> {
    let Scale {
        speed_rad_s,
        duration_s,
    } = scale;
    Some(match kind {
        MotionKind::Constant => {
            let velocity = match rng.u32(0..50) {
                0 => 0.0,
                1 => 1e-12 * speed_rad_s,
                _ => speed_rad_s,
            };
            (Motion::constant(sign(rng) * velocity), duration_s)
        }
        MotionKind::Sine => {
            let frequency_hz = log_uniform(rng, 0.1, 40.0) / duration_s;
            let amplitude_rad = speed_rad_s / (std::f64::consts::TAU * frequency_hz);
            let phase_deg = match rng.u32(0..4) {
                0 => 0.0,
                1 => 90.0,
                2 => -90.0,
                _ => uniform(rng, -180.0, 180.0),
            };
            (
                Motion::sine(sign(rng) * amplitude_rad, frequency_hz, phase_deg),
                duration_s,
            )
        }
        MotionKind::Knots => knots::draw(rng, scale),
        MotionKind::Strokes => {
            let stroke_s = duration_s / uniform(rng, 0.7, 6.0);
            let span_rad = speed_rad_s * stroke_s / 1.875;
            let from_rad = if rng.bool() {
                0.0
            } else {
                uniform(rng, -1.0, 1.0)
            };
            let strokes = Strokes {
                from_rad,
                to_rad: from_rad + sign(rng) * span_rad,
                peak_speed_rad_s: speed_rad_s,
                pause_s: if rng.bool() {
                    0.0
                } else {
                    rng.f64() * stroke_s
                },
            };
            // The span may be below the rounding of the start angle.
            let exact_s = strokes.stroke_s();
            if !(exact_s > 0.5 * stroke_s && exact_s < 2.0 * stroke_s) {
                return None;
            }
            let duration_s = match rng.u32(0..10) {
                0 => 2.0 * (exact_s + strokes.pause_s),
                1 => exact_s,
                _ => duration_s,
            };
            (Motion::Strokes(strokes), duration_s)
        }
        MotionKind::Recording => recorded::draw(rng, scale)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_is_a_function_of_its_number() {
        for n in [0, 1, 77, 9_999] {
            let (a, b) = (Case::new(n), Case::new(n));
            assert_eq!(a.settings, b.settings);
            assert_eq!(a.motion, b.motion);
            assert_eq!(a.duration_s.to_bits(), b.duration_s.to_bits());
        }
        assert_ne!(Case::new(1).settings, Case::new(2).settings);
    }

    #[test]
    fn everything_that_is_promised_is_drawn() {
        let cases: Vec<Case> = (0..2000).map(Case::new).collect();
        let share = |is: &dyn Fn(&Case) -> bool| cases.iter().filter(|c| is(c)).count();
        for kind in MotionKind::ALL {
            for convention in Convention::ALL {
                assert!(share(&|c| c.kind == kind && c.settings.convention == convention) > 60);
            }
        }
        let p = |c: &Case| c.settings.parameters;
        assert!(share(&|c| p(c).kinetic_torque_nm == 0.0) > 150);
        assert!(share(&|c| p(c).kinetic_torque_nm == p(c).static_torque_nm) > 100);
        assert!(share(&|c| p(c).damping_nms_per_rad > 0.0) > 500);
        assert!(share(&|c| c.settings.restart == crepitus_model::Restart::FromKinetic) > 200);
        assert!(share(&|c| p(c).inertia_kg_m2 < 1e-7 || p(c).inertia_kg_m2 > 10.0) > 80);
        let ends_with_motion = |c: &Case| match &c.motion {
            Motion::Sequence(pieces) => pieces
                .iter()
                .any(|p| p.start_s == c.duration_s || p.end_s == c.duration_s),
            _ => false,
        };
        assert!(share(&ends_with_motion) > 200);
        assert!(
            cases
                .iter()
                .all(|c| c.duration_s.is_finite() && c.duration_s > 0.0)
        );
    }
}
