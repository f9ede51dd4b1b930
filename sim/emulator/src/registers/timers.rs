//! Configuration registers of timers.

use super::fields::{Register, bit, choice, number, register};

const CENTRE: &[&str] = &[
    "edge-aligned",
    "centre-aligned 1",
    "centre-aligned 2",
    "centre-aligned 3",
];
const MASTER: &[&str] = &[
    "reset",
    "enable",
    "update",
    "compare pulse",
    "OC1",
    "OC2",
    "OC3",
    "OC4",
];
const SLAVE: &[&str] = &[
    "off",
    "encoder 1",
    "encoder 2",
    "encoder, both channels",
    "reset",
    "gated",
    "trigger",
    "external clock",
];
const OUTPUT: &[&str] = &[
    "frozen",
    "active on match",
    "inactive on match",
    "toggle",
    "inactive",
    "active",
    "PWM 1",
    "PWM 2",
];

const CR1: Register = register(
    "CR1",
    0x00,
    &[
        bit("CEN", 0),
        bit("UDIS", 1),
        bit("URS", 2),
        bit("OPM", 3),
        choice("CMS", 5, 2, CENTRE),
        bit("ARPE", 7),
        number("CKD", 8, 2),
    ],
)
// The direction in which it counts.
.without(0x10);

const CR2: Register = register(
    "CR2",
    0x04,
    &[
        bit("CCPC", 0),
        choice("MMS", 4, 3, MASTER),
        bit("OIS1", 8),
        bit("OIS1N", 9),
        bit("OIS2", 10),
        bit("OIS2N", 11),
    ],
);

const SMCR: Register = register(
    "SMCR",
    0x08,
    &[choice("SMS", 0, 3, SLAVE), number("TS", 4, 3)],
);

const DIER: Register = register(
    "DIER",
    0x0c,
    &[
        bit("UIE", 0),
        bit("CC1IE", 1),
        bit("CC2IE", 2),
        bit("BIE", 7),
    ],
);

/// Channels as outputs.
const CCMR1: Register = register(
    "CCMR1",
    0x18,
    &[
        number("CC1S", 0, 2),
        bit("OC1PE", 3),
        choice("OC1M", 4, 3, OUTPUT),
        number("CC2S", 8, 2),
        bit("OC2PE", 11),
        choice("OC2M", 12, 3, OUTPUT),
    ],
);

/// Channels as inputs.
const CCMR1_INPUT: Register = register(
    "CCMR1",
    0x18,
    &[
        choice("CC1S", 0, 2, &["output", "TI1", "TI2", "TRC"]),
        choice("IC1F", 4, 4, FILTER),
        choice("CC2S", 8, 2, &["output", "TI2", "TI1", "TRC"]),
        choice("IC2F", 12, 4, FILTER),
    ],
);

const FILTER: &[&str] = &[
    "none",
    "2 clocks",
    "4 clocks",
    "8 clocks",
    "6 samples of clock / 2",
    "8 samples of clock / 2",
    "6 samples of clock / 4",
    "8 samples of clock / 4",
    "6 samples of clock / 8",
    "8 samples of clock / 8",
];

const CCMR2: Register = register("CCMR2", 0x1c, &[]);

const CCER: Register = register(
    "CCER",
    0x20,
    &[
        bit("CC1E", 0),
        choice("CC1P", 1, 1, &["high", "low"]),
        bit("CC1NE", 2),
        choice("CC1NP", 3, 1, &["high", "low"]),
        bit("CC2E", 4),
        choice("CC2P", 5, 1, &["high", "low"]),
        bit("CC2NE", 6),
        choice("CC2NP", 7, 1, &["high", "low"]),
    ],
);

const PSC: Register = register("PSC", 0x28, &[number("PSC", 0, 16)]);
const RCR: Register = register("RCR", 0x30, &[number("REP", 0, 8)]);

/// Compare value at rest: changed while the bridge is driven.
const CCR1: Register = register("CCR1", 0x34, &[number("CCR1", 0, 16)]);
const CCR2: Register = register("CCR2", 0x38, &[number("CCR2", 0, 16)]);
const CCR3: Register = register("CCR3", 0x3c, &[number("CCR3", 0, 16)]);
const CCR4: Register = register("CCR4", 0x40, &[number("CCR4", 0, 16)]);

const BDTR: Register = register(
    "BDTR",
    0x44,
    &[
        number("DTG", 0, 8),
        number("LOCK", 8, 2),
        choice("OSSI", 10, 1, &["not driven", "idle level"]),
        choice("OSSR", 11, 1, &["not driven", "idle level"]),
        bit("BKE", 12),
        choice("BKP", 13, 1, &["low", "high"]),
        bit("AOE", 14),
        bit("MOE", 15),
    ],
);

/// A timer whose channels are outputs.
pub(super) const TIMER: &[Register] = &[
    CR1,
    CR2,
    SMCR,
    DIER,
    CCMR1,
    CCMR2,
    CCER,
    PSC,
    register("ARR", 0x2c, &[number("ARR", 0, 16)]).from(0xffff),
    RCR,
    CCR1,
    CCR2,
    CCR3,
    CCR4,
    BDTR,
];

/// One of 32 bits, whose channels are inputs.
pub(super) const TIMER_32: &[Register] = &[
    CR1,
    CR2,
    SMCR,
    DIER,
    CCMR1_INPUT,
    CCMR2,
    CCER,
    PSC,
    register("ARR", 0x2c, &[number("ARR", 0, 32)]).from(u32::MAX),
    CCR1,
    CCR2,
    CCR3,
    CCR4,
];
