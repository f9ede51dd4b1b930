//! The parts of `docs/generated/protocol.md` that are made from the code.

use crate::examples::{self, Example};
use crate::hex::hex;
use crate::messages::Tables;
use crate::{pages, walk};
use crepitus_protocol::coil::COIL_FAULTS;
use crepitus_protocol::counters::{COMMS_COUNTERS, CounterSpec, DRIVE_COUNTERS};
use crepitus_protocol::fault::FAULTS;
use crepitus_protocol::frame::{BODY_BYTES, CRC, FRAME_BYTES};
use crepitus_protocol::host::{Reply, Request};
use crepitus_protocol::link::{FromDrive, STALE_TICKS, ToDrive};
use crepitus_protocol::parameters::{Kind, PARAMETER_COUNT, PARAMETERS, When};
use crepitus_protocol::task_times::{COMMS_TASKS, DRIVE_TASKS};
use crepitus_protocol::telemetry::{
    BLOCK_SAMPLES, Block, COIL_CURRENTS, EFFECT_PHASES_BYTES, SAMPLE_BYTES,
};
use crepitus_protocol::{
    HEARTBEAT_TICKS, LEASE_TICKS, Lane, LimitReason, State, TICKS_PER_S, schema,
};
use postcard_schema::Schema;
use std::fmt::Write;

/// Examples whose frame is longer are in the file only.
const SHORT_BYTES: usize = 40;

#[test]
fn the_protocol_is_on_its_page() {
    let examples = examples::all();
    let find = |name: &str| {
        let found = examples.iter().find(|example| example.name == name);
        found.unwrap_or_else(|| panic!("no example {name}"))
    };
    let mut tables = Tables::new();
    let parts = [
        ("numbers", numbers()),
        ("lanes", lanes()),
        ("a frame", frame(find("management.hello"))),
        ("a request", reading(find("request.status"))),
        ("a reply", reading(find("reply.status-full"))),
        (
            "host messages",
            tables.of(Request::SCHEMA) + &tables.of(Reply::SCHEMA),
        ),
        ("telemetry", tables.of(Block::SCHEMA)),
        ("limits", limits()),
        (
            "link messages",
            tables.of(ToDrive::SCHEMA) + &tables.of(FromDrive::SCHEMA),
        ),
        ("parameters", parameters()),
        ("faults", faults()),
        ("coil faults", coil_faults()),
        ("drive counters", counters(&DRIVE_COUNTERS)),
        ("comms counters", counters(&COMMS_COUNTERS)),
        ("tasks", tasks()),
        ("examples", short(&examples)),
    ];
    pages::hold(
        "generated/protocol.md",
        &parts.map(|(name, part)| (name.to_owned(), part)),
    );
}

fn numbers() -> String {
    let mut text = "| what | value |\n|---|---|\n".to_owned();
    for (what, value) in [
        ("schema hash", format!("`{:016x}`", schema::HASH)),
        (
            "its bytes in an identity",
            format!("`{}`", hex(&schema::HASH.to_le_bytes())),
        ),
        (
            "tag of all lanes but management",
            format!("`{:02x}`", schema::TAG),
        ),
        ("longest body, bytes", BODY_BYTES.to_string()),
        (
            "longest frame with its delimiter, bytes",
            FRAME_BYTES.to_string(),
        ),
        ("ticks in a second", TICKS_PER_S.to_string()),
        ("samples in a block", BLOCK_SAMPLES.to_string()),
        ("bytes in a sample", SAMPLE_BYTES.to_string()),
        (
            "bytes in the phases of a tick",
            EFFECT_PHASES_BYTES.to_string(),
        ),
        ("currents of the coil in a block", COIL_CURRENTS.to_string()),
        ("parameters", PARAMETER_COUNT.to_string()),
        (
            "ticks from reading the last fresh heartbeat to no torque",
            HEARTBEAT_TICKS.to_string(),
        ),
        (
            "ticks from the last renewal to no torque",
            LEASE_TICKS.to_string(),
        ),
        (
            "age beyond which an echoed tick does not count, ticks",
            STALE_TICKS.to_string(),
        ),
    ] {
        let _ = writeln!(text, "| {what} | {value} |");
    }
    text
}

fn lanes() -> String {
    let mut text = "| byte | letter | tag | way | message |\n|---|---|---|---|---|\n".to_owned();
    for lane in Lane::ALL {
        let (way, message) = match lane {
            Lane::Management => ("host → comms → drive", "a management request"),
            Lane::ManagementAnswer => ("drive → comms → host", "its answer"),
            Lane::Request => ("host → comms", "`Request`"),
            Lane::Reply => ("comms → host", "`Reply`"),
            Lane::Telemetry => ("drive → comms → host", "`Block`"),
            Lane::ToDrive => ("comms → drive", "`ToDrive`"),
            Lane::FromDrive => ("drive → comms", "`FromDrive`"),
            Lane::Times => ("comms → host", "`DeviceTimes`"),
        };
        let _ = writeln!(
            text,
            "| `{:02x}` | {} | `{:02x}` | {way} | {message} |",
            lane.byte(),
            char::from(lane.byte()),
            lane.tag()
        );
    }
    text
}

/// Steps from a message to its frame.
fn frame(example: &Example) -> String {
    let checksum = CRC.checksum(&example.body);
    format!(
        "```text\nmessage        {}          {}\nbody           {}    lane, tag, message\nCRC-32         {checksum:08x}\n\
         with checksum  {}\nframe          {}\n```",
        hex(example.message()),
        example.means,
        hex(&example.body),
        hex(&[&example.body[..], &checksum.to_le_bytes()].concat()),
        hex(&example.frame),
    )
}

/// A message, field by field.
fn reading(example: &Example) -> String {
    let schema = example.schema.expect("postcard");
    let mut text = format!("`{}`\n\n", hex(&example.frame));
    text.push_str("| bytes | field | value |\n|---|---|---|\n");
    let [lane, tag, ..] = example.body[..] else {
        panic!("a body has two bytes");
    };
    let _ = writeln!(text, "| `{lane:02x} {tag:02x}` | lane, tag | |");
    for piece in walk::read(schema, example.message()).pieces {
        let _ = writeln!(
            text,
            "| `{}` | {} | {} |",
            hex(&piece.bytes),
            piece.path,
            piece.value
        );
    }
    let checksum = CRC.checksum(&example.body).to_le_bytes();
    let _ = writeln!(text, "| `{}` | CRC-32 | |", hex(&checksum));
    text
}

fn limits() -> String {
    let mut text = "| number | limit reason | state |\n|---|---|---|\n".to_owned();
    for reason in LimitReason::ALL {
        let state = State::ALL
            .into_iter()
            .find(|state| u16::from(state.number()) == reason.number())
            .map_or("", State::name);
        let _ = writeln!(
            text,
            "| {} | {} | {state} |",
            reason.number(),
            reason.name()
        );
    }
    text
}

fn parameters() -> String {
    let mut text =
        "| id | name | unit | allowed | default | changes | meaning |\n|---|---|---|---|---|---|---|\n"
            .to_owned();
    for parameter in &PARAMETERS {
        let (unit, allowed, default) = match parameter.kind {
            Kind::Number(spec) => (
                spec.unit,
                format!("{} … {}", number(spec.min), number(spec.max)),
                number(spec.default),
            ),
            Kind::Choice(choice) => (
                "",
                (0..)
                    .zip(choice.names)
                    .map(|(place, name)| format!("{place} {name}"))
                    .collect::<Vec<_>>()
                    .join(", "),
                number(f64::from(choice.default)),
            ),
        };
        let when = match parameter.when {
            When::Always => "always",
            When::Disarmed => "disarmed",
        };
        let _ = writeln!(
            text,
            "| {} | `{}.{}` | {unit} | {allowed} | {default} | {when} | {} |",
            parameter.id,
            parameter.group,
            parameter.key(),
            parameter.meaning()
        );
    }
    text
}

/// Formats a number in the shortest form that reads back.
fn number(value: f64) -> String {
    if value != 0.0 && !(1e-3..1e5).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

fn faults() -> String {
    let mut text = "| code | name | noticed by |\n|---|---|---|\n".to_owned();
    for spec in &FAULTS {
        let _ = writeln!(
            text,
            "| {} | [{name}](../faults.md#{code}-{name}) | {} |",
            spec.fault.code(),
            spec.detector.name(),
            name = spec.name,
            code = spec.fault.code(),
        );
    }
    text
}

fn coil_faults() -> String {
    let mut text = "| code | name |\n|---|---|\n".to_owned();
    for spec in &COIL_FAULTS {
        let _ = writeln!(
            text,
            "| {} | [{name}](../faults.md#the-coil) |",
            spec.fault.code(),
            name = spec.name,
        );
    }
    text
}

fn counters(list: &[CounterSpec]) -> String {
    let mut text = "| place | name | meaning |\n|---|---|---|\n".to_owned();
    for (place, counter) in list.iter().enumerate() {
        let _ = writeln!(text, "| {place} | {} | {} |", counter.name, counter.meaning);
    }
    text
}

/// Tasks of both controllers, by their place in `TaskTimes`.
fn tasks() -> String {
    let mut text = "| place | drive | comms |\n|---|---|---|\n".to_owned();
    for (place, drive) in DRIVE_TASKS.iter().enumerate() {
        let comms = COMMS_TASKS.get(place).copied().unwrap_or("–");
        let _ = writeln!(text, "| {place} | {drive} | {comms} |");
    }
    text
}

fn short(examples: &[Example]) -> String {
    let mut text = "| name | message | frame |\n|---|---|---|\n".to_owned();
    for example in examples.iter().filter(|e| e.frame.len() <= SHORT_BYTES) {
        let _ = writeln!(
            text,
            "| {} | {} | `{}` |",
            example.name,
            example.means,
            hex(&example.frame)
        );
    }
    text
}
