//! Waits for flash whose number is known: the reference manual's figure 5, and
//! loops that fit in the caches or do not.

use crate::assembler::{Assembler, HANDLER, PROGRAM, image_of};
use crate::core::latency_image;
use crepitus_emulator::mcu::{Step, Watch};
use crepitus_emulator::{Stm32f405, Time};

/// Bits of `FLASH_ACR`.
const PREFETCH: u32 = 1 << 8;
const INSTRUCTIONS: u32 = 1 << 9;
const DATA: u32 = 1 << 10;

/// Start addresses of the code that is timed, and of what it reads as data: lines.
const CODE: u32 = 0x0800_1000;
const TABLE: u32 = 0x0800_0800;

const LINE: u32 = 16;

const NARROW_NOP: u16 = 0xbf00;
const WIDE_NOP: [u16; 2] = [0xf3af, 0x8000];

#[derive(Default)]
struct Steps(Vec<Step>);

impl Watch for Steps {
    fn step(&mut self, step: &Step) {
        self.0.push(*step);
    }
}

/// Runs code with this value in `FLASH_ACR`; register 3 is the table.
fn run(register: u32, code: &[u16]) -> Vec<Step> {
    let mut program = Assembler::default();
    program.load(0, 0x4002_3c00).load(1, register);
    program.load(3, TABLE).load(7, CODE + 1);
    // `bx r7`
    program.store(1, 0, 0).raw(0x4738);
    let image = image_of(&[(PROGRAM, &program.0), (0x1000, code)]);
    let mut mcu = Stm32f405::new(&image);
    mcu.model_flash();
    let mut steps = Steps::default();
    mcu.watch_until(Time::from_us(2_000), &mut steps);
    assert_eq!(mcu.peek(0x4002_3c00), Some(register));
    steps.0.retain(|step| step.pc >= CODE);
    steps.0
}

/// Waits of each line of straight code of this instruction; all of them at the
/// line's first instruction.
fn waits_of_lines(register: u32, instruction: &[u16]) -> Vec<u32> {
    const LINES: usize = 16;
    let mut code = instruction.repeat(LINES * 8 / instruction.len());
    // `b .`
    code.push(0xe7fe);
    let steps = run(register, &code);
    let end = CODE + LINE * 16;
    let straight = steps.iter().take_while(|step| step.pc < end);
    let mut waits = [0; LINES];
    for step in straight {
        assert_eq!(step.cycles - step.waits, 1, "{step:?}");
        let offset = step.pc - CODE;
        assert!(step.waits == 0 || offset.is_multiple_of(LINE), "{step:?}");
        waits[(offset / LINE) as usize] += step.waits;
    }
    // The first comes after a branch.
    assert!(waits[0] >= register & 7);
    waits[1..].to_vec()
}

#[test]
fn straight_code_waits_as_in_the_figure() {
    // Wide instructions, 3 wait states: without prefetch the fifth waits for 3
    // cycles, with it for none, as the next line is read in the 4 cycles of this one.
    // With 5 wait states a line is read in 6 cycles.
    for (register, waits) in [(3, 3), (3 | PREFETCH, 0), (5, 5), (5 | PREFETCH, 2)] {
        assert_eq!(waits_of_lines(register, &WIDE_NOP), [waits; 15]);
    }
    // Eight narrow ones take long enough.
    for (register, waits) in [(3, 3), (3 | PREFETCH, 0), (5, 5), (5 | PREFETCH, 0)] {
        assert_eq!(waits_of_lines(register, &[NARROW_NOP]), [waits; 15]);
    }
}

#[test]
fn the_cache_changes_nothing_for_code_that_runs_once() {
    for register in [3, 3 | PREFETCH, 5, 5 | PREFETCH] {
        assert_eq!(
            waits_of_lines(register | INSTRUCTIONS, &WIDE_NOP),
            waits_of_lines(register, &WIDE_NOP)
        );
    }
}

#[test]
fn without_wait_states_nothing_waits() {
    for register in [0, PREFETCH | INSTRUCTIONS | DATA] {
        assert_eq!(waits_of_lines(register, &WIDE_NOP), [0; 15]);
    }
}

/// Adds a branch back to the begin of code that ends a line with it.
fn closed(mut code: Vec<u16>) -> Vec<u16> {
    let last = code.len() - 1;
    assert_eq!(code.len() % 8, 0);
    // To the begin, from 4 bytes after the branch, in half-words.
    let back = u16::try_from(last + 2).unwrap();
    code[last] = 0xe000 | (0x800 - back);
    code
}

/// Waits of each round of a loop but the first.
fn waits_of_rounds(register: u32, code: &[u16]) -> Vec<u32> {
    let steps = run(register, code);
    let rounds = steps.chunk_by(|_, next| next.pc != CODE);
    let rounds = rounds.map(|round| round.iter().map(|step| step.waits).sum());
    let rounds: Vec<u32> = rounds.collect();
    // Neither the first nor the last, which is not complete.
    rounds[1..rounds.len() - 1].to_vec()
}

#[track_caller]
fn assert_each_round_waits(register: u32, code: &[u16], waits: u32) {
    let rounds = waits_of_rounds(register, code);
    assert!(rounds.len() > 3);
    // The second still fills the cache.
    assert!(
        rounds[1..].iter().all(|round| *round == waits),
        "{rounds:?}"
    );
}

#[test]
fn a_loop_that_fits_in_the_cache_waits_in_its_first_round_only() {
    let lines = |lines: usize| closed(vec![NARROW_NOP; 8 * lines]);
    let register = 5 | INSTRUCTIONS;
    assert_each_round_waits(register, &lines(64), 0);
    // The least recently used line is the one that is needed next.
    assert_each_round_waits(register, &lines(65), 65 * 5);
    assert_each_round_waits(5, &lines(64), 64 * 5);
    assert_each_round_waits(register | PREFETCH, &lines(64), 0);
}

/// Waits at the second line of code each time that it begins: after the first
/// line once, then after a branch from the end of the third.
fn waits_at_second_line(register: u32, instruction: &[u16]) -> Vec<u32> {
    let mut lines = instruction.repeat(16 / instruction.len() - 1);
    lines.resize(16, NARROW_NOP);
    let first = instruction.repeat(8 / instruction.len());
    let steps = run(register, &[first, closed(lines)].concat());
    let begins = steps.iter().filter(|step| step.pc == CODE + LINE);
    begins.map(|step| step.waits).take(4).collect()
}

#[test]
fn a_prefetched_line_is_in_the_cache_only_if_it_was_late() {
    let register = 5 | INSTRUCTIONS | PREFETCH;
    assert_eq!(waits_at_second_line(register, &[NARROW_NOP]), [0, 5, 0, 0]);
    assert_eq!(waits_at_second_line(register, &WIDE_NOP), [2, 0, 0, 0]);
    let register = 5 | PREFETCH;
    assert_eq!(waits_at_second_line(register, &[NARROW_NOP]), [0, 5, 5, 5]);
    assert_eq!(waits_at_second_line(register, &WIDE_NOP), [2, 5, 5, 5]);
}

/// Code with a load of each of these lines of the table, one in a line of code:
/// `nop.w`; `ldr.w r2, [r3, #…]`; twice `nop.w`.
fn loads(lines: &[u16]) -> Vec<u16> {
    let code = lines.iter().flat_map(|line| {
        let load = [0xf8d3, 0x2000 | (16 * line)];
        [WIDE_NOP, load, WIDE_NOP, WIDE_NOP].concat()
    });
    code.collect()
}

/// Loads of these lines in a loop.
fn loop_of_loads(lines: &[u16]) -> Vec<u16> {
    let mut code = loads(lines);
    code.extend([NARROW_NOP; 8]);
    closed(code)
}

#[test]
fn eight_lines_of_data_fit_in_their_cache() {
    let register = 5 | INSTRUCTIONS | DATA;
    let lines = |count| loop_of_loads(&(0..count).collect::<Vec<_>>());
    assert_each_round_waits(register, &lines(8), 0);
    assert_each_round_waits(register, &lines(9), 9 * 5);
    assert_each_round_waits(5 | INSTRUCTIONS, &lines(8), 8 * 5);
}

#[test]
fn the_least_recently_used_line_is_replaced() {
    // The second read of line 0 makes line 1 the oldest, which line 8 replaces.
    let read = [0, 1, 2, 3, 4, 5, 6, 7, 0, 8, 0, 1];
    let mut code = loads(&read);
    code.push(0xe7fe);
    let steps = run(5 | DATA, &code);
    let loads = steps.iter().filter(|step| step.pc % LINE == 4);
    let waits: Vec<u32> = loads.map(|step| step.waits).take(read.len()).collect();
    assert_eq!(waits, [5, 5, 5, 5, 5, 5, 5, 5, 0, 5, 0, 5]);
}

#[test]
fn data_is_not_in_the_instruction_cache() {
    // 64 lines of code with a read of data that is not cached.
    let mut code = loads(&[0]);
    code.extend(vec![NARROW_NOP; 8 * 63]);
    assert_each_round_waits(5 | INSTRUCTIONS, &closed(code), 5);
}

#[test]
fn data_waits_for_a_prefetch_and_comes_before_one() {
    // `ldr r2, [r3]` among eight narrow instructions. The prefetch of the next line
    // takes the 6 cycles after the first.
    let register = 5 | PREFETCH;
    for (place, waits) in [(0, 5), (1, 5), (2, 5 + 5), (6, 1 + 5), (7, 5)] {
        let mut line = vec![NARROW_NOP; 8];
        line[place] = 0x681a;
        let code = closed([vec![NARROW_NOP; 8], line, vec![NARROW_NOP; 8]].concat());
        let steps = run(register, &code);
        let load = CODE + LINE + 2 * u32::try_from(place).unwrap();
        let steps = steps.iter().filter(|step| step.pc == load);
        for step in steps.skip(1) {
            assert_eq!(step.waits, waits, "{place}");
        }
    }
}

#[test]
fn a_vector_and_the_first_instruction_of_its_handler_are_read() {
    // 5 wait states as soon as TIM2 runs: `movw`, `movt`, `movs r1, #5`;
    // `str r1, [r0]`; `b .`
    let rest = [0xf643, 0x4000, 0xf2c4, 0x0002, 0x2105, 0x6001, 0xe7fe];
    let mut mcu = Stm32f405::new(&latency_image(1_000, &rest));
    mcu.model_flash();
    let mut steps = Steps::default();
    mcu.watch_until(Time::from_us(1_000), &mut steps);
    let handler = 0x0800_0000 + u32::try_from(HANDLER).unwrap();
    let mut entries = 0;
    for pair in steps.0.windows(2) {
        if pair[1].pc == handler {
            assert_eq!((pair[0].waits, pair[0].cycles), (5, 12 + 5));
            // The handler's first instruction reads a register of APB1, too: 3.
            assert_eq!(pair[1].waits, 5 + 3);
            entries += 1;
        }
    }
    assert!(entries > 10);
}
