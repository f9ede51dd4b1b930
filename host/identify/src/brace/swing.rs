//! Detection of the free swings in a recording.
//!
//! ```text
//!  held   ╲    ╱‾╲          at rest
//! ‾‾‾‾‾‾‾‾╎╲  ╱   ╲  ╱‾╲___________
//!         ╎ ╲╱     ╲╱     ╎
//!         ╎ ▲ from here   ╎ to here
//! ```
//!
//! A swing begins where the weight first passes through after its release, when nobody
//! touches it any more and the gear's teeth are surely in contact, and ends at rest. The
//! release is the turning point that is farthest from rest.

use crate::brace::passing::{Passing, passes};
use crate::brace::recording::Recording;
use crate::brace::refusal::Refusal;
use crate::brace::whole::whole;
use crepitus_plant::Extremes;
use crepitus_plant::swing::STEP_S;

/// Shortest rest, s: longer than a weight needs to cross the gap.
const REST_S: f64 = 0.35;

/// Largest motion in a rest, rad.
const STILL_RAD: f64 = 2e-3;

/// Smallest reversal that makes a turning point, rad.
const TURN_RAD: f64 = 4e-3;

/// Smallest amplitude of a swing, rad.
const AMPLITUDE_RAD: f64 = 0.1;

/// Rest that is kept at the end of a swing, s.
const TAIL_S: f64 = 0.05;

/// A free swing, step by step.
#[derive(Clone, Debug)]
pub(crate) struct Swing {
    /// Index of the recording.
    pub(crate) recording: usize,
    /// Time of the first angle in the recording, s.
    pub(crate) begins_s: f64,
    /// Angle of the rotor as each step begins, and as the last one ends, rad; NaN where no
    /// sample is.
    pub(crate) angles_rad: Vec<f64>,
    /// Nominal torque of the motor in each step, N·m, from its current.
    pub(crate) torques_nm: Vec<f64>,
    /// Initial velocity, rad/s.
    pub(crate) omega_rad_s: f64,
    /// Angles of the turning points, rad.
    pub(crate) turns_rad: Vec<f64>,
    /// Steps at the turning points.
    pub(crate) turn_steps: Vec<usize>,
}

impl Swing {
    /// Returns the RMS torque of the motor during the swing, N·m.
    pub(crate) fn torque_rms_nm(&self) -> f64 {
        let squares: f64 = self.torques_nm.iter().map(|t| t * t).sum();
        (squares / self.torques_nm.len().max(1) as f64).sqrt()
    }
}

/// A recording by integration steps: angle at the start of each, rad, and mean torque, N·m.
struct Steps {
    angles: Vec<f64>,
    torques: Vec<f64>,
}

/// Returns the free swings of a recording.
pub(crate) fn swings(
    place: usize,
    recording: &Recording,
    passing: Passing,
) -> Result<Vec<Swing>, Refusal> {
    let steps = Steps::of(recording)?;
    let filled = filled(&steps.angles);
    let extent = extent(&filled);
    if extent < AMPLITUDE_RAD {
        return Err(Refusal::NoMotion {
            degrees: extent.to_degrees(),
            expected: AMPLITUDE_RAD.to_degrees(),
        });
    }
    let mut found = Vec::new();
    let mut most_turns = 0;
    let (motions, goes_on) = motions(&filled);
    for (from, to) in motions {
        let turns = turns(&filled, from, to);
        most_turns = most_turns.max(turns.len());
        found.extend(steps.swing((place, passing), &filled, (from, to), &turns));
    }
    if found.is_empty() {
        let duration_s = filled.len() as f64 * STEP_S;
        return Err(if goes_on {
            Refusal::NotToRest
        } else if most_turns < 2 {
            Refusal::NoReversal { duration_s }
        } else {
            Refusal::NoSwing {
                amplitude: AMPLITUDE_RAD.to_degrees(),
            }
        });
    }
    Ok(found)
}

impl Steps {
    fn of(recording: &Recording) -> Result<Self, Refusal> {
        let samples = &recording.samples;
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
            return Err(Refusal::Short { duration_s: 0.0 });
        };
        whole(recording, first, last)?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small positive number"
        )]
        let ticks = (STEP_S / recording.tick_s).round().max(1.0) as u64;
        #[expect(clippy::cast_possible_truncation, reason = "steps of a recording")]
        let count = ((last.tick - first.tick) / ticks) as usize;
        let mut angles = vec![f64::NAN; count + 1];
        let mut sums = vec![(0.0, 0.0); count + 1];
        for sample in samples {
            let since = sample.tick - first.tick;
            #[expect(clippy::cast_possible_truncation, reason = "steps of a recording")]
            let step = (since / ticks) as usize;
            // Half a count: the encoder counts the edges below.
            if since.is_multiple_of(ticks) && !sample.is_lost {
                let count = sample.count.wrapping_sub(first.count);
                angles[step] = (f64::from(count) + 0.5) * recording.rad_per_count;
            }
            if let Some(amperes) = sample.current_a {
                sums[step].0 += f64::from(amperes) * recording.nm_per_a();
            }
            sums[step].1 += 1.0;
        }
        let torques = sums
            .iter()
            .map(|(sum, n)| if *n > 0.0 { sum / n } else { 0.0 });
        Ok(Self {
            torques: torques.collect(),
            angles,
        })
    }

    /// Returns the free swing in a motion, if it has one.
    fn swing(
        &self,
        (recording, passing): (usize, Passing),
        filled: &[f64],
        (from, to): (usize, usize),
        turns: &[usize],
    ) -> Option<Swing> {
        let rest = *filled.get(to)?;
        let amplitude = |step: usize| (filled[step] - rest).abs();
        // The release is a turning point, or where the motion begins.
        let released = std::iter::once(from)
            .chain(turns.iter().copied())
            .max_by(|a, b| amplitude(*a).total_cmp(&amplitude(*b)))?;
        let turns: Vec<usize> = turns.iter().copied().filter(|t| *t > released).collect();
        let [first, _, ..] = turns.as_slice() else {
            return None;
        };
        if amplitude(released) < AMPLITUDE_RAD {
            return None;
        }
        let (begin, omega) = passes(passing, filled, released, *first)?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small positive number"
        )]
        let end = (to + (TAIL_S / STEP_S) as usize).min(filled.len() - 1);
        Some(Swing {
            recording,
            begins_s: begin as f64 * STEP_S,
            angles_rad: self.angles[begin..=end].to_vec(),
            torques_nm: self.torques[begin..end].to_vec(),
            omega_rad_s: omega,
            turns_rad: turns.iter().map(|t| filled[*t]).collect(),
            turn_steps: turns.iter().map(|t| t - begin).collect(),
        })
    }
}

/// Fills missing angles with the last one.
fn filled(angles: &[f64]) -> Vec<f64> {
    let mut last = angles.iter().copied().find(|a| !a.is_nan()).unwrap_or(0.0);
    angles
        .iter()
        .map(|angle| {
            if !angle.is_nan() {
                last = *angle;
            }
            last
        })
        .collect()
}

fn extent(angles: &[f64]) -> f64 {
    angles.iter().copied().collect::<Extremes<f64>>().width()
}

/// Returns first and last step of each motion between two rests, and whether the recording ends in
/// motion.
fn motions(angles: &[f64]) -> (Vec<(usize, usize)>, bool) {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a small positive number"
    )]
    let rest = (REST_S / STEP_S) as usize;
    let mut found = Vec::new();
    let mut begun: Option<usize> = None;
    let mut at = 0;
    while at + rest < angles.len() {
        let window = &angles[at..=at + rest];
        let is_still = extent(window) < STILL_RAD;
        match (is_still, begun) {
            (false, None) => begun = Some(at),
            (true, Some(from)) => {
                found.push((from, at));
                begun = None;
            }
            _ => {}
        }
        at += 5;
    }
    (found, begun.is_some())
}

/// Returns the steps of the turning points between two steps.
fn turns(angles: &[f64], from: usize, to: usize) -> Vec<usize> {
    let mut found = Vec::new();
    let (mut low, mut high) = (from, from);
    let mut sense = 0.0;
    for step in from..=to {
        if angles[step] > angles[high] {
            high = step;
        }
        if angles[step] < angles[low] {
            low = step;
        }
        if sense >= 0.0 && angles[high] - angles[step] > TURN_RAD {
            if sense > 0.0 {
                found.push(high);
            }
            (sense, low) = (-1.0, step);
        } else if sense <= 0.0 && angles[step] - angles[low] > TURN_RAD {
            if sense < 0.0 {
                found.push(low);
            }
            (sense, high) = (1.0, step);
        }
    }
    found
}
