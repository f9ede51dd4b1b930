//! Registers of the core while the fast path runs.

use super::arithmetic::is_jump;
use super::float_registers::Floats;
use super::memory::Windows;
use super::permissions::Permissions;
use super::timing::Timing;
use rsemu::cpu::arm::v7m::{ArmV7m, xpsr};

/// Cycles of a branch that is taken, besides the instruction's one.
const REFILL: u64 = 2;

/// The core's registers while the fast path runs, and what it needs.
pub(super) struct Executor<'a> {
    pub(super) r: [u32; 16],
    pub(super) xpsr: u32,
    pub(super) cycles: u64,
    /// The instruction has set the program counter.
    pub(super) has_branched: bool,
    pub(super) ccr: u32,
    pub(super) is_privileged: bool,
    /// The floating-point unit is enabled and owes no saving of its registers.
    pub(super) has_floats: bool,
    pub(super) floats: Floats,
    pub(super) core: &'a ArmV7m,
    pub(super) permissions: &'a mut Permissions,
    pub(super) windows: &'a Windows,
    pub(super) timing: Timing<'a>,
}

impl Executor<'_> {
    /// Goes on at an address.
    #[inline]
    pub(super) fn branch(&mut self, target: u32) {
        self.r[15] = target & !1;
        self.has_branched = true;
        self.cycles += REFILL;
    }

    /// Goes on at an address from a register or from memory; `None` if that is an
    /// exception's return, or faults.
    #[inline]
    pub(super) fn jump(&mut self, address: u32) -> Option<()> {
        if !is_jump(address) {
            return None;
        }
        self.branch(address);
        Some(())
    }

    /// Value of a register.
    #[inline]
    pub(super) fn get(&self, register: u8) -> u32 {
        self.r[usize::from(register & 15)]
    }

    /// Sets a register other than the program counter.
    #[inline]
    pub(super) fn set(&mut self, register: u8, value: u32) {
        if register & 15 != 15 {
            self.r[usize::from(register & 15)] = value;
        }
    }

    /// Returns whether a flag is set.
    #[inline]
    pub(super) fn flag(&self, mask: u32) -> bool {
        self.xpsr & mask != 0
    }

    /// Sets or clears a flag.
    #[inline]
    pub(super) fn set_flag(&mut self, mask: u32, is_set: bool) {
        self.xpsr = self.xpsr & !mask | if is_set { mask } else { 0 };
    }

    /// Sets N and Z by a result.
    #[inline]
    pub(super) fn set_nz(&mut self, value: u32) {
        self.set_flag(xpsr::N, value >> 31 == 1);
        self.set_flag(xpsr::Z, value == 0);
    }

    /// Sets the state of an IT block.
    #[inline]
    pub(super) fn set_it_state(&mut self, it: u8) {
        let it = u32::from(it);
        self.xpsr = self.xpsr & !xpsr::IT_MASK | it >> 2 << 10 | (it & 3) << 25;
    }
}
