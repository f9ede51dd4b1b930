//! USB ids, to discover a device.

/// Vendor id: the shared one for free projects (V-USB).
pub const VENDOR_ID: u16 = 0x16c0;

/// Product id: a CDC-ACM device under [`VENDOR_ID`]; the strings distinguish
/// it from others.
pub const PRODUCT_ID: u16 = 0x27dd;

/// Text that the product string contains.
pub const PRODUCT: &str = "Crepitus";
