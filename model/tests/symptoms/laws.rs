//! Laws that hold for any symptom, hand and commit.

use super::ledger::*;
use super::random::*;
use super::rig::*;
use super::support;

use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::{EffectSettings, TANK_J, TANK_REFILL_W};
use proptest::prelude::*;

proptest! {
    #![proptest_config(support::cases(300))]

    #[test]
    fn a_play_gives_no_more_than_it_holds(
        (kind, x) in parameters(),
        points in prop_oneof![points(), tremble()],
        delay in 0..3_usize,
        counts: bool,
        single: bool,
        gaps in prop::option::of((30..400_usize, 1..19_usize)),
    ) {
        let hand = Hand {
            angles: &hand(&points),
            delay,
            counts,
            commits: &[],
            // The bound for late torque takes ticks of one length.
            gaps: gaps.filter(|_| !counts && delay == 0),
        };
        let settings = symptom(kind, &x);
        let (excess_j, _) = if single {
            excess::<f32>(settings, &hand)
        } else {
            excess::<f64>(settings, &hand)
        };
        let rounding_j = if single { 2e-5 } else { 1e-9 };
        prop_assert!(excess_j <= rounding_j, "{excess_j} J");
    }

    #[test]
    fn nor_does_it_over_commits(
        (kind, x) in parameters(),
        others in prop::collection::vec((prop::option::of(prop::collection::vec(0.0..1.0_f64, 6)), 0..20_000_usize), 1..6),
        points in prop_oneof![points(), tremble()],
    ) {
        let commits: Vec<_> = others
            .iter()
            .map(|(x, tick)| {
                let none = EffectSettings::default();
                (*tick, x.as_ref().map_or(none, |x| symptom(kind, x)))
            })
            .collect();
        let angles = hand(&points);
        let hand = Hand { angles: &angles, delay: 0, counts: false, commits: &commits, gaps: None };
        let settings = symptom(kind, &x);
        let (excess_j, _) = excess::<f64>(settings, &hand);
        prop_assert!(excess_j <= 1e-7, "{excess_j} J");
    }

    #[test]
    fn what_gives_energy_is_paid_from_the_tank(
        gain in 0.0..20.0_f64,
        amplitude in 0.0..4.5_f64,
        frequency in 0.5..12.0_f64,
        sweep in 0.05..0.6_f64,
        commits_after in prop::option::of(400..8_000_u32),
    ) {
        let mut settings = EffectSettings {
            spasticity: Some(SpasticitySettings {
                form: 1,
                threshold_deg: 60.0,
                velocity_shift_s: 0.27,
                gain_nm_per_rad: gain,
                ..SpasticitySettings::default()
            }),
            clonus: Some(ClonusSettings {
                amplitude_nm: amplitude,
                start_velocity_deg_s: 20.0,
                ..ClonusSettings::default()
            }),
            ..EffectSettings::default()
        };
        let mut rig = only::<f64>(settings, 60.0);
        let sweep = sweep.min(6.0 / (std::f64::consts::TAU * frequency));
        let motion = |t: f64| {
            let w = std::f64::consts::TAU * frequency;
            (1.05 + sweep * (w * t).sin(), sweep * w * (w * t).cos())
        };
        let (mut level_j, mut highest_j, mut nm) = (0.0_f64, 0.0_f64, 0.0);
        for n in 0..60_000_u32 {
            // Another rhythm: what was pushing fades, and is paid, too.
            if commits_after.is_some_and(|ticks| n % ticks == ticks - 1) {
                let clonus = settings.clonus.as_mut().unwrap();
                clonus.frequency_hz = 11.0 - clonus.frequency_hz;
                rig.commit(settings);
            }
            let (from, to) = (motion(f64::from(n) * TICK_S), motion(f64::from(n + 1) * TICK_S));
            level_j += nm * (to.0 - from.0) + TANK_REFILL_W * TICK_S;
            nm = rig.step(from, to, to.0 - from.0);
            highest_j = highest_j.max(level_j);
            // A tick may take more than is left.
            prop_assert!(highest_j - level_j <= TANK_J + 2e-3, "{}", highest_j - level_j);
        }
    }

    #[test]
    fn a_wall_never_pulls_and_keeps_its_cap(
        x in prop::collection::vec(0.0..1.0_f64, 6),
        y in prop::collection::vec(0.0..1.0_f64, 6),
        points in points(),
        at in 0..8_000_usize,
    ) {
        let (before, after) = (symptom(0, &x), symptom(0, &y));
        let cap = |s: &EffectSettings| s.range_limit.map_or(0.0, |s| s.flexion_torque_nm);
        let angles = hand(&points);
        let commits = [(at, after)];
        let hand = Hand { angles: &angles, delay: 0, counts: false, commits: &commits, gaps: None };
        let (_, largest_nm) = excess::<f64>(before, &hand);
        prop_assert!(largest_nm <= cap(&before).max(cap(&after)) + 1e-9);
    }
}
