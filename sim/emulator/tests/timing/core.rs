//! Timing whose answer is known: what the architecture's manual says of a
//! Cortex-M4 without wait states.

use crate::assembler::{Assembler, RAM, UNITS, image};
use crepitus_emulator::cycles::Cycles;
use crepitus_emulator::{Image, Stm32f405, Time};
use std::collections::BTreeSet;

/// TIM2 overflows every `period` clocks of the core; what then goes on for
/// ever is `rest`. The handler writes what the counter says, as its first
/// instruction reads it, to RAM.
pub(crate) fn latency_image(period: u32, rest: &[u16]) -> Image {
    let mut program = Assembler::interrupted(period, 1);
    program.0.extend(rest);
    let mut handler = Assembler::default();
    handler.fetch(5, 4, 0x24);
    // The flag off; `movs r3, #0`.
    handler.raw(0x2300).store(3, 4, 0x10);
    handler.store(5, 6, 0);
    // `adds r6, #4`; `bx lr`.
    handler.raw(0x3604).raw(0x4770);
    image(&program, &handler)
}

fn latencies(period: u32, rest: &[u16]) -> Vec<u32> {
    let mut mcu = Stm32f405::new(&latency_image(period, rest));
    mcu.run_until(Time::from_units(u64::from(period) * UNITS * 205));
    assert_eq!(mcu.not_modelled(), [""; 0]);
    (0..200).map(|n| mcu.peek(RAM + 4 * n).unwrap()).collect()
}

#[test]
fn entry_takes_twelve_cycles_after_the_instruction_that_is_interrupted() {
    // `b .` takes three: the interrupt finds it at its end, or one or two
    // cycles before. The handler's return begins the loop again, so which one
    // depends on the period.
    let periods = 1_000..1_003;
    let seen: BTreeSet<u32> = periods
        .flat_map(|period| latencies(period, &[0xe7fe]))
        .collect();
    assert_eq!(seen, [12, 13, 14].into());
}

#[test]
fn a_core_that_sleeps_is_there_in_twelve() {
    // `wfi`; `b .-2`
    for latency in latencies(1_000, &[0xbf30, 0xe7fd]) {
        assert!((12..=13).contains(&latency), "{latency}");
    }
}

#[test]
fn instructions_take_what_the_manual_says() {
    // `adds r0, r0, r0`; `ldr r0, [r6]`; `str r0, [r6]`; `b` to the first.
    // 1 + 2 + 2 + (1 + P), P of 1 to 3: here 2.
    let mut program = Assembler::default();
    program.load(6, RAM);
    program.0.extend([0x1800, 0x6830, 0x6030, 0xe7fb]);
    let mut mcu = Stm32f405::new(&image(&program, &Assembler::default()));
    mcu.run_until(Time::from_us(100));
    let (begin, cycles) = (mcu.now(), mcu.cycles());
    let at = mcu.program_counter();
    let mut rounds = 0;
    for _ in 0..4_000 {
        mcu.run_until(mcu.now() + Time::from_units(1));
        rounds += u64::from(mcu.program_counter() == at);
    }
    assert_eq!(rounds, 1_000);
    assert_eq!(mcu.cycles() - cycles, 8 * rounds);
    assert_eq!(mcu.now() - begin, Time::from_units(8 * rounds * UNITS));
}

#[test]
fn a_task_costs_entry_instructions_and_return() {
    let mut mcu = Stm32f405::new(&latency_image(1_000, &[0xe7fe]));
    let mut cycles = Cycles::default();
    mcu.watch_until(Time::from_us(1_000), &mut cycles);
    let cost = cycles.costs()[&(16 + 28)];
    assert!(cost.calls > 10);
    assert_eq!(cost.instructions, 6 * cost.calls);
    // Entry 12; ldr 2, movs 1, str 2, str 2, adds 1; return 10. The branch
    // that returns is part of the return, or costs a little of its own.
    let known = 12 + 8 + 10;
    assert!((known..=known + 3).contains(&cost.worst_cycles), "{cost:?}");
    assert_eq!(cost.cycles, cost.worst_cycles * cost.calls);
    assert!(cycles.preemptions().is_empty());
}
