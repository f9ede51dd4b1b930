//! State that the library loses when an exception is taken, and that a core
//! keeps (ARM DDI 0403E B1.5.6, B1.5.7).
//!
//! - `ITSTATE` is not stacked: the rest of an `IT` block would be executed
//!   unconditionally after the return.
//! - `FPSCR` is reset before it is stacked: a comparison would lose its result
//!   if an interrupt comes between `VCMP` and `VMRS`.

use super::Stm32f405;
use rsemu::core::space::MemAttrs;
use rsemu::core::value::Width;
use rsemu::cpu::arm::v7m::xpsr;

/// In `EXC_RETURN`: the frame is on the process stack.
const ON_PROCESS_STACK: u32 = 1 << 2;

/// Offset of xPSR in a frame.
const XPSR: u32 = 28;

/// State of a core before a step.
pub(super) struct Before {
    it: u32,
    active: u32,
}

impl Stm32f405 {
    /// Before a step: the library resets `FPSCR` to `FPDSCR`, so let it be the same.
    pub(super) fn keep_exception_state(&self) -> Before {
        let fpscr = self.core.fpscr();
        let active = self.core.with_sys(|sys| {
            sys.fpdscr = fpscr;
            sys.active_count()
        });
        Before {
            it: self.core.xpsr() & xpsr::IT_MASK,
            active,
        }
    }

    /// After it: adds `ITSTATE` to the frame, if an exception has been taken.
    pub(super) fn restore_exception_state(&self, before: &Before) {
        if before.it == 0 || self.core.with_sys(|sys| sys.active_count()) <= before.active {
            return;
        }
        let registers = self.core.regs();
        let frame = if registers.r[14] & ON_PROCESS_STACK == 0 {
            registers.msp
        } else {
            registers.psp
        };
        let (space, at) = (&self.memory.space, u64::from(frame + XPSR));
        if let Ok(stacked) = space.read(at, Width::U32, MemAttrs::DEBUG) {
            let stacked = stacked | u64::from(before.it);
            // A frame that cannot be written has been reported by the core.
            let _ = space.write(at, Width::U32, stacked, MemAttrs::DEBUG);
        }
    }
}
