//! The trainee's arm.

use crate::support::{Build, TICK_S, through};
use crepitus_plant::Motion;
use crepitus_plant::motion::Strokes;
use std::f64::consts::FRAC_PI_2;

const MASS_KG: f64 = 0.554;
const DAMPING: f64 = 6.45;
const STIFFNESS: f64 = 135.0;
const LEVER_M: f64 = 0.35;

const WEIGHT_NM: f64 = 0.061 * 70.0 * 9.806_65 * 0.606 * 0.246 * 1.75;

/// σ and ω_d of the arm alone.
fn arm() -> (f64, f64) {
    let sigma = DAMPING / (2.0 * MASS_KG);
    (sigma, (STIFFNESS / MASS_KG - sigma * sigma).sqrt())
}

#[test]
fn it_gives_way_to_a_step_of_torque_as_mass_spring_and_damper() {
    let mut rig = Build::of(&[("hand", &[])]).at_rest();
    let (sigma, damped) = arm();
    let known_rad = |t: f64| {
        let (sin, cos) = (damped * t).sin_cos();
        let left = (-sigma * t).exp() * (cos + sigma / damped * sin);
        -(1.0 - left) / (STIFFNESS * LEVER_M * LEVER_M)
    };
    let mut worst = 0.0_f64;
    for n in 1..=40_000_u32 {
        rig.tick(1.0);
        let t = f64::from(n) * TICK_S;
        worst = worst.max((rig.leg().angle_rad - known_rad(t)).abs());
        assert!(
            (rig.felt_nm - 1.0).abs() < 1e-9,
            "it feels what is rendered"
        );
    }
    println!("step of 1 N·m: angle off {worst:.1e} rad");
    assert!(worst < 1e-8);
    assert!(rig.relative_residual().abs() < 1e-12);
}

#[test]
fn it_follows_an_intention_as_mass_spring_and_damper() {
    // From rest at once to 0.7 rad/s: it falls behind by a ring.
    let mut rig = Build::of(&[("hand", &[])])
        .starting(0.0, 0.0)
        .on(Motion::constant(0.7));
    let (sigma, damped) = arm();
    let mut worst = 0.0_f64;
    for n in 1..=40_000_u32 {
        rig.tick(0.0);
        let t = f64::from(n) * TICK_S;
        let behind = 0.7 / damped * (-sigma * t).exp() * (damped * t).sin();
        worst = worst.max((0.7 * t - behind - rig.leg().angle_rad).abs());
    }
    println!("from rest to 0.7 rad/s: angle off {worst:.1e} rad");
    assert!(worst < 1e-8);
}

/// Torque of the leg's weight, N·m: sitting, standing, prone and supine.
fn weight_nm(posture: &str, knee_rad: f64) -> f64 {
    WEIGHT_NM
        * match posture {
            "sitting" => knee_rad.cos(),
            "standing" => -knee_rad.sin(),
            "prone" => -knee_rad.cos(),
            _ => knee_rad.sin(),
        }
}

#[test]
fn it_holds_the_leg_without_sagging_and_feels_its_weight() {
    for posture in ["sitting", "standing", "prone", "supine"] {
        for (knee_deg, passive) in [
            (0.0_f64, "none"),
            (30.0, "none"),
            (90.0, "none"),
            (120.0, "none"),
            (45.0, "riener-edrich"),
        ] {
            let knee = knee_deg.to_radians();
            // Brought there from 20° above within half a second.
            let there = Motion::Strokes(Strokes {
                from_rad: knee + 0.35,
                to_rad: knee,
                peak_speed_rad_s: 1.3,
                pause_s: 100.0,
            });
            let mut rig = Build::of(&[("limb", &[]), ("hand", &[("damping_ns_per_m", 30.0)])])
                .choosing("limb", "posture", posture)
                .choosing("limb", "passive", passive)
                .on(there);
            rig.ticks(240_000, 0.0);
            let sag = rig.leg().angle_rad - knee;
            assert!(sag.abs() < 1e-9, "{posture} at {knee_deg}°: {sag:.1e} rad");
            if passive == "none" {
                // What flexes the leg pushes the hand along growing angles.
                let off = rig.felt_nm + weight_nm(posture, knee);
                println!("{posture} at {knee_deg}°: sags {sag:.1e} rad, torque off {off:.1e} N·m");
                assert!(off.abs() < 1e-7);
            }
        }
    }
}

/// The rendered torque moves a held leg by what the arm and the weight's slope
/// allow.
#[test]
fn a_held_leg_gives_way_as_the_arm_does() {
    let mut rig = Build::of(&[("limb", &[]), ("hand", &[("damping_ns_per_m", 30.0)])])
        .choosing("limb", "passive", "none")
        .on(Motion::rest(FRAC_PI_2));
    rig.ticks(240_000, 1e-3);
    let given = rig.leg().angle_rad - FRAC_PI_2;
    // About the hanging leg the weight is a spring of m·g·l.
    let known = -1e-3 / (STIFFNESS * LEVER_M * LEVER_M + WEIGHT_NM);
    println!("1 mN·m moves the held leg by {given:.6e} rad, closed form {known:.6e}");
    assert!((given / known - 1.0).abs() < 1e-6);
}

/// With the motion prescribed the same leg is held by its weight, too.
#[test]
fn a_prescribed_leg_weighs_what_it_weighs() {
    for posture in ["sitting", "standing", "prone", "supine"] {
        for knee in [0.0, 0.4, 1.1, 1.9] {
            let build = Build::of(&[("limb", &[])])
                .choosing("limb", "posture", posture)
                .choosing("limb", "passive", "none");
            let mut rig = build.on(Motion::rest(knee));
            rig.tick(0.25);
            let known = 0.25 - weight_nm(posture, knee);
            assert!((rig.felt_nm - known).abs() < 1e-12);
            // Accelerated by 2 rad/s² about there, from rest.
            let mut rig = build
                .starting(0.0, 0.0)
                .on(through(&[(0.0, 0.0), (1.0, 2.0)]));
            rig.ticks(100, 0.0);
            let middle = (99.5 * TICK_S).powi(2);
            let inertia = 0.061 * 70.0 * (0.735_f64 * 0.246 * 1.75).powi(2);
            let known = 2.0 * inertia + 0.2 * 2.0 * 99.5 * TICK_S - weight_nm(posture, middle);
            assert!((rig.felt_nm - known).abs() < 1e-6);
        }
    }
}
