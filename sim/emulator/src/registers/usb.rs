//! Registers of the USB controller, in use as a device.

use super::fields::{Field, Register, bit, choice, number, register};

const KINDS: &[&str] = &["control", "isochronous", "bulk", "interrupt"];

/// Start and depth of a FIFO, in words.
const FIFO: &[Field] = &[number("start", 0, 16), number("depth", 16, 16)];

/// Bits that are state of an endpoint or a transfer, and no configuration: EPENA, NAKSTS,
/// EONUM.
const STATE: u32 = 1 << 31 | 1 << 17 | 1 << 16;

/// The first one is always active.
const USBAEP: u32 = 1 << 15;

const FIRST: &[Field] = &[
    choice("MPSIZ", 0, 2, &["64", "32", "16", "8"]),
    bit("USBAEP", 15),
    bit("STALL", 21),
];

const INTO_HOST: &[Field] = &[
    number("MPSIZ", 0, 11),
    bit("USBAEP", 15),
    choice("EPTYP", 18, 2, KINDS),
    bit("STALL", 21),
    number("TXFNUM", 22, 4),
];

const FROM_HOST: &[Field] = &[
    number("MPSIZ", 0, 11),
    bit("USBAEP", 15),
    choice("EPTYP", 18, 2, KINDS),
    bit("STALL", 21),
];

/// Registers of the whole controller, and those of its role as a device.
pub(super) const OTG: &[Register] = &[
    register("GAHBCFG", 0x008, &[bit("GINT", 0)]),
    register(
        "GUSBCFG",
        0x00c,
        &[
            number("TRDT", 10, 4),
            bit("SRPCAP", 8),
            bit("HNPCAP", 9),
            bit("FHMOD", 29),
            bit("FDMOD", 30),
        ],
    )
    .from(0xa00),
    register(
        "GINTMSK",
        0x018,
        &[
            bit("SOFM", 3),
            bit("RXFLVLM", 4),
            bit("USBSUSPM", 11),
            bit("USBRST", 12),
            bit("ENUMDNEM", 13),
            bit("IEPINT", 18),
            bit("OEPINT", 19),
            bit("WUIM", 31),
        ],
    ),
    register("GRXFSIZ", 0x024, &[number("depth", 0, 16)]),
    register("DIEPTXF0", 0x028, FIFO),
    register("GCCFG", 0x038, &[bit("PWRDWN", 16), bit("NOVBUSSENS", 21)]),
    register("DIEPTXF1", 0x104, FIFO),
    register("DIEPTXF2", 0x108, FIFO),
    register("DIEPTXF3", 0x10c, FIFO),
    // Without the address, which a host gives.
    register(
        "DCFG",
        0x800,
        &[choice("DSPD", 0, 2, &["high", "high", "", "full"])],
    )
    .without(0x7f0),
    register("DCTL", 0x804, &[bit("SDIS", 1)]),
    register("DIEPMSK", 0x810, &[bit("XFRCM", 0)]),
    register("DOEPMSK", 0x814, &[]),
    register(
        "DAINTMSK",
        0x81c,
        &[number("IEPM", 0, 16), number("OEPM", 16, 16)],
    ),
    register("DIEPEMPMSK", 0x834, &[]),
    register("DIEPCTL0", 0x900, FIRST)
        .from(USBAEP)
        .without(STATE),
    register("DIEPCTL1", 0x920, INTO_HOST).without(STATE),
    register("DIEPCTL2", 0x940, INTO_HOST).without(STATE),
    register("DIEPCTL3", 0x960, INTO_HOST).without(STATE),
    register("DOEPCTL0", 0xb00, FIRST)
        .from(USBAEP)
        .without(STATE),
    register("DOEPCTL1", 0xb20, FROM_HOST).without(STATE),
    register("DOEPCTL2", 0xb40, FROM_HOST).without(STATE),
    register("DOEPCTL3", 0xb60, FROM_HOST).without(STATE),
    register("PCGCCTL", 0xe00, &[]),
];
