//! Fatal errors and reboots: outputs off, the reason stored, then a reset.
//!
//! The next start reads the reason, raises a fault and reports it to the
//! host. Nothing is logged here: that would delay switching off the motor.

use crate::raw;
use crate::reset_record::{Reason, ResetRecord};
use core::panic::PanicInfo;
use cortex_m::peripheral::SCB;

/// Turns outputs off, stores the reason and resets the processor.
pub(crate) fn stop(reason: Reason, detail: u32) -> ! {
    raw::outputs_off();
    cortex_m::interrupt::disable();
    let record = ResetRecord::of(raw::record_words()).unwrap_or_default();
    let words = ResetRecord {
        reason,
        detail,
        ..record
    }
    .words();
    raw::store_record_words(words);
    SCB::sys_reset()
}

/// Resets the processor at the host's request.
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
