//! Laws that hold for any symptom, hand and commit.

use super::ledger::*;
use super::random::*;
use super::rig::*;
use super::support;

use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::{EffectSettings, TANK_J, TANK_REFILL_W};
use crepitus_model::render::position::Sensing;
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
    fn a_commit_pushes_no_hand_that_rests(
        (kind, x) in parameters(),
        (other, y) in parameters(),
        points in tremble(),
    ) {
        let angles = hand(&points);
        let mut rig = Rig::<f64>::new(symptom(kind, &x), Sensing::IDEAL, angles[0]);
        let mut nm = 0.0;
        for pair in angles.windows(2) {
            let omega = (pair[1] - pair[0]) / TICK_S;
            nm = rig.step((pair[0], omega), (pair[1], omega), pair[1] - pair[0]);
        }
        let rest = (angles[angles.len() - 1], 0.0);
        rig.commit(symptom(other, &y));
        for _ in 0..3_000 {
            let now_nm = rig.step(rest, rest, 0.0);
            let slower = (now_nm - nm).abs() <= SLEW_NM + 1e-12;
            // What decays or gives by itself does so as fast as it wants.
            prop_assert!(slower || now_nm.abs() <= nm.abs(), "{nm} to {now_nm}");
            prop_assert!(now_nm.abs() <= nm.abs() + 1e-12, "{nm} to {now_nm}");
            nm = now_nm;
        }
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
    fn no_input_makes_a_torque_that_is_none(
        (kind, x) in parameters(),
        samples in prop::collection::vec((0..12_usize, -3.0..3.0_f64), 500..1500),
    ) {
        let settings = symptom(kind, &x);
        let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e30, -1e30, 1e-42, f64::MAX];
        let mut rig = Rig::<f32>::new(settings, Sensing::IDEAL, 1.0);
        let mut phi = 1.0;
        // No torque of a symptom with these parameters is beyond.
        let most_nm = settings.largest_torque_nm(None) + 10.0 * 3.0;
        for (which, omega) in samples {
            let nm = if let Some(x) = bad.get(which) {
                let to = (phi, omega);
                match which % 3 {
                    0 => rig.step((phi, *x), to, 0.0),
                    1 => rig.step((phi, omega), (phi, *x), 0.0),
                    _ => rig.step((phi, omega), to, *x),
                }
            } else {
                phi += 20.0 * omega * TICK_S;
                rig.step((phi, omega), (phi, omega), omega * TICK_S)
            };
            prop_assert!(nm.is_finite() && nm.abs() <= most_nm, "{nm}");
        }
        for _ in 0..100 {
            let nm = rig.step((phi, 0.5), (phi + 0.5 * TICK_S, 0.5), 0.5 * TICK_S);
            phi += 0.5 * TICK_S;
            prop_assert!(nm.is_finite());
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

    #[test]
    fn flexors_are_the_mirror_image_of_extensors(
        which in 0..4_usize,
        x in prop::collection::vec(0.0..1.0_f64, 6),
        points in points(),
    ) {
        // Mirrored about 60 deg.
        let image = |deg: f64| 120.0 - deg;
        let mut own = EffectSettings::default();
        let mut other = own;
        match which {
            0 => {
                let wall = symptom(0, &x).range_limit.unwrap();
                own.range_limit = Some(wall);
                other.range_limit = Some(RangeLimitSettings {
                    extension_limit_deg: image(wall.flexion_limit_deg),
                    flexion_limit_deg: image(wall.extension_limit_deg),
                    ..wall
                });
            }
            1 => {
                let muscle = SpasticitySettings { muscles: 0, ..symptom(3, &x).spasticity.unwrap() };
                own.spasticity = Some(muscle);
                other.spasticity = Some(SpasticitySettings {
                    muscles: 1,
                    threshold_deg: image(muscle.threshold_deg),
                    ..muscle
                });
            }
            2 => {
                let knife = ClaspKnifeSettings {
                    muscles: 0,
                    onset_deg: 30.0 + 20.0 * x[0],
                    release_deg: 60.0 + 20.0 * x[1],
                    ..symptom(4, &x).clasp_knife.unwrap()
                };
                own.clasp_knife = Some(knife);
                other.clasp_knife = Some(ClaspKnifeSettings {
                    muscles: 1,
                    onset_deg: image(knife.onset_deg),
                    release_deg: image(knife.release_deg),
                    ..knife
                });
            }
            _ => {
                let clonus = ClonusSettings {
                    hold_deg: 40.0 + 40.0 * x[0],
                    start_velocity_deg_s: 20.0 + 100.0 * x[1],
                    ..ClonusSettings::default()
                };
                own.clonus = Some(clonus);
                other.clonus = Some(ClonusSettings {
                    muscles: 1,
                    hold_deg: image(clonus.hold_deg),
                    ..clonus
                });
            }
        }
        let angles = hand(&points);
        let middle = 60_f64.to_radians();
        let (mut one, mut two) = (only::<f64>(own, 60.0), only::<f64>(other, 60.0));
        let mut omega = 0.0;
        for pair in angles.windows(2) {
            let moved = pair[1] - pair[0];
            let end = moved / TICK_S;
            let nm = one.step((pair[0], omega), (pair[1], end), moved);
            let mirrored = |rad: f64| 2.0 * middle - rad;
            let image_nm = two.step((mirrored(pair[0]), -omega), (mirrored(pair[1]), -end), -moved);
            prop_assert!((nm + image_nm).abs() < 1e-9, "{nm} {image_nm}");
            // Both walls may have something to say in a tick.
            let words = |rig: &Rig<f64>| {
                let mut words: Vec<_> = rig.words.iter().map(|(word, _)| word.name()).collect();
                words.sort_unstable();
                words
            };
            prop_assert_eq!(words(&one), words(&two));
            omega = end;
        }
    }
}
