//! The client against both controllers, in one process and in their time.

#![expect(
    unreachable_pub,
    reason = "the support of a test is its own crate's business"
)]

#[path = "../support/mod.rs"]
mod support;

mod arming;
mod connect;
mod parameters;
mod reconnect;
mod repeats;
mod telemetry;
mod texts;
