//! A recording as MCAP, for Foxglove: JSON messages with a schema each.
//!
//! | topic | schema | how often |
//! |---|---|---|
//! | `/knee` | `crepitus.Knee` | every millisecond: the last of its 20 samples; of torques and current also lowest, mean and highest |
//! | `/events` | `crepitus.Event` | every break and stick, at its own tick |
//! | `/parameters` | `crepitus.Parameters` | whenever they change |
//! | `/log` | `foxglove.Log` | gaps, and what is wrong with the recording |
//!
//! Times are those of the recording's begin plus the time of the row.

use crate::column::{COLUMNS, Cell, Column};
use crate::parameters::Named;
use crate::recording::{ReadError, Recording};
use crate::row::{Row, Step, seconds};
use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, ErrorKind};

/// Samples of a message: 1 kHz.
const SAMPLES: u64 = 20;

/// Levels of `foxglove.Log`.
const INFO: u8 = 2;
const WARNING: u8 = 3;

fn other(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        error => io::Error::other(error),
    }
}

/// Lowest, mean and highest of a millisecond.
#[derive(Clone, Copy, Debug)]
struct Range {
    low: f32,
    high: f32,
    sum: f64,
    count: u32,
}

impl Default for Range {
    fn default() -> Self {
        Self {
            low: f32::INFINITY,
            high: f32::NEG_INFINITY,
            sum: 0.0,
            count: 0,
        }
    }
}

impl Range {
    fn add(&mut self, value: f32) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
        self.sum += f64::from(value);
        self.count += 1;
    }

    /// Adds the range as members to a message; null where nothing was measured.
    fn members(&self, name: &str, message: &mut Value) {
        let mean = self.sum / f64::from(self.count);
        let parts = if self.count == 0 {
            [Value::Null, Value::Null, Value::Null]
        } else {
            [json!(self.low), json!(mean), json!(self.high)]
        };
        for (part, value) in ["low", "mean", "high"].iter().zip(parts) {
            message[format!("{name}_{part}")] = value;
        }
    }
}

/// The columns of a row of which a message has the range.
fn ranged() -> impl Iterator<Item = &'static Column> {
    COLUMNS.iter().filter(|column| column.is_ranged)
}

/// The samples of a millisecond.
#[derive(Clone, Debug)]
struct Bin {
    last: Option<Row>,
    /// Of the columns that have one, in their order.
    ranges: Vec<Range>,
}

impl Default for Bin {
    fn default() -> Self {
        Self {
            last: None,
            ranges: ranged().map(|_| Range::default()).collect(),
        }
    }
}

impl Bin {
    fn add(&mut self, row: &Row) {
        for (range, column) in self.ranges.iter_mut().zip(ranged()) {
            let value = match column.cell {
                Cell::F32(get, _) => Some(get(row)),
                Cell::Measured(get, _) => get(row),
                _ => None,
            };
            if let Some(value) = value {
                range.add(value);
            }
        }
        self.last = Some(*row);
    }

    fn message(&self) -> Option<(f64, Value)> {
        let row = self.last?;
        let mut message = json!({
            "t_s": row.time_s,
            "tick": row.tick,
            "angle_deg": row.angle_rad.to_degrees(),
            "omega_deg_s": f64::from(row.omega_rad_s).to_degrees(),
            "phase": row.flags.phase_sign(),
            "limit": row.flags.limit().name(),
            "revision": row.revision,
        });
        for (range, column) in self.ranges.iter().zip(ranged()) {
            range.members(column.name, &mut message);
        }
        Some((row.time_s, message))
    }
}

fn knee_schema() -> Value {
    let number = |about: &str| json!({ "type": "number", "description": about });
    let mut properties = json!({
        "t_s": number("time since the first recorded tick, s"),
        "tick": { "type": "integer", "description": "ticks of 50 µs since the drive has started" },
        "angle_deg": number("angle of the joint, degrees; grows with flexion"),
        "omega_deg_s": number("estimated velocity of the joint, degrees/s"),
        "phase": { "type": "integer", "description": "0 stick, 1 slip to growing angle, -1 to falling" },
        "limit": { "type": "string", "description": "why the torque is not the model's" },
        "revision": { "type": "integer", "description": "of the parameters in force" },
    });
    for Column { name, about, .. } in ranged() {
        for part in ["low", "mean", "high"] {
            properties[format!("{name}_{part}")] =
                number(&format!("{about} (null here): {part} of the millisecond"));
        }
    }
    json!({ "type": "object", "properties": properties })
}

fn event_schema() -> Value {
    json!({ "type": "object", "properties": {
        "t_s": { "type": "number" },
        "tick": { "type": "integer" },
        "event": { "type": "string", "description": "break, stick, or both" },
        "angle_deg": { "type": "number" },
        "model_torque_nm": { "type": "number" },
    } })
}

fn parameters_schema() -> Value {
    json!({ "type": "object", "properties": {
        "revision": { "type": "integer" },
        "values": { "type": "object", "description": "those that have changed; first all" },
    } })
}

/// Foxglove's schema of a log message.
fn log_schema() -> Value {
    json!({ "title": "foxglove.Log", "type": "object", "properties": {
        "timestamp": { "type": "object", "title": "time", "properties": {
            "sec": { "type": "integer", "minimum": 0 },
            "nsec": { "type": "integer", "minimum": 0, "maximum": 999_999_999 },
        } },
        "level": { "type": "integer" },
        "message": { "type": "string" },
        "name": { "type": "string" },
        "file": { "type": "string" },
        "line": { "type": "integer", "minimum": 0 },
    } })
}

/// A topic, and the number of its messages.
struct Topic {
    channel: u16,
    count: u32,
}

struct Messages<'f> {
    writer: Writer<BufWriter<&'f File>>,
    begun_ns: u64,
    knee: Topic,
    events: Topic,
    parameters: Topic,
    log: Topic,
}

impl<'f> Messages<'f> {
    fn new(file: &'f File, recording: &Recording) -> io::Result<Self> {
        let mut writer = WriteOptions::new()
            .library(concat!("crepitus ", env!("CARGO_PKG_VERSION")))
            .create(BufWriter::new(file))
            .map_err(other)?;
        let mut topic = |topic: &str, name: &str, schema: &Value| -> io::Result<Topic> {
            let schema = writer
                .add_schema(name, "jsonschema", schema.to_string().as_bytes())
                .map_err(other)?;
            let channel = writer
                .add_channel(schema, topic, "json", &BTreeMap::new())
                .map_err(other)?;
            Ok(Topic { channel, count: 0 })
        };
        let knee = topic("/knee", "crepitus.Knee", &knee_schema())?;
        let events = topic("/events", "crepitus.Event", &event_schema())?;
        let parameters = topic("/parameters", "crepitus.Parameters", &parameters_schema())?;
        let log = topic("/log", "foxglove.Log", &log_schema())?;
        let about = recording.metadata();
        let mut metadata = BTreeMap::from([
            ("title".to_owned(), about.title.clone()),
            ("id".to_owned(), about.id.clone()),
            ("recorder".to_owned(), about.recorder.clone()),
            ("comms_serial".to_owned(), about.comms.serial.clone()),
            (
                "books".to_owned(),
                json!(recording.accounting().totals).to_string(),
            ),
        ]);
        if let Some(drive) = &about.drive {
            metadata.insert("drive_serial".to_owned(), drive.serial.clone());
        }
        writer
            .write_metadata(&mcap::records::Metadata {
                name: "crepitus".to_owned(),
                metadata,
            })
            .map_err(other)?;
        Ok(Self {
            writer,
            begun_ns: about.begun_unix_s.saturating_mul(1_000_000_000),
            knee,
            events,
            parameters,
            log,
        })
    }

    fn at_ns(&self, time_s: f64) -> u64 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "time since the begin, rounded"
        )]
        let since_ns = (time_s * 1e9).round() as u64;
        self.begun_ns.saturating_add(since_ns)
    }

    fn write(
        &mut self,
        topic: impl Fn(&mut Self) -> &mut Topic,
        time_s: f64,
        message: &Value,
    ) -> io::Result<()> {
        let log_time = self.at_ns(time_s);
        let topic = topic(self);
        let header = MessageHeader {
            channel_id: topic.channel,
            sequence: topic.count,
            log_time,
            publish_time: log_time,
        };
        topic.count = topic.count.wrapping_add(1);
        let message = message.to_string();
        self.writer
            .write_to_known_channel(&header, message.as_bytes())
            .map_err(other)
    }

    fn log(&mut self, time_s: f64, level: u8, message: &str) -> io::Result<()> {
        let at_ns = self.at_ns(time_s);
        let message = json!({
            "timestamp": { "sec": at_ns / 1_000_000_000, "nsec": at_ns % 1_000_000_000 },
            "level": level,
            "message": message,
            "name": "crepitus",
            "file": "",
            "line": 0,
        });
        self.write(|messages| &mut messages.log, time_s, &message)
    }

    fn bin(&mut self, bin: &mut Bin) -> io::Result<()> {
        if let Some((time_s, message)) = std::mem::take(bin).message() {
            self.write(|messages| &mut messages.knee, time_s, &message)?;
        }
        Ok(())
    }

    /// Logs missing samples or a restart between two rows; no millisecond reaches across.
    fn step(&mut self, bin: &mut Bin, before: &Row, row: &Row) -> io::Result<()> {
        let text = match row.step_from(before) {
            Step::Next => return Ok(()),
            Step::Missing(samples) => format!(
                "samples of {:.4} s are missing before tick {}",
                seconds(samples),
                row.tick
            ),
            Step::Restart => "the drive has restarted; how long that took is not known".to_owned(),
        };
        self.bin(bin)?;
        self.log(row.time_s, WARNING, &text)
    }

    fn event(&mut self, row: &Row) -> io::Result<()> {
        let event = row.event();
        if event.is_empty() {
            return Ok(());
        }
        let message = json!({
            "t_s": row.time_s,
            "tick": row.tick,
            "event": event,
            "angle_deg": row.angle_rad.to_degrees(),
            "model_torque_nm": row.model_torque_nm,
        });
        self.write(|messages| &mut messages.events, row.time_s, &message)
    }

    fn parameters(&mut self, time_s: f64, revision: u32, values: Option<&Named>) -> io::Result<()> {
        let message = json!({ "revision": revision, "values": values });
        self.write(|messages| &mut messages.parameters, time_s, &message)
    }
}

/// Writes a recording to an empty file, durably. `progress` gets the number of
/// rows so far; if it returns false, writing ends with [`ErrorKind::Interrupted`]. Returns the
/// number of rows of the new file, each of a millisecond.
///
/// # Errors
/// Of either file.
pub(crate) fn write(
    recording: &Recording,
    file: &File,
    progress: &mut dyn FnMut(u64) -> bool,
) -> io::Result<u64> {
    let mut messages = Messages::new(file, recording)?;
    messages.log(0.0, INFO, &recording.metadata().title)?;
    for warning in recording.warnings() {
        messages.log(0.0, WARNING, &warning)?;
    }
    let mut sets = recording.parameters().0.iter().peekable();
    let mut bin = Bin::default();
    let mut before: Option<Row> = None;
    for (count, row) in (0..).zip(recording.rows().map_err(io_error)?) {
        let row = row.map_err(io_error)?;
        while let Some(set) = sets.next_if(|set| set.first_row <= count) {
            messages.parameters(row.time_s, set.revision, set.values.as_ref())?;
        }
        if let Some(before) = before {
            messages.step(&mut bin, &before, &row)?;
        }
        messages.event(&row)?;
        bin.add(&row);
        if (row.tick + 1).is_multiple_of(SAMPLES) {
            messages.bin(&mut bin)?;
            if count % 20_000 < SAMPLES && !progress(count) {
                return Err(ErrorKind::Interrupted.into());
            }
        }
        before = Some(row);
    }
    messages.bin(&mut bin)?;
    messages.writer.finish().map_err(other)?;
    file.sync_all()?;
    Ok(messages.knee.count.into())
}

fn io_error(error: ReadError) -> io::Error {
    match error {
        ReadError::Io { source, .. } => source,
        error => io::Error::other(error),
    }
}
