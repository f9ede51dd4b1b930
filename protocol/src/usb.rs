//! By what a host finds a device on USB.

/// The vendor id: the shared one for free projects (V-USB).
pub const VENDOR_ID: u16 = 0x16c0;

/// The product id: a CDC-ACM device under [`VENDOR_ID`], told apart by its
/// strings.
pub const PRODUCT_ID: u16 = 0x27dd;

/// What the product's string contains.
pub const PRODUCT: &str = "Crepitus";
