//! A symptom that is reset, as at arming, keeps nothing of an earlier contact.

use super::random::*;
use super::rig::*;
use crepitus_model::Sample;
use crepitus_model::render::Addition;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::position::Sensing;
use proptest::prelude::*;

/// The tank is full after 0.2 J at 0.04 W.
const FILLED_TICKS: u32 = 101_000;

/// A symptom by number, those that push included.
fn any_symptom(kind: usize, x: &[f64]) -> EffectSettings {
    match kind.checked_sub(KINDS) {
        None => symptom(kind, x),
        Some(0) => on!(clonus: ClonusSettings {
            muscles: u8::from(x[0] > 0.5),
            hold_deg: 60.0,
            start_velocity_deg_s: 20.0 + 50.0 * x[1],
            ..ClonusSettings::default()
        }),
        Some(_) => {
            let caught = symptom(3, x).spasticity.unwrap();
            on!(spasticity: SpasticitySettings {
                form: 1,
                velocity_shift_s: 0.3,
                ..caught
            })
        }
    }
}

/// Follows these angles from the first on; the torques, and what happened.
fn follow(rig: &mut Rig<f64>, angles: &[f64]) -> Vec<(f64, usize)> {
    angles
        .windows(2)
        .map(|pair| {
            let rad_s = (pair[1] - pair[0]) / TICK_S;
            let nm = rig.step((pair[0], rad_s), (pair[1], rad_s), pair[1] - pair[0]);
            (nm, rig.words.len())
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(1), cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn a_symptom_that_is_reset_is_a_new_one(
        kind in 0..KINDS + 2,
        x in prop::collection::vec(0.0..1.0_f64, 6),
        before in points(),
        after in points(),
    ) {
        let settings = any_symptom(kind, &x);
        let (before, after) = (hand(&before), hand(&after));
        let mut used = Rig::<f64>::new(settings, Sensing::IDEAL, before[0]);
        follow(&mut used, &before);
        let mut new = Rig::<f64>::new(settings, Sensing::IDEAL, after[0]);
        let place = Sensing::IDEAL.position(after[0]);
        for rig in [&mut used, &mut new] {
            // What has been given stays given: the tank of those that push fills up first.
            let is_active = kind >= KINDS;
            for _ in 0..if is_active { FILLED_TICKS } else { 0 } {
                rig.tick(Sample::Lost, place);
            }
            rig.effects.rest(&place);
        }
        let (again, first) = (follow(&mut used, &after), follow(&mut new, &after));
        let off = again.iter().zip(&first).position(|(again, first)| again != first);
        prop_assert_eq!(off.map(|n| (n, again[n], first[n])), None);
    }
}
