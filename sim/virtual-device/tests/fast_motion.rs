//! Fast motion with bridge and amplifiers as they are: the two sensors of the current differ by what the later half's
//! amplifier has not settled, and that is no fault.

mod support;

use crepitus_protocol::State;
use crepitus_virtual_device::Start;
use crepitus_virtual_device::leg::{CurrentPath, CurrentSensor};
use support::{Host, scene};

/// A leg that is moved to and fro at up to 5.5 rad/s against the torque of a lead pipe. Amplifiers are thrown off by two and
/// a half times the bound.
const FAST: &str = r#"
version = 1
title = "Fast motion"
duration_s = 60.0
[motion]
kind = "strokes"
from_deg = 5.0
to_deg = 115.0
peak_speed_deg_s = 315.0
pause_s = 0.05
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.crepitus]
preset = "coarse"
[effects.lead-pipe]
torque_nm = 1.0
[effects.encoder]
[effects.motor]
dead_time_us = 0.4
lag_us = 0.43
bridge_dead_time_us = 0.4
amplifier_lag_us = 0.5
amplifier_excursion_a = 0.8
[effects.drivetrain]
"#;

const TICKS: u64 = 1_000_000;

#[test]
fn a_million_ticks_of_fast_motion_are_no_disagreement_of_the_currents() {
    let mut host = Host::new(&scene(FAST), &Start::default());
    host.run(2_000);
    host.arm();
    // Shunts and amplifiers of 1 % each, at opposite ends.
    let leg = host.device.board_mut().leg_mut();
    leg.set_current_sensor(CurrentPath::Sensor, CurrentSensor::Gain(1.02));
    leg.set_current_sensor(CurrentPath::Monitor, CurrentSensor::Gain(0.98));
    let (mut fast, mut most_apart_a) = (0_u64, 0.0_f64);
    for _ in 0..TICKS / 20 {
        host.run(20);
        let leg = host.device.board().leg();
        fast += u64::from(leg.shaft().omega_rad_s.abs() > 4.5);
        let apart_a = leg.current_a(CurrentPath::Sensor) - leg.current_a(CurrentPath::Monitor);
        most_apart_a = most_apart_a.max(apart_a.abs());
        let fault = host.device.board().drive().fault();
        assert_eq!(fault, None, "at {:?}", leg.shaft());
    }
    let status = host.status();
    assert_eq!(
        (status.state, status.drive_fault, status.comms_fault),
        (State::Armed, 0, 0)
    );
    println!(
        "{TICKS} ticks, {} of them beyond 4.5 rad/s; sensors up to {most_apart_a:.3} A apart at the end of a tick",
        20 * fast
    );
    assert!(20 * fast > TICKS / 20, "{fast}");
}
