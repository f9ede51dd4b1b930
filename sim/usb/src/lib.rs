//! A software USB bus.
#![forbid(unsafe_code)]
