//! Numbers at the ends of their ranges.

use crate::support::{Build, Rig, knot};
use crepitus_plant::Motion;

fn jumps() -> Motion {
    Motion::velocity_knots(&[
        knot(0.0, 0.0, 2.0),
        knot(0.02, 2.0, -5.0),
        knot(0.03, -5.0, 0.0),
        knot(0.031, 0.0, 0.0),
        knot(0.05, 0.0, 8.0),
        knot(0.050_05, -8.0, 0.5),
        knot(0.1, 0.0, 0.0),
    ])
}

/// Runs for a quarter of a second with a torque that reverses; returns it with
/// everything checked.
fn holds_out(build: &Build, motion: Motion) -> Rig {
    let mut rig = build.on(motion);
    let half_rad = build.gap_rad() / 2.0;
    let mut most_j = 1e-6_f64;
    for n in 0..5000_u32 {
        rig.tick(if (n / 37).is_multiple_of(2) {
            2.0
        } else {
            -1.5
        });
        assert!(rig.row().iter().all(|x| x.is_finite()), "{build:?}");
        assert!(rig.felt_nm.is_finite());
        if half_rad > 0.0 {
            assert!(rig.get("gap_rad").abs() <= half_rad, "{build:?}");
        }
        let balance = rig.plant.balance();
        most_j = most_j.max(balance.turnover_j());
        let open = balance.residual_j().abs() / most_j;
        assert!(open < 1e-8, "{open:.1e} left over at tick {n}: {build:?}");
    }
    rig
}

fn frictions() -> [Build; 3] {
    [0.0, 0.5, 100.0].map(|friction| Build::of(&[("drivetrain", &[("friction_nm", friction)])]))
}

#[test]
fn a_cuff_as_stiff_as_can_be() {
    let hard = [
        ("stiffness_nm_per_rad", 1e6),
        ("brace_inertia_kg_m2", 1e-5),
        ("damping_nms_per_rad", 0.0),
    ];
    let damped = [hard[0], hard[1], ("damping_nms_per_rad", 1e3)];
    for cuff in [hard, damped] {
        holds_out(&Build::of(&[("cuff", &cuff)]), jumps());
        for build in frictions() {
            holds_out(&build.clone().with("cuff", &cuff), jumps());
            holds_out(
                &build.clone().with("backlash", &[]).with("cuff", &cuff),
                jumps(),
            );
            let motored = build.with("motor", &[]).with("backlash", &[]);
            holds_out(&motored.clone().with("cuff", &cuff), jumps());
            holds_out(&motored.with("cuff", &cuff).with("hand", &[]), jumps());
        }
    }
}

#[test]
fn gaps_from_nothing_to_a_right_angle() {
    for gap_deg in [1e-6, 1e-3, 1.0, 90.0] {
        for build in frictions() {
            let build = build.with("backlash", &[("gap_deg", gap_deg)]);
            for motion in [jumps(), Motion::rest(0.2), Motion::sine(0.2, 5.0, 0.0)] {
                holds_out(&build, motion.clone());
                holds_out(&build.clone().with("hand", &[]), motion.clone());
                holds_out(&build.clone().with("cuff", &[]).with("motor", &[]), motion);
            }
        }
    }
}

#[test]
fn the_lightest_and_the_heaviest() {
    for inertia in [1e-6, 10.0] {
        let light = Build::of(&[("drivetrain", &[("inertia_kg_m2", inertia)])]);
        for build in [
            light.clone(),
            light.clone().with("backlash", &[]),
            light.clone().with("motor", &[]).with("backlash", &[]),
            light.with("hand", &[("mass_kg", 1e-3), ("lever_m", 0.01)]),
        ] {
            holds_out(&build, jumps());
        }
    }
}

#[test]
fn rest_is_rest() {
    for build in frictions() {
        for build in [build.clone(), build.with("backlash", &[])] {
            // Friction of 0 gives way to any torque; but nothing is asked for.
            let mut rig = build.on(Motion::rest(0.7));
            rig.ticks(2000, 0.0);
            assert_eq!(rig.shaft().omega_rad_s, 0.0);
            assert_eq!((rig.leg().angle_rad, rig.felt_nm), (0.7, 0.0));
        }
    }
    // Held by more than is asked for, it stays to the last bit.
    let held = Build::of(&[("drivetrain", &[("load_loss", 0.0)]), ("backlash", &[])]);
    for build in [
        held.clone(),
        held.clone().with("cuff", &[]),
        held.with("hand", &[]),
    ] {
        let mut rig = build.on(Motion::rest(0.7));
        for n in 0..4000_u32 {
            rig.tick(0.49 * f64::from(n).sin());
            assert_eq!(rig.shaft().angle_rad, 0.7);
            assert_eq!((rig.leg().angle_rad, rig.felt_nm), (0.7, 0.0));
        }
    }
}
