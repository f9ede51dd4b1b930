//! The drive's real image: see each module.

mod actuator;
mod book;
mod boot;
mod budget;
mod code;
mod commits;
mod crash;
mod current;
mod faults;
mod flash;
mod hand_over;
mod host;
mod killed;
mod locks;
mod mpu;
mod noise;
mod outputs;
mod profile;
#[path = "../timing/reference_flash.rs"]
mod reference_flash;
mod register_tables;
mod registers;
mod replay;
mod self_test;
mod slow;
mod symptoms;
mod tasks;
mod times;
mod torque;
mod wiring;
