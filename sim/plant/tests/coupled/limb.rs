//! The leg: released, and led beyond what is known of it.

use crate::support::{Build, Rig, root, through};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const MASS_KG: f64 = 0.061 * 70.0;
const SHANK_M: f64 = 0.246 * 1.75;
const INERTIA: f64 = MASS_KG * 0.735 * 0.735 * SHANK_M * SHANK_M;
const WEIGHT_NM: f64 = MASS_KG * 9.806_65 * 0.606 * SHANK_M;

fn leg(damping: f64) -> Build {
    Build::of(&[("limb", &[("damping_nms_per_rad", damping)])])
        .choosing("limb", "passive", "none")
        .released()
}

/// Hanging is at 90° when sitting; the leg is released this far beside it.
fn swing(damping: f64, beside_rad: f64) -> Rig {
    leg(damping).starting(FRAC_PI_2 + beside_rad, 0.0).at_rest()
}

/// Times at which it passes the hanging leg, and speeds there.
fn passes(rig: &mut Rig, ticks: u32) -> Vec<(f64, f64)> {
    let mut passes = Vec::new();
    for _ in 0..ticks {
        let (before, at) = (rig.leg(), rig.time_s());
        rig.tick(0.0);
        let after = rig.leg();
        let (x, y) = (before.angle_rad - FRAC_PI_2, after.angle_rad - FRAC_PI_2);
        if (x < 0.0) != (y < 0.0) {
            let share = x / (x - y);
            let speed = before.omega_rad_s + share * (after.omega_rad_s - before.omega_rad_s);
            passes.push((at + share * (rig.time_s() - at), speed));
        }
    }
    passes
}

/// The arithmetic-geometric mean.
fn agm(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..40 {
        (a, b) = (f64::midpoint(a, b), (a * b).sqrt());
    }
    a
}

#[test]
fn a_swing_of_any_size_has_the_period_of_the_pendulum() {
    let small_s = TAU * (INERTIA / WEIGHT_NM).sqrt();
    for beside_deg in [0.01_f64, 1.0, 10.0, 45.0, 90.0, 150.0, 175.0] {
        let beside = beside_deg.to_radians();
        let known_s = small_s / agm(1.0, (beside / 2.0).cos());
        let passes = passes(&mut swing(0.0, beside), 200_000);
        let last = (passes.len() - 1) / 2 * 2;
        #[expect(clippy::cast_precision_loss, reason = "small")]
        let found_s = (passes[last].0 - passes[0].0) / (last / 2) as f64;
        let off = found_s / known_s - 1.0;
        println!("{beside_deg}°: {found_s:.9} s, closed form {known_s:.9} s, off {off:.1e}");
        // The midpoint rule is slow by (ω·h)²/12 = 5e-9; more where it is fast.
        assert!(off.abs() < 2e-8);
    }
}

#[test]
fn a_small_swing_decays_as_the_closed_form_does() {
    for damping in [0.0, 0.02, 0.2, 1.0] {
        let beside = 1e-4;
        let mut rig = swing(damping, beside);
        let sigma = damping / (2.0 * INERTIA);
        let damped = (WEIGHT_NM / INERTIA - sigma * sigma).sqrt();
        let mut worst = 0.0_f64;
        for _ in 0..100_000 {
            rig.tick(0.0);
            let t = rig.time_s();
            let (sin, cos) = (damped * t).sin_cos();
            let known = beside * (-sigma * t).exp() * (cos + sigma / damped * sin);
            worst = worst.max((rig.leg().angle_rad - FRAC_PI_2 - known).abs() / beside);
        }
        // Period and decrement, from its passes.
        let passes = passes(&mut swing(damping, beside), 60_000);
        let period_s = passes[2].0 - passes[0].0;
        let decrement = (passes[0].1 / passes[2].1).ln();
        println!(
            "B = {damping}: period {period_s:.8} s, decrement {decrement:.8}; angle off {worst:.1e}"
        );
        assert!((period_s * damped / TAU - 1.0).abs() < 2e-8);
        assert!((decrement - TAU * sigma / damped).abs() < 1e-7);
        assert!(worst < 5e-7);
    }
}

#[test]
fn without_damping_energy_stays() {
    for beside_deg in [5.0_f64, 30.0, 90.0] {
        let mut rig = swing(0.0, beside_deg.to_radians());
        let lowest_j = WEIGHT_NM * (1.0 - beside_deg.to_radians().cos());
        let mut worst = 0.0_f64;
        for n in 0..2_000_000 {
            rig.tick(0.0);
            if n % 64 == 0 {
                worst = worst.max((rig.plant.balance().residual_j() / lowest_j).abs());
            }
        }
        let end = rig.plant.balance().residual_j() / lowest_j;
        println!("{beside_deg}°, 100 s: energy off by at most {worst:.1e}, {end:.1e} at the end");
        assert!(worst < if beside_deg < 10.0 { 1e-9 } else { 1e-7 });
    }
}

/// Weight and passive moment in balance, by another way to write them.
#[test]
fn a_released_leg_comes_to_rest_where_its_torques_cancel() {
    let moment = |hip: f64, knee_rad: f64| {
        let knee = knee_rad * 180.0 / PI;
        (1.8 - 0.0352 * knee + 0.0217 * hip).exp()
            - (-3.971 + 0.0495 * knee - 0.0128 * hip).exp()
            - 4.82
            + (2.22 - 0.15 * knee).exp()
    };
    for (posture, hip, turned) in [
        ("sitting", 90.0, 0.0),
        ("standing", 0.0, FRAC_PI_2),
        ("prone", 0.0, PI),
        ("supine", 90.0, -FRAC_PI_2),
    ] {
        let sum = |knee: f64| WEIGHT_NM * (knee + turned).cos() + moment(hip, knee);
        for start in [0.2, 1.3, 2.4] {
            let mut rig = Build::of(&[("limb", &[("damping_nms_per_rad", 4.0)])])
                .choosing("limb", "posture", posture)
                .released()
                .starting(start, 0.0)
                .at_rest();
            rig.ticks(400_000, 0.0);
            let found = rig.leg().angle_rad;
            let known = root(found - 0.05, found + 0.05, sum);
            println!(
                "{posture} from {start}: rests at {:.4}°, off {:.1e} rad",
                found.to_degrees(),
                found - known
            );
            assert!((found - known).abs() < 1e-10);
            assert!(rig.leg().omega_rad_s.abs() < 1e-10);
        }
    }
}

#[test]
fn a_knee_that_is_back_from_beyond_what_is_known_of_it_is_warned_of() {
    let warnings = |farthest_deg: f64| {
        let v = 5.0 * farthest_deg.to_radians();
        let motion = through(&[(0.0, 0.0), (0.2, v), (0.4, 0.0), (0.6, -v), (0.8, 0.0)]);
        let mut rig = Build::of(&[("limb", &[])]).on(motion);
        rig.ticks(8_000, 0.0);
        assert!((rig.leg().angle_rad - farthest_deg.to_radians()).abs() < 1e-9);
        rig.ticks(8_000, 0.0);
        assert!(rig.leg().angle_rad.abs() < 1e-9);
        rig.plant.warnings()
    };
    for within_deg in [-19.0, 159.0] {
        assert_eq!(warnings(within_deg), [""; 0], "{within_deg}°");
    }
    for beyond_deg in [-21.0, 161.0] {
        let found = warnings(beyond_deg);
        let words = "the knee leaves -20° to 160°";
        assert_eq!(found.len(), 1, "{beyond_deg}°: {found:?}");
        assert!(found[0].starts_with(words), "{beyond_deg}°: {found:?}");
    }
}
