//! The MCAP file of a recording, read with the library of Foxglove.

use crate::support::{open, recorded, rows_of, sent};
use crepitus_recording::{Row, mcap_writer};
use mcap::MessageStream;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::{self, File};

/// Columns of which a message has the lowest, mean and highest value.
type Column = (&'static str, fn(&Row) -> Option<f32>);
const RANGES: [Column; 4] = [
    ("model_torque_nm", |row| Some(row.model_torque_nm)),
    ("torque_nm", |row| Some(row.torque_nm)),
    ("current_a", |row| row.current_a),
    ("coil_current_a", |row| row.coil_a),
];

/// Checks a message of these rows: low, mean and high; null where nothing was measured.
fn sums_up(message: &Value, rows: &[Row]) {
    for (name, value) in RANGES {
        let values: Vec<_> = rows.iter().filter_map(value).map(f64::from).collect();
        let low = values.iter().copied().reduce(f64::min);
        let high = values.iter().copied().reduce(f64::max);
        let sum: f64 = values.iter().sum();
        let mean = low.map(|_| sum / values.len() as f64);
        for (part, expected) in [("low", low), ("mean", mean), ("high", high)] {
            let written = message[format!("{name}_{part}")].as_f64();
            let is_right = match (written, expected) {
                (Some(written), Some(expected)) => (written - expected).abs() < 1e-6,
                (None, None) => true,
                _ => false,
            };
            assert!(is_right, "{name}_{part}: {written:?} for {expected:?}");
        }
    }
}

/// Checks a message against its schema: all members, no others.
fn fits(message: &Value, schema: &Value, path: &str) {
    let is = match schema["type"].as_str().unwrap() {
        "object" => message.is_object(),
        "integer" => message.is_i64() || message.is_u64(),
        "string" => message.is_string(),
        "number" => message.is_number() || message.is_null(),
        other => panic!("{other}"),
    };
    assert!(is, "{path}: {message} is no {schema}");
    if let (Some(properties), Some(members)) =
        (schema["properties"].as_object(), message.as_object())
    {
        let names: Vec<_> = properties.keys().collect();
        assert_eq!(members.keys().collect::<Vec<_>>(), names, "{path}");
        for (name, member) in members {
            fits(member, &properties[name], &format!("{path}.{name}"));
        }
    }
}

#[test]
fn foxglove_reads_a_message_a_millisecond_and_every_event() {
    let folder = tempfile::tempdir().unwrap();
    let (log, out) = (folder.path().join("log"), folder.path().join("a.mcap"));
    let sent = sent(1_100);
    recorded(&log, "a test", &sent);
    let recording = open(&log).unwrap();
    mcap_writer().unwrap()(&recording, &File::create(&out).unwrap(), &mut |_| true).unwrap();
    let bytes = fs::read(&out).unwrap();
    let mut counts = BTreeMap::new();
    let mut last = 0;
    let mut knees = Vec::new();
    let mut logged = Vec::new();
    for message in MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let channel = &message.channel;
        let schema = channel.schema.as_ref().unwrap();
        assert_eq!(
            (schema.encoding.as_str(), channel.message_encoding.as_str()),
            ("jsonschema", "json")
        );
        let schema: Value = serde_json::from_slice(&schema.data).unwrap();
        let data: Value = serde_json::from_slice(&message.data).unwrap();
        if channel.topic != "/parameters" {
            fits(&data, &schema, &channel.topic);
        }
        *counts.entry(channel.topic.clone()).or_insert(0) += 1;
        if channel.topic == "/log" {
            logged.push(data["message"].as_str().unwrap().to_owned());
        }
        if channel.topic == "/knee" {
            assert!(message.log_time >= last);
            last = message.log_time;
            knees.push(data);
        }
    }
    let all = rows_of(&sent);
    let events = all
        .iter()
        .filter(|row| row.to_json()["event"] != "")
        .count();
    let events = events
        - all
            .iter()
            .filter(|row| row.to_json()["event"].is_null())
            .count();
    assert_eq!(counts["/knee"], 1_100);
    assert_eq!(counts["/events"], events);
    assert_eq!(counts["/parameters"], 12);
    // The title, what is missing, and each of the gaps.
    assert_eq!(counts["/log"], 2 + 4);
    assert_eq!(
        logged[2..],
        [
            "samples of 0.0020 s are missing before tick 5440",
            "samples of 0.0010 s are missing before tick 9860",
            "samples of 0.2000 s are missing before tick 18260",
            "the drive has restarted; how long that took is not known",
        ]
    );
    for (bin, knee) in all.chunks(20).zip(&knees) {
        sums_up(knee, bin);
    }
    let duration_ns = last - recording.metadata().begun_unix_s * 1_000_000_000;
    assert!((duration_ns as f64 * 1e-9 - all.last().unwrap().time_s).abs() < 1e-6);
}
