//! The range of motion, with both controllers: the torque fades before its ends,
//! there is none beyond them, and arming needs a zero and a leg inside.

mod support;

use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::telemetry::{Sample, SampleFlags};
use crepitus_protocol::{DeviceSettings, Fault, LimitReason, State, Values};
use crepitus_virtual_device::Start;
use crepitus_virtual_device::leg::EncoderWiring;
use support::{Host, examination};

/// A leg that is bent from 10° to 80° and back.
fn bending() -> Host {
    let mut host = Host::new(&examination(), &Start::default());
    host.run(400);
    host
}

/// Returns the faults of the drive, and of comms.
fn board_faults(host: &Host) -> (Option<Fault>, Option<Fault>) {
    let board = host.device.board();
    (board.drive().fault(), board.comms().fault())
}

fn refused(answer: Result<Answer, Refusal>) -> DriveRefusal {
    match answer {
        Err(Refusal::Drive(refusal)) => refusal,
        other => panic!("{other:?}"),
    }
}

/// Share of the torque at a count, by angles.
fn share(count: i32, range_deg: [f64; 3]) -> f64 {
    let settings = DeviceSettings::of(&Values::default()).expect("the defaults");
    let [least, most, fade] = range_deg;
    let deg = (f64::from(count) * settings.encoder.rad_per_count()).to_degrees();
    ((deg - least).min(most - deg) / fade).clamp(0.0, 1.0)
}

#[test]
fn the_torque_fades_before_an_end_and_there_is_none_beyond() {
    let mut host = bending();
    host.set("range.most_deg", 30.0);
    host.set("range.fade_deg", 10.0);
    host.subscribe();
    host.samples = Some(Vec::new());
    host.arm();
    // The zero is at 10°: from 30° on it fades, from 40° on there is none, 50° are a
    // fault.
    while host.device.board().leg().shaft().angle_rad.to_degrees() < 48.0 {
        host.tick();
    }
    assert_eq!(host.device.board().drive().state(), State::Armed);
    let samples = host.samples.take().expect("samples");
    let end = samples.last().expect("samples").count;
    assert_eq!(share(end, [-5.0, 30.0, 10.0]), 0.0);
    let mut seen = [0; 3];
    let armed = |sample: &&Sample| sample.flags.has(SampleFlags::ENERGISED);
    // Torque begins at zero, and grows to the model's.
    for sample in samples.iter().filter(armed).skip(100) {
        let share = share(sample.count, [-5.0, 30.0, 10.0]);
        let expected_nm = f64::from(sample.model_torque_nm) * share;
        let off_nm = f64::from(sample.torque_nm) - expected_nm;
        let fades = sample.flags.limit() == LimitReason::Range;
        if sample.flags.limit() == LimitReason::None || fades {
            assert_eq!(fades, share < 1.0, "{sample:?}");
        }
        if fades {
            assert!(off_nm.abs() < 1e-4, "{off_nm} N·m, {sample:?}");
        }
        seen[if share == 0.0 { 2 } else { usize::from(fades) }] += 1;
    }
    assert!(seen.iter().all(|&n| n > 1_000), "{seen:?}");
}

#[test]
fn arming_needs_a_zero_and_a_leg_inside() {
    let mut host = bending();
    host.renew_every = Some(1_000);
    let answer = host.ask_patiently(Operation::Arm);
    assert_eq!(refused(answer), DriveRefusal::NotZeroed);
    host.set("range.most_deg", 20.0);
    assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done));
    while host.device.board().leg().shaft().angle_rad.to_degrees() < 31.0 {
        host.tick();
    }
    let answer = host.ask_patiently(Operation::Arm);
    assert_eq!(refused(answer), DriveRefusal::OutsideRange);
    // Where it is now is inside, by another zero.
    assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done));
    assert_eq!(host.ask_patiently(Operation::Arm), Ok(Answer::Done));
}

#[test]
fn counts_in_doubt_end_the_zero() {
    let mut host = bending();
    host.arm();
    assert!(host.status().zeroed);
    let board = host.device.board_mut();
    board.leg_mut().set_encoder_wiring(EncoderWiring::Unplugged);
    while host.device.board().drive().state() == State::Armed {
        host.tick();
    }
    let board = host.device.board_mut();
    board.leg_mut().set_encoder_wiring(EncoderWiring::Right);
    host.run(100);
    assert!(!host.status().zeroed);
    assert_eq!(host.ask_patiently(Operation::ClearFault), Ok(Answer::Done));
    let answer = host.ask_patiently(Operation::Arm);
    assert_eq!(refused(answer), DriveRefusal::NotZeroed);
}

/// While nobody looks, too: the counter jumps, and after a millisecond it is taken
/// for the angle.
#[test]
fn a_counter_that_jumps_while_disarmed_ends_the_zero() {
    let mut host = bending();
    assert_eq!(host.ask_patiently(Operation::Zero), Ok(Answer::Done));
    host.run(200);
    assert!(host.status().zeroed);
    let leg = host.device.board_mut().leg_mut();
    leg.preset_count(leg.count().wrapping_add(5_000));
    host.run(200);
    assert!(!host.status().zeroed);
}

/// While it is being armed, whenever: there is never torque about an invalid zero.
#[test]
fn a_counter_that_jumps_while_arming_ends_it() {
    for ticks in (0..500).step_by(9) {
        let mut host = bending();
        assert_eq!(host.ask_patiently(Operation::Zero), Ok(Answer::Done));
        host.renew_every = Some(1_000);
        let request = host.request(Operation::Arm);
        host.say(&request);
        host.run(ticks);
        let leg = host.device.board_mut().leg_mut();
        leg.preset_count(leg.count().wrapping_add(5_000));
        // The jump is taken for the angle after 21 ticks.
        host.run(40);
        for _ in 0..2_000 {
            host.tick();
            assert!(!host.device.board().is_driven(), "after {ticks} ticks");
        }
        assert!(!host.status().zeroed, "after {ticks} ticks");
        let found = board_faults(&host);
        assert!(
            matches!(
                found,
                (Some(Fault::EncoderLost | Fault::SpeedMismatch), None)
            ) || ticks < 60 && found == (None, None),
            "after {ticks} ticks: {found:?}"
        );
    }
}

/// Faster than the bridge can hold the motor without a current: there the back-EMF would
/// brake the leg with what nobody has set.
#[test]
fn a_leg_that_is_too_fast_for_the_supply_is_let_go() {
    let scene = support::scene(
        r#"
version = 1
title = "Fast"
duration_s = 20.0
[motion]
kind = "strokes"
from_deg = 5.0
to_deg = 115.0
peak_speed_deg_s = 370.0
pause_s = 0.5
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.crepitus]
preset = "coarse"
[effects.encoder]
"#,
    );
    // With a weak supply sooner.
    for (supply_v, lets_go_rad_s) in [(24.0, 5.73), (20.0, 4.77)] {
        let mut host = Host::new(&scene, &Start::default());
        let leg = host.device.board_mut().leg_mut();
        leg.slow_sensors_mut().supply_v = Some(supply_v);
        host.run(400);
        host.arm();
        let mut fastest_rad_s: f64 = 0.0;
        for _ in 0..30_000 {
            host.tick();
            let board = host.device.board();
            let omega_rad_s = board.leg().shaft().omega_rad_s.abs();
            if board.is_driven() {
                fastest_rad_s = fastest_rad_s.max(omega_rad_s);
                // Ts, and what the gear's friction and the loop's ripple add.
                let motor_nm = board.leg().motor_nm().abs();
                assert!(motor_nm < 0.6, "{motor_nm} N·m at {omega_rad_s} rad/s");
            }
        }
        let found = (board_faults(&host), fastest_rad_s);
        assert_eq!(found.0, (Some(Fault::Overspeed), None));
        // The estimate lags, and the debounce takes a millisecond.
        assert!(
            (lets_go_rad_s - 0.1..lets_go_rad_s + 0.4).contains(&found.1),
            "{found:?}"
        );
    }
}

#[test]
fn another_encoder_ends_the_zero() {
    let mut host = bending();
    assert_eq!(host.ask_patiently(Operation::Zero), Ok(Answer::Done));
    host.set("crepitus.static_torque_nm", 0.5);
    host.run(200);
    assert!(host.status().zeroed);
    host.set("encoder.lines", 500.0);
    host.run(200);
    assert!(!host.status().zeroed);
}
