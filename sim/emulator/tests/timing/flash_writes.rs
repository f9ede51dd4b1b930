//! A core that programs flash stands while that lasts, and all else runs on.

use crate::assembler::{Assembler, RAM, UNITS, image};
use crepitus_emulator::{Stm32f405, Time};

const FLASH: u32 = 0x4002_3c00;
const PLACE: u32 = 0x0800_8000;

/// Programs so many bytes one after the other without waiting, and then counts in
/// RAM for ever.
fn program(bytes: u16) -> Assembler {
    let mut program = Assembler::default();
    program.load(0, FLASH).load(2, 0x4567_0123).store(2, 0, 4);
    program.load(2, 0xcdef_89ab).store(2, 0, 4);
    program.load(2, 1).store(2, 0, 0x10);
    program.load(3, PLACE).load(2, 0x5a).load(6, RAM);
    for n in 0..bytes {
        // `strb r2, [r3, #n]`
        program.raw(0x7000 | n << 6 | 3 << 3 | 2);
    }
    // `movs r1, #0`; `adds r1, #1`; `str r1, [r6]`; `b` to `adds`.
    program.0.extend([0x2100, 0x3101, 0x6031, 0xe7fc]);
    program
}

/// Time until the program counts.
fn counts_after(bytes: u16) -> Time {
    let mut mcu = Stm32f405::new(&image(&program(bytes), &Assembler::default()));
    mcu.poke(RAM, 0);
    while mcu.peek(RAM) == Some(0) {
        let next = mcu.now() + Time::from_units(UNITS);
        mcu.run_until(next);
    }
    assert_eq!(mcu.not_modelled(), [""; 0]);
    let words = bytes.div_ceil(4);
    for n in 0..u32::from(words) {
        assert_ne!(mcu.peek(PLACE + 4 * n), Some(u32::MAX));
    }
    mcu.now()
}

#[test]
fn each_byte_stops_the_core_for_sixteen_microseconds() {
    let begin = counts_after(0);
    for bytes in [1, 4, 16] {
        let took = counts_after(bytes) - begin;
        let us = took.units() / 336;
        let expected = 16 * u64::from(bytes);
        // And the store itself, two cycles of 16 MHz.
        assert!(
            (expected..=expected + u64::from(bytes)).contains(&us),
            "{bytes}: {us} µs"
        );
    }
}

#[test]
fn the_cycles_in_which_it_stands_are_none() {
    let image = image(&program(16), &Assembler::default());
    let mut mcu = Stm32f405::new(&image);
    mcu.run_until(Time::from_us(250));
    assert!(mcu.cycles() < 200, "{}", mcu.cycles());
}
