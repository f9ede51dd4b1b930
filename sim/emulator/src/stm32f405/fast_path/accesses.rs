//! Loads and stores of plain instructions.
//!
//! All that can end the fast path comes before the first store.

use super::arithmetic::{extended, offset};
use super::executor::Executor;
use super::permissions::is_one_piece;
use rsemu::cpu::arm::v7m::isa::{Insn, MemOffset};
use rsemu::cpu::arm::v7m::sys::{Access, ccr};

impl Executor<'_> {
    pub(super) fn load_or_store(&mut self, instruction: &Insn) -> Option<()> {
        let Insn::LoadStore {
            load,
            size,
            signed,
            rt,
            rn,
            offset: by,
            index,
            add,
            wback,
            ..
        } = *instruction
        else {
            return None;
        };
        let base = self.get(rn);
        let by = match by {
            MemOffset::Imm(value) => value,
            MemOffset::Reg { rm, lsl } => self.get(rm) << lsl,
        };
        let end = offset(base, by, add);
        let address = if index { end } else { base };
        let bytes = size.bytes();
        if load {
            let value = extended(self.load(address, bytes, false)?, size, signed);
            if rt == 15 {
                self.jump(value)?;
            }
            if wback {
                self.set(rn, end);
            }
            self.set(rt, value);
            return Some(());
        }
        self.store(address, bytes, self.get(rt))?;
        if wback {
            self.set(rn, end);
        }
        Some(())
    }

    pub(super) fn dual(&mut self, instruction: &Insn) -> Option<()> {
        let Insn::LoadStoreDual {
            load,
            rt,
            rt2,
            rn,
            imm,
            index,
            add,
            wback,
        } = *instruction
        else {
            return None;
        };
        let base = if rn == 15 {
            self.r[15] & !3
        } else {
            self.get(rn)
        };
        let end = offset(base, imm, add);
        let address = if index { end } else { base };
        let second = address.wrapping_add(4);
        if load {
            let low = self.load(address, 4, true)?;
            let high = self.load(second, 4, true)?;
            self.set(rt, low);
            self.set(rt2, high);
        } else {
            if !address.is_multiple_of(4) || !self.may_store(second, 4) {
                return None;
            }
            self.store(address, 4, self.get(rt))?;
            self.store(second, 4, self.get(rt2))?;
        }
        if wback {
            self.set(rn, end);
        }
        Some(())
    }

    /// Loads the registers of a list; written back is the base with its new value.
    pub(super) fn load_multiple(
        &mut self,
        start: u32,
        list: u16,
        written_back: Option<(u8, u32)>,
    ) -> Option<()> {
        let mut values = [0; 16];
        let mut address = start;
        for register in registers(list) {
            values[register] = self.load(address, 4, true)?;
            address = address.wrapping_add(4);
        }
        if list >> 15 == 1 {
            self.jump(values[15])?;
        }
        if let Some((register, end)) = written_back {
            self.set(register, end);
        }
        for register in registers(list & 0x7fff) {
            self.r[register] = values[register];
        }
        Some(())
    }

    /// Stores the registers of a list; written back is the base with its new value.
    pub(super) fn store_multiple(
        &mut self,
        start: u32,
        list: u16,
        written_back: Option<(u8, u32)>,
    ) -> Option<()> {
        if !start.is_multiple_of(4) {
            return None;
        }
        let words = (start..).step_by(4).take(list.count_ones() as usize);
        for address in words.clone() {
            if !self.may_store(address, 4) {
                return None;
            }
        }
        for (address, register) in words.zip(registers(list)) {
            self.store(address, 4, self.r[register])?;
        }
        if let Some((register, end)) = written_back {
            self.set(register, end);
        }
        Some(())
    }

    /// `None` if the MPU refuses a fetch.
    #[inline]
    pub(super) fn may_fetch(&mut self, pc: u32, width: u32) -> Option<()> {
        self.may(pc, width, Access::Fetch).then_some(())
    }

    /// Returns whether the MPU permits an access. The first and the last byte decide.
    #[inline]
    fn may(&mut self, address: u32, bytes: u32, access: Access) -> bool {
        let (core, is_privileged) = (self.core, self.is_privileged);
        let last = address.wrapping_add(bytes - 1);
        let mut permits = |at| self.permissions.permits(core, at, access, is_privileged);
        permits(address) && (is_one_piece(address, last) || permits(last))
    }

    /// Returns whether an access of this alignment is one without a fault.
    fn is_aligned(&self, address: u32, bytes: u32, is_always: bool) -> bool {
        address.is_multiple_of(bytes) || !is_always && self.ccr & ccr::UNALIGN_TRP == 0
    }

    #[inline]
    pub(super) fn load(&mut self, address: u32, bytes: u32, must_align: bool) -> Option<u32> {
        if !self.is_aligned(address, bytes, must_align) || !self.may(address, bytes, Access::Read) {
            return None;
        }
        let value = self.windows.read(address, bytes)?;
        self.timing.data(address, bytes)?;
        self.cycles += 1;
        Some(value)
    }

    pub(super) fn may_store(&mut self, address: u32, bytes: u32) -> bool {
        self.windows.is_writable(address, bytes) && self.may(address, bytes, Access::Write)
    }

    #[inline]
    pub(super) fn store(&mut self, address: u32, bytes: u32, value: u32) -> Option<()> {
        if !self.is_aligned(address, bytes, false) || !self.may(address, bytes, Access::Write) {
            return None;
        }
        self.windows.write(address, bytes, value)?;
        self.cycles += 1;
        Some(())
    }
}

/// The registers of a list, the lowest first.
fn registers(list: u16) -> impl Iterator<Item = usize> + Clone {
    (0..16).filter(move |register| list >> register & 1 == 1)
}
