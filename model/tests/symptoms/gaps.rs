//! Commits and gaps in contact: what a fuzzer found.

mod walls;

use super::rig::*;
use crepitus_model::joint::MOST_STIFFNESS_NM_PER_RAD;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::symptom::Word;
use crepitus_model::render::effects::texture::TextureSettings;
use crepitus_model::render::input_check::{InputCheck, InputLimits};
use crepitus_model::render::position::Sensing;
use crepitus_model::render::{Addition, Check, ShaftEstimate, Shown};
use crepitus_model::{Sample, ShaftStep};

fn lead_pipe(settings: LeadPipeSettings) -> EffectSettings {
    on!(lead_pipe: settings)
}

/// Along at 1 rad/s for so many ticks, then at rest there.
fn moved(rig: &mut Rig<f64>, from_rad: f64, ticks: u32) -> (f64, f64) {
    let mut at = (from_rad, 1.0);
    for _ in 0..ticks {
        let to = (at.0 + TICK_S, 1.0);
        rig.step(at, to, TICK_S);
        at = to;
    }
    (at.0, 0.0)
}

fn lost(rig: &mut Rig<f64>, at_rad: f64, ticks: u32) -> f64 {
    let place = Sensing::IDEAL.position(at_rad);
    (0..ticks).fold(0.0, |_, _| rig.tick(Sample::Lost, place))
}

#[test]
fn what_was_released_while_samples_were_missing_stays_released() {
    let mut rig = only::<f64>(lead_pipe(LeadPipeSettings::default()), 45.0);
    let rest = moved(&mut rig, 45_f64.to_radians(), 2_000);
    // Held for 20 ticks, then let go of by 5 mN·m a tick.
    let released_nm = lost(&mut rig, rest.0, 120);
    near(released_nm, 1.2 - 100.0 * SLEW_NM, 1e-9);
    for _ in 0..10 {
        near(rig.step(rest, rest, 0.0), released_nm, 1e-9);
    }
}

#[test]
fn a_limit_that_a_commit_has_lowered_falls_also_while_samples_are_missing() {
    let mut rig = only::<f64>(lead_pipe(LeadPipeSettings::default()), 45.0);
    let rest = moved(&mut rig, 45_f64.to_radians(), 2_000);
    rig.commit(lead_pipe(LeadPipeSettings {
        torque_nm: 0.5,
        presliding_deg: 1.5 * 0.5 / 1.2,
        ..LeadPipeSettings::default()
    }));
    let released_nm = lost(&mut rig, rest.0, 200);
    near(released_nm, 1.2 - 180.0 * SLEW_NM, 0.02);
    // On by 0.6 deg, in 2 ms.
    let mut at = (rest.0, 5.0);
    let mut on_nm = 0.0;
    for _ in 0..40 {
        let to = (at.0 + 5.0 * TICK_S, 5.0);
        on_nm = rig.step(at, to, 5.0 * TICK_S);
        at = to;
    }
    near(on_nm, 0.5, 1e-9);
}

#[test]
fn a_commit_between_two_samples_shows_within_the_slew_limit() {
    let spring = |neutral_deg| {
        lead_pipe(LeadPipeSettings {
            torque_nm: 0.0,
            elastic_nm_per_rad: 10.0,
            neutral_deg,
            ..LeadPipeSettings::default()
        })
    };
    let mut rig = only::<f64>(spring(45.0), 45.0);
    let rest = (45_f64.to_radians(), 0.0);
    let mut last_nm = rig.step(rest, rest, 0.0);
    rig.commit(spring(140.0));
    lost(&mut rig, rest.0, 1);
    for _ in 0..100 {
        let nm = rig.step(rest, rest, 0.0);
        assert!((nm - last_nm).abs() <= SLEW_NM + 1e-12, "{last_nm} {nm}");
        last_nm = nm;
    }
    assert!(last_nm < -0.4, "{last_nm}");
}

#[test]
fn a_gap_over_many_asperities_leaves_no_late_snaps() {
    let rough = on!(texture: TextureSettings::default());
    let mut rig = only::<f64>(rough, 45.0);
    let rest = moved(&mut rig, 45_f64.to_radians(), 500);
    lost(&mut rig, rest.0, 30);
    let there = (rest.0 - 0.46, 0.0);
    rig.step((rest.0, 0.0), there, -0.46);
    rig.words.clear();
    let nm = rig.step(there, there, 0.0);
    for _ in 0..40 {
        near(rig.step(there, there, 0.0), nm, 1e-12);
        assert!(rig.words.is_empty(), "{:?}", rig.words);
    }
}

#[test]
fn a_symptom_that_is_committed_begins_without_torque_where_the_joint_is() {
    let mut rig = only::<f64>(EffectSettings::default(), 45.0);
    let mut at = (moved(&mut rig, 45_f64.to_radians(), 100).0, 1.0);
    rig.commit(lead_pipe(LeadPipeSettings::default()));
    let mut go = |ticks: u32| {
        (0..ticks).fold(0.0, |_, _| {
            let to = (at.0 + TICK_S, 1.0);
            let nm = rig.step(at, to, TICK_S);
            at = to;
            nm
        })
    };
    assert_eq!(go(1), 0.0);
    // From there on by its stiffness, up to 1.2 N·m after 1.5 deg.
    let per_tick_nm = 1.2 / 1.5_f64.to_radians() * TICK_S;
    near(go(100), 100.0 * per_tick_nm, 1e-9);
    near(go(500), 1.2, 1e-9);
}

#[test]
fn a_torque_that_fades_gives_way_as_a_spring_where_it_would_push() {
    let with = |elastic_nm_per_rad: f64| {
        lead_pipe(LeadPipeSettings {
            torque_nm: 0.0,
            elastic_nm_per_rad,
            neutral_deg: 0.0,
            ..LeadPipeSettings::default()
        })
    };
    let mut rig = only::<f64>(with(2.0), 45.0);
    let rest = moved(&mut rig, 45_f64.to_radians(), 10);
    let full_nm = rig.step(rest, rest, 0.0);
    near(full_nm, 2.0 * rest.0, 1e-9);
    // The stiffness is gone at once, its torque is not.
    rig.commit(with(0.0));
    for n in 1..=20 {
        near(
            rig.step(rest, rest, 0.0),
            full_nm - f64::from(n) * SLEW_NM,
            1e-9,
        );
    }
    // A hand that goes along with it at 0.5 rad/s gets what the stiffest spring has.
    let (mut at, mut nm) = (rest.0, full_nm - 20.0 * SLEW_NM);
    let travel_rad = -0.5 * TICK_S;
    for _ in 0..10 {
        nm -= SLEW_NM + MOST_STIFFNESS_NM_PER_RAD * 0.5 * TICK_S;
        near(
            rig.step((at, -0.5), (at + travel_rad, -0.5), travel_rad),
            nm,
            1e-9,
        );
        at += travel_rad;
    }
}

/// Commits while the joint rests; the torque once it has slewed.
fn committed(rig: &mut Rig<f64>, settings: EffectSettings, rest: (f64, f64)) -> f64 {
    let mut last_nm = rig.step(rest, rest, 0.0);
    assert!(last_nm > 0.4, "{last_nm}");
    rig.commit(settings);
    // Without a sample nothing grows.
    let unseen_nm = lost(rig, rest.0, 5);
    assert!((last_nm - 6.0 * SLEW_NM..=last_nm + 1e-12).contains(&unseen_nm));
    last_nm = unseen_nm;
    for _ in 0..700 {
        let nm = rig.step(rest, rest, 0.0);
        assert!((last_nm - nm).abs() <= SLEW_NM + 1e-3, "{last_nm} {nm}");
        last_nm = nm;
    }
    last_nm
}

/// Times of a decay, s, with further ticks: just before anything has decayed, and long after.
const DECAYS: [(f64, u32); 2] = [(0.3, 0), (0.03, 6_000)];

#[test]
fn a_blade_that_has_fallen_obeys_a_commit() {
    for (collapse_s, later) in DECAYS {
        let knife = |onset_torque_nm, slope_nm_per_rad| {
            on!(clasp_knife: ClaspKnifeSettings {
                onset_torque_nm,
                slope_nm_per_rad,
                collapse_s,
                ..ClaspKnifeSettings::default()
            })
        };
        let mut rig = only::<f64>(knife(0.8, 3.0), 70.0);
        // The resistance falls at 75 deg, from 3.2 N·m to 0.15 of them.
        let rest = moved(&mut rig, 70_f64.to_radians(), 1_800 + later);
        let nm = committed(&mut rig, knife(0.2, 0.0), rest);
        assert!(nm <= 0.2, "{nm}");
        if later > 0 {
            near(nm, 0.15 * 0.2, 1e-3);
        }
    }
}

#[test]
fn an_onset_that_is_moved_behind_the_joint_pushes_nobody() {
    for (trigger, from_deg) in [(0, 20.0), (1, 45.0)] {
        let knife = |onset_deg| {
            on!(clasp_knife: ClaspKnifeSettings {
                trigger,
                onset_deg,
                release_deg: 90.0,
                onset_torque_nm: 3.0,
                ..ClaspKnifeSettings::default()
            })
        };
        let mut rig = only::<f64>(knife(80.0), from_deg);
        let rest = moved(&mut rig, f64::to_radians(from_deg), 10_000);
        rig.commit(knife(40.0));
        for _ in 0..200 {
            assert_eq!(rig.step(rest, rest, 0.0), 0.0);
        }
        // Onwards it is a spring from here on.
        let stiffness = knife(40.0).clasp_knife.unwrap().catch_stiffness_nm_per_rad;
        let to = (rest.0 + 1e-3, 0.0);
        near(rig.step(rest, to, 1e-3), 1e-3 * stiffness, 1e-9);
    }
}

/// Commits an onset beyond the joint's angle: the torque falls to zero within the slew limit. Returns the word, the torques that it tells, and that before the commit.
fn let_go(muscles: u8, has_fallen: bool) -> (Word, (f64, f64), f64) {
    // Flexors: the mirror image about 60 deg.
    let along = if muscles == 0 { 1.0 } else { -1.0 };
    let knife = |onset_deg: f64, release_deg: f64| {
        on!(clasp_knife: ClaspKnifeSettings {
            muscles,
            onset_deg: 60.0 + along * (onset_deg - 60.0),
            release_deg: 60.0 + along * (release_deg - 60.0),
            onset_torque_nm: 2.0,
            residual_share: 0.5,
            ..ClaspKnifeSettings::default()
        })
    };
    let release_deg = if has_fallen { 45.0 } else { 90.0 };
    let mut at = (60.0 - along * 21.0_f64).to_radians();
    let mut rig = only::<f64>(knife(40.0, release_deg), at.to_degrees());
    for _ in 0..4_000 {
        let to = at + along * TICK_S;
        rig.step((at, along), (to, along), along * TICK_S);
        at = to;
    }
    let rest = (at, 0.0);
    let before_nm = rig.step(rest, rest, 0.0);
    assert!(along * before_nm > 0.9, "{before_nm}");
    rig.commit(knife(80.0, 90.0));
    let mut last_nm = rig.step(rest, rest, 0.0);
    let told = (rig.words.last().unwrap().0, *rig.torques_nm.last().unwrap());
    assert!((last_nm - before_nm).abs() <= SLEW_NM + 1e-9);
    for _ in 0..1_000 {
        let nm = rig.step(rest, rest, 0.0);
        assert!((last_nm - nm).abs() <= SLEW_NM + 1e-9, "{last_nm} {nm}");
        last_nm = nm;
    }
    assert_eq!(last_nm, 0.0);
    (told.0, told.1, before_nm)
}

#[test]
fn an_onset_that_is_moved_before_the_joint_lets_go_within_the_slew_limit() {
    for (muscles, has_fallen, word) in [
        (0, false, Word::Back),
        (1, false, Word::Back),
        (0, true, Word::Rearm),
        (1, true, Word::Rearm),
    ] {
        let (told, (from_nm, to_nm), before_nm) = let_go(muscles, has_fallen);
        assert_eq!((told, to_nm), (word, 0.0));
        near(from_nm, before_nm, 2.0 * SLEW_NM);
    }
}

#[test]
fn a_muscle_that_has_caught_obeys_a_commit() {
    for (release_s, later) in DECAYS {
        let muscle = |torque_nm| {
            on!(spasticity: SpasticitySettings {
                form: 0,
                threshold_deg: 40.0,
                velocity_shift_s: 0.0,
                threshold_velocity_deg_s: 20.0,
                torque_nm,
                release_s,
                stiffness_nm_per_rad: 0.0,
                residual_share: 0.8,
                ..SpasticitySettings::default()
            })
        };
        let mut rig = only::<f64>(muscle(3.0), 39.0);
        let rest = moved(&mut rig, 39_f64.to_radians(), 600 + later);
        let nm = committed(&mut rig, muscle(0.1), rest);
        assert!(nm <= 0.1, "{nm}");
        if later > 0 {
            near(nm, 0.8 * 0.1, 1e-3);
        }
    }
}

/// Tick of the refused sample: the hand goes back, and the tank is low.
const REFUSED_TICK: u32 = 1_900;

/// The torque of a reflex whose tank is low, and after a sample that is refused: a travel
/// of a thousand radians against that torque.
fn around_a_refused_sample(effects: &mut impl Addition<f64>) -> (f64, f64) {
    let mut check = InputCheck::new(&InputLimits::device(TICK_S), TICK_S, 0.0);
    let motion = |tick: u32| {
        let phase = 25.0 * f64::from(tick) * TICK_S;
        (1.05 + 0.3 * phase.sin(), 7.5 * phase.cos())
    };
    effects.rest(&Sensing::IDEAL.position(motion(0).0));
    let mut tick = |shaft: ShaftStep<f64>, at_rad: f64| {
        let sample = Sample::Taken(shaft);
        let seen = ShaftEstimate {
            sample,
            omega_rad_s: 0.0,
            place: Sensing::IDEAL.position(at_rad),
            is_driven: true,
        };
        let mut shown = Shown::nothing();
        effects.tick(&seen, &check.check(&sample), &mut shown, &mut ());
        shown.torque_nm
    };
    let mut before_nm = 0.0;
    for n in 0..REFUSED_TICK {
        let (from, to) = (motion(n), motion(n + 1));
        let shaft = ShaftStep {
            delta_phi_rad: to.0 - from.0,
            omega_start_rad_s: from.1,
            omega_end_rad_s: to.1,
        };
        before_nm = tick(shaft, to.0);
    }
    let refused = ShaftStep {
        delta_phi_rad: 1e3_f64.copysign(before_nm),
        ..ShaftStep::default()
    };
    (before_nm, tick(refused, motion(REFUSED_TICK).0))
}

#[test]
fn a_sample_that_is_refused_fills_no_tank() {
    let reflex = on!(spasticity: SpasticitySettings {
        form: 1,
        threshold_deg: 60.0,
        velocity_shift_s: 0.27,
        gain_nm_per_rad: 15.0,
        ..SpasticitySettings::default()
    });
    let mut alone = reflex.laws::<f64>(&timing(Sensing::IDEAL)).unwrap();
    let mut armed = only::<f64>(reflex, 60.0).effects;
    for (before_nm, after_nm) in [
        around_a_refused_sample(&mut alone),
        around_a_refused_sample(&mut armed),
    ] {
        assert!(before_nm > 0.05, "{before_nm}");
        near(after_nm, before_nm, 0.01 * before_nm);
    }
    let level_j = alone.tank.level_j();
    assert!(level_j < 0.05, "{level_j} J: nothing would be seen");
}
