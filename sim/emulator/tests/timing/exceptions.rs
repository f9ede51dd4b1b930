//! A program does not notice that it is interrupted, wherever that is.

use crate::assembler::{Assembler, TIM2, image};
use crepitus_emulator::{Stm32f405, Time};

/// Register that counts the runs of a handler.
const RUNS: u8 = 5;
/// Register that is not zero once the program went wrong.
const WRONG: u8 = 7;

/// Goes round for ever; a condition that was wrong, or is forgotten, shows in `r7`.
const ROUND: [u16; 18] = [
    // `movs r7, #0`
    0x2700, //
    // `cmp r7, #0`; `itee eq`; `moveq r0, #0`; `movne r7, #1`; `movne r7, #2`
    0x2f00, 0xbf0e, 0x2000, 0x2701, 0x2702, //
    // `cmp r7, #1`; `it eq`; `moveq r7, #3`
    0x2f01, 0xbf08, 0x2703, //
    // `vcmp.f32 s0, s1`; `vmrs apsr_nzcv, fpscr`; `it ge`; `movge r7, #4`: 1 < 2
    0xeeb4, 0x0a60, 0xeef1, 0xfa10, 0xbfa8, 0x2704, //
    // `cmp r7, #0`; `beq` to the first comparison; `b .`
    0x2f00, 0xd0ef, 0xe7fe,
];

/// A handler of both timers.
fn handler(computes: bool) -> Assembler {
    let mut handler = Assembler::default();
    // Both flags off; `adds r5, #1`.
    handler.raw(0x2300).load(2, TIM2 + 0x400);
    handler.store(3, 4, 0x10).store(3, 2, 0x10).raw(0x3501);
    if computes {
        // `vadd.f32 s0, s0, s1`; `vcmp.f32 s1, s1`
        handler.raw(0xee30).raw(0x0a20).raw(0xeef4).raw(0x0a60);
    }
    handler.raw(0x4770);
    handler
}

fn check(timers: u32, computes: bool) {
    for period in 150..190 {
        let mut program = Assembler::interrupted(period, timers);
        program.load(5, 0);
        // The unit for floats on; `vmov.f32 s0, #1.0`; `vmov.f32 s1, #2.0`.
        program
            .load(0, 0xe000_ed88)
            .load(2, 0xf << 20)
            .store(2, 0, 0);
        program.raw(0xeeb7).raw(0x0a00).raw(0xeef0).raw(0x0a00);
        program.0.extend(ROUND);
        let mut mcu = Stm32f405::new(&image(&program, &handler(computes)));
        mcu.run_until(Time::from_us(2_000));
        assert_eq!(mcu.not_modelled(), [""; 0]);
        assert!(mcu.register(RUNS) > 150, "{}", mcu.register(RUNS));
        let wrong = mcu.register(WRONG);
        assert_eq!(wrong, 0, "{period}, {computes}");
    }
}

#[test]
fn conditions_and_comparisons_survive_an_interrupt() {
    check(1, false);
    check(1, true);
}

#[test]
fn they_survive_one_that_follows_another() {
    check(3, false);
    check(3, true);
}
