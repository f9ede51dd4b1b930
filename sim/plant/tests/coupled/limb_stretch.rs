//! The oval cam against its closed form and its energy.

use crate::support::{Build, TICK_S, knot};
use crepitus_plant::Motion;
use crepitus_plant::energy_balance::Account;

const PULL_N: f64 = 20.0;
const STRAIGHT_M: f64 = 0.06;
const BENT_M: f64 = 0.048;

/// A leg without weight, moment and damping of its own.
fn leg() -> Build {
    Build::of(&[
        (
            "limb",
            &[("body_mass_kg", 1.0), ("damping_nms_per_rad", 0.0)],
        ),
        ("limb-stretch", &[]),
    ])
    .choosing("limb", "passive", "none")
}

fn distance_m(angle_rad: f64) -> f64 {
    (STRAIGHT_M * angle_rad.cos()).hypot(BENT_M * angle_rad.sin())
}

/// T > 0 opposes growing angle.
fn torque_nm(angle_rad: f64) -> f64 {
    let (sin, cos) = angle_rad.sin_cos();
    PULL_N * (STRAIGHT_M * STRAIGHT_M - BENT_M * BENT_M) * sin * cos / distance_m(angle_rad)
}

#[test]
fn a_slow_bend_shows_the_torque_and_the_distance_of_the_oval() {
    // 0 to 2 rad in 10 s.
    let mut rig = leg().on(Motion::constant(0.2));
    let mut most_nm = 0.0_f64;
    for _ in 0..200_000 {
        rig.tick(0.0);
        let now = rig.leg().angle_rad;
        // The column is the mean of the tick.
        let known_nm = torque_nm(now - 0.1 * TICK_S);
        let found_nm = rig.get("limb_stretch_nm");
        assert!((found_nm - known_nm).abs() < 1e-9, "{found_nm} {known_nm}");
        assert!((rig.get("limb_stretch_m") - distance_m(now)).abs() < 1e-15);
        most_nm = most_nm.max(found_nm);
    }
    println!("{most_nm:.4} N·m at most");
    assert!((torque_nm(45.0_f64.to_radians()) - 0.24).abs() < 0.002);
    assert!((most_nm - 0.24).abs() < 0.005);
}

#[test]
fn over_a_loop_it_gives_back_all_that_it_took() {
    let there_and_back = Motion::velocity_knots(&[
        knot(0.0, 0.0, 0.0),
        knot(0.1, 3.0, 3.0),
        knot(0.5, 3.0, 3.0),
        knot(0.6, 0.0, 0.0),
        knot(0.7, -3.0, -3.0),
        knot(1.1, -3.0, -3.0),
        knot(1.2, 0.0, 0.0),
    ]);
    let mut rig = leg().on(there_and_back);
    let stored_j = |rig: &crate::support::Rig| {
        let balance = rig.plant.balance();
        let mut terms = balance.terms().iter();
        let own = terms.find(|t| t.effect == "limb-stretch" && t.account == Account::Stored);
        own.expect("its energy").joule
    };
    let mut work_j = 0.0;
    let (mut most_j, mut before) = (0.0_f64, rig.leg().angle_rad);
    for _ in 0..24_000 {
        rig.tick(0.0);
        let now = rig.leg().angle_rad;
        work_j += rig.get("limb_stretch_nm") * (now - before);
        before = now;
        let known_j = PULL_N * (STRAIGHT_M - distance_m(now));
        assert!((work_j - known_j).abs() < 1e-12, "{work_j} {known_j}");
        assert!((stored_j(&rig) - known_j).abs() < 1e-12);
        most_j = most_j.max(work_j);
    }
    println!("{most_j:.4} J at most, {work_j:.1e} J after the loop");
    // 12 mm of 20 N, but for the last 4° of a right angle.
    assert!((most_j - 0.24).abs() < 2e-3);
    assert!(work_j.abs() < 1e-12);
}

#[test]
fn a_free_leg_swings_on_it_without_loss() {
    let mut rig = leg().released().starting(1.0, 0.0).at_rest();
    let mut worst = 0.0_f64;
    for _ in 0..400_000 {
        rig.tick(0.0);
        let balance = rig.plant.balance();
        worst = worst.max(balance.relative_residual().abs());
    }
    println!("20 s: energy off by at most {worst:.1e}");
    assert!(worst < 1e-9);
}
