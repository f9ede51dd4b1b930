//! The vibration actuator on the drive's image: bit for bit the native drive, within its
//! cycles, silent where it has to be, and off with its own fault while the motor goes on.

use crate::book::on_record;
use crate::budget::TICK_CYCLES;
use crate::host::{Flash, Host, image, is_long, judged};
use crate::replay::{REGISTERS, compare};
use crate::symptoms::{PERIOD_TICKS, added, commit, mean, moving, worst};
use crepitus_emulator::Reset;
use crepitus_emulator::cycles::Cycles;
use crepitus_emulator::mcu::Pin;
use crepitus_emulator::pins::Pull;
use crepitus_protocol::host::{Answer, Operation, Status};
use crepitus_protocol::telemetry::CoilCurrent;
use crepitus_protocol::{CoilFault, State, Values};
use crepitus_scene::values::values;
use crepitus_virtual_device::leg::CoilFaults;

pub(crate) const TIM8_BDTR: u32 = 0x4001_0444;
pub(crate) const MOE: u32 = 1 << 15;

/// The most that the stage may add to a tick of `render_torque`, cycles with 0 wait states.
const MOST_CYCLES: u64 = 350;

/// The mass on the leg; what the device makes of it follows.
const MASS: &str = "[effects.reaction-mass]\n";

/// Crepitus and ringing, without the actuator and with it.
pub(crate) fn off() -> Values {
    values(&moving(MASS)).expect("values")
}

pub(crate) fn on() -> Values {
    let effects = [MASS, "[effects.vibration-actuator]\n"].concat();
    let mut values = values(&moving(&effects)).expect("values");
    let (output, _) = crepitus_protocol::parameters::find("bone-shaping.output").expect("a choice");
    values.set(output, 1.0);
    values
}

/// The drive, armed on the moving shaft with the mass, without the actuator.
pub(crate) fn armed(registers: &[u32], flash: Flash) -> Option<Host> {
    let mut host = Host::timed(&image()?, &moving(MASS), registers, flash);
    host.arm();
    host.run_until_torque();
    Some(host)
}

pub(crate) fn with_actuator(registers: &[u32], flash: Flash) -> Option<Host> {
    let mut host = armed(registers, flash)?;
    commit(&mut host, on());
    Some(host)
}

fn status(host: &mut Host) -> Status {
    match host.ask(Operation::Status) {
        Ok(Answer::Status(status)) => status,
        other => panic!("no status but {other:?}"),
    }
}

/// Currents of the coil in the last blocks, mA.
fn currents(host: &Host, blocks: usize) -> Vec<CoilCurrent> {
    let last = host.blocks.iter().rev().take(blocks);
    last.flat_map(|block| block.coil_currents).collect()
}

fn outputs_are_on(host: &Host) -> bool {
    host.board.mcu().peek(TIM8_BDTR).expect("a register") & MOE != 0
}

#[test]
fn it_is_that_of_the_native_drive_bit_for_bit() {
    // Bits do not depend on the flash, unless something is late.
    let modelled = is_long().then_some(Flash::Modelled);
    for flash in std::iter::once(Flash::ZeroWaitStates).chain(modelled) {
        let Some(mut host) = with_actuator(&REGISTERS, flash) else {
            return;
        };
        host.run(2 * PERIOD_TICKS);
        // A gain that changes, and off again, in the middle of it.
        let mut louder = on();
        let (gain, _) =
            crepitus_protocol::parameters::find("vibration-actuator.gain").expect("one");
        louder.set(gain, 1.7);
        commit(&mut host, louder);
        host.run(PERIOD_TICKS);
        let measured = currents(&host, 150);
        assert!(measured.iter().all(|current| *current != CoilCurrent::NONE));
        let most = measured.iter().map(|current| current.0.abs()).max();
        assert!(most > Some(100), "{most:?} mA");
        commit(&mut host, off());
        host.run(PERIOD_TICKS);
        assert!(!outputs_are_on(&host));
        let none = currents(&host, 50);
        assert!(none.iter().all(|current| *current == CoilCurrent::NONE));
        assert!(compare(&mut host) as u64 >= 4 * PERIOD_TICKS);
        assert_eq!(host.board.errors(), []);
        assert_eq!(status(&mut host).coil_fault, 0);
    }
}

#[test]
fn what_is_commanded_is_at_the_coil_with_its_sign() {
    let Some(mut host) = with_actuator(&[], Flash::ZeroWaitStates) else {
        return;
    };
    // The current follows the voltage, so that a block has the sign of most of its ticks.
    let (mut driven, mut power_w) = (0, 0.0);
    for _ in 0..2 * PERIOD_TICKS {
        host.run(1);
        let leg = host.board.leg();
        let volts = leg.coil_v().expect("it is driven");
        driven += u64::from(volts.abs() > 0.2);
        power_w += volts * leg.coil_a();
    }
    assert!(driven > 200, "{driven} ticks");
    assert!(power_w > 0.0);
    let squares = |host: &Host| -> f64 {
        let all = currents(host, 150)
            .into_iter()
            .filter_map(CoilCurrent::amperes);
        all.map(|a| f64::from(a) * f64::from(a)).sum()
    };
    assert!(squares(&host) > 1e-3);
    assert_eq!(status(&mut host).coil_fault, 0);
    assert_eq!(host.board.errors(), []);
}

#[test]
fn without_it_its_pins_stay_low() {
    let Some(mut host) = armed(&[], Flash::ZeroWaitStates) else {
        return;
    };
    for _ in 0..200 {
        host.run(10);
        assert!(!outputs_are_on(&host));
        assert_eq!(host.board.leg().coil_v(), None);
    }
    for number in [8, 9] {
        let setup = host.board.mcu().pin_setup(Pin::new('C', number));
        assert_eq!(setup.pull, Pull::Down);
    }
    assert_eq!(host.board.errors(), []);
}

#[test]
fn it_sleeps_with_the_torque_and_after_a_reset() {
    let Some(mut host) = with_actuator(&[], Flash::ZeroWaitStates) else {
        return;
    };
    assert!(outputs_are_on(&host) && host.board.leg().coil_v().is_some());
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
    host.run(20);
    assert!(!outputs_are_on(&host));
    assert_eq!(host.board.leg().coil_v(), None);
    host.arm();
    host.run(200);
    assert!(outputs_are_on(&host) && host.board.leg().coil_v().is_some());
    host.board.reset(Reset::Pin);
    host.run(1);
    assert!(!outputs_are_on(&host));
    assert_eq!(host.board.leg().coil_v(), None);
}

#[test]
fn its_driver_opens_it_without_the_program_and_the_motor_goes_on() {
    let Some(mut host) = with_actuator(&[], Flash::ZeroWaitStates) else {
        return;
    };
    let fails = |host: &mut Host, driver_fails| {
        let faults = CoilFaults {
            driver_fails,
            ..CoilFaults::default()
        };
        host.board.leg_mut().set_coil_faults(faults);
    };
    // To the beginning of a tick: the program's turn comes after its middle.
    host.board.to_the_middle();
    host.board.half(None);
    fails(&mut host, true);
    host.board.half(None);
    assert!(!outputs_are_on(&host), "by the timer alone");
    host.run(100);
    let after = status(&mut host);
    assert_eq!(after.coil_fault, CoilFault::Driver.code());
    assert_eq!((after.state, after.drive_fault), (State::Armed, 0));
    assert!(host.board.is_driven());
    // Repaired and armed again it stays off, until it is cleared.
    fails(&mut host, false);
    for clears in [false, true] {
        assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
        host.run(100);
        if clears {
            assert_eq!(host.ask(Operation::ClearFault), Ok(Answer::Done));
        }
        host.arm();
        host.run(200);
        assert_eq!(outputs_are_on(&host), clears);
        let code = if clears { 0 } else { CoilFault::Driver.code() };
        assert_eq!(status(&mut host).coil_fault, code);
    }
}

#[test]
fn its_current_is_measured_and_a_short_is_noticed() {
    let Some(mut host) = with_actuator(&[], Flash::ZeroWaitStates) else {
        return;
    };
    let shorted = CoilFaults {
        short_ohm: Some(0.4),
        ..CoilFaults::default()
    };
    host.board.leg_mut().set_coil_faults(shorted);
    host.run(PERIOD_TICKS);
    let after = status(&mut host);
    assert_eq!(after.coil_fault, CoilFault::Short.code());
    assert_eq!((after.state, after.drive_fault), (State::Armed, 0));
}

#[test]
fn the_stage_adds_no_more_than_its_cycles() {
    let flash = Flash::ZeroWaitStates;
    let (Some(mut with), Some(mut without)) = (armed(&[], flash), armed(&[], flash)) else {
        return;
    };
    commit(&mut with, on());
    let added = added(&mut with, &mut without);
    let most = added.iter().max().expect("ticks");
    let mean = mean(&added);
    on_record(
        "`render_torque`, more with the actuator",
        flash,
        Some(mean),
        *most,
    );
    assert!(*most <= MOST_CYCLES, "{most}");
}

#[test]
fn a_tick_with_crepitus_a_ringing_bone_and_it_ends_within_it() {
    for flash in judged(Flash::BOTH) {
        let Some(mut host) = with_actuator(&[], flash) else {
            return;
        };
        let mut cycles = Cycles::default();
        host.watch(PERIOD_TICKS, &mut cycles);
        let busy = cycles.worst_busy_cycles();
        let mean = cycles.mean_busy_cycles();
        let what = "a tick with crepitus, a ringing bone and the actuator";
        on_record(what, flash, Some(mean), busy);
        assert!(busy <= TICK_CYCLES, "{busy}");
        assert!(worst(&mut host) <= TICK_CYCLES);
    }
}
