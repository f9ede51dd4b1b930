//! Registers of the floating-point unit while the fast path runs.

use rsemu::cpu::arm::v7m::ArmV7m;

/// Registers of the unit, read when they are first needed.
#[derive(Clone, Copy, Default)]
pub(super) struct Floats {
    s: [u32; 32],
    known: u32,
    changed: u32,
    fpscr: Option<u32>,
    fpscr_changed: bool,
    /// An instruction of the unit has been executed.
    pub(super) is_used: bool,
}

impl Floats {
    /// Value of a register.
    #[inline]
    pub(super) fn get(&mut self, core: &ArmV7m, register: u8) -> u32 {
        let bit = 1 << (register & 31);
        if self.known & bit == 0 {
            self.known |= bit;
            self.s[usize::from(register & 31)] = core.s(register);
        }
        self.s[usize::from(register & 31)]
    }

    /// Sets a register.
    #[inline]
    pub(super) fn set(&mut self, register: u8, value: u32) {
        let bit = 1 << (register & 31);
        self.known |= bit;
        self.changed |= bit;
        self.s[usize::from(register & 31)] = value;
    }

    /// Value of FPSCR.
    #[inline]
    pub(super) fn fpscr(&mut self, core: &ArmV7m) -> u32 {
        *self.fpscr.get_or_insert_with(|| core.fpscr())
    }

    /// Sets FPSCR.
    #[inline]
    pub(super) fn set_fpscr(&mut self, value: u32) {
        self.fpscr_changed |= self.fpscr != Some(value);
        self.fpscr = Some(value);
    }

    /// Gives the library what has changed.
    pub(super) fn write_back(&self, core: &ArmV7m) {
        let mut changed = self.changed;
        for (register, value) in (0..).zip(self.s) {
            if changed == 0 {
                break;
            }
            if changed & 1 == 1 {
                core.set_s(register, value);
            }
            changed >>= 1;
        }
        if let Some(fpscr) = self.fpscr.filter(|_| self.fpscr_changed) {
            core.set_fpscr(fpscr);
        }
    }
}
