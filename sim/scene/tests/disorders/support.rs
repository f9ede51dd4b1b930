//! Symptoms and motions in the units of scene files.

use crepitus_plant::Motion;
use crepitus_plant::motion::VelocityKnot;
use crepitus_plant::piece::Curve;
use crepitus_scene::reference::symptoms::{Keys, Symptom, SymptomEvent, Word};

/// Tolerances within which the reference agrees with closed forms, s and N·m.
pub(crate) const TIME_S: f64 = 1e-9;
pub(crate) const TORQUE_NM: f64 = 1e-9;

/// Numbers and choices by key.
#[derive(Clone, Debug, Default)]
pub(crate) struct Given {
    pub(crate) numbers: Vec<(String, f64)>,
    pub(crate) choices: Vec<(String, String)>,
}

impl Keys for Given {
    fn number(&self, key: &str) -> Option<f64> {
        let found = self.numbers.iter().find(|(k, _)| k == key);
        found.map(|(_, number)| *number)
    }

    fn choice(&self, key: &str) -> Option<&str> {
        let found = self.choices.iter().find(|(k, _)| k == key);
        found.map(|(_, name)| name.as_str())
    }
}

/// Numbers, and choices, by key.
pub(crate) fn given(numbers: &[(&str, f64)], choices: &[(&str, &str)]) -> Given {
    Given {
        numbers: numbers.iter().map(|(k, x)| ((*k).to_owned(), *x)).collect(),
        choices: choices
            .iter()
            .map(|(k, name)| ((*k).to_owned(), (*name).to_owned()))
            .collect(),
    }
}

/// Knots as (time, deg/s just before, deg/s just after).
pub(crate) fn jumps(from_deg: f64, knots: &[(f64, f64, f64)]) -> Motion {
    let knots: Vec<_> = knots
        .iter()
        .map(|&(time_s, left, right)| VelocityKnot {
            time_s,
            omega_left_rad_s: left.to_radians(),
            omega_right_rad_s: right.to_radians(),
        })
        .collect();
    let Motion::Sequence(mut pieces) = Motion::velocity_knots(&knots) else {
        panic!("knots are a sequence of pieces");
    };
    for piece in &mut pieces {
        if let Curve::Polynomial(c) = &mut piece.curve {
            c[0] += from_deg.to_radians();
        }
    }
    Motion::Sequence(pieces)
}

/// Knots as (time, deg/s).
pub(crate) fn knots(from_deg: f64, knots: &[(f64, f64)]) -> Motion {
    let knots: Vec<_> = knots.iter().map(|&(t, v)| (t, v, v)).collect();
    jumps(from_deg, &knots)
}

pub(crate) fn constant(from_deg: f64, deg_s: f64) -> Motion {
    Motion::constant_from(from_deg.to_radians(), deg_s.to_radians())
}

pub(crate) fn symptom<'a>(name: &str, given: &Given, motion: &'a Motion) -> Symptom<'a> {
    Symptom::new(name, given, motion).expect("a valid symptom")
}

/// All events up to `end_s`.
pub(crate) fn events(name: &str, given: &Given, motion: &Motion, end_s: f64) -> Vec<SymptomEvent> {
    symptom(name, given, motion).advance(end_s)
}

/// The torque at one time, N·m.
pub(crate) fn torque_at(name: &str, given: &Given, motion: &Motion, time_s: f64) -> f64 {
    let mut symptom = symptom(name, given, motion);
    symptom.advance(time_s);
    symptom.torque_nm()
}

/// The words of events.
pub(crate) fn words(events: &[SymptomEvent]) -> Vec<&'static str> {
    events.iter().map(|e| e.kind.name()).collect()
}

/// The times of the events of a kind, s.
pub(crate) fn times(events: &[SymptomEvent], kind: Word) -> Vec<f64> {
    let own = events.iter().filter(|e| e.kind == kind);
    own.map(|e| e.time_s).collect()
}

/// Asserts that two numbers agree.
#[track_caller]
pub(crate) fn near(found: f64, expected: f64, within: f64) {
    let error = (found - expected).abs();
    assert!(error <= within, "{found} for {expected}: {error:e}");
}

/// ∫T dφ over a motion at constant speeds between the given times, by Simpson's
/// rule on parts between which the torque is smooth.
pub(crate) fn work_j(name: &str, keys: &Given, motion: &Motion, marks: &[f64]) -> f64 {
    const PARTS: u32 = 200;
    let mut symptom = symptom(name, keys, motion);
    let mut work = 0.0;
    for span in marks.windows(2) {
        let (from_s, to_s) = (span[0], span[1]);
        let step_s = (to_s - from_s) / f64::from(2 * PARTS);
        // Just inside the span, so that a jump at its ends is not seen.
        let inside_s = 1e-12 * (to_s - from_s);
        for i in 0..=2 * PARTS {
            let time_s = (from_s + step_s * f64::from(i)).clamp(from_s + inside_s, to_s - inside_s);
            symptom.advance(time_s);
            let weight = match i {
                0 => 1.0,
                i if i == 2 * PARTS => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let omega = motion.at(time_s).omega_rad_s;
            work += weight * step_s / 3.0 * symptom.torque_nm() * omega;
        }
    }
    work
}
