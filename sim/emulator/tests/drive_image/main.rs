//! The drive's real image: see each module.

mod boot;
mod budget;
mod faults;
mod host;
mod replay;
mod tasks;
mod torque;
