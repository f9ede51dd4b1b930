//! Talks to a device.
#![forbid(unsafe_code)]
