//! Every message on both wires.
#![no_std]
#![forbid(unsafe_code)]
