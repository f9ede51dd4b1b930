//! The regions of the MPU, as a table (ARM DDI 0403E, B3.5).

use crepitus_emulator::Stm32f405;
use std::fmt::Write;

/// Access permissions of privileged code, by the field AP.
const ACCESS: [&str; 8] = [
    "none",
    "read, write",
    "read, write",
    "read, write",
    "reserved",
    "read",
    "read",
    "read",
];

/// A row for each region that has a size.
pub(super) fn table(mcu: &Stm32f405, text: &mut String) -> std::fmt::Result {
    writeln!(
        text,
        "| region | enabled | from | bytes | without eighths | access | execute | TEX, S, C, B |"
    )?;
    writeln!(text, "|---|---|---|---|---|---|---|---|")?;
    for (number, (base, attributes)) in mcu.mpu_regions().into_iter().enumerate() {
        let field = |shift: u32, width: u32| attributes >> shift & ((1 << width) - 1);
        if attributes == 0 {
            continue;
        }
        let yes = |is_set: bool| if is_set { "yes" } else { "no" };
        let missing: Vec<String> = (0..8)
            .filter(|eighth| field(8 + eighth, 1) == 1)
            .map(|eighth| eighth.to_string())
            .collect();
        writeln!(
            text,
            "| {number} | {} | {:#010x} | {} | {} | {} | {} | {:03b} {} {} {} |",
            yes(field(0, 1) == 1),
            base & !0x1f,
            1_u64 << (field(1, 5) + 1),
            missing.join(" "),
            ACCESS[field(24, 3) as usize],
            yes(field(28, 1) == 0),
            field(19, 3),
            field(18, 1),
            field(17, 1),
            field(16, 1),
        )?;
    }
    writeln!(text)
}
