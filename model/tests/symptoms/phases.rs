//! The phases of each symptom, and its torque while samples are missing.

use super::rig::*;
use crepitus_model::Sample;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::cogwheel::CogwheelSettings;
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::symptom::Word;
use crepitus_model::render::effects::texture::TextureSettings;
use crepitus_model::render::position::{Position, Sensing};

/// A symptom, and an examination that brings it through its phases.
struct Case {
    settings: EffectSettings,
    from_deg: f64,
    /// Speeds and how long each lasts, deg/s and s.
    strokes: &'static [(f64, f64)],
    phases: &'static [Option<&'static str>],
    /// A time at which it has torque, s.
    torque_s: f64,
}

fn cases() -> Vec<Case> {
    vec![
        Case {
            settings: on!(range_limit: RangeLimitSettings {
                flexion_limit_deg: 60.0,
                ..RangeLimitSettings::default()
            }),
            from_deg: 58.0,
            strokes: &[(20.0, 0.3), (-20.0, 0.3)],
            phases: &[
                None,
                Some("in-the-wall"),
                Some("at-its-cap"),
                Some("in-the-wall"),
                None,
            ],
            torque_s: 0.29,
        },
        Case {
            settings: on!(lead_pipe: LeadPipeSettings {
                elastic_nm_per_rad: 1.0,
                // Both parts of the torque in one direction.
                neutral_deg: 0.0,
                ..LeadPipeSettings::default()
            }),
            from_deg: 20.0,
            strokes: &[(20.0, 0.2), (-20.0, 0.05)],
            phases: &[None, Some("sliding"), None],
            torque_s: 0.15,
        },
        Case {
            settings: on!(cogwheel: CogwheelSettings {
                elastic_nm_per_rad: 1.0,
                // Both parts of the torque in one direction.
                neutral_deg: 0.0,
                ..CogwheelSettings::default()
            }),
            from_deg: 20.0,
            strokes: &[(60.0, 0.2)],
            phases: &[Some("high"), None, Some("high")],
            torque_s: 0.07,
        },
        Case {
            settings: on!(spasticity: SpasticitySettings::default()),
            from_deg: 40.0,
            strokes: &[(90.0, 0.2), (-90.0, 0.3)],
            phases: &[None, Some("caught"), None],
            torque_s: 0.19,
        },
        Case {
            settings: on!(spasticity: SpasticitySettings {
                form: 1,
                torque_nm: 0.5,
                velocity_shift_s: 0.1,
                ..SpasticitySettings::default()
            }),
            from_deg: 60.0,
            strokes: &[(90.0, 0.4), (-90.0, 0.4)],
            phases: &[
                None,
                Some("reflex"),
                Some("reflex-at-its-largest"),
                Some("reflex"),
                None,
            ],
            torque_s: 0.39,
        },
        Case {
            settings: on!(clasp_knife: ClaspKnifeSettings::default()),
            from_deg: 25.0,
            strokes: &[(60.0, 1.0), (-120.0, 0.6)],
            phases: &[None, Some("building"), Some("fallen"), None],
            torque_s: 0.5,
        },
        Case {
            settings: on!(clonus: ClonusSettings::default()),
            from_deg: 40.0,
            // The joint is let go of in mid-beat.
            strokes: &[(150.0, 0.2), (-300.0, 0.15)],
            phases: &[None, Some("beating"), Some("stopping"), None],
            torque_s: 0.195,
        },
        Case {
            settings: on!(texture: TextureSettings {
                irregularity: 0.0,
                ..TextureSettings::default()
            }),
            from_deg: 20.2,
            strokes: &[(20.0, 0.04)],
            phases: &[None, Some("sliding")],
            torque_s: 0.03,
        },
    ]
}

/// Angle and velocity of an examination over time, rad and rad/s.
fn motion(case: &Case) -> impl Fn(f64) -> (f64, f64) {
    let (from_deg, strokes) = (case.from_deg, case.strokes);
    move |time_s| {
        let (mut deg, mut left_s) = (from_deg, time_s);
        for &(deg_s, lasts_s) in strokes {
            if left_s < lasts_s - 1e-9 {
                return ((deg + deg_s * left_s).to_radians(), deg_s.to_radians());
            }
            deg += deg_s * lasts_s;
            left_s -= lasts_s;
        }
        (deg.to_radians(), 0.0)
    }
}

#[test]
fn every_phase_is_shown_while_it_lasts() {
    for case in cases() {
        let mut rig = only::<f64>(case.settings, case.from_deg);
        let end_s = case.strokes.iter().map(|stroke| stroke.1).sum();
        let run = rig.run(end_s, motion(&case));
        assert_eq!(run.phases, case.phases);
    }
}

#[test]
fn a_torque_is_held_for_a_millisecond_without_samples_and_then_released() {
    for case in cases() {
        let mut rig = only::<f64>(case.settings, case.from_deg);
        let run = rig.run(case.torque_s, motion(&case));
        let (_, at_rad, nm) = *run.rows.last().unwrap();
        assert!(nm.abs() > 0.05, "{nm}");
        let place = Sensing::IDEAL.position(at_rad);
        for _ in 0..20 {
            assert_eq!(rig.tick(Sample::Lost, place), nm, "{:?}", rig.phase());
        }
        let released_nm = rig.tick(Sample::Lost, place);
        // Each part of a torque is released with the slew limit.
        let less_nm = nm.abs() - released_nm.abs();
        assert!(
            (SLEW_NM - 1e-9..=2.0 * SLEW_NM + 1e-9).contains(&less_nm),
            "{:?}: {less_nm}",
            case.phases
        );
    }
}

#[test]
fn a_beat_within_a_gap_has_its_time() {
    let case = cases().swap_remove(6);
    let mut rig = only::<f64>(case.settings, 40.0);
    // Clonus starts at 2,666.7 ticks, the beat is 1,000 ticks later.
    let motion = motion(&case);
    rig.run(3_665.0 * TICK_S, &motion);
    assert!(rig.words.is_empty());
    let [from, to] = [3_665.0, 3_668.0].map(|tick| motion(tick * TICK_S));
    for _ in 0..2 {
        rig.tick(Sample::Lost, Sensing::IDEAL.position(from.0));
    }
    rig.step(from, to, to.0 - from.0);
    let [(Word::Beat, share)] = rig.words[..] else {
        panic!("{:?}", rig.words);
    };
    near(share, 5.0 / 9.0, 1e-6);
}

/// The start of clonus, and the stretch that ends: what follows them comes when it would.
#[test]
fn whatever_a_gap_hides_of_clonus_happens_in_its_time() {
    let case = cases().swap_remove(6);
    let motion = motion(&case);
    let end_s = 0.35;
    let is_own = |word: &(Word, f64)| !word.0.is_of_play();
    let run = only::<f64>(case.settings, 40.0).run(end_s, &motion);
    let whole: Vec<_> = run.words.into_iter().filter(is_own).collect();
    assert!(whole.len() >= 3, "{whole:?}");
    for (hidden, time_s) in &whole {
        let first = (time_s / TICK_S).floor() as u32 - 1;
        let mut rig = only::<f64>(case.settings, 40.0);
        let mut words = Vec::new();
        let (mut tick, end) = (0, (end_s / TICK_S).round() as u32);
        while tick < end {
            let ticks = if tick == first { 3 } else { 1 };
            let at = |tick: u32| motion(f64::from(tick) * TICK_S);
            let (from, to) = (at(tick), at(tick + ticks));
            for _ in 1..ticks {
                rig.tick(Sample::Lost, Sensing::IDEAL.position(from.0));
            }
            let nm = rig.step(from, to, to.0 - from.0);
            near(nm, run.rows[(tick + ticks) as usize - 1].2, 1e-5);
            let now = rig.words.iter().map(|(word, share)| {
                (*word, TICK_S * (f64::from(tick) + share * f64::from(ticks)))
            });
            words.extend(now.filter(is_own));
            tick += ticks;
        }
        assert_eq!(words.len(), whole.len(), "{hidden:?} hidden: {words:?}");
        for (found, expected) in words.iter().zip(&whole) {
            assert_eq!(found.0, expected.0);
            near(found.1, expected.1, 1e-9);
        }
    }
}

/// The first beat is due three ticks before the muscle is let go of, or three ticks after.
#[test]
fn a_beat_and_the_end_of_a_stretch_within_one_gap_come_in_their_order() {
    let settings = on!(clonus: ClonusSettings::default());
    // From 59 deg it passes 60 deg after 1/130 s, and the delay is 0.05 s.
    let beat_s = 1.0 / 130.0 + 0.05;
    for (ticks_later, told) in [
        (3.0, &[Word::Start, Word::Beat, Word::Stop][..]),
        (-3.0, &[Word::Start, Word::Stop][..]),
    ] {
        let back_s = beat_s + ticks_later * TICK_S;
        let motion = |t: f64| {
            let (out, back) = (59.0 + 130.0 * t, 55.0 + 200.0 * (back_s - t));
            let (deg, deg_s) = if out < back {
                (out, 130.0)
            } else {
                (back, -200.0)
            };
            (f64::to_radians(deg), f64::to_radians(deg_s))
        };
        let run = only::<f64>(settings, 59.0).run(0.07, motion);
        let whole: Vec<_> = run
            .words
            .iter()
            .filter(|word| !word.0.is_of_play())
            .collect();
        assert!(
            whole.iter().map(|word| word.0).eq(told.iter().copied()),
            "{whole:?}"
        );

        let mut rig = only::<f64>(settings, 59.0);
        let first = (beat_s / TICK_S) as u32 - 6;
        rig.run(f64::from(first) * TICK_S, motion);
        let [from, to] = [first, first + 12].map(|tick| motion(f64::from(tick) * TICK_S));
        for _ in 1..12 {
            rig.tick(Sample::Lost, Sensing::IDEAL.position(from.0));
        }
        let nm = rig.step(from, to, to.0 - from.0);
        near(nm, run.rows[first as usize + 11].2, 1e-5);
        let hidden: Vec<_> = rig
            .words
            .iter()
            .filter(|word| !word.0.is_of_play())
            .collect();
        assert_eq!(hidden.len(), told.len() - 1, "{hidden:?}");
        for (found, expected) in hidden.iter().zip(&whole[1..]) {
            assert_eq!(found.0, expected.0);
            near(
                (f64::from(first) + 12.0 * found.1) * TICK_S,
                expected.1,
                1e-9,
            );
        }
    }
}

/// Rest of a catch after a gap in which it began: the same as without a gap, in both
/// laws that decay.
#[test]
fn a_decay_that_begins_within_a_gap_has_its_time() {
    let motion = ramp(20.0, 130.0);
    let spastic = on!(spasticity: SpasticitySettings {
        release_s: 0.02,
        ..SpasticitySettings::default()
    });
    let clasp_knife = on!(clasp_knife: ClaspKnifeSettings {
        collapse_s: 0.01,
        onset_deg: 25.0,
        release_deg: 42.5,
        ..ClaspKnifeSettings::default()
    });
    for settings in [spastic, clasp_knife] {
        let whole = only::<f64>(settings, 20.0).run(0.2, &motion);
        let mut rig = only::<f64>(settings, 20.0);
        // Both come at 42.5 deg, 3,461.5 ticks after the beginning.
        let (before, after) = (3_455_u32, 3_471_u32);
        rig.run(f64::from(before) * TICK_S, &motion);
        let at = |tick: u32| motion(f64::from(tick) * TICK_S);
        for tick in before + 1..after {
            rig.tick(Sample::Lost, Sensing::IDEAL.position(at(tick).0));
        }
        let (from, to) = (at(before), at(after));
        rig.step(from, to, to.0 - from.0);
        for tick in after..4_000 {
            let (from, to) = (at(tick), at(tick + 1));
            let nm = rig.step(from, to, to.0 - from.0);
            if tick == 3_999 {
                near(nm, whole.rows.last().unwrap().2, 1e-6);
                assert!(nm.abs() > 0.1, "{nm}");
            }
        }
    }
}

#[test]
fn a_count_that_flickers_at_the_edge_of_a_tooth_gives_nothing_way() {
    let sensing =
        Sensing::of_encoder(&crepitus_model::control::encoder::EncoderSettings::default());
    let settings = on!(cogwheel: CogwheelSettings {
        mode: 1,
        ..CogwheelSettings::default()
    });
    // A tooth of 7.5 deg is high for its first half.
    let edge = sensing.position::<f64>(3.75_f64.to_radians()).count;
    let mut rig = Rig::<f64>::new(settings, sensing, 0.0);
    let mut count = 0;
    let mut go = |to: i32| {
        let mut nm = 0.0;
        while count != to {
            let by = (to - count).signum();
            count += by;
            let travel_rad = f64::from(by) * sensing.rad_per_count;
            let omega = travel_rad / TICK_S;
            let shaft = crepitus_model::ShaftStep {
                delta_phi_rad: travel_rad,
                omega_start_rad_s: omega,
                omega_end_rad_s: omega,
            };
            nm = rig.tick(Sample::Taken(shaft), Position::at(count));
        }
        nm
    };
    near(go(edge), 2.0, 1e-9);
    for _ in 0..10 {
        assert!(go(edge + 1) > 1.99);
        assert!(go(edge) > 1.99);
    }
    near(go(edge + 3), 0.8, 1e-2);
}
