//! The two devices with a simulated leg.
#![forbid(unsafe_code)]
