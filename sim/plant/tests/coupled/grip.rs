//! The hand that grips.

use crate::support::{Build, TICK_S};
use crepitus_plant::Motion;

const LEVER_M: f64 = 0.35;

/// Angles and velocities of palm and arm under 1 N·m, by classical Runge-Kutta: a
/// firm grip on nothing else.
fn integrated(mut state: [f64; 4], time_s: f64) -> [f64; 4] {
    let square = LEVER_M * LEVER_M;
    let rate = |[p, v, a, w]: [f64; 4]| {
        let tissue = 600.0 * (p - a) + 20.0 * (v - w);
        [
            v,
            (-1.0 / square - tissue) / 0.2,
            w,
            (tissue - 135.0 * a - 6.45 * w) / 0.554,
        ]
    };
    let steps = 50;
    let h = time_s / f64::from(steps);
    let plus = |s: [f64; 4], k: [f64; 4], h: f64| {
        std::array::from_fn(|place: usize| s[place] + h * k[place])
    };
    for _ in 0..steps {
        let a = rate(state);
        let b = rate(plus(state, a, h / 2.0));
        let c = rate(plus(state, b, h / 2.0));
        let d = rate(plus(state, c, h));
        for (place, value) in state.iter_mut().enumerate() {
            *value += h / 6.0 * (a[place] + 2.0 * b[place] + 2.0 * c[place] + d[place]);
        }
    }
    state
}

#[test]
fn it_gives_way_as_palm_tissue_and_arm() {
    let mut rig = Build::of(&[("hand", &[])])
        .choosing("hand", "grip", "firm")
        .at_rest();
    let mut state = [0.0; 4];
    let mut worst = 0.0_f64;
    for _ in 0..20_000 {
        rig.tick(1.0);
        state = integrated(state, TICK_S);
        worst = worst
            .max((rig.leg().angle_rad - state[0]).abs())
            .max((rig.get("arm_angle_rad") - state[2]).abs());
        assert!(
            (rig.felt_nm - 1.0).abs() < 1e-9,
            "it feels what is rendered"
        );
    }
    println!("step of 1 N·m: angle off {worst:.1e} rad");
    assert!(worst < 1e-6);
    assert!(rig.relative_residual().abs() < 1e-12);
}

#[test]
fn every_grip_carries_the_leg_and_follows_the_motion() {
    for grip in ["light", "firm", "whole-arm"] {
        let mut rig = Build::of(&[("limb", &[]), ("hand", &[])])
            .choosing("hand", "grip", grip)
            .choosing("limb", "passive", "none")
            .on(Motion::rest(0.4));
        for _ in 0..40_000 {
            rig.tick(0.0);
        }
        assert!(
            (rig.leg().angle_rad - 0.4).abs() < 1e-9,
            "{grip}: it does not sag"
        );
        let moved = Build::of(&[("hand", &[])])
            .choosing("hand", "grip", grip)
            .on(Motion::constant(0.5));
        let mut rig = moved;
        for _ in 0..40_000 {
            rig.tick(0.0);
        }
        assert!((rig.leg().omega_rad_s - 0.5).abs() < 1e-6);
        assert!(rig.relative_residual().abs() < 1e-9);
    }
}

#[test]
fn the_firmer_the_grip_the_less_it_moves_at_100_hz() {
    let shakes = |grip: &str| {
        let mut rig = Build::of(&[("hand", &[])])
            .choosing("hand", "grip", grip)
            .at_rest();
        let mut most = 0.0_f64;
        for n in 0..20_000_u32 {
            rig.tick(0.1 * (std::f64::consts::TAU * 100.0 * TICK_S * f64::from(n)).sin());
            if n > 16_000 {
                most = most.max(rig.get("hand_acceleration_m_s2").abs());
            }
        }
        most
    };
    let [light, firm, whole] = ["light", "firm", "whole-arm"].map(shakes);
    println!("0.1 N·m at 100 Hz: {light:.2}, {firm:.2}, {whole:.2} m/s²");
    assert!(light > firm && firm > whole);
    // Little more than a mass: F/m, with F = 0.1 N·m / 0.35 m.
    assert!((firm - 0.1 / LEVER_M / 0.2).abs() < 0.15);
}
