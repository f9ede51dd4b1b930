//! The configuration registers that are shown, by part of the chip (RM0090,
//! PM0214).

use super::fields::{Field, Part, Register, bit, choice, number, part, register};
use super::timers::{TIMER, TIMER_32};
use super::usb::OTG;

/// All parts. The ports are shown pin by pin, the interrupts by themselves.
pub(super) const PARTS: &[Part] = &[
    part("VECTORS", 0x0800_0000, &[register("STACK", 0, &[])]),
    part("SCB", 0xe000_ed00, CORE),
    part("MPU", 0xe000_ed90, &[register("CTRL", 0x04, PROTECTION)]),
    part("STK", 0xe000_e010, &[register("CTRL", 0, TICK)]),
    part("RCC", 0x4002_3800, CLOCKS),
    part("FLASH", 0x4002_3c00, &[register("ACR", 0, FLASH)]),
    part("PWR", 0x4000_7000, &[register("CR", 0, POWER).from(0x4000)]),
    part("IWDG", 0x4000_3000, WATCHDOG),
    part("TIM1", 0x4001_0000, TIMER),
    part("TIM8", 0x4001_0400, TIMER),
    part("TIM2", 0x4000_0000, TIMER_32),
    part("TIM3", 0x4000_0400, TIMER),
    part("TIM4", 0x4000_0800, TIMER),
    part("TIM5", 0x4000_0c00, TIMER_32),
    part("ADC1", 0x4001_2000, CONVERTER),
    part("ADC2", 0x4001_2100, CONVERTER),
    // The sequence of ADC3 is no configuration: it turns from tick to tick.
    part(
        "ADC3",
        0x4001_2200,
        CONVERTER.split_at(CONVERTER.len() - 2).0,
    ),
    part("ADC", 0x4001_2300, &[register("CCR", 0x04, COMMON)]),
    part("USART6", 0x4001_1400, USART),
    part("DMA1", 0x4002_6000, STREAMS),
    part("DMA2", 0x4002_6400, STREAMS),
    part("OTG_FS", 0x5000_0000, OTG),
];

const CORE: &[Register] = &[
    register("VTOR", 0x08, &[]),
    register("AIRCR", 0x0c, &[number("PRIGROUP", 8, 3)]).without(0xffff_0000),
    register(
        "SCR",
        0x10,
        &[
            bit("SLEEPONEXIT", 1),
            bit("SLEEPDEEP", 2),
            bit("SEVONPEND", 4),
        ],
    ),
    register("CCR", 0x14, &[]).from(0x200),
    register("SHPR1", 0x18, &[]),
    register("SHPR2", 0x1c, &[]),
    register("SHPR3", 0x20, &[]),
    register("SHCSR", 0x24, &[]).without(0xffff),
    // Lazy saving, without its state.
    register("FPCCR", 0x234, &[])
        .from(0xc000_0000)
        .without(0x1ff),
    register("CPACR", 0x88, &[choice("FPU", 20, 4, FPU)]),
];

const FPU: &[&str] = &[
    "off",
    "",
    "",
    "",
    "",
    "privileged",
    "",
    "",
    "",
    "",
    "",
    "",
    "",
    "",
    "",
    "on",
];

const PROTECTION: &[Field] = &[bit("ENABLE", 0), bit("HFNMIENA", 1), bit("PRIVDEFENA", 2)];

const TICK: &[Field] = &[bit("ENABLE", 0), bit("TICKINT", 1), bit("CLKSOURCE", 2)];

const CLOCKS: &[Register] = &[
    register(
        "CR",
        0x00,
        &[
            bit("HSION", 0),
            bit("HSEON", 16),
            bit("HSEBYP", 18),
            bit("CSSON", 19),
            bit("PLLON", 24),
        ],
    )
    .from(0x01)
    // Ready flags, trimming.
    .without(0x0a02_fffa),
    register(
        "PLLCFGR",
        0x04,
        &[
            number("M", 0, 6),
            number("N", 6, 9),
            choice("P", 16, 2, &["2", "4", "6", "8"]),
            choice("SRC", 22, 1, &["internal oscillator", "crystal"]),
            number("Q", 24, 4),
        ],
    )
    .from(0x2400_3010),
    register(
        "CFGR",
        0x08,
        &[
            choice("SW", 0, 2, &["internal oscillator", "crystal", "PLL"]),
            choice("HPRE", 4, 4, &["1"]),
            choice("PPRE1", 10, 3, &["1", "", "", "", "2", "4", "8", "16"]),
            choice("PPRE2", 13, 3, &["1", "", "", "", "2", "4", "8", "16"]),
        ],
    )
    .without(0x0c),
    // Flags.
    register("CIR", 0x0c, &[]).without(0x00ff_00ff),
    register("AHB1RSTR", 0x10, &[]),
    register("AHB2RSTR", 0x14, &[]),
    register("APB1RSTR", 0x20, &[]),
    register("APB2RSTR", 0x24, &[]),
    register(
        "AHB1ENR",
        0x30,
        &[
            bit("GPIOA", 0),
            bit("GPIOB", 1),
            bit("GPIOC", 2),
            bit("CRC", 12),
            bit("CCM RAM", 20),
            bit("DMA1", 21),
            bit("DMA2", 22),
        ],
    )
    .from(0x0010_0000),
    register("AHB2ENR", 0x34, &[bit("RNG", 6), bit("OTG_FS", 7)]),
    register("AHB3ENR", 0x38, &[]),
    register(
        "APB1ENR",
        0x40,
        &[
            bit("TIM2", 0),
            bit("TIM3", 1),
            bit("TIM4", 2),
            bit("TIM5", 3),
            bit("PWR", 28),
        ],
    ),
    register(
        "APB2ENR",
        0x44,
        &[
            bit("TIM1", 0),
            bit("TIM8", 1),
            bit("USART6", 5),
            bit("ADC1", 8),
            bit("ADC2", 9),
            bit("ADC3", 10),
            bit("SYSCFG", 14),
        ],
    ),
    register("BDCR", 0x70, &[]),
];

const FLASH: &[Field] = &[
    choice("LATENCY", 0, 3, &["0", "1", "2", "3", "4", "5", "6", "7"]),
    bit("PRFTEN", 8),
    bit("ICEN", 9),
    bit("DCEN", 10),
];

const POWER: &[Field] = &[
    bit("PVDE", 4),
    number("PLS", 5, 3),
    bit("DBP", 8),
    number("VOS", 14, 2),
];

const WATCHDOG: &[Register] = &[
    register(
        "PR",
        0x04,
        &[choice(
            "PR",
            0,
            3,
            &["4", "8", "16", "32", "64", "128", "256"],
        )],
    ),
    register("RLR", 0x08, &[number("RL", 0, 12)]).from(0xfff),
];

const SAMPLING: &[&str] = &[
    "3 clocks",
    "15 clocks",
    "28 clocks",
    "56 clocks",
    "84 clocks",
    "112 clocks",
    "144 clocks",
    "480 clocks",
];
const TRIGGER: &[&str] = &[
    "TIM1 CC1",
    "TIM1 CC2",
    "TIM1 CC3",
    "TIM2 CC2",
    "TIM2 CC3",
    "TIM2 CC4",
    "TIM2 TRGO",
    "TIM3 CC1",
    "TIM3 TRGO",
    "TIM4 CC4",
    "TIM5 CC1",
    "TIM5 CC2",
    "TIM5 CC3",
    "TIM8 CC1",
    "TIM8 TRGO",
    "EXTI 11",
];

const CONVERTER: &[Register] = &[
    register(
        "CR1",
        0x04,
        &[
            bit("EOCIE", 5),
            bit("JEOCIE", 7),
            bit("SCAN", 8),
            bit("JAUTO", 10),
            bit("OVRIE", 26),
        ],
    ),
    register(
        "CR2",
        0x08,
        &[
            bit("ADON", 0),
            bit("CONT", 1),
            bit("DMA", 8),
            bit("EOCS", 10),
            choice("EXTSEL", 24, 4, TRIGGER),
            choice(
                "EXTEN",
                28,
                2,
                &["off", "rising edge", "falling edge", "both edges"],
            ),
        ],
    ),
    register(
        "SMPR1",
        0x0c,
        &[
            choice("SMP10", 0, 3, SAMPLING).brief(),
            choice("SMP11", 3, 3, SAMPLING).brief(),
            choice("SMP12", 6, 3, SAMPLING).brief(),
            choice("SMP13", 9, 3, SAMPLING).brief(),
        ],
    ),
    register("SMPR2", 0x10, &[choice("SMP2", 6, 3, SAMPLING).brief()]),
    register("SQR1", 0x2c, &[number("L", 20, 4)]),
    register("SQR2", 0x30, &[]),
    register(
        "SQR3",
        0x34,
        &[
            number("SQ1", 0, 5),
            number("SQ2", 5, 5),
            number("SQ3", 10, 5),
        ],
    ),
    register(
        "JSQR",
        0x38,
        &[
            number("JSQ1", 0, 5),
            number("JSQ2", 5, 5),
            number("JSQ3", 10, 5),
            number("JSQ4", 15, 5),
            number("JL", 20, 2),
        ],
    ),
];

const COMMON: &[Field] = &[
    number("MULTI", 0, 5),
    choice("ADCPRE", 16, 2, &["2", "4", "6", "8"]),
    bit("TSVREFE", 23),
];

const USART: &[Register] = &[
    register(
        "BRR",
        0x08,
        &[number("fraction", 0, 4), number("mantissa", 4, 12)],
    ),
    register(
        "CR1",
        0x0c,
        &[
            bit("RE", 2),
            bit("TE", 3),
            bit("IDLEIE", 4),
            bit("RXNEIE", 5),
            bit("TCIE", 6),
            bit("TXEIE", 7),
            bit("PCE", 10),
            bit("M", 12),
            bit("UE", 13),
            bit("OVER8", 15),
        ],
    ),
    register("CR2", 0x10, &[number("STOP", 12, 2)]),
    register(
        "CR3",
        0x14,
        &[
            bit("EIE", 0),
            bit("HDSEL", 3),
            bit("DMAR", 6),
            bit("DMAT", 7),
        ],
    ),
];

const STREAM: &[Field] = &[
    bit("EN", 0),
    bit("DMEIE", 1),
    bit("TEIE", 2),
    bit("HTIE", 3),
    bit("TCIE", 4),
    bit("PFCTRL", 5),
    choice(
        "DIR",
        6,
        2,
        &["to memory", "to peripheral", "memory to memory"],
    ),
    bit("CIRC", 8),
    bit("PINC", 9),
    bit("MINC", 10),
    choice("PSIZE", 11, 2, &["byte", "half word", "word"]),
    choice("MSIZE", 13, 2, &["byte", "half word", "word"]),
    choice("PL", 16, 2, &["low", "medium", "high", "very high"]),
    number("CHSEL", 25, 3),
];

/// Registers of the streams without lengths and memory addresses, which a program or a build moves.
const STREAMS: &[Register] = &[
    register("S0CR", 0x10, STREAM),
    register("S1CR", 0x28, STREAM),
    register("S1PAR", 0x30, &[]),
    register("S1FCR", 0x3c, &[]).from(0x21),
    register("S2CR", 0x40, STREAM),
    register("S3CR", 0x58, STREAM),
    register("S4CR", 0x70, STREAM),
    register("S5CR", 0x88, STREAM),
    // Enabled while it sends.
    register("S6CR", 0xa0, STREAM).without(1),
    register("S6PAR", 0xa8, &[]),
    register("S6FCR", 0xb4, &[]).from(0x21),
    register("S7CR", 0xb8, STREAM),
];
