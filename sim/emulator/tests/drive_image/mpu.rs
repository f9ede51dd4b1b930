//! Memory protection: what the map forbids ends in a reset by the program, with
//! outputs off, and is not done.

use crate::code::{FOREVER, bytes, load, store};
use crate::host::{Host, examination, image};
use crepitus_device::usb_port::HostBytes;
use crepitus_emulator::firmware::{Program, image_for_test};
use crepitus_emulator::{Reset, Stm32f405, Time};
use crepitus_protocol::fault::Fault;
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::management::{Action, ManagementRequest};
use crepitus_protocol::{Lane, frame};

const TIM1_CCR1: u32 = 0x4001_0034;
const TIM1_BDTR: u32 = 0x4001_0044;
const GPIOA_MODER: u32 = 0x4002_0000;
const GPIOB_BSRR: u32 = 0x4002_0418;
const RCC_APB2ENR: u32 = 0x4002_3844;

/// Exception of `command_motor`.
const COMMAND: u16 = 16 + 29;

/// Addresses in the drive's RAM, behind its variables, and in its flash, where nothing is stored.
const FREE_RAM: u32 = 0x2001_f000;
const FREE_FLASH: u32 = 0x080f_0000;

/// Half ticks until a violation has to have ended in a reset: its post-mortem record
/// takes four.
const AT_MOST: u64 = 20;

fn armed() -> Option<Host> {
    let mut host = Host::new(&image()?, &examination());
    host.arm();
    host.run(100);
    assert!(host.board.drive_is_on());
    Some(host)
}

/// The idle loop runs these instructions next, and then nothing.
fn run_in_idle(host: &mut Host, instructions: &[u16]) {
    let idle = host.idle_pc();
    // Only the watchdog ends what nothing else does.
    let code = bytes(&[instructions, &[FOREVER]].concat());
    host.board.mcu_mut().patch_flash(idle, &code);
}

/// Runs until the program resets the processor, with outputs off from then on.
fn assert_reset(host: &mut Host, what: &str) {
    for _ in 0..AT_MOST {
        if !host.board.resets().is_empty() {
            break;
        }
        host.board.half(None);
    }
    let reset = host.board.resets().first().map(|(_, cause)| *cause);
    assert_eq!(reset, Some(Reset::Software), "{what}");
    assert!(!host.board.drive_is_on(), "{what}");
}

/// Start of the peripheral registers. Memory below keeps its content over a reset.
const PERIPHERALS: u32 = 0x4000_0000;

#[test]
fn a_store_from_outside_command_motor_is_not_done_and_ends_in_a_reset() {
    /// A bit of a register, by its alias.
    const fn alias(register: u32, bit: u32) -> u32 {
        0x4200_0000 + 32 * (register - 0x4000_0000) + 4 * bit
    }
    let forbidden = [
        ("duty", TIM1_CCR1, 4_000),
        ("outputs and dead time", TIM1_BDTR, 0x8001),
        ("outputs, by the alias of MOE", alias(TIM1_BDTR, 15), 1),
        ("enable line", GPIOB_BSRR, 0x0000_0003),
        ("pins of the upper switches", GPIOA_MODER, 0x0005_0000),
        ("clocks", RCC_APB2ENR, 0),
        ("null", 0, 1),
        ("beyond null", 0x40, 1),
        ("program", FREE_FLASH, 0),
        ("below the stack", 0x0fff_fffc, 0),
        ("beyond RAM", 0x2002_0000, 0),
        ("USB, which the drive has not", 0x5000_0000, 0),
    ];
    for (what, address, value) in forbidden {
        let Some(mut host) = armed() else { return };
        let mcu = host.board.mcu_mut();
        let before = mcu.peek(address);
        mcu.listen(&[address, TIM1_BDTR]);
        run_in_idle(&mut host, &store(address, value));
        assert_reset(&mut host, what);
        if address < PERIPHERALS {
            assert_eq!(host.board.mcu_mut().peek(address), before, "{what}");
        }
        let (reset, _) = host.board.resets()[0];
        let accesses = host.board.mcu_mut().take_accesses();
        let done = accesses.iter().any(|access| {
            access.is_write
                && access.at < reset
                && (access.address, access.value) == (address, value)
        });
        assert!(!done, "{what}: was written");
    }
}

#[test]
fn a_null_pointer_that_is_read_ends_in_a_reset() {
    let Some(mut host) = armed() else { return };
    // `ldr r1, [r0]`
    run_in_idle(&mut host, &[&load(0, 0)[..], &[0x6801]].concat());
    assert_reset(&mut host, "read");
}

#[test]
fn code_in_ram_or_in_registers_ends_in_a_reset() {
    // RAM, CCM RAM, a register that reads as two instructions, address 0.
    for address in [FREE_RAM, 0x1000_0100, TIM1_CCR1, 0] {
        let Some(mut host) = armed() else { return };
        let forever = u32::from(FOREVER) << 16 | u32::from(FOREVER);
        if address == FREE_RAM || address == 0x1000_0100 {
            host.board.mcu_mut().poke(address, forever);
        }
        // `bx r0`
        run_in_idle(&mut host, &[&load(0, address | 1)[..], &[0x4700]].concat());
        assert_reset(&mut host, &format!("execution at {address:#x}"));
    }
}

/// The program itself switches off while its outputs are protected: no second fault
/// hides why.
#[test]
fn a_reboot_that_was_asked_for_is_no_fault() {
    let Some(mut host) = armed() else { return };
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
    host.run(100);
    let request = ManagementRequest {
        action: Action::Reboot,
        token: 1,
    };
    let frame = frame::encode_bytes(Lane::Management, &request.bytes()).expect("a frame");
    host.board.comms_mut().comms_mut().received(&frame);
    host.run(3_000);
    let reset = host.board.resets().first().map(|(_, cause)| *cause);
    assert_eq!(reset, Some(Reset::Software));
    match host.ask(Operation::Status) {
        Ok(Answer::Status(status)) => {
            assert_ne!(status.drive_fault, Fault::DrivePanic.code());
        }
        other => panic!("no status but {other:?}"),
    }
}

/// A store by `command_motor` itself, but before it sets the outputs.
#[test]
fn command_motor_writes_to_the_outputs_only_where_it_sets_them() {
    let Some(mut host) = armed() else { return };
    let image = image().expect("it was there");
    let at = image.vector(COMMAND).expect("a handler");
    let handler = [&store(TIM1_CCR1, 4_000)[..], &[FOREVER]].concat();
    host.board.mcu_mut().patch_flash(at, &bytes(&handler));
    assert_reset(&mut host, "command_motor");
}

/// Programs as the flash driver of comms does: unlocked, and by words.
#[test]
fn comms_can_program_its_parameter_sectors_and_nothing_else() {
    const FLASH_KEYR: u32 = 0x4002_3c04;
    const FLASH_CR: u32 = 0x4002_3c10;
    const PROGRAM_WORDS: u32 = 0x201;
    const VALUE: u32 = 0x1234_5678;
    // After two erasures.
    const STARTED: Time = Time::from_us(900_000);
    let Some(image) = image_for_test(Program::Comms) else {
        return;
    };
    for (address, is_allowed) in [
        (0x0800_8000, true),
        (0x0800_fffc, true),
        (0x0800_7ffc, false),
        (FREE_FLASH, false),
    ] {
        let mut mcu = Stm32f405::new(&image);
        mcu.run_until(STARTED);
        let before = mcu.peek(address).expect("flash");
        let stores = [
            store(FLASH_KEYR, 0x4567_0123),
            store(FLASH_KEYR, 0xcdef_89ab),
            store(FLASH_CR, PROGRAM_WORDS),
            store(address, VALUE),
            vec![FOREVER],
        ];
        let at = mcu.program_counter();
        mcu.patch_flash(at, &bytes(&stores.concat()));
        // The core may sleep until its next tick.
        mcu.run_until(STARTED + Time::from_us(600));
        let is_done = mcu.peek(address) == Some(before & VALUE) && before & VALUE != before;
        let was_reset = !mcu.take_resets().is_empty();
        assert_eq!(
            (is_done, was_reset),
            (is_allowed, !is_allowed),
            "{address:#x}"
        );
    }
}
