//! Effect of shorter steps.

use crate::support::{Build, Rig, TICK_S};
use crepitus_plant::Motion;
use std::f64::consts::TAU;

const TICKS: u32 = 10_000;

/// Everything that moves.
fn state(rig: &Rig) -> Vec<f64> {
    let (shaft, leg) = (rig.shaft(), rig.leg());
    let mut state = rig.row();
    state.extend([
        shaft.angle_rad,
        shaft.omega_rad_s,
        leg.angle_rad,
        leg.omega_rad_s,
    ]);
    state
}

/// Runs side by side with 1, 2, 4 and 100 steps a tick: the largest distance
/// of the first three from the last, of the shaft's angle and the leg's.
fn distances(build: &Build, motion: &Motion) -> [f64; 3] {
    let rig = |substeps| build.clone().substeps(substeps).on(motion.clone());
    let mut coarse = [1, 2, 4].map(rig);
    let mut fine = rig(100);
    let mut worst = [0.0_f64; 3];
    for n in 0..TICKS {
        let t = f64::from(n) * TICK_S;
        let torque = 1.5 * (TAU * 31.8 * t).sin() + 0.4 * (TAU * 3.0 * t).cos();
        fine.tick(torque);
        for (worst, rig) in worst.iter_mut().zip(&mut coarse) {
            rig.tick(torque);
            assert!(state(rig).iter().all(|x| x.is_finite()));
            let shaft = rig.shaft().angle_rad - fine.shaft().angle_rad;
            let leg = rig.leg().angle_rad - fine.leg().angle_rad;
            *worst = worst.max(shaft.abs()).max(leg.abs());
        }
    }
    worst
}

fn orders([one, two, four]: [f64; 3]) -> (f64, f64) {
    // Against 100 steps a tick, not against the truth: 1/16 − 1/10⁴ and so on.
    ((one / two).log2(), (two / four).log2())
}

#[test]
fn smooth_plants_are_of_second_order() {
    let smooth = [("friction_nm", 0.0), ("load_loss", 0.0)];
    let drivetrain = Build::of(&[("drivetrain", &smooth)]);
    let cuffed = drivetrain.clone().with("cuff", &[]);
    let legged = cuffed.clone().with("limb", &[]).with("hand", &[]);
    let sine = Motion::sine(0.3, 1.5, 0.0);
    for (name, build) in [
        ("cuff", cuffed.clone()),
        ("cuff, hand", cuffed.clone().with("hand", &[])),
        (
            "drivetrain, limb, hand",
            drivetrain.with("limb", &[]).with("hand", &[]),
        ),
        ("cuff, limb, hand", legged.clone()),
        ("motor, cuff", cuffed.with("motor", &[])),
        ("motor, cuff, limb, hand", legged.with("motor", &[])),
    ] {
        let distances = distances(&build, &sine);
        let [one, two, four] = distances;
        let (first, second) = orders(distances);
        println!("{name}: {one:.1e}, {two:.1e}, {four:.1e} rad, orders {first:.3} and {second:.3}");
        // In one step a tick the loop's sample in the middle sees the shaft's
        // mean velocity over the whole tick instead of the first half: an
        // error of the first order, but of microradians.
        if name.starts_with("motor") {
            assert!(one < 5e-5);
        } else {
            assert!((first - 2.0).abs() < 0.05);
        }
        assert!((second - 2.0).abs() < 0.05);
    }
}

/// Teeth part at the beginning of a step, and not inside it: of the first
/// order, and less than 0.1 mrad of a gap of 17 mrad.
#[test]
fn friction_and_backlash_stay_close() {
    let gear = Build::of(&[("drivetrain", &[]), ("backlash", &[])]);
    let sine = Motion::sine(0.3, 1.5, 0.0);
    for (name, build, bound_rad) in [
        (
            "friction, cuff",
            Build::of(&[("drivetrain", &[]), ("cuff", &[])]),
            1e-6,
        ),
        ("gear", gear.clone(), 1e-4),
        ("gear, cuff", gear.clone().with("cuff", &[]), 1e-4),
        (
            "motor, gear, cuff, limb, hand",
            gear.with("motor", &[])
                .with("cuff", &[])
                .with("limb", &[])
                .with("hand", &[]),
            1e-4,
        ),
    ] {
        let distances = distances(&build, &sine);
        let [one, two, four] = distances;
        println!("{name}: {one:.1e}, {two:.1e}, {four:.1e} rad");
        assert!(distances.iter().all(|d| *d < bound_rad));
    }
}
