//! # The ladder on the target
//!
//! `crepitus_ladder::serve` and a core: no peripheral, no clock, no interrupt,
//! so that this one file runs in every emulator. The host writes commands to
//! RAM and reads results there: see `sim/ladder`.
//!
//! Not a program for a board: nothing would ever command it there.
#![no_std]
#![no_main]

use core::sync::atomic::AtomicU32;
use crepitus_ladder::exchange::{ADDRESS, WORDS};
use crepitus_ladder::{Exchange, serve};

/// The exchange, exclusive in this program.
#[allow(unsafe_code, reason = "a fixed address is the point of it")]
fn words() -> &'static [AtomicU32] {
    // SAFETY: `memory.x` keeps the program out of this part of RAM; any bits
    // are an AtomicU32, and the address is a multiple of four.
    unsafe { core::slice::from_raw_parts(ADDRESS as *const AtomicU32, WORDS) }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    let exchange = Exchange::new(words());
    loop {
        serve(&exchange, &mut || true);
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        cortex_m::asm::nop();
    }
}
