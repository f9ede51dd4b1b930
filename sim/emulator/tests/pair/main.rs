//! Both images together, over USB: what a host's program sees of the firmware
//! that is flashed.

#[path = "../../../virtual-device/tests/usbip/client.rs"]
#[allow(dead_code)] // Shared with the server's own tests.
mod client;
mod faults;
mod host;
mod hostile;
mod killed;
mod load;
mod power;
mod replay;
mod same;
mod session;
mod speed;
mod starts;
mod times;
mod usb;
mod usbip;
