//! The post-mortem record of the real image.

use crate::host::{Host, examination, image};
use crate::tasks::RENDER;
use crepitus_emulator::Reset;
use crepitus_protocol::crash::{Controller, End, Head, TICKS, Tick, ticks};
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Sample, SampleFlags};

/// `udf #0`, and `b .`
const UNDEFINED: [u8; 2] = [0x00, 0xde];
const FOREVER: [u8; 2] = [0xfe, 0xe7];

/// Bits of CFSR (an undefined instruction) and of HFSR (it became a HardFault).
const UNDEFINSTR: u32 = 1 << 16;
const FORCED: u32 = 1 << 30;

/// The stack's RAM.
const CCM: std::ops::Range<u32> = 0x1000_0000..0x1001_0000;

fn armed() -> Option<Host> {
    let mut host = Host::new(&image()?, &examination());
    host.arm();
    host.run_until_torque();
    Some(host)
}

/// The drive's record, once it runs again.
fn read(host: &mut Host) -> Vec<u32> {
    host.run(2_000);
    let mut words = Vec::new();
    for part in 0.. {
        let controller = Controller::Drive;
        match host.ask(Operation::ReadCrash { controller, part }) {
            Ok(Answer::CrashPart(part)) => match part.words {
                Some(part) => words.extend(part),
                None => break,
            },
            other => panic!("{other:?}"),
        }
    }
    words
}

/// Replaces an instruction and puts it back after the reset that follows.
fn crash(host: &mut Host, at: u32, instruction: [u8; 2], cause: Reset) {
    let whole = image().expect("it was there").flash;
    let place = (at - crepitus_emulator::image::FLASH) as usize;
    let mcu = host.board.mcu_mut();
    mcu.set_watchdog_hz(47_000);
    mcu.patch_flash(at, &instruction);
    for _ in 0..2_000 {
        host.run(1);
        if let Some((_, reset)) = host.board.resets().last() {
            assert_eq!(*reset, cause);
            let mcu = host.board.mcu_mut();
            mcu.patch_flash(at, &whole[place..place + 2]);
            return;
        }
    }
    panic!("no reset");
}

/// Samples that came in blocks of the first start, with the numbers of their
/// ticks.
fn shown(host: &Host) -> Vec<(u64, Sample)> {
    let start = host.blocks[0].flags.start();
    let blocks = host.blocks.iter();
    let blocks = blocks.take_while(|block| block.flags.start() == start);
    blocks
        .flat_map(|block| (block.first_tick..).zip(block.samples))
        .collect()
}

/// The record's ticks, which follow each other.
fn last_ticks(words: &[u32]) -> Vec<Tick> {
    let ticks: Vec<Tick> = ticks(words).collect();
    assert_eq!(ticks.len(), TICKS);
    let mut pairs = ticks.windows(2);
    assert!(pairs.all(|pair| pair[1].number == pair[0].number + 1));
    ticks
}

/// The ticks are what the blocks showed of them.
fn check_ticks(host: &Host, words: &[u32]) {
    let ticks = last_ticks(words);
    let shown = shown(host);
    let last = shown.last().expect("samples").0;
    // The last block, and the one that was on its way, have not come.
    let newest = u64::from(ticks[TICKS - 1].number);
    assert!((last..last + 3 * BLOCK_SAMPLES as u64).contains(&newest));
    let mut compared = 0;
    for tick in &ticks {
        let same = shown
            .iter()
            .find(|(number, _)| *number == u64::from(tick.number));
        if let Some((_, sample)) = same {
            assert_eq!(tick.sample, *sample);
            compared += 1;
        }
    }
    assert!(compared >= BLOCK_SAMPLES / 2, "{compared}");
}

#[test]
fn a_fault_leaves_registers_stack_and_the_last_ticks() {
    let Some(mut host) = armed() else { return };
    let at = image()
        .expect("it was there")
        .vector(RENDER)
        .expect("a handler")
        & !1;
    crash(&mut host, at, UNDEFINED, Reset::Software);
    let words = read(&mut host);
    let head = Head::of(&words).expect("a record");
    assert_eq!((head.end, head.detail), (End::Fault, at));
    let [pc, lr, sp, xpsr, cfsr, hfsr, _, _] = head.registers;
    assert_eq!(pc, at);
    // The handler was to return to what it interrupted.
    assert_eq!(lr & 0xffff_ff00, 0xffff_ff00, "{lr:#x}");
    assert_eq!(xpsr & 0x1ff, u32::from(RENDER));
    assert!(CCM.contains(&sp), "{sp:#x}");
    assert_eq!((cfsr, hfsr), (UNDEFINSTR, FORCED));
    assert_eq!(head.stack[5..8], [lr, pc, xpsr]);
    check_ticks(&host, &words);
}

#[test]
fn a_task_that_hangs_leaves_the_last_ticks() {
    let Some(mut host) = armed() else { return };
    let at = image()
        .expect("it was there")
        .vector(RENDER)
        .expect("a handler")
        & !1;
    crash(&mut host, at, FOREVER, Reset::Watchdog);
    let words = read(&mut host);
    let head = Head::of(&words).expect("a record");
    assert_eq!(head.end, End::Watchdog);
    assert_eq!(head.registers, [0; 8]);
    // `command_motor` went on, without what the other should have rendered.
    let is_late = |tick: &Tick| tick.sample.flags.has(SampleFlags::LATE);
    assert!(last_ticks(&words).iter().all(is_late));
    // The record outlives a restart that is no crash, but not power-off. The board sees pins
    // that are not set up yet.
    host.breaks_board = true;
    host.board.mcu_mut().reset(Reset::Software);
    assert_eq!(read(&mut host), words);
    host.board.mcu_mut().reset(Reset::PowerOn);
    assert_eq!(read(&mut host), [0; 0]);
}

#[test]
fn an_interrupt_without_a_handler_leaves_the_stack() {
    /// Registers of the core that enable an interrupt, and request it.
    const ENABLE: u32 = 0xe000_e100;
    const REQUEST: u32 = 0xe000_e200;
    /// Number of the tamper pin's interrupt, which nobody uses.
    const TAMPER: u16 = 2;
    let Some(mut host) = armed() else { return };
    let mcu = host.board.mcu_mut();
    for register in [ENABLE, REQUEST] {
        mcu.poke(register, 1 << TAMPER);
    }
    let words = read(&mut host);
    let head = Head::of(&words).expect("a record");
    // The interrupt's number is not modelled: the library's ICSR has no VECTACTIVE.
    assert_eq!(head.end, End::Unhandled);
    assert!(CCM.contains(&head.registers[2]));
    assert_ne!(head.stack, [0; 16]);
    check_ticks(&host, &words);
}

#[test]
fn without_a_crash_there_is_no_record() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    assert_eq!(read(&mut host), [0; 0]);
}
