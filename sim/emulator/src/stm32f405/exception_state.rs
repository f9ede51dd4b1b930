//! State that the library loses when an exception is taken, and that a core
//! keeps (ARM DDI 0403E B1.5.6, B1.5.7).
//!
//! - `ITSTATE` is not stacked: the rest of an `IT` block would be executed
//!   whatever its condition after the return.
//! - `FPSCR` is reset before it is stacked: a comparison would lose its result
//!   if an interrupt comes between `VCMP` and `VMRS`.

use super::Stm32f405;
use rsemu::core::space::MemAttrs;
use rsemu::core::value::Width;
use rsemu::cpu::arm::v7m::{ArmV7m, xpsr};

/// Offset of xPSR in a frame, which is on the only stack that we use.
const XPSR: u32 = 28;

/// State of the core before a step that may begin with an interrupt.
pub(super) struct Before {
    xpsr: u32,
    fpscr: u32,
}

impl Before {
    pub(super) fn step(core: &ArmV7m) -> Self {
        Self {
            xpsr: core.xpsr(),
            fpscr: core.fpscr(),
        }
    }
}

impl Stm32f405 {
    /// Restores `FPSCR` after the step that has taken an exception.
    pub(super) fn keep_flags(&self, before: &Before) {
        self.core.set_fpscr(before.fpscr);
    }

    /// Adds `ITSTATE` to a frame, after the step that has stacked the frame.
    pub(super) fn keep_it_block(&self, before: &Before) {
        let it = before.xpsr & xpsr::IT_MASK;
        if it == 0 {
            return;
        }
        let at = u64::from(self.core.reg(13).wrapping_add(XPSR));
        let space = &self.memory.space;
        if let Ok(stacked) = space.read(at, Width::U32, MemAttrs::DEBUG) {
            let stacked = stacked | u64::from(it);
            // A frame that cannot be written has been reported by the core.
            let _ = space.write(at, Width::U32, stacked, MemAttrs::DEBUG);
        }
    }
}
