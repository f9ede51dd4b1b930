//! The tank of symptoms that give energy, empty.

use super::symptom_tools::{renders_symptoms, times, torque, trial, under};
use crate::stability::case::{Case, located};
use crate::stability::criterion::Criterion;
use crate::stability::input::SymptomRun;
use crate::stability::subject::Rung;
use crate::symptoms::{Given, Hand};
use crepitus_model::render::effects::symptom::Word;
use crepitus_model::render::effects::{TANK_J, TANK_REFILL_W};

/// A stretch beyond the hold, then back so slowly that the muscle beats on for three seconds and a half.
fn slow_return() -> Hand {
    Hand::Knots {
        from_deg: 20.0,
        knots: vec![(0.0, 0.0, 220.0), (0.5, 220.0, -20.0), (4.0, -20.0, -20.0)],
    }
}

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[Case {
    id: "H88",
    name: "tank-empty",
    title: "A hand that goes back slowly with the beats of a strong clonus",
    hard: "Each beat of 4.5 N·m gives energy to the hand, ten times what the tank refills with. The rhythm goes on; what is shown fades \
               with the level of the tank, without a jump, to what the refill pays for. An account that lets the level \
               fall below zero silences the muscle for seconds, one that forgets a tick pays on.",
    source: "docs/symptoms.md, Sum, tank and limits",
    long: false,
    must: located,
    trials: |subject| {
        if !renders_symptoms(subject) || subject.solver == Rung::Reference {
            return Vec::new();
        }
        let clonus = Given::new("clonus", &[("amplitude_nm", 4.5)], &[]);
        (0..=2)
            .map(|delay_ticks| {
                let run = SymptomRun {
                    delay_ticks,
                    ..under(&clonus, slow_return(), 3.8)
                };
                trial(
                    run,
                    [
                        times(Word::Start, 1),
                        Criterion::WordCount {
                            word: Word::Beat,
                            least: 18,
                            most: 22,
                        },
                        torque(2.0, 0.0, 1.0, 0.0),
                        Criterion::TorqueStep { most_nm: 0.1 },
                        Criterion::NetReturned {
                            most_j: TANK_J + 2.0 * TANK_REFILL_W,
                        },
                    ],
                )
            })
            .collect()
    },
}];
