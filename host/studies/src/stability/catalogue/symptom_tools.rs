//! Helpers shared by the cases of symptoms besides crepitus.

use super::tools::TICK_S;
use crate::stability::case::Trial;
use crate::stability::criterion::{Criterion, Limits};
use crate::stability::input::{Input, Lost, SymptomRun};
use crate::stability::subject::{Rung, Subject};
use crate::symptoms::{Given, Hand};
use crepitus_model::render::effects::symptom::Word;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Settings};

/// Limits that the laws promise where the motion is a parabola in every tick: events.
pub(super) const ON_TIME: Limits = Limits {
    f64: 1e-9,
    f32: 1e-6,
};

/// Limits that the laws promise where the motion is a parabola in every tick: torque at the ends of ticks.
pub(super) const SAME_TORQUE: Limits = Limits {
    f64: 5e-6,
    f32: 5e-5,
};

/// Returns whether a subject renders symptoms: it is what the firmware has, or their reference. Symptoms
/// have no convention, which is of slips.
pub(super) fn renders_symptoms(subject: Subject) -> bool {
    let is_either = matches!(
        subject.solver,
        Rung::Reference | Rung::Ladder(Solver::ExactEvents)
    );
    subject.convention == Convention::Frozen && is_either
}

/// One symptom under a hand, on the true motion at the device's tick.
pub(super) fn under(given: &Given, hand: Hand, duration_s: f64) -> SymptomRun {
    SymptomRun {
        symptoms: vec![given.clone()],
        hand,
        counts: false,
        commits: Vec::new(),
        lost: Lost::NONE,
        delay_ticks: 0,
        delay_varies: false,
        duration_s,
        step_s: TICK_S,
    }
}

/// This run through the encoder.
pub(super) fn seen_in_counts(run: SymptomRun) -> SymptomRun {
    SymptomRun {
        counts: true,
        ..run
    }
}

/// A trial.
pub(super) fn trial<const N: usize>(run: SymptomRun, criteria: [Criterion; N]) -> Trial {
    Trial {
        settings: Settings::default(),
        input: Input::Symptoms(run),
        criteria: Vec::from(criteria),
    }
}

/// Events and torque of the reference.
pub(super) fn as_the_reference() -> [Criterion; 2] {
    [
        Criterion::SymptomEvents { within_s: ON_TIME },
        Criterion::SymptomTorques {
            within_nm: SAME_TORQUE,
        },
    ]
}

/// The events of the reference, which are these, and its torque.
pub(super) fn exactly(words: &'static [Word]) -> [Criterion; 3] {
    let [events, torques] = as_the_reference();
    [events, torques, Criterion::Words(words)]
}

/// Criterion of exactly `count` events of this kind.
pub(super) fn times(word: Word, count: u64) -> Criterion {
    Criterion::WordCount {
        word,
        least: count,
        most: count,
    }
}

/// A torque in a band from a time on, N·m.
pub(super) fn torque(from_s: f64, low_nm: f64, high_nm: f64, slack_nm: f64) -> Criterion {
    Criterion::TorqueWithin {
        from_s,
        low_nm,
        high_nm,
        slack_nm,
    }
}
