//! A winding on a bridge: driven, open, and a generator.

use crate::random::case;
use crate::support::{Build, Rig, TICK_S, cases};
use crepitus_plant::Motion;
use crepitus_plant::effects::motor::bridge::{Bridge, DIODE_V, Terminals};
use proptest::prelude::*;

const OHM: f64 = 1.23;
const HENRY: f64 = 0.34e-3;
const TAU_S: f64 = HENRY / OHM;
const SUPPLY_V: f64 = 24.0;
/// Voltage that open terminals hold against a current, V.
const AGAINST_V: f64 = SUPPLY_V + 2.0 * DIODE_V;
/// Kt·N with the defaults, N·m/A.
const CONSTANT: f64 = 0.0389 * 86.0;

fn set(rig: &mut Rig<Bridge>, terminals: Terminals) {
    rig.plant.actuator_mut().set(terminals);
}

fn ampere(rig: &Rig<Bridge>) -> f64 {
    rig.plant.actuator().current_a()
}

fn steps(rig: &mut Rig<Bridge>, steps: u32) {
    (0..steps).for_each(|_| rig.step());
}

/// A current that changes towards another one under a constant voltage.
fn after(from_a: f64, final_a: f64, seconds: f64) -> f64 {
    final_a + (from_a - final_a) * (-seconds / TAU_S).exp()
}

/// Time at which an open bridge has used up a current, s, and the charge
/// until then, A·s. `emf_v` opposes the current.
fn dies_away(from_a: f64, emf_v: f64) -> (f64, f64) {
    let final_a = (-AGAINST_V - emf_v) / OHM;
    let seconds = TAU_S * (1.0 - from_a / final_a).ln();
    (seconds, final_a * seconds + TAU_S * from_a)
}

#[test]
fn a_voltage_fills_the_winding_of_a_locked_rotor() {
    for wanted in [5.0, -12.0, 24.0, 100.0, -100.0] {
        let mut rig = Build::of(&[]).on_bridge(Motion::rest(0.3));
        set(&mut rig, Terminals::Driven(wanted));
        let final_a = wanted.clamp(-SUPPLY_V, SUPPLY_V) / OHM;
        for n in 1..=400_u32 {
            rig.step();
            let known = after(0.0, final_a, f64::from(n) * TICK_S);
            assert!((ampere(&rig) - known).abs() < 1e-13, "{wanted} V, step {n}");
        }
        assert!(rig.relative_residual().abs() < 1e-14);
    }
}

#[test]
fn an_open_bridge_uses_a_current_up_and_stops_at_zero() {
    for omega in [0.0, 2.0, -2.0, 6.0] {
        for volt in [1.0, -1.0, 20.0, -20.0] {
            let mut rig = Build::of(&[]).on_bridge(Motion::constant(omega));
            set(&mut rig, Terminals::Driven(volt));
            steps(&mut rig, 300);
            let from_a = ampere(&rig);
            let sense = from_a.signum();
            let charge = rig.plant.actuator().charge_c();
            let (seconds, known) = dies_away(from_a.abs(), sense * CONSTANT * omega);
            set(&mut rig, Terminals::Open);
            for n in 1..=30_u32 {
                rig.step();
                let left = if f64::from(n) * TICK_S < seconds {
                    let final_a = (-sense * AGAINST_V - CONSTANT * omega) / OHM;
                    after(from_a, final_a, f64::from(n) * TICK_S)
                } else {
                    0.0
                };
                assert!((ampere(&rig) - left).abs() < 1e-12, "step {n}");
            }
            assert_eq!(ampere(&rig), 0.0);
            let found = sense * (rig.plant.actuator().charge_c() - charge);
            assert!((found - known).abs() < 1e-9 * known, "{found} {known}");
            // From here on there is no torque at all.
            let felt = rig.plant.felt_nms();
            steps(&mut rig, 50);
            assert_eq!(rig.plant.felt_nms(), felt);
            assert_eq!(rig.get("motor_torque_nm"), 0.0);
            assert!(rig.relative_residual().abs() < 1e-10);
        }
    }
}

#[test]
fn what_the_diodes_lose_is_their_voltage_times_the_charge() {
    let mut rig = Build::of(&[]).on_bridge(Motion::rest(0.0));
    set(&mut rig, Terminals::Driven(12.0));
    steps(&mut rig, 200);
    let given = rig.joule("motor", "supply");
    let (_, charge) = dies_away(ampere(&rig), 0.0);
    set(&mut rig, Terminals::Open);
    steps(&mut rig, 10);
    let lost = rig.joule("motor", "diodes");
    assert!((lost - 2.0 * DIODE_V * charge).abs() < 1e-9 * lost);
    let back = given - rig.joule("motor", "supply");
    assert!((back - SUPPLY_V * charge).abs() < 1e-9 * back);
    assert_eq!(rig.joule("motor", "field"), 0.0);
}

#[test]
fn faster_than_the_supply_an_open_bridge_generates() {
    let edge = AGAINST_V / CONSTANT;
    for share in [0.5, 0.999, 1.001, 1.5, -0.9, -1.2] {
        let omega = share * edge;
        let mut rig = Build::of(&[]).on_bridge(Motion::constant(omega));
        steps(&mut rig, 400);
        let beyond_v = (CONSTANT * omega.abs() - AGAINST_V).max(0.0);
        let known = -omega.signum() * beyond_v / OHM;
        assert!((ampere(&rig) - known).abs() < 1e-12, "{share}");
        // The motor brakes, and what the supply is given is not more than the work.
        let torque = rig.get("motor_torque_nm");
        assert!((torque + CONSTANT * known).abs() < 1e-11);
        assert!(rig.joule("motor", "supply") <= 0.0);
        assert!(rig.relative_residual().abs() < 1e-12);
    }
}

#[test]
fn shorted_terminals_brake() {
    let ratio = 14_976.0 / 175.0;
    let build = Build::of(&[("motor", &[("gear_ratio", ratio)])]);
    for omega in [0.5, -3.0, 7.0] {
        let mut rig = build.on_bridge(Motion::constant(omega));
        set(&mut rig, Terminals::Driven(0.0));
        steps(&mut rig, 400);
        let brake = rig.get("motor_torque_nm") / omega;
        assert!((brake - (0.0389 * ratio).powi(2) / OHM).abs() < 1e-11);
        assert!((brake - 9.0).abs() < 0.05);
    }
}

/// An emergency off in the middle of a swing: the rotor coasts with what the
/// motor had given it.
#[test]
fn a_free_rotor_coasts() {
    let numbers = [("friction_nm", 0.0), ("load_loss", 0.0)];
    let build = Build::of(&[("drivetrain", &numbers)])
        .starting(0.0, 0.0)
        .released();
    let run = |parts: u32| {
        let mut rig = build.clone().substeps(parts).on_bridge(Motion::rest(0.0));
        set(&mut rig, Terminals::Driven(15.0));
        steps(&mut rig, 100 * parts);
        set(&mut rig, Terminals::Open);
        steps(&mut rig, 4 * parts);
        assert_eq!(ampere(&rig), 0.0);
        let omega = rig.shaft().omega_rad_s;
        steps(&mut rig, 100 * parts);
        assert!((rig.shaft().omega_rad_s - omega).abs() < 1e-13);
        // All of its velocity is the charge that went through the winding.
        let known = CONSTANT * rig.plant.actuator().charge_c() / 0.051;
        assert!((omega - known).abs() < 1e-11);
        assert!(rig.relative_residual().abs() < 1e-12);
        omega
    };
    let (coarse, half, fine) = (run(1), run(2), run(64));
    println!(
        "coasts with {fine:.9} rad/s, {:.1e} off, {:.1e}",
        coarse - fine,
        half - fine
    );
    assert!((half - fine).abs() < 0.26 * (coarse - fine).abs());
}

/// A leg that is thrown faster than the supply can follow is braked by the
/// diodes to the speed at which they cease to conduct.
#[test]
fn a_generator_brakes_a_free_rotor_to_the_edge() {
    let numbers = [("friction_nm", 0.0), ("load_loss", 0.0)];
    let edge = AGAINST_V / CONSTANT;
    for sense in [1.0, -1.0] {
        let mut rig = Build::of(&[("drivetrain", &numbers)])
            .starting(0.0, sense * 1.4 * edge)
            .released()
            .on_bridge(Motion::rest(0.0));
        let mut before = 1.4 * edge;
        for _ in 0..4000 {
            rig.step();
            let speed = sense * rig.shaft().omega_rad_s;
            assert!(speed <= before + 1e-13);
            before = speed;
        }
        assert!((before / edge - 1.0).abs() < 1e-3, "{before} {edge}");
        assert!(rig.joule("motor", "supply") < 0.0);
        assert!(rig.relative_residual().abs() < 1e-12);
    }
}

/// Terminals of a bridge in a step of a random run.
fn terminals(volt: f64, step: u32, every: u32) -> Terminals {
    if (step / every) % 3 == 1 {
        Terminals::Open
    } else {
        Terminals::Driven(volt)
    }
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn energy_is_kept_to_rounding(case in case(false), every in 1..400_u32) {
        let mut rig = case.rig_on_bridge(1.0);
        let mut most_j = 1e-5_f64;
        for n in 0..6000_u32 {
            set(&mut rig, terminals(6.0 * case.asks.torque_nm(n), n, every));
            rig.step();
            prop_assert!(ampere(&rig).is_finite());
            if n % 8 == 0 {
                let balance = rig.plant.balance();
                most_j = most_j.max(balance.turnover_j());
                let open = balance.residual_j().abs() / most_j;
                prop_assert!(open < 1e-9, "{open:.1e} left over at step {n}");
            }
        }
    }

    #[test]
    fn a_mirrored_run_is_the_mirror_of_the_run(case in case(false), every in 1..400_u32) {
        let (mut rig, mut image) = (case.rig_on_bridge(1.0), case.rig_on_bridge(-1.0));
        for n in 0..3000_u32 {
            let volt = 6.0 * case.asks.torque_nm(n);
            set(&mut rig, terminals(volt, n, every));
            set(&mut image, terminals(-volt, n, every));
            rig.step();
            image.step();
            prop_assert_eq!(ampere(&rig), -ampere(&image), "step {}", n);
            let (a, b) = (rig.shaft(), image.shaft());
            prop_assert_eq!((a.angle_rad, a.omega_rad_s), (-b.angle_rad, -b.omega_rad_s));
        }
        prop_assert_eq!(rig.plant.balance(), image.plant.balance());
    }

    /// Open bridge that nobody drives: a current never comes from nothing.
    #[test]
    fn an_open_bridge_takes_energy_only(case in case(false)) {
        let mut rig = case.rig_on_bridge(1.0);
        for _ in 0..3000 {
            rig.step();
            prop_assert!(rig.plant.absorbed_j() >= -1e-12);
        }
    }
}
