//! The hand of a person at a screen.

use crate::random::{Case, case};
use crate::support::{Build, Rig, TICK_S, cases};
use crepitus_plant::Motion;
use crepitus_plant::chain::Body;
use crepitus_plant::guiding_hand::{GuidingHand, HandNumbers};
use crepitus_plant::motion::Strokes;
use proptest::prelude::*;

const HAND: HandNumbers = HandNumbers {
    inertia_kg_m2: 0.07,
    stiffness_nm_per_rad: 40.0,
    damping_nms_per_rad: 9.0,
    limit_nm: 25.0,
};

/// Lets the hand take the right end of a rig, guided along the rig's motion.
fn take(rig: &mut Rig) {
    let guided = rig.now;
    rig.plant
        .hold_by(|chain| Box::new(GuidingHand::new(HAND, guided, chain)));
}

fn taken(build: &Build, motion: Motion) -> Rig {
    let mut rig = build.on(motion);
    take(&mut rig);
    rig
}

#[test]
fn a_resistance_is_a_lag_of_the_leg() {
    for torque_nm in [0.4, -2.5, 20.0] {
        let mut rig = taken(&Build::of(&[]), Motion::rest(0.3));
        rig.ticks(80_000, torque_nm);
        let lag_rad = 0.3 - rig.leg().angle_rad;
        assert!((lag_rad - torque_nm / 40.0).abs() < 1e-6, "{lag_rad}");
        assert!((rig.felt_nm - torque_nm).abs() < 1e-5, "{}", rig.felt_nm);
    }
}

/// The lag at a steady speed is that of the resistance alone: the damper is between hand and leg.
#[test]
fn the_speed_of_a_hand_is_no_lag() {
    let mut rig = taken(&Build::of(&[]), Motion::constant(1.3));
    rig.ticks(80_000, 2.0);
    let lag_rad = rig.now.angle_rad - rig.leg().angle_rad;
    assert!((lag_rad - 2.0 / 40.0).abs() < 1e-6, "{lag_rad}");
}

#[test]
fn more_than_the_limit_moves_the_hand() {
    let mut rig = taken(&Build::of(&[]), Motion::rest(0.0));
    // Long after the damper has given all that it may: J/b is 8 ms.
    rig.ticks(4_000, 30.0);
    let before_rad_s = rig.leg().omega_rad_s;
    rig.ticks(1_000, 30.0);
    let gained = rig.leg().omega_rad_s - before_rad_s;
    let known = -5.0 / HAND.inertia_kg_m2 * 1_000.0 * TICK_S;
    assert!((gained / known - 1.0).abs() < 1e-6, "{gained}");
    assert!(rig.relative_residual().abs() < 1e-12);
    // It lets go of nothing: with less it comes back.
    rig.ticks(120_000, 0.0);
    assert!(rig.leg().angle_rad.abs() < 1e-6, "{:?}", rig.leg());
}

#[test]
fn a_healthy_leg_goes_along_in_every_posture() {
    for posture in ["sitting", "standing", "prone", "supine"] {
        let build = Build::of(&[("limb", &[])]).choosing("limb", "posture", posture);
        let motion = Motion::Strokes(Strokes {
            from_rad: 0.2,
            to_rad: 1.4,
            peak_speed_rad_s: 3.0,
            pause_s: 1.0,
        });
        let mut rig = taken(&build, motion);
        let mut worst_rad = 0.0_f64;
        for _ in 0..60_000 {
            rig.tick(0.0);
            worst_rad = worst_rad.max((rig.now.angle_rad - rig.leg().angle_rad).abs());
        }
        println!("{posture}: lags by {:.2}°", worst_rad.to_degrees());
        // The damping of the knee, 0.2 N·m·s/rad, is 0.6 N·m.
        assert!(worst_rad < 0.02, "{posture}: {worst_rad}");
    }
}

#[test]
fn a_leg_is_taken_and_released_as_it_moves() {
    let build = Build::of(&[("limb", &[]), ("hand", &[])]);
    let mut rig = build.on(Motion::constant(0.8));
    rig.ticks(2_000, 0.5);
    let before = rig.leg();
    take(&mut rig);
    assert_eq!(rig.leg(), before);
    rig.tick(0.5);
    let Body { omega_rad_s, .. } = rig.leg();
    // 25 N·m of the hand and 25 that swing the leg, on more than 0.4 kg·m².
    assert!((omega_rad_s - before.omega_rad_s).abs() < 120.0 * TICK_S);
    let before = rig.leg();
    rig.plant.release();
    assert_eq!(rig.leg(), before);
    assert_eq!(rig.plant.balance().residual_j(), 0.0);
}

/// Runs a case with a guided hand; returns the largest residual, as a share of all energy that there was and
/// that moved.
fn run(case: &Case) -> Result<f64, TestCaseError> {
    let mut rig = case.rig(1.0);
    take(&mut rig);
    let mut lost_j = 0.0;
    let (mut worst_j, mut most_j) = (0.0_f64, 1e-5_f64);
    for n in 0..4_000 {
        rig.tick(case.asks.torque_nm(n));
        let leg = rig.leg();
        prop_assert!(leg.angle_rad.is_finite() && leg.omega_rad_s.is_finite());
        if n % 8 == 0 {
            let balance = rig.plant.balance();
            let moved_j = balance.turnover_j();
            let now_j = rig.joule("guiding-hand", "damping");
            prop_assert!(now_j >= lost_j - 1e-15 * moved_j, "{lost_j} to {now_j}");
            lost_j = now_j;
            worst_j = worst_j.max(balance.residual_j().abs());
            most_j = most_j.max(moved_j);
        }
    }
    Ok(worst_j / most_j)
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn without_a_leg_its_energy_is_kept_to_rounding(case in case(false)) {
        let open = run(&case)?;
        prop_assert!(open < 1e-9, "{open:.1e} left over");
    }

    #[test]
    fn with_a_leg_its_energy_is_kept_to_the_bends_of_its_torque(case in case(true)) {
        let open = run(&case)?;
        prop_assert!(open < 1e-7, "{open:.1e} left over");
    }
}

/// However a device pushes, a hand that is held still gives no work, and gets back less than it took.
#[test]
fn a_hand_that_is_held_still_is_passive() {
    let mut rig = taken(&Build::of(&[]), Motion::rest(0.0));
    let mut given_j = 0.0;
    for n in 0..60_000_u32 {
        // Up to 40 N·m, beyond the limit, with jumps.
        let torque_nm = f64::from(n / 50 * 7_919 % 81) - 40.0;
        let before_rad = rig.leg().angle_rad;
        rig.tick(torque_nm);
        // Work of the device on hand and arm.
        given_j -= torque_nm * (rig.leg().angle_rad - before_rad);
        assert!(given_j > -1e-9, "{given_j} J at tick {n}");
    }
    assert_eq!(rig.joule("guiding-hand", "work"), 0.0);
    assert!(rig.joule("guiding-hand", "damping") > 0.1);
}
