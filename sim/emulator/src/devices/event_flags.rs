//! Registers of a DMA controller that refuse to enable a stream whose event flags are set
//! (RM0090 10.5.5): silicon does not start it.

use crate::refusal::{Refusal, Refusals};
use rsemu::core::space::{AccessConstraints, MemAttrs, MemOps, MemResult};
use std::fmt;
use std::sync::Arc;

/// First register of stream 0, `DMA_S0CR`, and bytes of a stream's registers.
const STREAMS: u64 = 0x10;
const STREAM_BYTES: u64 = 0x18;

const ENABLE: u32 = 1;

/// Lowest bits of the flags of four streams in `DMA_LISR` and `DMA_HISR`, and their mask.
const SHIFTS: [u32; 4] = [0, 6, 16, 22];
const FLAGS: u32 = 0b11_1101;

/// The registers.
pub(crate) struct EventFlags {
    /// Number of the controller, from 1 on.
    pub(crate) controller: u8,
    pub(crate) registers: Arc<dyn MemOps>,
    pub(crate) refusals: Arc<Refusals>,
}

impl fmt::Debug for EventFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("registers of a DMA controller")
    }
}

/// The stream whose control register is at this offset.
fn stream(offset: u64) -> Option<u8> {
    let within = offset.checked_sub(STREAMS)?;
    let is_control = within.is_multiple_of(STREAM_BYTES);
    u8::try_from(within / STREAM_BYTES)
        .ok()
        .filter(|stream| is_control && *stream < 8)
}

impl EventFlags {
    fn word(&self, offset: u64) -> u32 {
        let mut word = [0; 4];
        let read = self.registers.read(offset, &mut word, MemAttrs::DEBUG);
        read.map_or(0, |()| u32::from_le_bytes(word))
    }

    fn check(&self, offset: u64, from: &[u8]) {
        let is_enabling = from.first().is_some_and(|low| low & 1 == 1);
        let Some(stream) = stream(offset).filter(|_| is_enabling) else {
            return;
        };
        let four = usize::from(stream % 4);
        let shift = SHIFTS.get(four).copied().unwrap_or_default();
        let status = self.word(u64::from(stream / 4) * 4);
        let flags = status >> shift & FLAGS;
        if flags != 0 && self.word(offset) & ENABLE == 0 {
            let controller = self.controller;
            self.refusals.refuse(Refusal::StreamFlags {
                controller,
                stream,
                flags,
            });
        }
    }
}

impl MemOps for EventFlags {
    fn read(&self, offset: u64, into: &mut [u8], attrs: MemAttrs) -> MemResult {
        self.registers.read(offset, into, attrs)
    }

    fn write(&self, offset: u64, from: &[u8], attrs: MemAttrs) -> MemResult {
        self.check(offset, from);
        self.registers.write(offset, from, attrs)
    }

    fn constraints(&self) -> AccessConstraints {
        self.registers.constraints()
    }
}
