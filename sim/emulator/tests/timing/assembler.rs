//! Tiny programs for a core without an operating system.

use crepitus_emulator::Image;

pub(crate) const TIM2: u32 = 0x4000_0000;
pub(crate) const RAM: u32 = 0x2000_0000;

/// The internal oscillator of 16 MHz, with which the chip starts: units of
/// time in a cycle.
pub(crate) const UNITS: u64 = 21;

/// A program, half a word at a time.
#[derive(Default)]
pub(crate) struct Assembler(pub(crate) Vec<u16>);

impl Assembler {
    /// A program that begins with TIM2 (bit 0 of `timers`) and TIM3 (bit 1) overflowing
    /// every `period` clocks of the core, with an interrupt each. TIM2 is in `r4`,
    /// RAM in `r6`, 1 in `r1`.
    pub(crate) fn interrupted(period: u32, timers: u32) -> Self {
        let mut program = Self::default();
        // The clocks of both on.
        program.load(0, 0x4002_3840).load(1, 3).store(1, 0, 0);
        program.load(0, 0xe000_e100).load(2, timers << 28);
        program.store(2, 0, 0).load(1, 1).load(6, RAM);
        for timer in (0..2).rev().filter(|timer| timers >> timer & 1 == 1) {
            program.load(4, TIM2 + 0x400 * timer);
            program.load(2, period - 1).store(2, 4, 0x2c);
            program.store(1, 4, 0x0c).store(1, 4, 0x00);
        }
        program
    }

    /// `movw`, `movt`.
    pub(crate) fn load(&mut self, register: u16, value: u32) -> &mut Self {
        for (operation, half) in [(0xf240, value & 0xffff), (0xf2c0, value >> 16)] {
            let half = u16::try_from(half).unwrap();
            let (top, i) = (half >> 12, half >> 11 & 1);
            self.0.push(operation | i << 10 | top);
            self.0
                .push((half >> 8 & 7) << 12 | register << 8 | half & 0xff);
        }
        self
    }

    /// `str value, [base, #offset]`
    pub(crate) fn store(&mut self, value: u16, base: u16, offset: u16) -> &mut Self {
        self.raw(0x6000 | ((offset / 4) << 6) | (base << 3) | value)
    }

    /// `ldr value, [base, #offset]`
    pub(crate) fn fetch(&mut self, value: u16, base: u16, offset: u16) -> &mut Self {
        self.raw(0x6800 | ((offset / 4) << 6) | (base << 3) | value)
    }

    pub(crate) fn raw(&mut self, instruction: u16) -> &mut Self {
        self.0.push(instruction);
        self
    }
}

/// Offsets at which the program and the handler of the timers begin.
pub(crate) const PROGRAM: usize = 0x200;
pub(crate) const HANDLER: usize = 0x300;

pub(crate) fn image(program: &Assembler, handler: &Assembler) -> Image {
    image_of(&[(PROGRAM, &program.0), (HANDLER, &handler.0)])
}

/// An image of pieces at their offsets; the program and the handler of the timers
/// begin where they always do.
pub(crate) fn image_of(pieces: &[(usize, &[u16])]) -> Image {
    let mut flash = vec![0xff; 0x2000];
    let mut vector = |number: usize, value: usize| {
        let value = u32::try_from(value).unwrap().to_le_bytes();
        flash[4 * number..4 * number + 4].copy_from_slice(&value);
    };
    vector(0, 0x2000_8000);
    vector(1, 0x0800_0001 + PROGRAM);
    vector(16 + 28, 0x0800_0001 + HANDLER);
    vector(16 + 29, 0x0800_0001 + HANDLER);
    for (begin, code) in pieces {
        for (place, half) in flash[*begin..].chunks_mut(2).zip(*code) {
            place.copy_from_slice(&half.to_le_bytes());
        }
    }
    Image::of_flash(&flash)
}
