//! Both images together, over USB: what a host's program sees of the firmware
//! that is flashed.

mod faults;
mod host;
mod hostile;
mod load;
mod power;
mod replay;
mod same;
mod session;
mod usb;
