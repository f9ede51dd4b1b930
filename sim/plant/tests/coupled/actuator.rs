//! The reaction mass with its coil.

use crate::support::{Build, TICK_S};
use crepitus_plant::Motion;
use crepitus_plant::plant::Coil;
use std::f64::consts::TAU;

const MASS_KG: f64 = 0.06;
const CONSTANT: f64 = 1.1;
const OHM: f64 = 1.8;
const HENRY: f64 = 2e-4;
const LEVER_M: f64 = 0.3;
const OMEGA: f64 = TAU * 35.0;

/// Damping of the flexure by itself.
fn damping() -> f64 {
    let electric = CONSTANT * CONSTANT / (2.0 * OHM * MASS_KG * OMEGA);
    2.0 * (0.13 - electric) * MASS_KG * OMEGA
}

/// Excursion, velocity and current of a mass on a fixture, by classical Runge-Kutta
/// in a tenth of a microsecond; without a voltage the coil is open.
fn integrated(volts: Option<f64>, mut state: [f64; 3], time_s: f64) -> [f64; 3] {
    let rate = |[x, v, i]: [f64; 3]| {
        let force = -MASS_KG * OMEGA * OMEGA * x - damping() * v;
        match volts {
            Some(volts) => [
                v,
                (force - CONSTANT * i) / MASS_KG,
                (volts - OHM * i + CONSTANT * v) / HENRY,
            ],
            None => [v, force / MASS_KG, 0.0],
        }
    };
    let h = 1e-6;
    let plus =
        |s: [f64; 3], k: [f64; 3], h: f64| [s[0] + h * k[0], s[1] + h * k[1], s[2] + h * k[2]];
    let mut t = 0.0;
    while t < time_s - h / 2.0 {
        let a = rate(state);
        let b = rate(plus(state, a, h / 2.0));
        let c = rate(plus(state, b, h / 2.0));
        let d = rate(plus(state, c, h));
        for (place, value) in state.iter_mut().enumerate() {
            *value += h / 6.0 * (a[place] + 2.0 * b[place] + 2.0 * c[place] + d[place]);
        }
        t += h;
    }
    state
}

#[test]
fn a_voltage_moves_the_mass_as_coil_flexure_and_damper() {
    let mut errors = Vec::new();
    for substeps in [1, 4, 16, 64] {
        let mut rig = Build::of(&[("reaction-mass", &[])])
            .substeps(substeps)
            .at_rest();
        let mut state = [0.0; 3];
        let mut worst = 0.0_f64;
        for n in 0..1_200 {
            let volts = if n < 400 { 1.2 } else { -0.4 };
            rig.tick_with(0.0, Coil::Driven(volts));
            state = integrated(Some(volts), state, TICK_S);
            worst = worst
                .max((rig.get("excursion_m") - state[0]).abs() / 1e-3)
                .max((rig.get("coil_current_a") - state[2]).abs());
        }
        errors.push(worst);
    }
    println!("excursion in mm and current in A off: {errors:?} for 1, 4, 16, 64 steps a tick");
    // Second order: a sixteenth for a quarter of the step.
    assert!(errors[0] < 2e-2 && errors[3] < 1e-5);
    assert!((10.0..24.0).contains(&(errors[1] / errors[2])));
    assert!((12.0..20.0).contains(&(errors[2] / errors[3])));
}

#[test]
fn the_carrier_gets_what_accelerates_the_mass() {
    let mut rig = Build::of(&[("reaction-mass", &[])]).at_rest();
    let mut momentum = 0.0;
    let mut velocity = 0.0;
    let mut before = 0.0;
    for n in 0..400_u32 {
        let volts = (f64::from(n) * 0.1).sin();
        rig.tick_with(0.0, Coil::Driven(volts));
        let x = rig.get("excursion_m");
        velocity = 2.0 * (x - before) / TICK_S - velocity;
        before = x;
        // Positive opposes growing angle, so it is what the mass gets.
        momentum += rig.get("actuator_torque_nm") / LEVER_M * TICK_S;
        assert!((momentum - MASS_KG * velocity).abs() < 1e-12);
        assert!((rig.felt_nm - rig.get("actuator_torque_nm")).abs() < 1e-12);
    }
    // At first a voltage pushes the carrier towards growing angle: it has to be held.
    let mut rig = Build::of(&[("reaction-mass", &[])]).at_rest();
    rig.tick_with(0.0, Coil::Driven(2.0));
    assert!(rig.get("actuator_torque_nm") < 0.0);
}

#[test]
fn an_open_coil_leaves_the_mass_to_its_flexure() {
    let mut rig = Build::of(&[("reaction-mass", &[])]).substeps(16).at_rest();
    for _ in 0..300 {
        rig.tick_with(0.0, Coil::Driven(1.0));
    }
    let x = rig.get("excursion_m");
    rig.tick_with(0.0, Coil::Driven(1.0));
    let slope = (rig.get("excursion_m") - x) / TICK_S;
    // The velocity at the end of that tick is known to the first order only: fit it.
    let start_m = rig.get("excursion_m");
    let mut ticks = Vec::new();
    for _ in 0..2_000 {
        rig.tick_with(0.0, Coil::Open);
        assert_eq!(rig.get("coil_current_a"), 0.0);
        ticks.push(rig.get("excursion_m"));
    }
    let first = integrated(None, [start_m, slope, 0.0], TICK_S)[0];
    let sensitivity = (integrated(None, [start_m, slope + 1e-3, 0.0], TICK_S)[0] - first) / 1e-3;
    let velocity = slope + (ticks[0] - first) / sensitivity;
    let mut state = [start_m, velocity, 0.0];
    for (n, x) in ticks.iter().enumerate() {
        state = integrated(None, state, TICK_S);
        assert!((x - state[0]).abs() < 2e-8, "{n}: {x} {}", state[0]);
    }
    let most = ticks[1_900..]
        .iter()
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!(most < start_m.abs() * 0.4 && most > 1e-6);
}

#[test]
fn its_energy_is_booked_through_stops_switching_and_turning() {
    let mut knocks = 0.0;
    for (on, seed) in [("shell", 3), ("brace", 8)] {
        for held in ["shell", "leg"] {
            let mut rig = Build::of(&[
                ("drivetrain", &[]),
                ("cuff", &[]),
                ("limb", &[]),
                ("shell", &[]),
                ("reaction-mass", &[]),
                ("hand", &[]),
            ])
            .choosing("reaction-mass", "on", on)
            .choosing("shell", "hand_on", held)
            .choosing("hand", "grip", "firm")
            .on(Motion::sine(0.3, 1.3, 10.0));
            let mut random = fastrand::Rng::with_seed(seed);
            for n in 0..30_000_u32 {
                let square = (TAU * 35.0 * TICK_S * f64::from(n)).sin().signum();
                let coil = match (n / 2_000) % 4 {
                    0 => Coil::Driven(5.0 * square),
                    1 => Coil::Driven(6.0 * random.f64() - 3.0),
                    2 => Coil::Open,
                    _ => Coil::Driven(0.0),
                };
                rig.tick_with(0.3 * square, coil);
            }
            let residual = rig.relative_residual();
            knocks += rig.get("stop_knocks");
            println!("{on}, hand on the {held}: residual {residual:.1e}");
            // A leg keeps it to the bends of its torque.
            assert!(residual.abs() < 1e-9);
            assert!(rig.joule("reaction-mass", "copper") > 0.1);
            assert!(rig.joule("reaction-mass", "stops") > 0.0);
        }
    }
    assert!(knocks > 20.0, "{knocks}");
}

#[test]
fn a_mass_at_its_stops_stays_there_and_says_so() {
    let mut rig = Build::of(&[("reaction-mass", &[])]).at_rest();
    let mut most = 0.0_f64;
    for n in 0..20_000_u32 {
        let square = (TAU * 35.0 * TICK_S * f64::from(n)).sin().signum();
        rig.tick_with(0.0, Coil::Driven(5.0 * square));
        most = most.max(rig.get("excursion_m").abs());
    }
    println!("beyond the stops: {:.2} mm of 1.6", most * 1e3);
    assert!((1.6e-3..2.2e-3).contains(&most));
    let warnings = rig.plant.warnings();
    assert!(
        warnings.iter().any(|w| w.contains("met its stops")),
        "{warnings:?}"
    );
}

#[test]
fn the_bridge_gives_no_more_than_its_supply() {
    let mut rig = Build::of(&[("reaction-mass", &[("supply_v", 3.0)])]).at_rest();
    rig.tick_with(0.0, Coil::Driven(-9.0));
    assert_eq!(rig.get("coil_voltage_v"), -3.0);
    assert!(rig.plant.coil_current_a().is_some_and(|a| a < 0.0));
    assert_eq!(
        Build::of(&[("cuff", &[])]).at_rest().plant.coil_current_a(),
        None
    );
}

#[test]
fn weight_lets_it_sag_as_far_as_the_posture_says() {
    for (posture, knee_rad) in [("sitting", 0.3_f64), ("prone", 0.7), ("standing", 0.5)] {
        let mut rig = Build::of(&[("limb", &[]), ("reaction-mass", &[])])
            .choosing("limb", "posture", posture)
            .on(Motion::rest(knee_rad));
        for _ in 0..20_000 {
            rig.tick(0.0);
        }
        let pull = match posture {
            "sitting" => knee_rad.cos(),
            "prone" => -knee_rad.cos(),
            _ => -knee_rad.sin(),
        };
        let sag_m = 9.806_65 / (OMEGA * OMEGA) * pull;
        assert!((rig.get("excursion_m") - sag_m).abs() < 1e-9, "{posture}");
    }
}
