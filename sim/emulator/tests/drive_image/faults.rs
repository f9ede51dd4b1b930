//! Rows of the fault table with the real image: outputs off in the time that
//! the table says, measured in half ticks of the leg.

use crate::host::{Host, examination, image};
use crepitus_emulator::drive_board::CommsSide;
use crepitus_emulator::mcu::{Step, Watch};
use crepitus_emulator::{Reset, Time};
use crepitus_protocol::fault::{FAULTS, Fault};
use crepitus_protocol::host::{Answer, Operation};
use crepitus_virtual_device::leg::{CurrentPath, CurrentSensor, EncoderWiring};

/// The encoder's counter.
const TIM5_CNT: u32 = 0x4000_0c24;

/// The table's time, in half ticks; measuring is one more.
fn limit(fault: Fault) -> u64 {
    let spec = FAULTS.iter().find(|spec| spec.fault == fault);
    let ticks = spec.and_then(|spec| spec.within_ticks).expect("a time");
    2 * u64::from(ticks) + 1
}

/// 4 × (160 + 1) clocks of 17 kHz, 37.9 ms, in half ticks.
const SLOWEST_WATCHDOG: u64 = 1_516;

fn under_torque() -> Option<Host> {
    let mut host = Host::new(&image()?, &examination());
    host.arm();
    host.run_until_torque();
    Some(host)
}

/// Fault that the drive reports.
fn drive_fault(host: &mut Host) -> u8 {
    match host.ask(Operation::Status) {
        Ok(Answer::Status(status)) => status.drive_fault,
        other => panic!("no status but {other:?}"),
    }
}

#[test]
fn a_link_that_is_cut() {
    let Some(mut host) = under_torque() else {
        return;
    };
    host.board.faults.down_is_cut = true;
    let halves = host.halves_until_off(limit(Fault::CommsSilent));
    println!("link cut: off after {halves} half ticks");
    assert!(halves > 2 * 60);
    host.board.faults.down_is_cut = false;
    host.run(200);
    assert_eq!(drive_fault(&mut host), Fault::CommsSilent.code());
}

#[test]
fn comms_that_hangs() {
    let Some(mut host) = under_torque() else {
        return;
    };
    host.board.comms_mut().set_hung(true);
    let halves = host.halves_until_off(limit(Fault::CommsSilent));
    println!("comms hangs: off after {halves} half ticks");
    // The line of comms stays as it was: the drive's is the one that fell.
    assert!(host.board.comms_line_is_on());
}

#[test]
fn interference_on_the_encoder() {
    let Some(mut host) = under_torque() else {
        return;
    };
    let mut halves = 0;
    while host.board.drive_is_on() {
        assert!(halves <= limit(Fault::EncoderLost), "still on");
        if halves % 2 == 0 {
            let mcu = host.board.mcu_mut();
            let count = mcu.peek(TIM5_CNT).expect("a counter");
            mcu.poke(TIM5_CNT, count.wrapping_add(5_000));
        }
        host.board.half(None);
        halves += 1;
    }
    println!("encoder jumps: off after {halves} half ticks");
    assert!(halves > 2 * 18);
    host.run(200);
    assert_eq!(drive_fault(&mut host), Fault::EncoderLost.code());
}

/// Control and reload registers of the timers of `command_motor` and of `sample_encoder`,
/// with `render_torque` behind it.
const COMMAND_CONTROL: u32 = 0x4000_0400;
const COMMAND_RELOAD: u32 = 0x4000_042c;
const RENDER_CONTROL: u32 = 0x4000_0800;
const RENDER_RELOAD: u32 = 0x4000_082c;

/// Stops a timer.
fn stop(host: &mut Host, control: u32) {
    let mcu = host.board.mcu_mut();
    let word = mcu.peek(control).expect("a timer");
    mcu.poke(control, word & !1);
}

#[test]
fn a_stopped_timer_of_the_model() {
    let Some(mut host) = under_torque() else {
        return;
    };
    stop(&mut host, RENDER_CONTROL);
    let halves = host.halves_until_off(limit(Fault::RenderingLate));
    println!("timer of the model stopped: off after {halves} half ticks");
    host.run(200);
    assert_eq!(drive_fault(&mut host), Fault::RenderingLate.code());
}

/// Heartbeats time out by a clock that does not depend on it.
#[test]
fn a_stopped_timer_of_the_model_and_a_link_that_is_cut() {
    let Some(mut host) = under_torque() else {
        return;
    };
    // One result in five is late, which is not too many.
    host.board.faults.down_is_cut = true;
    let mut off = None;
    for halves in 0..=limit(Fault::CommsSilent) {
        if !host.board.drive_is_on() {
            off = Some(halves);
            break;
        }
        if halves % 40 == 0 {
            stop(&mut host, RENDER_CONTROL);
        } else if halves % 40 == 8 {
            let mcu = host.board.mcu_mut();
            let word = mcu.peek(RENDER_CONTROL).expect("a timer");
            mcu.poke(RENDER_CONTROL, word | 1);
        }
        host.board.half(None);
    }
    let halves = off.expect("off");
    println!("timer of the model stopping, link cut: off after {halves} half ticks");
    host.board.faults.down_is_cut = false;
    host.run(200);
    assert_eq!(drive_fault(&mut host), Fault::CommsSilent.code());
}

#[test]
fn a_timer_of_the_model_at_half_its_rate() {
    let Some(mut host) = under_torque() else {
        return;
    };
    host.board.mcu_mut().poke(RENDER_RELOAD, 2 * 4_200 - 1);
    // Every other tick is late, of which a quarter is made up for.
    let halves = host.halves_until_off(4 * limit(Fault::RenderingLate));
    println!("timer of the model at half its rate: off after {halves} half ticks");
    host.run(200);
    assert_eq!(drive_fault(&mut host), Fault::RenderingLate.code());
}

#[test]
fn a_timer_of_the_model_that_is_too_fast() {
    // With twice the rate every other run begins with `command_motor`, and ends after it.
    for reload in [2_100, 1_400, 4_000] {
        let Some(mut host) = under_torque() else {
            return;
        };
        host.board.mcu_mut().poke(RENDER_RELOAD, reload - 1);
        let halves = host.halves_until_off(2 * limit(Fault::RenderingLate));
        println!("timer of the model at {reload} of 4200: off after {halves} half ticks");
        host.run(200);
        assert_eq!(drive_fault(&mut host), Fault::RenderingLate.code());
    }
}

#[test]
fn a_timer_of_the_command_at_another_rate() {
    for reload in [3_500, 5_000] {
        let Some(mut host) = under_torque() else {
            return;
        };
        // The converters sample at other times.
        host.breaks_board = true;
        host.board.mcu_mut().poke(COMMAND_RELOAD, reload);
        let halves = host.halves_until_off(2 * limit(Fault::TickIrregular));
        println!("timer of the command, {reload}: off after {halves} half ticks");
        host.run(200);
        assert_eq!(drive_fault(&mut host), Fault::TickIrregular.code());
    }
}

#[test]
fn a_stopped_timer_of_the_command() {
    let Some(mut host) = under_torque() else {
        return;
    };
    stop(&mut host, COMMAND_CONTROL);
    // Comms takes its line away, and the watchdog is not fed.
    for halves in 0..=limit(Fault::DriveSilent) {
        if !host.board.is_driven() {
            println!("timer of the command stopped: comms' line off after {halves} half ticks");
            break;
        }
        host.board.half(None);
    }
    assert!(!host.board.is_driven());
    let halves = host.halves_until_off(SLOWEST_WATCHDOG);
    println!("and the drive is reset after {halves} more");
    assert_eq!(
        host.board.resets().last().map(|(_, reset)| *reset),
        Some(Reset::Watchdog)
    );
}

/// The fault is found with the comparator blind, too: the two ways of the current differ.
#[test]
fn a_current_sensor_that_is_broken() {
    for (path, sensor) in [
        (CurrentPath::Sensor, CurrentSensor::StuckAt(0.6)),
        (CurrentPath::Sensor, CurrentSensor::Offset(-0.5)),
        (CurrentPath::Monitor, CurrentSensor::StuckAt(-0.6)),
        (CurrentPath::Monitor, CurrentSensor::Offset(0.5)),
    ] {
        let Some(mut host) = under_torque() else {
            return;
        };
        host.board.faults.trip_is_blind = true;
        host.board.leg_mut().set_current_sensor(path, sensor);
        let halves = host.halves_until_off(limit(Fault::CurrentDisagreement));
        println!("{path:?} {sensor:?}: off after {halves} half ticks");
        host.run(200);
        assert_eq!(drive_fault(&mut host), Fault::CurrentDisagreement.code());
    }
}

#[test]
fn a_converter_that_stops() {
    for converter in [0, 1] {
        let Some(mut host) = under_torque() else {
            return;
        };
        host.board.mcu_mut().set_converter_dead(converter, true);
        let halves = host.halves_until_off(limit(Fault::CurrentMissing));
        println!("converter {converter} stops: off after {halves} half ticks");
        host.run(200);
        assert_eq!(drive_fault(&mut host), Fault::CurrentMissing.code());
    }
}

#[test]
fn an_encoder_that_is_unplugged() {
    let Some(mut host) = under_torque() else {
        return;
    };
    // Faster than what the table says is needed to notice.
    while host.board.leg().shaft().omega_rad_s < 0.6 {
        host.run(1);
    }
    host.board
        .leg_mut()
        .set_encoder_wiring(EncoderWiring::Unplugged);
    let halves = host.halves_until_off(limit(Fault::SpeedMismatch));
    println!("encoder unplugged: off after {halves} half ticks");
    host.run(200);
    assert_eq!(drive_fault(&mut host), Fault::SpeedMismatch.code());
}

#[test]
fn the_break_input_needs_no_program() {
    let Some(mut host) = under_torque() else {
        return;
    };
    host.board.mcu_mut().set_hung(true);
    host.board
        .mcu_mut()
        .drive_pin(crepitus_emulator::Pin::new('B', 12), false);
    assert!(!host.board.drive_is_on());
}

#[test]
fn a_brown_out() {
    let Some(mut host) = under_torque() else {
        return;
    };
    host.board.brown_out();
    assert!(
        !host.board.drive_is_on(),
        "a pin that is reset drives nothing"
    );
    for _ in 0..2_000 {
        host.run(1);
        assert!(!host.board.drive_is_on());
    }
    assert!(host.board.is_synchronised(), "it has started again");
    assert_eq!(drive_fault(&mut host), Fault::DriveBrownOut.code());
}

/// The last instruction before an exception.
struct Below(u32);

impl Watch for Below {
    fn step(&mut self, step: &Step) {
        if step.active == 0 {
            self.0 = step.pc;
        }
    }
}

#[test]
fn a_stack_that_was_written_over() {
    /// The stack's RAM, and where nobody executes anything.
    const CCM: std::ops::Range<u32> = 0x1000_0000..0x1001_0000;
    const NOWHERE: u32 = 0xf000_0000;
    let Some(mut host) = under_torque() else {
        return;
    };
    let mcu = host.board.mcu_mut();
    // In `render_torque`, with the way back on the stack.
    let mut below = Below(0);
    let until = Time::from_units(mcu.now().units() + 26 * 336);
    mcu.watch_until(until, &mut below);
    let ways_back: Vec<u32> = CCM
        .step_by(4)
        .filter(|at| {
            let back = mcu.peek(*at).unwrap_or(0).wrapping_sub(below.0);
            back <= 4 && back.is_multiple_of(2)
        })
        .collect();
    assert!(!ways_back.is_empty());
    for at in ways_back {
        mcu.poke(at, NOWHERE);
    }
    let halves = host.halves_until_off(2);
    println!("stack written over: off after {halves} half ticks");
    for _ in 0..2_000 {
        host.run(1);
        assert!(!host.board.drive_is_on());
    }
    assert!(host.board.is_synchronised(), "it has started again");
    assert_eq!(drive_fault(&mut host), Fault::DrivePanic.code());
}

#[test]
fn a_program_that_hangs_is_reset_by_the_watchdog() {
    for hz in [17_000, 47_000] {
        let Some(mut host) = under_torque() else {
            return;
        };
        host.board.mcu_mut().set_watchdog_hz(hz);
        host.board.mcu_mut().set_hung(true);
        let halves = host.halves_until_off(SLOWEST_WATCHDOG);
        println!("watchdog at {hz} Hz: off after {halves} half ticks");
        let last = host.board.resets().last().map(|(_, reset)| *reset);
        assert_eq!(last, Some(Reset::Watchdog));
        host.run(2_000);
        assert_eq!(drive_fault(&mut host), Fault::DriveWatchdog.code());
    }
}
