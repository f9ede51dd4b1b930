//! Ways in which the outputs are switched off: each by itself, without the help of the
//! next one.

use crate::actuator::{MOE, TIM8_BDTR};
use crate::host::{Host, examination, image};
use crepitus_emulator::Reset;
use crepitus_emulator::drive_board::Faults;
use crepitus_emulator::mcu::Access;
use crepitus_protocol::State;
use crepitus_protocol::fault::Fault;
use crepitus_protocol::host::{Answer, Operation};

const GPIOB_BSRR: u32 = 0x4002_0418;
const TIM1_BDTR: u32 = 0x4001_0044;

/// Sets an interrupt pending; enables one.
const NVIC_ISPR: u32 = 0xe000_e200;
const NVIC_ISER: u32 = 0xe000_e100;

/// An interrupt that no task is bound to: that of the camera interface, 78.
const UNUSED: u32 = 78;

fn drive_fault(host: &mut Host) -> u8 {
    match host.ask(Operation::Status) {
        Ok(Answer::Status(status)) => status.drive_fault,
        other => panic!("no status but {other:?}"),
    }
}

fn armed() -> Option<Host> {
    let mut host = Host::new(&image()?, &examination());
    host.arm();
    Some(host)
}

#[test]
fn a_bridge_that_floats_opens_its_switches_and_not_only_the_line() {
    let Some(mut host) = armed() else { return };
    host.run(100);
    assert!(host.board.drive_is_on());
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
    host.run(100);
    let bdtr = host.board.mcu().peek(TIM1_BDTR).expect("a register");
    assert_eq!(bdtr & MOE, 0, "MOE is still set after disarming");
}

#[test]
fn a_line_that_stays_low_is_noticed_by_its_read_back() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    host.board.faults = Faults {
        line_is_stuck: Some(false),
        ..Faults::default()
    };
    let asked = host.try_to_arm();
    host.run(2_000);
    assert_ne!(
        host.board.comms().comms().state(),
        State::Armed,
        "{asked:?}"
    );
    assert_eq!(drive_fault(&mut host), Fault::EnableStuckOff.code());
}

#[test]
fn a_line_that_stays_high_is_noticed_by_its_read_back() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    host.board.faults = Faults {
        line_is_stuck: Some(true),
        ..Faults::default()
    };
    host.run(2_000);
    assert_eq!(drive_fault(&mut host), Fault::EnableStuckOn.code());
}

/// Returns whether the program has switched off line, bridge and coil, before the reset that
/// then does so in any case.
fn assert_off_before_reset(host: &Host, accesses: &[Access]) {
    let (reset, cause) = *host.board.resets().first().expect("a reset");
    assert_eq!(cause, Reset::Software);
    let before = || {
        accesses
            .iter()
            .filter(|access| access.is_write && access.at < reset)
    };
    let line =
        before().rfind(|access| access.address == GPIOB_BSRR && access.value & 0x0001_0001 != 0);
    assert_eq!(
        line.map(|access| access.value & 1),
        Some(0),
        "the enable line is left on"
    );
    for (timer, name) in [(TIM1_BDTR, "bridge"), (TIM8_BDTR, "coil")] {
        let last = before().rfind(|access| access.address == timer);
        let outputs = last.map(|access| access.value & MOE);
        assert_eq!(outputs, Some(0), "MOE of the {name} is left on");
    }
}

#[test]
fn a_processor_fault_switches_off_before_it_resets() {
    let Some(mut host) = armed() else { return };
    host.run(100);
    host.board
        .mcu_mut()
        .listen(&[GPIOB_BSRR, TIM1_BDTR, TIM8_BDTR]);
    // An undefined instruction where the idle loop goes on.
    let idle = host.idle_pc();
    host.board
        .mcu_mut()
        .patch_flash(idle, &[0x00, 0xde, 0x00, 0xde]);
    for _ in 0..100 {
        if !host.board.resets().is_empty() {
            break;
        }
        host.board.half(None);
    }
    let accesses = host.board.mcu_mut().take_accesses();
    assert_off_before_reset(&host, &accesses);
}

#[test]
fn an_interrupt_that_nobody_handles_switches_off_before_it_resets() {
    let Some(mut host) = armed() else { return };
    host.run(100);
    let mcu = host.board.mcu_mut();
    mcu.listen(&[GPIOB_BSRR, TIM1_BDTR, TIM8_BDTR]);
    let (word, bit) = (4 * (UNUSED / 32), 1 << (UNUSED % 32));
    mcu.poke(NVIC_ISER + word, bit);
    mcu.poke(NVIC_ISPR + word, bit);
    for _ in 0..100 {
        if !host.board.resets().is_empty() {
            break;
        }
        host.board.half(None);
    }
    let accesses = host.board.mcu_mut().take_accesses();
    assert_off_before_reset(&host, &accesses);
}
