//! The loops and limits around the joint: shaft in, motor out.

pub mod chirp;
pub mod current_loop;
pub mod current_path;
pub mod device_limits;
pub mod encoder;
pub mod energy_observer;
