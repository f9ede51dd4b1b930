//! `docs/generated/board.md`, made from the board description.

use crepitus_device::board::analog::{CLOCK_HZ, INPUTS};
use crepitus_device::board::pins::{Connection, Mode, Pull, comms, drive};
use crepitus_device::board::{self, TIMERS};
use std::fmt::Write;
use std::path::Path;

const HEAD: &str = "\
# The boards, pin by pin

What is wired to the two controllers, and the values of those parts: one description, `device/src/board.rs`, from which the \
firmware takes its pins and scales, the emulator its wires, and this page its tables. Not measured on hardware. Made and checked by

```text
CREPITUS_BLESS=1 cargo test -p crepitus-device --test board_page
```

";

fn pins(connections: &[Connection]) -> String {
    let mut table =
        "| pin | function | what | connects to | in the chip | at rest |\n|---|---|---|---|---|---|\n"
            .to_owned();
    for it in connections {
        let mode = match it.mode {
            Mode::Input => "input".to_owned(),
            Mode::Output => "output".to_owned(),
            Mode::Alternate(function) => format!("AF{function}"),
            Mode::Analog => "analog".to_owned(),
        };
        let pull = match it.pull {
            Pull::Any => "",
            Pull::Up => ", pull-up",
            Pull::Down => ", pull-down",
        };
        let Connection {
            pin,
            function,
            part,
            to,
            at_rest,
            ..
        } = it;
        // Writing to a String cannot fail.
        let _ = writeln!(
            table,
            "| {pin} | {function} | {part} | {to} | {mode}{pull} | {at_rest} |"
        );
    }
    table
}

fn timers() -> String {
    let head = "| timer | does | starts |\n|---|---|---|\n".to_owned();
    TIMERS.iter().fold(head, |table, it| {
        table + &format!("| {} | {} | {} |\n", it.timer, it.does, it.starts)
    })
}

fn inputs() -> String {
    let head = "| pin | converter | source | at the pin | sampled for |\n|---|---|---|---|---|\n";
    INPUTS.iter().fold(head.to_owned(), |table, it| {
        let clocks = it.sampling_clocks;
        table
            + &format!(
                "| {} | {} | {:.1} kΩ | {:.0} nF | {clocks} clocks, {:.0} ns |\n",
                it.connection.pin,
                it.connection.function,
                it.source_ohm * 1e-3,
                it.farad * 1e9,
                it.sampling_s() * 1e9
            )
    })
}

fn parts() -> String {
    let amplifier = |it: &board::analog::Amplifier| {
        format!(
            "{:.0} mΩ × {:.0} V/V: {:.2} V/A, ±{:.1} A",
            it.shunt_ohm * 1e3,
            it.gain,
            it.volts_per_ampere(),
            it.range_a()
        )
    };
    let filter = board::BREAK_FILTER;
    let rows = [
        (
            "crystal of both controllers",
            format!("{} MHz", board::CRYSTAL_HZ / 1_000_000),
        ),
        (
            "crystals that will do",
            board::CRYSTALS_HZ
                .map(|hz| (hz / 1_000_000).to_string())
                .join(", ")
                + " MHz",
        ),
        (
            "reference and supply of the amplifiers",
            format!("{} V", board::REFERENCE_V),
        ),
        (
            "the motor's current, twice",
            amplifier(&board::MOTOR_CURRENT),
        ),
        ("the coil's current", amplifier(&board::COIL_CURRENT)),
        (
            "divider of the supply",
            format!(
                "{:.0} kΩ and {:.0} kΩ: 1 to {:.0}",
                board::SUPPLY.upper_ohm * 1e-3,
                board::SUPPLY.lower_ohm * 1e-3,
                board::SUPPLY.share()
            ),
        ),
        (
            "temperature of the motor",
            format!(
                "{} V at 0 °C, {:.0} mV/°C",
                board::MOTOR_TEMPERATURE.freezing_v,
                1e3 / board::MOTOR_TEMPERATURE.celsius_per_volt
            ),
        ),
        (
            "comparator, and the software's limit",
            format!("±{} A", board::TRIP_A),
        ),
        (
            "filter of both break inputs",
            format!(
                "{:.1} kΩ to 3.3 V at the far end, {:.0} kΩ and {:.0} pF at the pin: {:.2} µs",
                filter.pull_up_ohm * 1e-3,
                filter.series_ohm * 1e-3,
                filter.farad * 1e12,
                filter.time_constant_s() * 1e6
            ),
        ),
        (
            "PWM of bridge and coil",
            format!("{} kHz, centre-aligned", board::PWM_HZ / 1_000),
        ),
        (
            "dead time",
            format!("{:.0} ns", f64::from(board::DEAD_CLOCKS) / 0.168),
        ),
        (
            "largest duty of the bridge, of the coil",
            format!("{}, {}", board::LARGEST_DUTY, board::LARGEST_COIL_DUTY),
        ),
        (
            "clock of the converters",
            format!("{} MHz", CLOCK_HZ / 1_000_000),
        ),
        (
            "link",
            format!("{:.1} Mbaud", f64::from(board::LINK_BAUD) * 1e-6),
        ),
    ];
    rows.iter().fold(
        "| what | value |\n|---|---|\n".to_owned(),
        |table, (what, value)| table + &format!("| {what} | {value} |\n"),
    )
}

#[test]
fn the_page_is_made_from_the_description() {
    let page = format!(
        "{HEAD}## Drive\n\n{}\n## Comms\n\n{}\n## Timers of the drive\n\n{}\n## Analog inputs\n\n{}\n## Parts\n\n{}",
        pins(drive::ALL),
        pins(comms::ALL),
        timers(),
        inputs(),
        parts()
    );
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/generated/board.md");
    if std::env::var_os("CREPITUS_BLESS").is_some_and(|value| value != "0") {
        std::fs::write(&path, &page).expect("the page can be written");
    }
    let known = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(known, page, "docs/generated/board.md differs");
}
