//! The tank of symptoms that give energy, empty.

use super::symptom_energy::PAID_J;
use super::symptom_tools::{DEVICE, armed, lasting, times};
use crate::stability::case::Case;
use crate::stability::criteria::{net_returned, torque, torque_step, word_count};
use crate::stability::input::SymptomRun;
use crate::symptoms::{Given, Hand};
use crepitus_model::render::effects::symptom::Word;

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[Case {
    id: "H88",
    name: "tank-empty",
    title: "A hand that goes back slowly with the beats of a strong clonus",
    hard: "Each beat of 4.5 N·m gives energy to the hand, ten times what the tank refills with. The rhythm goes on; what is shown fades \
           with the level of the tank, without a jump, to what the refill pays for. An account that lets the level \
           fall below zero silences the muscle for seconds, one that forgets a tick pays on.",
    source: "docs/symptoms.md, Sum, tank and limits",
    trials: |_| {
        let clonus = Given::new("clonus", &[("amplitude_nm", 4.5)], &[]);
        // A stretch beyond the hold, then back so slowly that the muscle beats on for three
        // seconds and a half.
        let slow_return = Hand::Knots {
            from_deg: 20.0,
            knots: vec![(0.0, 0.0, 220.0), (0.5, 220.0, -20.0), (4.0, -20.0, -20.0)],
        };
        let trial = |delay_ticks| {
            let run = SymptomRun {
                delay_ticks,
                ..armed(&clonus, slow_return.clone())
            };
            lasting(run, 3.8).meets([
                times(Word::Start, 1),
                word_count(Word::Beat, 18, 22),
                torque(2.0, 0.0, 1.0, 0.0),
                torque_step(0.1),
                net_returned(PAID_J),
            ])
        };
        (0..=2).map(trial).collect()
    },
    ..DEVICE
}];
