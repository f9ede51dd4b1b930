//! State that a core keeps over an exception.

use crate::core::latency_image;
use crepitus_emulator::{Mcu, Stm32f405, Time};

/// Register 7 after some hundred interrupts of a loop that must not change it.
fn changes(period: u32, rest: &[u16]) -> u32 {
    let mut mcu = Stm32f405::new(&latency_image(period, rest));
    mcu.correct_exceptions();
    mcu.run_until(Time::from_us(20_000));
    mcu.register(7)
}

#[test]
fn an_it_block_goes_on_as_it_began() {
    // `movs r7, #0`; loop: `cmp r7, r7`; `itttt ne`; four times `addne r7, #1`;
    // `b` to the loop.
    let rest = [
        0x2700, 0x42bf, 0xbf1f, 0x3701, 0x3701, 0x3701, 0x3701, 0xe7f8,
    ];
    // Periods that find every place of the loop.
    for period in 501..510 {
        assert_eq!(changes(period, &rest), 0, "period {period}");
    }
}

#[test]
fn a_comparison_of_floats_keeps_its_result() {
    // `movs r7, #0`; CPACR: `movw r0, #0xed88`; `movt r0, #0xe000`;
    // `mov.w r1, #0xf00000`; `str r1, [r0]`; loop: `vcmp.f32 s0, s0`; `nop`;
    // `vmrs apsr, fpscr`; `it ne`; `addne r7, #1`; `b` to the loop.
    let rest = [
        0x2700, 0xf64e, 0x5088, 0xf2ce, 0x0000, 0xf44f, 0x0170, 0x6001, 0xeeb4, 0x0a40, 0xbf00,
        0xeef1, 0xfa10, 0xbf18, 0x3701, 0xe7f7,
    ];
    for period in 501..510 {
        assert_eq!(changes(period, &rest), 0, "period {period}");
    }
}
