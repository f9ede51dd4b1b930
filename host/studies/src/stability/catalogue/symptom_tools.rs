//! Helpers shared by the cases of symptoms besides crepitus.

use super::tools::{CASE, TICK_S, is_frozen};
use crate::stability::case::Case;
use crate::stability::criteria::{symptom_events, symptom_torques, word_count, words};
use crate::stability::criterion::{Criterion, Limits};
use crate::stability::input::{Input, SymptomRun, What};
use crate::stability::subject::{Rung, Subject};
use crate::symptoms::{Given, Hand};
use crepitus_model::render::effects::symptom::Word;
use crepitus_model::solver::Solver;

/// Limits that the laws promise where the motion is a parabola in every tick: events.
pub(super) const ON_TIME: Limits = Limits(1e-9, 1e-6);

/// Limits that the laws promise where the motion is a parabola in every tick: torque at the ends of ticks.
const SAME_TORQUE: Limits = Limits(5e-6, 5e-5);

/// A case of what the firmware has, and of the reference of symptoms.
pub(super) const SYMPTOM: Case = Case {
    of: renders_symptoms,
    ..CASE
};

/// A case of what the firmware has.
pub(super) const DEVICE: Case = Case {
    of: |subject| renders_symptoms(subject) && subject.solver != Rung::Reference,
    ..CASE
};

/// Returns whether a subject renders symptoms: it is what the firmware has, or their reference. Symptoms
/// have no convention, which is of slips.
pub(super) fn renders_symptoms(subject: Subject) -> bool {
    let is_either = matches!(
        subject.solver,
        Rung::Reference | Rung::Ladder(Solver::ExactEvents)
    );
    is_frozen(subject) && is_either
}

/// A symptom at its defaults.
pub(super) fn plain(effect: &'static str) -> Given {
    Given::new(effect, &[], &[])
}

/// A hand at one velocity.
pub(super) fn steady(from_deg: f64, deg_s: f64) -> Hand {
    Hand::Constant { from_deg, deg_s }
}

/// A hand at one velocity, deg/s, to an angle, about which it then trembles by this amplitude,
/// deg, and frequency, Hz.
pub(super) fn tremble(
    (from_deg, deg_s): (f64, f64),
    at_deg: f64,
    (by_deg, frequency_hz): (f64, f64),
) -> Hand {
    Hand::Tremble {
        from_deg,
        deg_s,
        at_deg,
        by_deg,
        frequency_hz,
    }
}

/// A hand that wanders about an angle at velocities up to this.
pub(super) fn wander(about_deg: f64, deg_s: f64, seed: u64) -> Hand {
    Hand::Wander {
        about_deg,
        deg_s,
        seed,
    }
}

/// One symptom under a hand, on the true motion.
pub(super) fn armed(given: &Given, hand: Hand) -> SymptomRun {
    SymptomRun {
        symptoms: vec![given.clone()],
        hand,
        counts: false,
        commits: Vec::new(),
        delay_ticks: 0,
        delay_varies: false,
    }
}

/// A run at the device's tick.
pub(super) fn lasting(run: SymptomRun, duration_s: f64) -> Input {
    Input::new(What::Symptoms(run), duration_s, TICK_S)
}

/// One symptom under a hand, on the true motion.
pub(super) fn under(given: &Given, hand: Hand, duration_s: f64) -> Input {
    lasting(armed(given, hand), duration_s)
}

/// One symptom under a hand, through the encoder.
pub(super) fn in_counts(given: &Given, hand: Hand, duration_s: f64) -> Input {
    let run = SymptomRun {
        counts: true,
        ..armed(given, hand)
    };
    lasting(run, duration_s)
}

/// Events and torque of the reference.
pub(super) fn as_the_reference() -> [Criterion; 2] {
    [symptom_events(ON_TIME), symptom_torques(SAME_TORQUE)]
}

/// The events of the reference, which are these, and its torque.
pub(super) fn exactly(all: &'static [Word]) -> [Criterion; 3] {
    let [events, torques] = as_the_reference();
    [events, torques, words(all)]
}

/// Exactly `count` events of this kind.
pub(super) fn times(word: Word, count: u64) -> Criterion {
    word_count(word, count, count)
}
