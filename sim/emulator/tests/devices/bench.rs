//! A chip whose core stands.

use crepitus_emulator::{Image, Stm32f405, Time};

/// A program that only loops.
const LOOP: [u8; 12] = [0, 0, 1, 0x20, 9, 0, 0, 8, 0xfe, 0xe7, 0xfe, 0xe7];

pub(crate) struct Bench(pub(crate) Stm32f405);

impl Bench {
    pub(crate) fn new() -> Self {
        let mut mcu = Stm32f405::new(&Image::of_flash(&LOOP));
        mcu.set_hung(true);
        Self(mcu)
    }

    pub(crate) fn read(&mut self, address: u32) -> u32 {
        self.0.load(address).expect("a register")
    }

    pub(crate) fn write(&mut self, address: u32, value: u32) {
        self.0.poke(address, value);
    }

    pub(crate) fn set(&mut self, address: u32, bits: u32) {
        let value = self.read(address);
        self.write(address, value | bits);
    }

    pub(crate) fn run_us(&mut self, us: u64) {
        let end = self.0.now() + Time::from_us(us);
        self.0.run_until(end);
    }
}
