//! Configuration registers of an image, as a table for people.
//!
//! Only configuration: counters, flags and addresses that a build moves are
//! left out. A register with its reset value is not shown, and one that is not
//! shown has its reset value.

mod fields;
mod parts;
mod regions;
mod timers;
mod usb;

use crate::mcu::{Mcu, Pin};
use crate::pins::{Mode, Pull};
use crate::stm32f405::Stm32f405;
use fields::{Part, Register};
use std::fmt::Write;

/// Interrupts of the chip.
const INTERRUPTS: u32 = 82;

/// Names of those that an image uses.
const NAMES: [(u32, &str); 6] = [
    (28, "TIM2"),
    (29, "TIM3"),
    (30, "TIM4"),
    (55, "TIM7"),
    (67, "OTG_FS"),
    (69, "DMA2_STREAM6"),
];

/// Addresses that a register may hold.
const ADDRESSES: [(u32, &str); 2] = [
    (0x1001_0000, "end of the CCM RAM"),
    (0x4001_1404, "USART6_DR"),
];

/// Pins of the debugger, which are not at the setup of other pins after a
/// reset: PA13, PA14, PA15, PB3, PB4.
const DEBUG_PINS: [Pin; 5] = [
    Pin::new('A', 13),
    Pin::new('A', 14),
    Pin::new('A', 15),
    Pin::new('B', 3),
    Pin::new('B', 4),
];

/// The tables of an image: core and stack, interrupts, pins, protected memory, parts.
pub fn tables(mcu: &Stm32f405) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = interrupts(mcu, &mut text);
    let _ = pins(mcu, &mut text);
    let _ = regions::table(mcu, &mut text);
    let _ = registers(mcu, &mut text);
    text
}

fn word(mcu: &Stm32f405, address: u32) -> u32 {
    mcu.peek(address).unwrap_or_default()
}

fn interrupts(mcu: &Stm32f405, text: &mut String) -> std::fmt::Result {
    writeln!(
        text,
        "| interrupt | number | enabled | priority, 0 is most urgent |"
    )?;
    writeln!(text, "|---|---|---|---|")?;
    for number in 0..INTERRUPTS {
        let is_enabled = word(mcu, 0xe000_e100 + number / 32 * 4) >> (number % 32) & 1 == 1;
        let priority = word(mcu, 0xe000_e400 + number / 4 * 4) >> (8 * (number % 4)) & 0xff;
        if !is_enabled && priority == 0 {
            continue;
        }
        let name = NAMES.iter().find(|(known, _)| *known == number);
        let name = name.map_or("unknown", |(_, name)| name);
        let enabled = if is_enabled { "yes" } else { "no" };
        writeln!(
            text,
            "| {name} | {number} | {enabled} | {} |",
            priority >> 4
        )?;
    }
    writeln!(text)
}

fn pins(mcu: &Stm32f405, text: &mut String) -> std::fmt::Result {
    writeln!(
        text,
        "| pin | mode | pull | driver | speed |\n|---|---|---|---|---|"
    )?;
    for port in 'A'..='I' {
        for number in 0..16 {
            let pin = Pin::new(port, number);
            let setup = mcu.pin_setup(pin);
            let base = 0x4002_0000 + 0x400 * u32::try_from(pin.port()).unwrap_or_default();
            let speed = word(mcu, base + 0x08) >> (2 * u32::from(number)) & 3;
            let is_at_reset = (setup.mode, setup.pull, setup.is_open_drain, speed)
                == (Mode::Input, Pull::None, false, 0);
            if is_at_reset || DEBUG_PINS.contains(&pin) {
                continue;
            }
            let driver = if setup.is_open_drain {
                "open drain"
            } else {
                "push-pull"
            };
            let speed = ["2 MHz", "25 MHz", "50 MHz", "100 MHz"][speed as usize];
            let (mode, pull) = (setup.mode, setup.pull);
            writeln!(text, "| {pin} | {mode} | {pull} | {driver} | {speed} |")?;
        }
    }
    writeln!(text)
}

fn registers(mcu: &Stm32f405, text: &mut String) -> std::fmt::Result {
    writeln!(text, "| register | value | fields |\n|---|---|---|")?;
    for Part {
        name: part,
        base,
        registers,
    } in parts::PARTS
    {
        for register in *registers {
            let value = word(mcu, base + register.offset) & !register.ignored;
            if value != register.reset {
                line(part, register, value, text)?;
            }
        }
    }
    Ok(())
}

fn line(part: &str, register: &Register, value: u32, text: &mut String) -> std::fmt::Result {
    let mut known = register.ignored;
    let mut words = Vec::new();
    for field in register.fields {
        let mask = u32::MAX >> (32 - field.width) << field.shift;
        known |= mask;
        if field.is_brief && value & mask == register.reset & mask {
            continue;
        }
        let number = (value & mask) >> field.shift;
        let word = field
            .words
            .get(number as usize)
            .copied()
            .unwrap_or_default();
        words.push(match word {
            "" => format!("{} {number}", field.name),
            word => format!("{} {word}", field.name),
        });
    }
    let address = ADDRESSES.iter().find(|(known, _)| *known == value);
    words.extend(address.map(|(_, name)| (*name).to_owned()));
    let others = (value ^ register.reset) & !known;
    if others != 0 && address.is_none() {
        words.push(format!("bits {others:#x} differ from reset"));
    }
    let name = register.name;
    writeln!(
        text,
        "| {part}_{name} | {value:#010x} | {} |",
        words.join("; ")
    )
}
