//! Two faults at once, and what nothing notices: how bad it gets.

use crate::support::{Host, examination, examination_at};
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_protocol::{Fault, State};
use crepitus_virtual_device::Start;
use crepitus_virtual_device::leg::{CurrentPath, CurrentSensor, EncoderWiring};

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
    let fault = host.device.board().drive().fault();
    println!(
        "dead sensor and comparator: {fault:?} after {ticks} ticks, {most_a:.2} A, {most_nm:.1} N·m"
    );
    assert_eq!(fault, Some(Fault::SpeedMismatch));
    assert!(!host.device.board().is_driven());
}

/// The wire of the line of comms to the drive's pin makes contact now and then. The bridge
/// floats while it does not, so this is not felt for long; it ends, too, however it comes and goes.
#[test]
fn a_line_of_comms_that_comes_and_goes_ends_torque() {
    for (off, on) in [(119, 1), (50, 50), (3, 1), (1, 3)] {
        let mut host = rendering(Host::new(&examination(), &Start::default()), 0.5);
        let ticks = (0..3_000_u64).position(|n| {
            let is_on = n % (off + on) >= off;
            host.device.board_mut().set_comms_line_wire(is_on);
            host.tick();
            host.device.board().drive().fault() == Some(Fault::CommsLineOff)
        });
        assert!(
            ticks.is_some_and(|ticks| ticks < 2_000),
            "{off}, {on}: {ticks:?}"
        );
    }
    let mut host = rendering(Host::new(&examination(), &Start::default()), 0.5);
    for n in 0..20_000_u64 {
        host.device.board_mut().set_comms_line_wire(n % 100 >= 10);
        host.tick();
        assert_eq!(host.device.board().drive().state(), State::Armed, "{n}");
    }
}

/// When it is back, torque grows as after arming.
#[test]
fn torque_that_was_interrupted_comes_back_slowly() {
    let mut host = Host::new(&examination(), &Start::default());
    host.run(400);
    host.set("crepitus.inertia_kg_m2", 0.03);
    host.set("crepitus.static_torque_nm", 1.1);
    host.set("crepitus.kinetic_torque_nm", 1.0);
    host.set("limits.slew_nm_per_s", 50.0);
    host.subscribe();
    let mut host = rendering(host, 0.9);
    host.device.board_mut().set_comms_line_wire(false);
    host.run(60);
    host.samples = Some(Vec::new());
    host.device.board_mut().set_comms_line_wire(true);
    host.run(1_500);
    assert_eq!(host.device.board().drive().state(), State::Armed);
    let samples = host.samples.take().expect("samples");
    let off = (samples.iter()).take_while(|s| !s.flags.has(SampleFlags::ENERGISED));
    let off = off.count();
    assert!(off > 0, "{off}");
    let driven = &samples[off..];
    let mut last_nm = 0.0;
    let mut ramps = 0;
    let mut most_nm: f32 = 0.0;
    for sample in driven {
        let step_nm = sample.torque_nm.abs() - last_nm;
        // 2.5 mN·m a tick are allowed until it is the model's; the model's own jumps are exempt.
        let is_ramp = sample.torque_nm.abs() < 0.9 * sample.model_torque_nm.abs();
        assert!(!is_ramp || step_nm <= 0.003, "{step_nm} N·m in a tick");
        last_nm = sample.torque_nm.abs();
        ramps += usize::from(is_ramp);
        most_nm = most_nm.max(last_nm);
    }
    assert!(most_nm > 0.8, "{most_nm}");
    assert!(ramps > 200, "{ramps}");
}

/// An encoder that freezes under a slow motion shows no difference of speeds
/// that is beyond doubt. The joint stops grating; its torque stays what it
/// was, within Ts.
#[test]
fn an_encoder_that_freezes_under_a_slow_motion_does_no_harm() {
    for (peak_deg_s, is_noticed) in [(15.0, false), (30.0, true)] {
        let host = Host::new(&examination_at(peak_deg_s, 0.2), &Start::default());
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
