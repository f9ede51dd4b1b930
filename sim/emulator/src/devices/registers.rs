//! Registers of our own devices: words, as the bridges to an APB have them.

use rsemu::core::error::BusError;
use rsemu::core::space::{MemAttrs, MemOps, MemResult};
use std::fmt;
use std::sync::Arc;

/// Words at multiples of four.
pub(crate) trait Words: Send + Sync {
    /// Reads the word at `offset`; a debugger's read has no side effects.
    fn read(&self, offset: u32, is_debugger: bool) -> u32;

    /// Writes the word at `offset`.
    fn write(&self, offset: u32, value: u32);
}

/// Words as the bus wants them.
pub(crate) struct AsRegisters<T>(pub(crate) Arc<T>);

impl<T> fmt::Debug for AsRegisters<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("registers")
    }
}

impl<T: Words> MemOps for AsRegisters<T> {
    fn read(&self, offset: u64, into: &mut [u8], attrs: MemAttrs) -> MemResult {
        let offset = u32::try_from(offset).map_err(|_| BusError::Unassigned)?;
        let word = self.0.read(offset, attrs.debug).to_le_bytes();
        for (place, byte) in into.iter_mut().zip(word) {
            *place = byte;
        }
        Ok(())
    }

    fn write(&self, offset: u64, from: &[u8], _: MemAttrs) -> MemResult {
        let offset = u32::try_from(offset).map_err(|_| BusError::Unassigned)?;
        let word = from.try_into().map_err(|_| BusError::BadAccess)?;
        self.0.write(offset, u32::from_le_bytes(word));
        Ok(())
    }
}
