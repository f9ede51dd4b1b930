//! Bounds of the firmware's budget that are constants of the sources are still those.

use crepitus_device::comms::sessions::SESSIONS;
use crepitus_model::render::effects::SYMPTOMS;
use crepitus_model::render::position::MOST_TICKS;
use crepitus_protocol::crash::{HEAD_WORDS, PART_WORDS};
use crepitus_protocol::frame::BODY_BYTES;
use crepitus_protocol::management::IDENTITY_BYTES;
use crepitus_protocol::parameters::PARAMETER_COUNT;
use crepitus_protocol::telemetry::BLOCK_SAMPLES;
use std::path::Path;
use toml::Value;

#[test]
fn bounds_that_name_a_constant_have_its_value() {
    let constants = [
        ("SESSIONS", SESSIONS),
        ("SYMPTOMS", SYMPTOMS.len()),
        ("MOST_TICKS", MOST_TICKS as usize),
        ("HEAD_WORDS", HEAD_WORDS),
        ("PART_WORDS", PART_WORDS),
        ("BODY_BYTES", BODY_BYTES),
        ("IDENTITY_BYTES", IDENTITY_BYTES),
        ("PARAMETER_COUNT", PARAMETER_COUNT),
        ("BLOCK_SAMPLES", BLOCK_SAMPLES),
    ];
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware/budget.toml");
    let budget: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let mut entries = Vec::new();
    collect(&Value::Table(budget), &mut entries);
    for (name, value) in constants {
        let mut compared = 0;
        for (function, bounds, reason) in &entries {
            let is_named = reason
                .split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
                .any(|word| word == name);
            if is_named && !bounds.is_empty() {
                let value = if reason.starts_with("words") {
                    value.div_ceil(4)
                } else {
                    value
                };
                let expected = i64::try_from(value).unwrap();
                assert!(
                    bounds.iter().all(|bound| *bound == expected),
                    "{function}: {bounds:?}, but {name} is {expected}"
                );
                compared += 1;
            }
        }
        assert!(compared > 0, "no bound is {name}");
    }
}

/// Function, bounds and reason of every entry.
fn collect(value: &Value, entries: &mut Vec<(String, Vec<i64>, String)>) {
    if let Some(list) = value.as_array() {
        for value in list {
            collect(value, entries);
        }
    }
    let Some(table) = value.as_table() else {
        return;
    };
    if let (Some(function), Some(reason)) = (table.get("function"), table.get("reason")) {
        let bounds = table.get("bounds").and_then(Value::as_array);
        let bounds = bounds.into_iter().flatten().filter_map(Value::as_integer);
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        entries.push((text(function), bounds.collect(), text(reason)));
    }
    for value in table.values() {
        collect(value, entries);
    }
}
