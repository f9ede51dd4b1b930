//! The three converters at their place on the bus.

use super::Adc;
use crate::chip::part::Peripheral;
use crate::devices::registers::Words;
use rsemu::core::wire::{Level, WireId, WireSink};
use std::sync::Arc;

/// Bytes from the registers of a converter to those of the next; those of all
/// three follow.
const SPAN: u32 = 0x100;

/// Their common control register, as each of them keeps it.
const COMMON: u32 = 0x304;

/// The three converters at their place on the bus.
pub(crate) struct Adcs(pub(crate) [Arc<Adc>; 3]);

impl Adcs {
    fn of(&self, offset: u32) -> Option<(&Adc, u32)> {
        let adc = self.0.get((offset / SPAN) as usize)?;
        Some((adc, offset % SPAN))
    }
}

impl Words for Adcs {
    fn read(&self, offset: u32, is_debugger: bool) -> u32 {
        match self.of(offset) {
            Some((adc, offset)) => adc.read(offset, is_debugger),
            None => self.0[0].read(offset, is_debugger),
        }
    }

    fn write(&self, offset: u32, value: u32) {
        match self.of(offset) {
            Some((adc, offset)) => adc.write(offset, value),
            None if offset == COMMON => self.0.iter().for_each(|adc| adc.write(COMMON, value)),
            None => {}
        }
    }
}

impl Peripheral for Adcs {
    fn advance_to(&self, tick: u64) {
        self.0.iter().for_each(|adc| adc.advance_to(tick));
    }

    fn next_event(&self) -> Option<u64> {
        self.0.iter().filter_map(|adc| adc.next_event()).min()
    }

    fn reset(&self) {
        self.0.iter().for_each(|adc| adc.reset());
    }
}

impl WireSink for Adcs {
    fn set_level(&self, _: WireId, line: u32, level: Level) {
        self.0.iter().for_each(|adc| adc.set_trigger(line, level));
    }
}
