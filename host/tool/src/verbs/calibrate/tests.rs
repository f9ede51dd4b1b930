//! Devices that are broken.
