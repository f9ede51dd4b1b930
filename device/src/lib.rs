//! What each controller does, without hardware.
#![no_std]
#![forbid(unsafe_code)]
