//! The rotor behind the gear, and dry friction.

use crate::support::{Build, TICK_S, through};
use crepitus_plant::Motion;
use std::f64::consts::PI;

const INERTIA: f64 = 0.051;
const FRICTION_NM: f64 = 0.5;

fn without_load_loss() -> Build {
    Build::of(&[("drivetrain", &[("load_loss", 0.0)])])
}

#[test]
fn a_hand_that_accelerates_it_feels_inertia_and_friction() {
    // Up, on, down through zero, back to rest.
    let motion = through(&[(0.0, 0.0), (0.1, 2.0), (0.2, 2.0), (0.4, -3.0), (0.5, 0.0)]);
    let mut rig = without_load_loss().on(motion);
    let mut worst = 0.0_f64;
    for n in 0..12_000_u32 {
        rig.tick(0.0);
        let t = (f64::from(n) + 0.5) * TICK_S;
        // The motion passes zero at 0.28 s, between two ticks.
        let (acceleration, sense) = match t {
            t if t < 0.1 => (20.0, 1.0),
            t if t < 0.2 => (0.0, 1.0),
            t if t < 0.4 => (-25.0, if t < 0.28 { 1.0 } else { -1.0 }),
            t if t < 0.5 => (30.0, -1.0),
            _ => (0.0, 0.0),
        };
        let known = INERTIA * acceleration + FRICTION_NM * sense;
        worst = worst.max((rig.felt_nm - known).abs());
    }
    println!("reflected inertia and friction: error {worst:.1e} N·m");
    assert!(worst < 1e-8);
    assert_eq!(rig.felt_nm, 0.0, "at rest nothing is felt");
    assert!(rig.relative_residual().abs() < 1e-12);
}

#[test]
fn it_breaks_away_at_its_friction() {
    for (load_loss, limit_nm) in [(0.0, 0.5), (0.3, 0.5 / 0.7)] {
        for sign in [1.0, -1.0] {
            let build = Build::of(&[("drivetrain", &[("load_loss", load_loss)])]);
            let mut rig = build.clone().starting(0.3, 0.0).released().at_rest();
            rig.ticks(2000, sign * limit_nm * (1.0 - 1e-9));
            assert_eq!((rig.leg().angle_rad, rig.leg().omega_rad_s), (0.3, 0.0));
            rig.tick(sign * (limit_nm + 1e-6));
            let known = -sign * TICK_S * 1e-6 * (1.0 - load_loss) / INERTIA;
            assert!((rig.leg().omega_rad_s / known - 1.0).abs() < 1e-9);
            // Held by the hand, only what goes beyond is felt.
            let mut held = build.on(Motion::rest(0.3));
            held.ticks(10, sign * limit_nm * 0.999);
            assert_eq!(held.felt_nm, 0.0);
            held.ticks(10, sign * (limit_nm + 0.25));
            let known = sign * 0.25 * (1.0 - load_loss);
            assert!((held.felt_nm - known).abs() < 1e-12);
        }
    }
}

#[test]
fn it_comes_to_rest_in_time_and_stays_there() {
    for omega in [1.0, -0.37, 1e-3, 7.3] {
        let mut rig = without_load_loss()
            .starting(0.0, omega)
            .released()
            .at_rest();
        let stop_s = INERTIA * f64::abs(omega) / FRICTION_NM;
        let mut worst = 0.0_f64;
        while rig.time_s() + TICK_S <= stop_s {
            rig.tick(0.0);
            let known = omega - FRICTION_NM / INERTIA * rig.time_s() * omega.signum();
            worst = worst.max((rig.leg().omega_rad_s - known).abs());
        }
        rig.ticks(2, 0.0);
        let at = rig.leg();
        let travel = INERTIA * omega * omega.abs() / (2.0 * FRICTION_NM);
        println!(
            "from {omega} rad/s: speed off {worst:.1e} rad/s, rests off {:.1e} rad",
            at.angle_rad - travel
        );
        // The rest position gives the time of the stop, inside a tick.
        assert!(worst < 1e-12 * omega.abs());
        assert!((at.angle_rad / travel - 1.0).abs() < 1e-11);
        assert_eq!(at.omega_rad_s, 0.0);
        rig.ticks(20_000, 0.0);
        assert_eq!(rig.leg(), at);
        let kinetic_j = 0.5 * INERTIA * omega * omega;
        assert!((rig.joule("drivetrain", "friction") / kinetic_j - 1.0).abs() < 1e-11);
    }
}

#[test]
fn a_load_on_the_gear_costs_its_share() {
    for (torque, omega) in [(1.2, 1.0), (-1.2, 1.0), (0.4, -2.0), (4.5, 0.3)] {
        let mut rig = Build::of(&[("drivetrain", &[])]).on(Motion::constant(omega));
        rig.ticks(100, torque);
        let friction = FRICTION_NM + 0.3 * f64::abs(torque);
        let known = torque + friction * omega.signum();
        assert!((rig.felt_nm - known).abs() < 1e-9);
        assert!((rig.get("gear_friction_nm") - friction * omega.signum()).abs() < 1e-12);
    }
}

/// A mass on a spring with dry friction: each half swing is a harmonic one
/// about ±F/k, so the turns lose 2F/k, until one is within the dead band.
#[test]
fn a_spring_against_dry_friction_decays_in_a_straight_line() {
    let (stiffness, brace) = (120.0, 0.01);
    let mut rig = without_load_loss()
        .with("cuff", &[("damping_nms_per_rad", 0.0)])
        .at_rest();
    // Pushed aside slowly enough to rest there, then released.
    for n in 0..20_000_u32 {
        rig.tick(-8.0 * f64::from(n.min(16_000)) / 16_000.0);
    }
    // The mass crept along, so there is some swing left; let it die first.
    assert_eq!(rig.leg().omega_rad_s, 0.0);
    let start = rig.shaft().angle_rad;
    let lost = 2.0 * FRICTION_NM / stiffness;
    let half_s = PI * ((INERTIA + brace) / stiffness).sqrt();
    let mut turns = vec![start];
    let mut last = rig.shaft();
    let mut at_s = Vec::new();
    for n in 0..40_000_u32 {
        rig.tick(0.0);
        let now = rig.shaft();
        if last.omega_rad_s * now.omega_rad_s < 0.0
            || (last.omega_rad_s != 0.0 && now.omega_rad_s == 0.0)
        {
            turns.push(now.angle_rad);
            at_s.push(f64::from(n + 1) * TICK_S);
        }
        last = now;
    }
    let swings = turns.len() - 1;
    for (n, pair) in turns.windows(2).enumerate() {
        let off = pair[1] + pair[0].signum() * (pair[0].abs() - lost);
        // The turn is within the tick: A·(ω·h)²/2.
        assert!(off.abs() < 2e-7, "half swing {n}: off {off:.1e}");
    }
    for (n, at) in at_s.iter().enumerate() {
        let known = half_s * (f64::from(u32::try_from(n).unwrap()) + 1.0);
        assert!((at - known).abs() < 1.01 * TICK_S, "turn {n}: {at} {known}");
    }
    let rest = turns[swings];
    assert!(rest.abs() < FRICTION_NM / stiffness, "within the dead band");
    assert_eq!((last.angle_rad, last.omega_rad_s), (rest, 0.0));
    let band = FRICTION_NM / stiffness;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "small"
    )]
    let known = ((start - band) / lost).ceil() as usize;
    assert_eq!(swings, known);
    println!("{swings} half swings of {half_s:.6} s, 2F/k = {lost:.6} rad each, rest at {rest:.6}");
}
