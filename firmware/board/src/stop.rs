//! Fatal errors and reboots: outputs off, the reason stored, then a reset.
//!
//! The next start reads the reason, raises a fault and reports it to the
//! host. Nothing is logged here: that would delay switching off the motor.

use crate::crash;
use crate::raw;
use crate::reset_record::{Reason, ResetRecord};
use core::panic::PanicInfo;
use cortex_m::peripheral::SCB;
use cortex_m::register::msp;
use crepitus_protocol::crash::{self as record, End, Head};

/// End of a program.
pub(crate) struct Ended {
    reason: Reason,
    /// Record for the next start, and for people.
    crash: Option<Head>,
}

impl Ended {
    /// End by a processor fault, whose frame is at this address: r0 to r3, r12, LR, PC,
    /// xPSR.
    pub(crate) fn by_fault(frame: u32) -> Self {
        let [_, _, _, _, _, lr, pc, xpsr] = raw::stack(frame);
        let [cfsr, hfsr, mmfar, bfar] = raw::fault_registers();
        Self {
            reason: Reason::Fault,
            crash: Some(Head {
                registers: [pc, lr, frame, xpsr, cfsr, hfsr, mmfar, bfar],
                stack: raw::stack(frame),
                ..Head::new(0, End::Fault, pc)
            }),
        }
    }

    /// End by an exception without a handler.
    pub(crate) fn unhandled(number: u16) -> Self {
        Self {
            reason: Reason::Unhandled,
            crash: Some(here(End::Unhandled, number.into())),
        }
    }

    fn by_panic(info: &PanicInfo) -> Self {
        let location = info.location();
        let line = location.map_or(0, core::panic::Location::line);
        let file = location.map_or("", core::panic::Location::file);
        Self {
            reason: Reason::Panic,
            crash: Some(Head {
                place: record::place(file),
                ..here(End::Panic, line)
            }),
        }
    }
}

/// Returns the head of a record with the stack as it is.
fn here(end: End, detail: u32) -> Head {
    let sp = msp::read();
    Head {
        registers: [0, 0, sp, 0, 0, 0, 0, 0],
        stack: raw::stack(sp),
        ..Head::new(0, end, detail)
    }
}

/// Turns outputs off, stores how the program ended and resets the processor.
pub(crate) fn stop(ended: &Ended) -> ! {
    raw::outputs_off();
    cortex_m::interrupt::disable();
    let record = ResetRecord::of(raw::record_words()).unwrap_or_default();
    let words = ResetRecord {
        reason: ended.reason,
        detail: ended.crash.as_ref().map_or(0, |head| head.detail),
        ..record
    }
    .words();
    raw::store_record_words(words);
    if let Some(head) = &ended.crash {
        crash::keep(&Head {
            start: record.start,
            ..*head
        });
    }
    SCB::sys_reset()
}

/// Resets the processor at the host's request.
pub fn reboot() -> ! {
    stop(&Ended {
        reason: Reason::Asked,
        crash: None,
    })
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    raw::outputs_off();
    stop(&Ended::by_panic(info))
}
