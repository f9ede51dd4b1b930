//! Addresses of the buses of the peripherals.

/// First address of the parts on the AHB. Below, on an APB, there are only words:
/// the bridge repeats half a word, or a byte, over all of it (RM0090 2.1).
pub(super) const AHB: u32 = 0x4002_0000;

/// First address of the parts on APB2; below they are on APB1.
pub(super) const APB2: u32 = 0x4001_0000;
