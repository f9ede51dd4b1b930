//! Motions of a hand under which events are timed.
//!
//! At a constant speed every cycle is like the one before, and a solver that knows it multiplies.
//! Under a hand each event has to be searched for.

use crepitus_plant::Motion;
use crepitus_plant::motion::Strokes;
use crepitus_plant::piece::Piece;
use crepitus_plant::recording::{self, AngleUnit, Angles, Quantity, Samples, Source};
use crepitus_scene::preset::Joint;
use std::cell::Cell;
use std::f64::consts::TAU;
use std::path::Path;
use std::rc::Rc;

/// Low-pass of a recorded knee, Hz: what a scene uses if it does not say.
const CUTOFF_HZ: f64 = 6.0;

/// A hand that moves the shaft of a joint.
#[derive(Clone)]
pub struct Hand {
    /// The joint.
    pub joint: Joint,
    /// Name on the command line.
    pub name: &'static str,
    /// Description and source of the motion.
    pub source: String,
    /// The motion.
    pub motion: Rc<Motion>,
    /// Duration, s.
    pub duration_s: f64,
    /// Time in which the hand may turn back, s.
    pub turn_s: f64,
    /// Errors of an event that may be asked for, s; the next one where none reaches the one before.
    pub event_limits_s: &'static [f64],
}

impl Hand {
    /// Joint and motion.
    pub fn name(&self) -> String {
        format!("{}, {}", self.joint.name, self.name)
    }
}

/// Name of the knee pass.
pub const HAND_SINE: &str = "hand-sine";
/// Name of the recorded knee.
pub const RECORDED_KNEE: &str = "recorded-knee";
/// Name of the passive examination.
pub const STROKES: &str = "strokes";

/// The knee pass of `scenes/knee-pass-*.toml`: 45° at 0.25 Hz, from full extension.
pub fn hand_sine(joint: Joint) -> Hand {
    Hand {
        joint,
        name: HAND_SINE,
        source: "45° at 0.25 Hz for 10 s".into(),
        motion: Rc::new(Motion::sine(45f64.to_radians(), 0.25, -90.0)),
        duration_s: 10.0,
        turn_s: 0.25,
        event_limits_s: &[1e-9],
    }
}

/// Minimum-jerk strokes of 60° there and back with a peak of 60°/s, as in the accuracy study.
pub fn strokes(joint: Joint) -> Hand {
    let full_rad = 60_f64.to_radians();
    Hand {
        joint,
        name: STROKES,
        source: "minimum-jerk, 60° with a peak of 60°/s, pauses of 0.1 s, for 10 s".into(),
        motion: Rc::new(Motion::Strokes(Strokes {
            from_rad: 0.0,
            to_rad: full_rad,
            peak_speed_rad_s: full_rad,
            pause_s: 0.1,
        })),
        duration_s: 10.0,
        turn_s: 0.1,
        event_limits_s: &[1e-9],
    }
}

/// A walk: the recording beside the repository, or a synthetic one where that is missing.
///
/// # Errors
/// Error message of a recording that cannot be read.
pub fn recorded_knee(joint: Joint) -> Result<Hand, String> {
    const FILE: &str = "opensim_walk_100hz.csv";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let path = path.join(FILE);
    let (samples, source) = if path.exists() {
        let samples = recording::read(&Source::new(
            &path,
            "time_s",
            "knee_flexion_deg",
            Quantity::Angles(Angles::of(Some(AngleUnit::Deg))),
        ));
        (samples.map_err(|e| e.to_string())?, format!("{FILE}, "))
    } else {
        (synthetic_walk(), "synthetic (no recording found), ".into())
    };
    let segments = recording::smooth(&samples, CUTOFF_HZ).map_err(|e| e.to_string())?;
    let duration_s = samples.duration_s();
    Ok(Hand {
        joint,
        name: RECORDED_KNEE,
        source: format!("{source}{duration_s:.2} s below {CUTOFF_HZ} Hz"),
        motion: Rc::new(Motion::recording(&segments)),
        duration_s,
        turn_s: 1.0 / (16.0 * CUTOFF_HZ),
        event_limits_s: &[1e-9, 1e-7],
    })
}

/// Two strides in 2.4 s from a few harmonics, sampled at 100 Hz.
fn synthetic_walk() -> Samples {
    // Amplitude, deg, and phase, turns, of each harmonic of the stride.
    const HARMONICS: [(f64, f64); 4] = [(18.0, 0.62), (13.0, 0.15), (3.5, 0.60), (1.0, 0.20)];
    let time_s: Vec<f64> = (0..=240).map(|n| f64::from(n) * 0.01).collect();
    let angle = |t: f64| {
        let mut turns = 0.0;
        let swing: f64 = HARMONICS
            .iter()
            .map(|(amplitude, phase)| {
                turns += t / 1.2;
                amplitude * (TAU * (turns + phase)).sin()
            })
            .sum();
        (27.0 + swing).to_radians()
    };
    Samples {
        angle_rad: time_s.iter().map(|&t| angle(t)).collect(),
        time_s,
        ..Samples::default()
    }
}

/// Pieces of a motion for an integrator: a cursor remembers the piece it was asked for last.
#[derive(Clone)]
pub struct Cursor {
    pieces: Rc<[Piece]>,
    at: Cell<usize>,
}

impl Cursor {
    /// Begins with the first of the pieces up to the end of a run.
    pub fn new(motion: &Motion, duration_s: f64) -> Self {
        let after = |last: &Piece| (last.end_s <= duration_s).then(|| motion.piece(last.end_s));
        Self {
            pieces: std::iter::successors(Some(motion.piece(0.0)), after).collect(),
            at: Cell::new(0),
        }
    }

    /// The piece at a time, s: near the last one, so it is found in a step or two.
    #[inline]
    pub fn piece(&self, time_s: f64) -> &Piece {
        let mut at = self.at.get();
        while at > 0 && time_s < self.pieces[at].start_s {
            at -= 1;
        }
        while at + 1 < self.pieces.len() && time_s >= self.pieces[at].end_s {
            at += 1;
        }
        self.at.set(at);
        &self.pieces[at]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_scene::preset::joints;

    #[test]
    fn a_cursor_gives_what_the_motion_gives_forth_and_back() {
        let segments = recording::smooth(&synthetic_walk(), CUTOFF_HZ).unwrap();
        let strokes = strokes(joints()[0]);
        for motion in [&Motion::recording(&segments), &*strokes.motion] {
            let cursor = Cursor::new(motion, 2.4);
            for n in (0..=2400).chain((0..2400).rev().step_by(7)) {
                let time_s = f64::from(n) * 1e-3;
                let found = cursor.piece(time_s).at(time_s);
                assert_eq!(found, motion.at(time_s), "{time_s}");
            }
        }
    }

    #[test]
    fn the_synthetic_walk_is_one_that_a_knee_can_do() {
        let samples = synthetic_walk();
        let deg = samples.angle_rad.iter().map(|a| a.to_degrees());
        let (least, most) = deg.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
        assert!(
            least > -10.0 && (50.0..75.0).contains(&most),
            "{least} {most}"
        );
    }
}
