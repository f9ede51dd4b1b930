//! The drive's real image: see each module.

mod boot;
mod faults;
mod host;
mod replay;
mod tasks;
mod torque;
