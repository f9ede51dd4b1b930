//! Commits and gaps in contact: what a fuzzer found.

use super::rig::*;
use crepitus_model::Sample;
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::texture::TextureSettings;
use crepitus_model::render::effects::{EffectSettings, MOST_STIFFNESS_NM_PER_RAD};
use crepitus_model::render::position::Sight;

fn lead_pipe(settings: LeadPipeSettings) -> EffectSettings {
    EffectSettings {
        lead_pipe: Some(settings),
        ..EffectSettings::default()
    }
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
    let place = Sight::IDEAL.position(at_rad);
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
fn a_wall_that_leaves_and_is_committed_again_does_not_push() {
    let wall = EffectSettings {
        range_limit: Some(RangeLimitSettings {
            flexion_limit_deg: 60.0,
            ..RangeLimitSettings::default()
        }),
        ..EffectSettings::default()
    };
    let mut rig = only::<f64>(wall, 59.9);
    let rest = moved(&mut rig, 59.9_f64.to_radians(), 800);
    let full_nm = rig.step(rest, rest, 0.0);
    assert!(full_nm > 2.0, "{full_nm}");
    rig.commit(EffectSettings::default());
    for _ in 0..200 {
        rig.step(rest, rest, 0.0);
    }
    rig.commit(wall);
    let left_nm = rig.step(rest, rest, 0.0);
    near(left_nm, full_nm - 1.0, 0.02);
    for _ in 0..1_000 {
        let nm = rig.step(rest, rest, 0.0);
        assert!(nm <= left_nm + 1e-12, "{left_nm} grows to {nm}");
    }
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
    let rough = EffectSettings {
        texture: Some(TextureSettings::default()),
        ..EffectSettings::default()
    };
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
