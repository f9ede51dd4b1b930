//! Winding, current loop and supply.

use crate::support::{
    Build, Complex, Harmonic, Rig, TICK_S, knot, over, root, size, through, times,
};
use crepitus_plant::Motion;
use std::f64::consts::TAU;

const OHM: f64 = 1.23;
const HENRY: f64 = 0.34e-3;
const SUPPLY_V: f64 = 24.0;
/// Kt·N with the defaults, N·m/A.
const CONSTANT: f64 = 0.0389 * 86.0;

fn motor() -> Build {
    Build::of(&[("motor", &[])])
}

/// The sampled loop. The winding, τ = L/R, is sampled at mid-tick; the voltage
/// computed then is loaded half a tick later, at the end of the tick. With
/// q = e^(−h/2τ) and u(n) the voltage computed at sample n,
///
/// ```text
/// i(n+1) = q²·i(n) + (q·(1 − q)·u(n−1) + (1 − q)·u(n))/R
/// u = K·(z − q²)/(z − 1)·(r − i),   K = g·R/(1 − q²),   g = 1 − e^(−2πfh)
/// ```
///
/// so that i/r = γ·(z + q)/(z² − (1 − γ)·z + γ·q), γ = g/(1 + q).
struct Theory {
    q: f64,
    gamma: f64,
}

impl Theory {
    fn new() -> Self {
        let q = (-OHM * TICK_S / (2.0 * HENRY)).exp();
        let g = 1.0 - (-TAU * 1000.0 * TICK_S).exp();
        Self {
            q,
            gamma: g / (1.0 + q),
        }
    }

    fn response(&self, hertz: f64) -> Complex {
        let (sin, cos) = (TAU * hertz * TICK_S).sin_cos();
        let z = (cos, sin);
        let square = times(z, z);
        let below = (
            square.0 - (1.0 - self.gamma) * z.0 + self.gamma * self.q,
            square.1 - (1.0 - self.gamma) * z.1,
        );
        over((self.gamma * (z.0 + self.q), self.gamma * z.1), below)
    }

    fn bandwidth_hz(&self) -> f64 {
        root(500.0, 5000.0, |f| size(self.response(f)) - 0.5_f64.sqrt())
    }
}

/// A tick with a current setpoint.
fn ask(rig: &mut Rig, ampere: f64) {
    rig.tick(-ampere * CONSTANT);
}

#[test]
fn a_step_of_the_current_is_that_of_the_sampled_loop() {
    let Theory { q, gamma } = Theory::new();
    let mut rig = motor().substeps(2).at_rest();
    let mut whole = motor().at_rest();
    let (mut now, mut next) = (0.0, gamma);
    let (mut worst, mut highest) = (0.0_f64, 0.0_f64);
    for _ in 0..400 {
        ask(&mut rig, 1.0);
        let found = rig.mid("motor_current_a");
        worst = worst.max((found - now).abs());
        highest = highest.max(found);
        // In one step for a tick the sample is taken inside it.
        ask(&mut whole, 1.0);
        let (a, b) = (rig.get("motor_current_a"), whole.get("motor_current_a"));
        assert!((a - b).abs() < 1e-13);
        (now, next) = (
            next,
            (1.0 - gamma) * next - gamma * q * now + gamma * (1.0 + q),
        );
    }
    println!("step of the current: error {worst:.1e} A, highest {highest:.6} A");
    assert!(worst < 1e-13);
    assert!((rig.get("motor_current_a") - 1.0).abs() < 1e-13);
}

fn measured(hertz: f64) -> Complex {
    let mut rig = motor().substeps(2).at_rest();
    let mut harmonic = Harmonic::default();
    for n in 0..6000_u32 {
        let angle = TAU * hertz * TICK_S * f64::from(n);
        ask(&mut rig, 0.5 * angle.sin());
        if n >= 2000 {
            harmonic.add(angle, 2.0 * rig.mid("motor_current_a"));
        }
    }
    harmonic.response()
}

#[test]
fn the_bandwidth_is_that_of_the_sampled_loop() {
    let theory = Theory::new();
    for hertz in [50.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0] {
        let (found, known) = (measured(hertz), theory.response(hertz));
        let off = size((found.0 - known.0, found.1 - known.1));
        assert!(off < 1e-9, "{hertz} Hz: {found:?} {known:?}");
    }
    let bandwidth_hz = theory.bandwidth_hz();
    let gain = size(measured(bandwidth_hz));
    println!("−3 dB at {bandwidth_hz:.2} Hz by theory; gain there {gain:.12}");
    assert!((gain - 0.5_f64.sqrt()).abs() < 1e-9);
    // Between a voltage that is not late and one that is a whole tick late.
    assert!(bandwidth_hz > 1009.0 && bandwidth_hz < 1687.0);
}

#[test]
fn a_held_voltage_fills_the_winding_exponentially() {
    // The setpoint exceeds what 1 V can drive: from the second tick on it is on.
    let mut rig = Build::of(&[("motor", &[("supply_v", 1.0)])])
        .substeps(2)
        .at_rest();
    let closed = |seconds: f64| (1.0 - (-seconds * OHM / HENRY).exp()) / OHM;
    let mut worst = 0.0_f64;
    for n in 0..200_u32 {
        ask(&mut rig, 1.37);
        let at = f64::from(n) * TICK_S;
        if n > 0 {
            worst = worst.max((rig.mid("motor_current_a") - closed(at - TICK_S / 2.0)).abs());
        }
        worst = worst.max((rig.get("motor_current_a") - closed(at)).abs());
    }
    println!("voltage step: error {worst:.1e} A");
    assert!(worst < 1e-14);
}

#[test]
fn the_supply_limits_what_a_turning_shaft_can_be_given() {
    let (mut met, mut short) = (0, 0);
    let mut worst = 0.0_f64;
    for n in -90..=90_i32 {
        let omega = f64::from(n) * 0.1;
        for wanted in [1.3, 0.4, 0.0, -0.4, -1.3] {
            let mut rig = motor().on(Motion::constant(omega));
            (0..600).for_each(|_| ask(&mut rig, wanted));
            let emf_v = CONSTANT * omega;
            let known = wanted.clamp((-SUPPLY_V - emf_v) / OHM, (SUPPLY_V - emf_v) / OHM);
            if known == wanted {
                met += 1;
            } else {
                short += 1;
            }
            let found = rig.get("motor_current_a");
            worst = worst.max((found - known).abs());
            let torque = rig.get("motor_torque_nm");
            assert!(
                (torque + CONSTANT * known).abs() < 1e-11,
                "{omega} {wanted}"
            );
            assert!((rig.felt_nm - torque).abs() < 1e-10, "the hand feels it");
        }
    }
    println!("{met} speeds and currents met, {short} saturated: error {worst:.1e} A");
    assert!(worst < 1e-12 && short > 100);
}

/// The domain's numbers: 347 deg/s is 20.2 V, and 24 V push 1.37 A along up to
/// 6.67 rad/s, against it beyond 7.17 rad/s.
#[test]
fn fast_tests_leave_little_voltage() {
    let ratio = 14_976.0 / 175.0;
    let numbers = [("gear_ratio", ratio)];
    let fast = 347.0_f64.to_radians();
    let build = Build::of(&[("motor", &numbers)]);
    let mut rig = build.on(Motion::constant(fast));
    rig.ticks(600, 0.0);
    let emf_v = rig.get("motor_voltage_v");
    println!("347 deg/s: {emf_v:.3} V");
    assert!((emf_v - 20.2).abs() < 0.05);
    assert!((emf_v - 0.0389 * ratio * fast).abs() < 1e-12);
    // Along a faster motion the current falls short; against it it does not.
    let along = |omega: f64| {
        let mut rig = build.on(Motion::constant(omega));
        rig.ticks(600, -1.37 * 0.0389 * ratio);
        rig.get("motor_current_a")
    };
    let limit = (24.0 - OHM * 1.37) / (0.0389 * ratio);
    assert!((along(limit - 1e-6) - 1.37).abs() < 1e-9);
    assert!(along(limit + 0.01) < 1.37 - 0.02);
    assert!((along(-limit - 0.5) - 1.37).abs() < 1e-9);
}

#[test]
fn shorted_terminals_brake() {
    let ratio = 14_976.0 / 175.0;
    let build = Build::of(&[("motor", &[("supply_v", 1.0), ("gear_ratio", ratio)])]);
    // 1 V cannot hold off the back-EMF: it stays on, and what grows with the
    // speed is what terminals of a constant voltage do, 0 V as well.
    let torque = |omega: f64| {
        let mut rig = build.on(Motion::constant(omega));
        rig.ticks(600, 0.0);
        assert_eq!(rig.get("motor_voltage_v").abs(), 1.0);
        rig.felt_nm
    };
    let known = (0.0389 * ratio).powi(2) / OHM;
    for (slow, fast) in [(1.0, 2.0), (2.0, 7.0), (-1.0, -3.0)] {
        let brake = (torque(fast) - torque(slow)) / (fast - slow);
        println!("{slow} to {fast} rad/s: braked by {brake:.6} N·m·s/rad");
        assert!((brake - known).abs() < 1e-10);
        assert!((brake - 9.0).abs() < 0.05);
    }
}

/// A voltage step on motor and rotor, which have a closed form of the second
/// order: mechanical time constant J·R/(Kt·N)².
#[test]
fn motor_and_rotor_run_up_as_two_lags() {
    let build = Build::of(&[
        ("motor", &[("supply_v", 1.0)]),
        ("drivetrain", &[("friction_nm", 0.0), ("load_loss", 0.0)]),
    ]);
    let inertia = 0.051;
    let (sum, product) = (OHM / HENRY, CONSTANT * CONSTANT / (inertia * HENRY));
    let root = (sum * sum / 4.0 - product).sqrt();
    let (slow, quick) = (-sum / 2.0 + root, -sum / 2.0 - root);
    let mut rig = build.starting(0.0, 0.0).released().at_rest();
    let (mut off_a, mut off_rad_s) = (0.0_f64, 0.0_f64);
    for n in 0..1000_u32 {
        rig.tick(-10.0);
        let t = f64::from(n) * TICK_S;
        let (a, b) = ((slow * t).exp(), (quick * t).exp());
        let ampere = (a - b) / (slow - quick) / HENRY;
        let omega = (1.0 + (quick * a - slow * b) / (slow - quick)) / CONSTANT;
        off_a = off_a.max((rig.get("motor_current_a") - ampere).abs());
        off_rad_s = off_rad_s.max((rig.shaft().omega_rad_s - omega).abs());
    }
    println!(
        "run-up: time constant {:.3} ms, errors {off_a:.1e} A, {off_rad_s:.1e} rad/s",
        -1e3 / slow
    );
    // Of second order in the step: (h/τ)²/12 = 3e-3 of the winding.
    assert!(off_a < 3e-4 && off_rad_s < 1e-5);
    assert!(rig.relative_residual().abs() < 1e-12);
}

#[test]
fn what_the_supply_gives_is_copper_field_and_work() {
    let motions = [
        Motion::constant(7.0),
        Motion::sine(0.8, 1.3, 40.0),
        through(&[(0.0, 0.0), (0.1, 8.0), (0.3, -8.0), (0.4, 0.0)]),
        Motion::velocity_knots(&[
            knot(0.0, 0.0, 3.0),
            knot(0.2, 3.0, -6.0),
            knot(0.35, -6.0, 0.0),
        ]),
    ];
    for motion in motions {
        let mut rig = motor().with("drivetrain", &[]).on(motion);
        for n in 0..10_000_u32 {
            let t = f64::from(n) * TICK_S;
            let jumps = if (n / 700) % 2 == 0 { 1.0 } else { -0.7 };
            rig.tick(3.0 * (TAU * 31.8 * t).sin() + jumps);
        }
        let rest = rig.joule("motor", "supply")
            - rig.joule("motor", "copper")
            - rig.joule("motor", "field")
            + rig.plant.absorbed_j();
        let through = rig.joule("motor", "copper");
        println!(
            "supply {:.3} J, left over {rest:.1e} J",
            rig.joule("motor", "supply")
        );
        assert!(rest.abs() < 1e-12 * through);
        assert!(rig.relative_residual().abs() < 1e-12);
    }
}
