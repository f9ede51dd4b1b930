//! Commits and gaps at an end of the range, or at both.

use super::{lost, moved};
use crate::rig::*;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;

#[test]
fn a_wall_that_leaves_and_is_committed_again_does_not_push() {
    let wall = on!(range_limit: RangeLimitSettings {
        flexion_limit_deg: 60.0,
        ..RangeLimitSettings::default()
    });
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
        // Nor does more of it go.
        near(nm, left_nm, 0.02);
    }
}

/// Ends as firm as given, with the leg where both push it, against each other.
fn between_two_walls(extension_loss: f64) -> (Rig<f64>, EffectSettings, f64) {
    let walls = |extension_limit_deg, flexion_limit_deg| {
        on!(range_limit: RangeLimitSettings {
            extension_limit_deg,
            flexion_limit_deg,
            extension_loss,
            ..RangeLimitSettings::default()
        })
    };
    let mut rig = only::<f64>(walls(10.0, 60.0), 59.9);
    let (mut at_rad, _) = moved(&mut rig, 59.9_f64.to_radians(), 800);
    rig.commit(walls(70.0, 120.0));
    for _ in 0..40 {
        let to_rad = at_rad - 5e-5;
        rig.step((at_rad, -1.0), (to_rad, -1.0), -5e-5);
        at_rad = to_rad;
    }
    (rig, walls(70.0, 120.0), at_rad)
}

/// Asserts that at rest the torque falls from `left_nm`, and never to the other side.
fn never_grows(rig: &mut Rig<f64>, rest: (f64, f64), mut left_nm: f64) {
    for _ in 0..1_000 {
        let nm = rig.step(rest, rest, 0.0);
        assert!(
            (0.0..=left_nm + 1e-12).contains(&nm),
            "{left_nm} grows to {nm}"
        );
        left_nm = nm;
    }
}

/// Part of the sum of two ends that has left: it does not come back.
#[test]
fn two_walls_that_leave_and_are_committed_again_do_not_push() {
    let (mut rig, walls, at_rad) = between_two_walls(0.3);
    let rest = (at_rad, 0.0);
    let both_nm = rig.step(rest, rest, 0.0);
    assert!(both_nm > 1.0, "{both_nm}");
    rig.commit(EffectSettings::default());
    // The sum is held, its share that is shown falls.
    let left_nm = lost(&mut rig, at_rad, 19);
    near(left_nm, both_nm - 19.0 * SLEW_NM, 1e-9);
    rig.commit(walls);
    never_grows(&mut rig, rest, left_nm);
}

#[test]
fn either_end_lets_go_of_its_torque_while_samples_are_missing() {
    for (from_deg, rad_s) in [(119.9_f64, 1.0), (10.1, -1.0)] {
        let wall = on!(range_limit: RangeLimitSettings::default());
        let mut rig = only::<f64>(wall, from_deg);
        let (mut at_rad, mut pressed_nm) = (from_deg.to_radians(), 0.0);
        for _ in 0..400 {
            let to_rad = at_rad + rad_s * TICK_S;
            pressed_nm = rig.step((at_rad, rad_s), (to_rad, rad_s), rad_s * TICK_S);
            at_rad = to_rad;
        }
        assert!(rad_s * pressed_nm > 0.5, "{pressed_nm}");
        // Held for 20 ticks.
        let left_nm = lost(&mut rig, at_rad, 120);
        near(left_nm, pressed_nm - rad_s * 100.0 * SLEW_NM, 1e-9);
    }
}

/// Nor does the sum grow where a commit makes the weaker of them softer.
#[test]
fn a_wall_that_a_commit_softens_gives_the_other_no_push() {
    let (mut rig, firm, at_rad) = between_two_walls(0.6);
    let mut soft = firm;
    soft.range_limit.as_mut().unwrap().extension_loss = 0.1;
    let rest = (at_rad, 0.0);
    let both_nm = rig.step(rest, rest, 0.0);
    rig.commit(soft);
    never_grows(&mut rig, rest, both_nm);
}

/// A torque above a lowered cap falls at the slew limit only while the leg is in the wall: after
/// the leg has left it, the new cap holds at once.
#[test]
fn a_wall_that_was_left_comes_back_with_its_new_cap() {
    let wall = |flexion_torque_nm| {
        on!(range_limit: RangeLimitSettings {
            flexion_limit_deg: 60.0,
            flexion_torque_nm,
            ..RangeLimitSettings::default()
        })
    };
    let mut rig = only::<f64>(wall(4.0), 59.9);
    let mut at_rad = moved(&mut rig, 59.9_f64.to_radians(), 2_000).0;
    let mut go = |rig: &mut Rig<f64>, omega_rad_s: f64| {
        let (from, to_rad) = (at_rad, at_rad + omega_rad_s * TICK_S);
        at_rad = to_rad;
        rig.step((from, omega_rad_s), (to_rad, omega_rad_s), to_rad - from)
    };
    assert_eq!(go(&mut rig, 1.0), 4.0);
    rig.commit(wall(1.0));
    let back: Vec<f64> = (0..400).map(|_| go(&mut rig, -8.0)).collect();
    assert_eq!(back.last(), Some(&0.0));
    let again = (0..600).map(|_| go(&mut rig, 8.0));
    let most_nm = again.fold(0.0, f64::max);
    near(most_nm, 1.0, 1e-12);
}
