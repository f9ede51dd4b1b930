//! Configuration registers of an image, as a table for people.
//!
//! Only configuration: counters, flags and addresses that a build moves are
//! left out. A register with its reset value is not shown, and one that is not
//! shown has its reset value.

mod regions;

use crepitus_emulator::pins::{Mode, Pull};
use crepitus_emulator::{Pin, Stm32f405};
use std::fmt::Write;

/// Parts, their registers and fields; the head of the file says how they are written.
const PARTS: &str = include_str!("register_tables/parts.txt");

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
pub(crate) fn tables(mcu: &Stm32f405) -> String {
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
    let table = PARTS.replace("\n    ", " ");
    let is_row = |row: &&str| !row.is_empty() && !row.starts_with('#');
    let rows: Vec<&str> = table.lines().filter(is_row).collect();
    for part in rows.iter().take_while(|row| !row.starts_with('[')) {
        let mut words = part.split(' ');
        let name = words.next().unwrap_or_default();
        let base = words.next().map_or(0, hex);
        for list in words {
            let head = format!("[{list}]");
            let own = rows.iter().skip_while(|row| **row != head).skip(1);
            for register in own.take_while(|row| !row.starts_with('[')) {
                let (register, fields) = register.split_once(": ").unwrap_or((*register, ""));
                let fields = if fields.starts_with('@') {
                    rows.iter()
                        .find_map(|row| row.strip_prefix(fields)?.strip_prefix(' '))
                        .unwrap_or_default()
                } else {
                    fields
                };
                line(mcu, (name, base), register, fields, text)?;
            }
        }
    }
    Ok(())
}

/// Writes a register, unless it has its value after a reset.
fn line(
    mcu: &Stm32f405,
    (part, base): (&str, u32),
    register: &str,
    fields: &str,
    text: &mut String,
) -> std::fmt::Result {
    let mut register = register.split(' ');
    let name = register.next().unwrap_or_default();
    let offset = register.next().map_or(0, hex);
    let (mut reset, mut known) = (0, 0);
    for bits in register {
        match bits.strip_prefix('=') {
            Some(value) => reset = hex(value),
            None => known = hex(bits.trim_start_matches('-')),
        }
    }
    let value = word(mcu, base + offset) & !known;
    if value == reset {
        return Ok(());
    }
    let mut shown = Vec::new();
    for field in fields.split("; ").filter(|field| !field.is_empty()) {
        let (place, field) = field.split_once(' ').unwrap_or((field, ""));
        let (shift, width) = place.split_once('+').unwrap_or((place, "1"));
        let (shift, width) = (decimal(shift), decimal(width));
        let (name, meanings, is_brief) = match field.split_once('=') {
            Some((name, meanings)) => {
                let brief = name.strip_suffix('?');
                (brief.unwrap_or(name), meanings, brief.is_some())
            }
            None if place.contains('+') => (field, "", true),
            None => (field, "off|on", true),
        };
        let mask = u32::MAX >> (32 - width) << shift;
        known |= mask;
        if is_brief && value & mask == reset & mask {
            continue;
        }
        let number = (value & mask) >> shift;
        shown.push(match meanings.split('|').nth(number as usize) {
            None | Some("") => format!("{name} {number}"),
            Some(meaning) => format!("{name} {meaning}"),
        });
    }
    let address = ADDRESSES.iter().find(|(known, _)| *known == value);
    shown.extend(address.map(|(_, name)| (*name).to_owned()));
    let others = (value ^ reset) & !known;
    if others != 0 && address.is_none() {
        shown.push(format!("bits {others:#x} differ from reset"));
    }
    writeln!(
        text,
        "| {part}_{name} | {value:#010x} | {} |",
        shown.join("; ")
    )
}

fn hex(digits: &str) -> u32 {
    u32::from_str_radix(digits, 16).expect("a hexadecimal number of the table")
}

fn decimal(digits: &str) -> u32 {
    digits.parse().expect("a number of the table")
}
