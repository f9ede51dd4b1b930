//! The `[motion]` table.

use super::data_file::DataFile;
use super::plausible_angles::{ANY_DEG, ANY_RAD};
use super::recorded_motion::recording;
use crate::document::{Range, Section};
use crate::error::SceneError;
use crepitus_plant::Motion;
use crepitus_plant::motion::{Strokes, VelocityKnot};

crepitus_model::named! {
    /// The kinds of motion.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum MotionKind {
        /// One velocity.
        Constant => "constant",
        /// A sine of the angle.
        Sine => "sine",
        /// A piecewise linear velocity.
        VelocityKnots => "velocity-knots",
        /// Minimum-jerk strokes there and back.
        Strokes => "strokes",
        /// A recording.
        Recording => "recording",
        /// A released leg.
        Released => "released",
    }
}

/// A motion as read.
pub(super) struct ReadMotion {
    pub(super) kind: MotionKind,
    pub(super) motion: Motion,
    pub(super) seed: Option<u64>,
    pub(super) warnings: Vec<String>,
    /// Largest change of Ω̇ between samples of a recording, rad/s².
    pub(super) ripple_rad_s2: Option<f64>,
    /// The recording.
    pub(super) data: Option<DataFile>,
}

pub(super) fn read(section: &Section<'_>, duration_s: f64) -> Result<ReadMotion, SceneError> {
    let kind = section.choice("kind", &MotionKind::ALL.map(|k| (k.name(), k)))?;
    let mut warnings = Vec::new();
    let (mut ripple_rad_s2, mut data) = (None, None);
    let motion = match kind {
        MotionKind::Constant => {
            let velocity_rad_s = section.number("velocity_rad_s", ANY_RAD)?;
            let from_deg = section.number_or("from_deg", ANY_DEG, 0.0)?;
            Motion::constant_from(from_deg.to_radians(), velocity_rad_s)
        }
        MotionKind::Sine => sine(section)?,
        MotionKind::VelocityKnots => velocity_knots(section)?,
        MotionKind::Strokes => strokes(section)?,
        MotionKind::Recording => {
            let (motion, ripple, file) = recording(section, duration_s, &mut warnings)?;
            (ripple_rad_s2, data) = (Some(ripple), file);
            motion
        }
        MotionKind::Released => Motion::rest(section.number("from_deg", ANY_DEG)?.to_radians()),
    };
    let seed = seed(section)?;
    section.finish()?;
    Ok(ReadMotion {
        kind,
        motion,
        seed,
        warnings,
        ripple_rad_s2,
        data,
    })
}

/// A whole number that f64 holds exactly.
fn seed(section: &Section<'_>) -> Result<Option<u64>, SceneError> {
    /// 2^53: above it, neighbouring seeds would be the same number.
    const LARGEST: f64 = 9_007_199_254_740_992.0;
    match section.optional_number("seed", Range::closed(0.0, LARGEST))? {
        None => Ok(None),
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole and in range"
        )]
        Some(x) if x.fract() == 0.0 => Ok(Some(x as u64)),
        Some(x) => Err(section.key_error("seed", format!("{x} is not a whole number"))),
    }
}

/// Range of a stroke's duration, s.
const STROKE_S: std::ops::RangeInclusive<f64> = 1e-3..=1e7;

/// The slowest sine, Hz, of a period as long as the longest stroke.
const LEAST_HZ: f64 = 1e-7;

/// The shortest time between two knots, s: within less an acceleration is no
/// number any more.
const LEAST_KNOT_S: f64 = 1e-9;

fn sine(section: &Section<'_>) -> Result<Motion, SceneError> {
    let rad = section.optional_number("amplitude_rad", ANY_RAD)?;
    let deg = section.optional_number("amplitude_deg", ANY_DEG)?;
    let amplitude_rad = match (rad, deg) {
        (Some(rad), None) => rad,
        (None, Some(deg)) => deg.to_radians(),
        (Some(_), Some(_)) => {
            return Err(section.key_error(
                "amplitude_deg",
                "give amplitude_rad or amplitude_deg, not both",
            ));
        }
        (None, None) => {
            return Err(section.error("a sine needs amplitude_deg or amplitude_rad"));
        }
    };
    let frequency_hz = section.number("frequency_hz", Range::closed(LEAST_HZ, 1e4))?;
    let phase_deg = section.number_or("phase_deg", Range::closed(-360.0, 360.0), 0.0)?;
    let from_deg = section.number_or("from_deg", ANY_DEG, 0.0)?;
    Ok(Motion::sine(amplitude_rad, frequency_hz, phase_deg).shifted(from_deg.to_radians()))
}

fn velocity_knots(section: &Section<'_>) -> Result<Motion, SceneError> {
    let items = section.sections("knots")?;
    let mut knots: Vec<VelocityKnot> = Vec::with_capacity(items.len());
    for item in &items {
        let time_s = item.number("t_s", Range::closed(0.0, 1e7))?;
        let one = item.optional_number("omega_rad_s", ANY_RAD)?;
        let left = item.optional_number("omega_left_rad_s", ANY_RAD)?;
        let right = item.optional_number("omega_right_rad_s", ANY_RAD)?;
        let (omega_left_rad_s, omega_right_rad_s) = match (one, left, right) {
            (Some(omega), None, None) => (omega, omega),
            (None, Some(left), Some(right)) => (left, right),
            _ => {
                return Err(item.error(
                    "a knot has omega_rad_s, or omega_left_rad_s and omega_right_rad_s where the velocity jumps",
                ));
            }
        };
        item.finish()?;
        match knots.last() {
            None if time_s != 0.0 => {
                return Err(item.key_error("t_s", "the first knot must be at t_s = 0"));
            }
            Some(before) if time_s - before.time_s < LEAST_KNOT_S => {
                return Err(item.key_error(
                    "t_s",
                    format!(
                        "{time_s} is not after the knot before it, at {}, by at least {LEAST_KNOT_S:e} s",
                        before.time_s
                    ),
                ));
            }
            _ => {}
        }
        knots.push(VelocityKnot {
            time_s,
            omega_left_rad_s,
            omega_right_rad_s,
        });
    }
    if knots.is_empty() {
        return Err(section.key_error("knots", "at least one knot is needed, at t_s = 0"));
    }
    let from_deg = section.number_or("from_deg", ANY_DEG, 0.0)?;
    Ok(Motion::velocity_knots(&knots).shifted(from_deg.to_radians()))
}

fn strokes(section: &Section<'_>) -> Result<Motion, SceneError> {
    let from_deg = section.number("from_deg", ANY_DEG)?;
    let to_deg = section.number("to_deg", ANY_DEG)?;
    if from_deg == to_deg {
        return Err(section.key_error("to_deg", "a stroke needs two different angles"));
    }
    let peak_deg_s = section.number("peak_speed_deg_s", Range::above(0.0, 1e6))?;
    let pause_s = section.number("pause_s", Range::closed(0.0, 1e6))?;
    let strokes = Strokes {
        from_rad: from_deg.to_radians(),
        to_rad: to_deg.to_radians(),
        peak_speed_rad_s: peak_deg_s.to_radians(),
        pause_s,
    };
    let stroke_s = strokes.stroke_s();
    if !STROKE_S.contains(&stroke_s) {
        return Err(section.key_error(
            "peak_speed_deg_s",
            format!(
                "a stroke would take {stroke_s:e} s: between {:e} and {:e} s are allowed",
                STROKE_S.start(),
                STROKE_S.end()
            ),
        ));
    }
    Ok(Motion::Strokes(strokes))
}
