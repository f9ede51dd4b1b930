//! Entries of the processor's faults and of interrupts without a handler.
//!
//! | what | why it is sound |
//! |---|---|
//! | `HardFault` | the stack may be unusable, so its pointer is reset; never returns |
//! | `DefaultHandler` | only switches outputs off, and never returns |
#![allow(unsafe_code)]

use crate::raw::outputs_off;
use crate::stop::{Ended, stop};

/// Handler of processor faults, above all of a stack overflow.
#[unsafe(naked)]
#[unsafe(no_mangle)]
#[allow(non_snake_case, reason = "the vector's name")]
extern "C" fn HardFault() -> ! {
    core::arch::naked_asm!(
        "mrs r0, msp",
        "movw r1, #:lower16:_stack_start",
        "movt r1, #:upper16:_stack_start",
        "msr msp, r1",
        "b {fault}",
        fault = sym fault,
    )
}

extern "C" fn fault(frame: *const u32) -> ! {
    outputs_off();
    let address = u32::try_from(frame.addr()).unwrap_or_default();
    stop(&Ended::by_fault(address))
}

#[cortex_m_rt::exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    outputs_off();
    stop(&Ended::unhandled(number.unsigned_abs()))
}
