//! Waits for registers of peripherals: the table in `chip/bus_waits.rs`.

use crate::assembler::{Assembler, image};
use crepitus_emulator::mcu::{Step, Watch};
use crepitus_emulator::{Stm32f405, Time};

/// Registers: on APB1, APB2, AHB1, AHB2; and memory.
const PLACES: [u32; 6] = [
    0x4000_0000,
    0x4001_0000,
    0x4002_0000,
    0x5006_0800,
    0x2000_0000,
    0x1000_0000,
];

#[derive(Default)]
struct Waits(Vec<u32>);

impl Watch for Waits {
    fn step(&mut self, step: &Step) {
        self.0.push(step.waits);
    }
}

/// Waits of a load and of a store at each place, with these prescalers.
fn waits(prescalers: u32) -> Vec<(u32, u32)> {
    let mut program = Assembler::default();
    program.load(0, 0x4002_3808).load(1, prescalers);
    program.store(1, 0, 0);
    for place in PLACES {
        program.load(0, place).fetch(2, 0, 0).store(2, 0, 0);
    }
    program.raw(0xe7fe);
    let mut mcu = Stm32f405::new(&image(&program, &Assembler::default()));
    mcu.model_flash();
    let mut waits = Waits::default();
    mcu.watch_until(Time::from_us(50), &mut waits);
    // The reset, `load`, `load`, `store`; then four instructions for each.
    let places = waits.0[6..].chunks(4).take(PLACES.len());
    places.map(|place| (place[2], place[3])).collect()
}

#[test]
fn a_register_waits_for_its_bus() {
    let each = |waits: [u32; 6]| waits.map(|waits| (waits, waits));
    assert_eq!(waits(0), each([3, 3, 1, 1, 0, 0]));
    // As the firmware has them: APB1 at a fourth, APB2 at half.
    let prescalers = 0b101 << 10 | 0b100 << 13;
    assert_eq!(waits(prescalers), each([11, 5, 1, 1, 0, 0]));
}
