//! Two faults at once, and what nothing notices: how bad it gets.

use crate::support::{Host, examination, scene};
use crepitus_board::Start;
use crepitus_board::leg::{CurrentPath, CurrentSensor, EncoderWiring};
use crepitus_protocol::State;

/// Armed, on a leg that moves faster than this, rad/s.
fn rendering(mut host: Host, omega_rad_s: f64) -> Host {
    host.run(400);
    host.arm();
    while host.device.board().leg().shaft().omega_rad_s < omega_rad_s {
        host.tick();
    }
    assert_eq!(host.device.board().drive().state(), State::Armed);
    host
}

/// The current sensor shows nothing, and the comparator is as blind: the loop
/// is open. What ends it is what encoder and voltage say of the speed.
#[test]
fn a_dead_sensor_without_a_comparator_ends_by_the_speed() {
    let mut host = rendering(Host::new(&examination(), &Start::default()), 0.5);
    let board = host.device.board_mut();
    board.set_trip(false);
    for path in [CurrentPath::Sensor, CurrentPath::Monitor] {
        board
            .leg_mut()
            .set_current_sensor(path, CurrentSensor::StuckAt(0.0));
    }
    let (mut ticks, mut most_a, mut most_nm) = (0, 0.0_f64, 0.0_f64);
    while host.device.board().drive().state() == State::Armed {
        host.tick();
        ticks += 1;
        let leg = host.device.board().leg();
        most_a = most_a.max(leg.winding_current_a().abs());
        most_nm = most_nm.max(leg.motor_nm().abs());
        assert!(ticks < 5_000, "not noticed");
    }
    println!(
        "dead sensor and comparator: {:?} after {ticks} ticks, {most_a:.2} A, {most_nm:.1} N·m",
        host.device.board().drive().fault()
    );
    assert!(!host.device.board().is_driven());
}

/// An encoder that freezes under a slow motion shows no difference of speeds
/// that is beyond doubt. The joint stops grating; its torque stays what it
/// was, within Ts.
#[test]
fn an_encoder_that_freezes_under_a_slow_motion_does_no_harm() {
    for (peak_deg_s, is_noticed) in [(15.0, false), (30.0, true)] {
        let text = format!(
            r#"
version = 1
title = "Slow"
duration_s = 60.0
[motion]
kind = "strokes"
from_deg = 10.0
to_deg = 80.0
peak_speed_deg_s = {peak_deg_s}
pause_s = 0.2
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.crepitus]
preset = "coarse"
[effects.encoder]
[effects.motor]
[effects.drivetrain]
[effects.cuff]
[effects.limb]
[effects.hand]
"#
        );
        let host = Host::new(&scene(&text), &Start::default());
        let mut host = rendering(host, 0.2);
        host.device
            .board_mut()
            .leg_mut()
            .set_encoder_wiring(EncoderWiring::Unplugged);
        let mut most_nm = 0.0_f64;
        for _ in 0..40_000 {
            host.tick();
            most_nm = most_nm.max(host.device.board().leg().motor_nm().abs());
        }
        let fault = host.device.board().drive().fault();
        println!("frozen encoder, strokes of {peak_deg_s} deg/s: {fault:?}, {most_nm:.2} N·m");
        assert_eq!(fault.is_some(), is_noticed);
        assert!(most_nm < 0.5, "{most_nm} N·m");
    }
}
