//! When a program cannot go on: outputs off, the reason kept, a new start.
//!
//! The next start finds the reason, is in a fault of its own and says so to
//! the host. Nothing is logged here: that takes longer than a motor should
//! wait.

use crate::kept::{Kept, Reason};
use crate::raw;
use core::panic::PanicInfo;
use cortex_m::peripheral::SCB;

/// Outputs off, then a new start that knows the reason.
pub(crate) fn stop(reason: Reason, detail: u32) -> ! {
    raw::outputs_off();
    cortex_m::interrupt::disable();
    let kept = Kept::of(raw::kept_words()).unwrap_or_default();
    let words = Kept {
        reason,
        detail,
        ..kept
    }
    .words();
    raw::keep_words(words);
    SCB::sys_reset()
}

/// A new start that somebody asked for.
pub fn reboot() -> ! {
    stop(Reason::Asked, 0)
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    stop(
        Reason::Panic,
        info.location().map_or(0, core::panic::Location::line),
    )
}
