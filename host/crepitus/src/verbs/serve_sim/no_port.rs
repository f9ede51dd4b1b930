//! The device as a serial port, on a system without pseudo terminals: there is none.

use crate::failure::Failure;
use crepitus_virtual_device::usb::cabled::CabledDevice;

/// Refuses every name.
pub(super) fn check(_: &str) -> Result<(), Failure> {
    Err(Failure::Input(
        "this system has no pseudo terminals, so a simulated device cannot be served as a serial port; with --usbip \
         it is a USB device, and --device sim needs no port"
            .to_owned(),
    ))
}

/// Returns the error of [`check`].
pub(super) fn serve(_: &mut dyn CabledDevice, _: &str, name: &str, _: bool) -> Result<(), Failure> {
    check(name)
}
