//! The fast path, which observed accesses switch off, does what the library does, in as
//! many cycles and with the same waits for flash.

use crate::assembler::{Assembler, HANDLER, PROGRAM, RAM, UNITS, image, image_of};
use crepitus_emulator::mcu::{Step, Watch};
use crepitus_emulator::{Image, Reset, Stm32f405, Time};
use fastrand::Rng;

const FLASH: u32 = 0x0800_0000;

/// First values of registers 0 to 13 and of the flags; all are those of the
/// floating-point unit, too.
const TABLE: u32 = FLASH + 0x400;
const WORDS: usize = 32;
const CORE_WORDS: usize = 15;

/// Start address of the instructions that are compared.
const COMPARED: u32 = FLASH + 0x280;

/// Their half words: enough for three to eight instructions.
const HALF_WORDS: usize = 8;

/// Cycles of a program: all of its start, and some of the loop at its end.
const CYCLES: u64 = 80;

/// Bytes of RAM that are compared.
const RAM_BYTES: u32 = 0x1000;

const ACR: u32 = 0x4002_3c00;
const CPACR: u32 = 0xe000_ed88;
const FLOATS_ON: u32 = 0xf << 20;
const FPCCR: u32 = 0xe000_ef34;
const CCR: u32 = 0xe000_ed14;
const MPU_CTRL: u32 = 0xe000_ed94;
const MPU_RBAR: u32 = 0xe000_ed9c;
const MPU_RASR: u32 = 0xe000_eda0;

/// All steps.
#[derive(Default)]
struct Steps(Vec<Step>);

impl Watch for Steps {
    fn step(&mut self, step: &Step) {
        self.0.push(*step);
    }
}

/// One chip twice: by the library, and with the fast path.
fn both(chip: impl Fn() -> Stm32f405) -> [Stm32f405; 2] {
    let (mut by_library, fast) = (chip(), chip());
    by_library.observe_ram(&[]);
    [by_library, fast]
}

/// A chip that loads its registers from the table, those of the floating-point unit
/// too if it is on, and goes on at [`COMPARED`]. All faults end in a loop.
fn chip(has_floats: bool) -> Stm32f405 {
    let mut program = Assembler::default();
    program.load(0, TABLE);
    if has_floats {
        // `vldmia r0, {s0-s31}`; `vmsr fpscr, r0`, without effect but on the flags.
        program.raw(0xec90).raw(0x0a20).raw(0xeee1).raw(0x0a10);
    }
    // `ldr r1, [r0, #56]`; `msr apsr_nzcvqg, r1`; `ldr.w r13, [r0, #52]`;
    // `ldm.w r0, {r0-r12}`
    program.raw(0x6b81).raw(0xf381).raw(0x8c00);
    program.raw(0xf8d0).raw(0xd034).raw(0xe890).raw(0x1fff);
    let here = PROGRAM + 2 * program.0.len() + 4;
    let far = (COMPARED - FLASH) as usize - here;
    program.raw(0xe000 | u16::try_from(far / 2).unwrap());
    let mcu = image_of(&[(PROGRAM, &program.0), (HANDLER, &[0xe7fe])]);
    let mut mcu = Stm32f405::new(&mcu);
    let handler = FLASH + u32::try_from(HANDLER).unwrap() + 1;
    mcu.patch_flash(FLASH + 4 * 3, &handler.to_le_bytes());
    mcu
}

/// Initial state of a program.
#[derive(Debug)]
struct Start {
    code: Vec<u16>,
    table: Vec<u32>,
    /// Registers of the core that are written after reset.
    core: Vec<(u32, u32)>,
}

/// A value: often an address of RAM or of flash, or a small number.
fn value(random: &mut Rng) -> u32 {
    match random.u32(..8) {
        0..3 => RAM + random.u32(..RAM_BYTES / 4) * 4,
        3 => RAM + random.u32(..RAM_BYTES),
        4 => random.u32(..40),
        5 => FLASH + random.u32(..0x2000),
        6 => u32::MAX << random.u32(..32),
        _ => random.u32(..),
    }
}

/// An instruction of 16 bits.
fn narrow(random: &mut Rng) -> Vec<u16> {
    vec![random.u16(..0b11101 << 11)]
}

/// An instruction of 32 bits, most of which exist.
fn wide(random: &mut Rng) -> Vec<u16> {
    vec![random.u16(0b11101 << 11..), random.u16(..)]
}

fn narrow_or_wide(random: &mut Rng) -> Vec<u16> {
    if random.bool() {
        narrow(random)
    } else {
        wide(random)
    }
}

/// An instruction of the floating-point unit, most of which exist.
fn float(random: &mut Rng) -> Vec<u16> {
    let precision = if random.u32(..16) == 0 { 0xb00 } else { 0xa00 };
    // Any, or one of an operand: root, comparison, conversion.
    let (first, second) = if random.bool() {
        (0xec00 | random.u16(..0x400), 0)
    } else {
        (0xeeb0 | random.u16(..0x10), 0x40)
    };
    let mut code = vec![first, random.u16(..) & 0xf0ff | precision | second];
    match random.u32(..8) {
        0 => code.insert(0, 0xbf08 | random.u16(..15) << 4),
        1 => code.extend(narrow(random)),
        _ => {}
    }
    code
}

/// The bits of a number: small, one with a short mantissa, or any.
fn float_value(random: &mut Rng) -> u32 {
    match random.u32(..6) {
        0 => 0,
        1 => (random.f32() * 100.0 - 50.0).to_bits(),
        2 => f32::from(random.i8(..)).to_bits(),
        3 => random.u32(..) & 0x807f_ffff,
        4 => random.u32(..) | 0x7f80_0000,
        _ => random.u32(..),
    }
}

/// An `IT` for up to four instructions.
fn it_block(random: &mut Rng) -> Vec<u16> {
    let mut block = vec![0xbf00 | random.u16(..15) << 4 | random.u16(1..16)];
    block.extend(narrow_or_wide(random));
    block.extend(narrow(random));
    block
}

/// Regions of the MPU all over RAM and code, and the traps that there are.
fn core_registers(random: &mut Rng) -> Vec<(u32, u32)> {
    let mut writes = vec![(CCR, 0x200 | random.u32(..4) << 3)];
    for region in 0..random.u32(..6) {
        let size = random.u32(4..12);
        let base = if random.u32(..4) == 0 { FLASH } else { RAM };
        let base = base + (random.u32(..RAM_BYTES) >> (size + 1) << (size + 1));
        let access = random.u32(..8) << 24 | u32::from(random.u32(..8) == 0) << 28;
        let without = if random.bool() {
            random.u32(..256) << 8
        } else {
            0
        };
        writes.push((MPU_RBAR, base | 1 << 4 | region));
        writes.push((MPU_RASR, access | without | size << 1 | 1));
    }
    writes.push((MPU_CTRL, 0b101));
    writes
}

fn state(mcu: &Stm32f405) -> (u64, u64, u16, Vec<u32>) {
    let registers = (0..16).map(|number| mcu.register(number));
    let memory = (0..RAM_BYTES)
        .step_by(4)
        .map(|at| mcu.peek(RAM + at).unwrap());
    let all = registers.chain(mcu.float_registers()).chain(memory);
    (
        mcu.now().units(),
        mcu.cycles(),
        mcu.exception(),
        all.collect(),
    )
}

/// Runs both for so many cycles, watched or not.
fn run_both(chips: &mut [Stm32f405; 2], cycles: u64, is_watched: bool) -> bool {
    let time = Time::from_units(cycles * UNITS);
    let mut steps = [Steps::default(), Steps::default()];
    for (mcu, steps) in chips.iter_mut().zip(&mut steps) {
        let end = mcu.now() + time;
        if is_watched {
            mcu.watch_until(end, steps);
        } else {
            mcu.run_until(end);
        }
    }
    state(&chips[0]) == state(&chips[1]) && steps[0].0 == steps[1].0
}

/// The library has executed all of the first; of the second the fast path has executed at
/// least this share. Else the library would be compared with itself.
fn check_shares(chips: &[Stm32f405; 2], least_percent: u64) {
    let [library, fast] = chips
        .each_ref()
        .map(|mcu| 100 * mcu.fast_cycles() / mcu.cycles());
    println!("the fast path: {fast} %");
    assert!(library == 0 && fast >= least_percent, "{library}, {fast} %");
}

/// Compares random programs of such instructions, of which the fast path executes at least a
/// share.
fn compare(
    least_percent: u64,
    rounds: u32,
    chip: impl Fn() -> Stm32f405,
    next: fn(&mut Rng) -> Vec<u16>,
    core: fn(&mut Rng) -> Vec<(u32, u32)>,
) {
    let mut random = Rng::with_seed(1);
    let mut chips = both(chip);
    for _ in 0..rounds {
        let mut code = Vec::new();
        while code.len() < HALF_WORDS - 2 {
            code.extend(next(&mut random));
        }
        // `mrs`, which shows the flags; `b .`
        code.extend([0xf3ef, 0x8000 | random.u16(..13) << 8, 0xe7fe]);
        let start = Start {
            code,
            table: (0..WORDS)
                .map(|place| match place {
                    0..CORE_WORDS => value(&mut random),
                    _ => float_value(&mut random),
                })
                .collect(),
            core: core(&mut random),
        };
        for mcu in &mut chips {
            let code: Vec<u8> = start
                .code
                .iter()
                .flat_map(|half| half.to_le_bytes())
                .collect();
            let table: Vec<u8> = start
                .table
                .iter()
                .flat_map(|word| word.to_le_bytes())
                .collect();
            mcu.patch_flash(COMPARED, &code);
            mcu.patch_flash(TABLE, &table);
            mcu.reset(Reset::Pin);
            for (address, value) in &start.core {
                mcu.poke(*address, *value);
            }
        }
        let is_watched = random.bool();
        for cycles in [random.u64(1..CYCLES), CYCLES] {
            let is_same = run_both(&mut chips, cycles, is_watched);
            assert!(is_same, "after {cycles} cycles: {start:08x?}");
        }
    }
    check_shares(&chips, least_percent);
}

/// A chip whose flash makes the core wait, with prefetch and both caches.
fn waiting(has_floats: bool) -> Stm32f405 {
    let mut mcu = chip(has_floats);
    mcu.model_flash();
    mcu
}

fn nothing(_: &mut Rng) -> Vec<(u32, u32)> {
    Vec::new()
}

fn floats_on(_: &mut Rng) -> Vec<(u32, u32)> {
    vec![(CPACR, FLOATS_ON)]
}

/// Five wait states, with or without prefetch and caches.
fn waits(random: &mut Rng) -> Vec<(u32, u32)> {
    vec![(CPACR, FLOATS_ON), (ACR, random.u32(..8) << 8 | 5)]
}

#[test]
fn instructions_of_16_bits_are_executed_as_by_the_library() {
    compare(15, 8_000, || chip(false), narrow, nothing);
}

#[test]
fn instructions_of_32_bits_are_executed_as_by_the_library() {
    compare(15, 8_000, || chip(false), wide, nothing);
}

#[test]
fn conditional_blocks_are_executed_as_by_the_library() {
    compare(40, 8_000, || chip(false), it_block, nothing);
}

#[test]
fn what_the_mpu_refuses_and_traps_fault_as_in_the_library() {
    compare(15, 8_000, || chip(false), narrow_or_wide, core_registers);
}

#[test]
fn floats_are_calculated_as_by_the_library() {
    compare(40, 16_000, || chip(true), float, floats_on);
}

#[test]
fn flash_makes_it_wait_as_the_library() {
    compare(50, 8_000, || waiting(false), narrow_or_wide, waits);
    compare(80, 8_000, || waiting(true), float, waits);
}

/// A program that is interrupted by one that is interrupted, of some instructions in
/// some order.
fn interrupted(random: &mut Rng, period: u32, code: &[&[u16]], handled: &[u16]) -> Image {
    let mut program = Assembler::interrupted(period, 3);
    let begin = program.0.len();
    for _ in 0..12 {
        for half in *random.choice(code).unwrap() {
            program.raw(*half);
        }
    }
    program.raw(0xb662);
    let back = u16::try_from(program.0.len() - begin + 2).unwrap();
    program.raw(0xe000 | 0x7ff & 0_u16.wrapping_sub(back));
    // The flags of both timers off, the second's a while later; `bx lr`.
    let mut handler = Assembler::default();
    handler.raw(0x2300).store(3, 4, 0x10);
    for half in handled {
        handler.raw(*half);
    }
    handler.load(2, 0x4000_0410).raw(0x3701).raw(0x6077);
    handler.store(3, 2, 0).raw(0x4770);
    image(&program, &handler)
}

fn compare_interrupted(chip: impl Fn(u32, &mut Rng) -> Stm32f405) {
    for period in [61, 97, 200] {
        let mut chips = both(|| chip(period, &mut Rng::with_seed(1)));
        let mut random = Rng::with_seed(2);
        for round in 0..2_000 {
            let is_watched = random.bool();
            let is_same = run_both(&mut chips, random.u64(1..60), is_watched);
            assert!(is_same, "period {period}, slice {round}");
        }
        let entries = chips[0].register(7);
        assert!(entries > 100, "{entries}");
        check_shares(&chips, 12);
    }
}

#[test]
fn interrupts_come_at_the_same_cycle() {
    // `adds r3, #1`, `str r3, [r6, #64]`, `ldr r5, [r6, #64]`, `cpsid i`, `cpsie i`.
    let code: [&[u16]; 5] = [&[0x3301], &[0x6433], &[0x6c35], &[0xb672], &[0xb662]];
    compare_interrupted(|period, random| Stm32f405::new(&interrupted(random, period, &code, &[])));
}

#[test]
fn floats_of_what_is_interrupted_are_saved_alike() {
    // `vadd s1, s2, s3`, `vldr s2, [r6, #64]`, `vstr s1, [r6, #64]`, `vmov s3, r3`,
    // `adds r3, #1`.
    let code: [&[u16]; 5] = [
        &[0xee71, 0x0a21],
        &[0xed96, 0x1a10],
        &[0xedc6, 0x0a10],
        &[0xee01, 0x3a90],
        &[0x3301],
    ];
    // `vadd s1, s1, s1` in the handler; with and without lazy saving, and without any.
    for fpccr in [3_u32 << 30, 1 << 31, 0] {
        for handled in [&[0xee70_u16, 0x0aa0][..], &[]] {
            compare_interrupted(|period, random| {
                let mut mcu = Stm32f405::new(&interrupted(random, period, &code, handled));
                mcu.poke(CPACR, FLOATS_ON);
                mcu.poke(FPCCR, fpccr);
                mcu
            });
        }
    }
}
