//! The shell on its seat.

use crate::support::{Build, TICK_S, over, size};
use crepitus_plant::Motion;
use crepitus_plant::plant::Coil;
use std::f64::consts::TAU;

const MASS_KG: f64 = 0.25;
const STIFFNESS: f64 = 4_000.0;
const DAMPING: f64 = 20.0;
const LEVER_M: f64 = 0.3;

/// Amplitude of what a signal has of this frequency, over whole periods.
fn amplitude(signal: &[f64], hertz: f64) -> f64 {
    let mut sum = (0.0, 0.0);
    for (n, value) in (0_u32..).zip(signal) {
        let (sin, cos) = (TAU * hertz * TICK_S * f64::from(n)).sin_cos();
        sum = (sum.0 + value * cos, sum.1 + value * sin);
    }
    let count = u32::try_from(signal.len()).expect("few");
    2.0 * size(sum) / f64::from(count)
}

#[test]
fn a_shell_beside_the_hand_follows_the_leg_as_a_mass_on_its_seat() {
    for hertz in [5.0, 20.0, 50.0, 125.0] {
        let mut rig = Build::of(&[("shell", &[])])
            .choosing("shell", "hand_on", "leg")
            .on(Motion::sine(0.01, hertz, 0.0));
        let mut accelerations = Vec::new();
        for n in 0..20_000 {
            rig.tick(0.0);
            if n >= 12_000 {
                accelerations.push(rig.get("shell_acceleration_m_s2"));
            }
        }
        let omega = TAU * hertz;
        let seat = (STIFFNESS, DAMPING * omega);
        let follows = size(over(seat, (seat.0 - MASS_KG * omega * omega, seat.1)));
        let known = LEVER_M * 0.01 * omega * omega * follows;
        let found = amplitude(&accelerations, hertz);
        let error = (found / known - 1.0).abs();
        println!("{hertz} Hz: {found:.4} m/s², off by {error:.1e}");
        // The midpoint rule: (ωh)²/12 of a frequency, twice in an acceleration.
        assert!(error < 1e-6 + (omega * TICK_S).powi(2) / 4.0);
    }
}

#[test]
fn a_hand_slows_the_shell_that_it_holds() {
    let hertz = 60.0;
    let omega = TAU * hertz;
    let parts: &[(&str, &[(&str, f64)])] = &[("limb", &[]), ("shell", &[]), ("hand", &[])];
    let answers = ["shell", "leg"].map(|held| {
        let mut rig = Build::of(parts)
            .choosing("shell", "hand_on", held)
            .choosing("limb", "passive", "none")
            .choosing("hand", "grip", "firm")
            .on(Motion::rest(1.2));
        let mut shells = Vec::new();
        for n in 0..20_000_u32 {
            rig.tick((omega * TICK_S * f64::from(n)).sin());
            if n >= 12_000 {
                shells.push(rig.get("shell_acceleration_m_s2"));
            }
        }
        amplitude(&shells, hertz)
    });
    // A hand of 0.2 kg on the shell slows it down, on the leg hardly.
    assert!(answers[0] < 0.75 * answers[1], "{answers:?}");
}

#[test]
fn what_the_actuator_gives_a_shell_that_is_held_arrives_whole_and_beside_it_hardly() {
    let share = |held: &str, hertz: f64| {
        let mut rig = Build::of(&[("shell", &[]), ("reaction-mass", &[])])
            .choosing("shell", "hand_on", held)
            .on(Motion::rest(1.2));
        let (mut felt, mut given) = (Vec::new(), Vec::new());
        for n in 0..20_000_u32 {
            let volts = (TAU * hertz * TICK_S * f64::from(n)).sin();
            rig.tick_with(0.0, Coil::Driven(volts));
            if n >= 12_000 {
                felt.push(rig.felt_nm);
                given.push(rig.get("actuator_torque_nm"));
            }
        }
        amplitude(&felt, hertz) / amplitude(&given, hertz)
    };
    for hertz in [25.0, 100.0, 250.0] {
        assert!((share("shell", hertz) - 1.0).abs() < 1e-9);
        let omega = TAU * hertz;
        let seat = (STIFFNESS, DAMPING * omega);
        let known = size(over(seat, (seat.0 - MASS_KG * omega * omega, seat.1)));
        let found = share("leg", hertz);
        assert!(
            (found - known).abs() < 2e-2 * known,
            "{hertz}: {found} {known}"
        );
    }
}
