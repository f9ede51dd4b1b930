//! Metadata of a recording: its JSON file.

use crepitus_model::{Convention, Parameters, Restart, Settings};
use crepitus_protocol::management::Identity;
use crepitus_protocol::parameters::Kind;
use crepitus_protocol::{Revision, TICKS_PER_S, Values, schema};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

/// Version of the two files.
pub(crate) const FORMAT: u32 = 1;

/// Identity of a controller.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Controller {
    /// Version of its program.
    pub version: String,
    /// Schema hash of its program, hexadecimal.
    pub schema: String,
    /// Number of its chip, hexadecimal.
    pub serial: String,
    /// CRC-32 of its program's image, hexadecimal; 0 where there is none.
    pub image: String,
}

impl From<&Identity> for Controller {
    fn from(identity: &Identity) -> Self {
        let [major, minor, patch] = identity.version;
        let serial = identity.serial.iter().fold(String::new(), |mut hex, byte| {
            let _ = write!(hex, "{byte:02x}");
            hex
        });
        Self {
            version: format!("{major}.{minor}.{patch}"),
            schema: format!("{:016x}", identity.schema),
            serial,
            image: format!("{:08x}", identity.image),
        }
    }
}

/// Parameters that were active from a tick on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterSet {
    /// Their revision.
    pub revision: u32,
    /// The first tick that was recorded with them.
    pub first_tick: u64,
    /// Name to value; a choice by its name.
    pub values: Map<String, Value>,
}

/// A gap: missing samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Gap {
    /// The first missing tick.
    pub first_tick: u64,
    /// Number of missing samples.
    pub samples: u64,
}

/// Sample accounting: produced = received + dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Totals {
    /// Samples that the drive produced from the first to the last recorded
    /// tick.
    pub produced: u64,
    /// Samples that were recorded.
    pub received: u64,
    /// Samples lost anywhere between drive and file.
    pub dropped: u64,
}

/// The JSON file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sidecar {
    /// Version of the two files.
    pub format: u32,
    /// Title.
    pub title: String,
    /// Start of the recording, seconds since 1970.
    pub begun_unix_s: u64,
    /// Version of the program that has recorded it.
    pub recorder: String,
    /// Schema hash of that program, hexadecimal.
    pub schema: String,
    /// The comms controller.
    pub comms: Controller,
    /// The drive controller.
    pub drive: Option<Controller>,
    /// Ticks in a second.
    pub ticks_per_s: u32,
    /// Meaning of each column.
    pub columns: Map<String, Value>,
    /// Whether the recording was finished. If not, `telemetry` and `drops` are
    /// those of the last update of this file.
    pub complete: bool,
    /// Every active parameter set, in order.
    pub parameters: Vec<ParameterSet>,
    /// Sample accounting.
    pub telemetry: Totals,
    /// The first thousand gaps.
    pub drops: Vec<Gap>,
    /// Restarts of the drive during the recording; ticks restart from 0.
    pub drive_restarts: u32,
}

impl Sidecar {
    /// Metadata of a recording that begins now.
    pub fn new(title: &str, begun_unix_s: u64, comms: &Identity, drive: Option<&Identity>) -> Self {
        Self {
            format: FORMAT,
            title: title.to_owned(),
            begun_unix_s,
            recorder: env!("CARGO_PKG_VERSION").to_owned(),
            schema: format!("{:016x}", schema::HASH),
            comms: comms.into(),
            drive: drive.map(Controller::from),
            ticks_per_s: TICKS_PER_S,
            columns: crate::row::COLUMNS
                .iter()
                .map(|(name, meaning)| ((*name).to_owned(), json!(meaning)))
                .collect(),
            complete: false,
            parameters: Vec::new(),
            telemetry: Totals::default(),
            drops: Vec::new(),
            drive_restarts: 0,
        }
    }

    /// The settings of the stick-slip joint in a revision; none if the
    /// revision is not in this recording.
    pub fn joint_settings(&self, revision: Revision) -> Option<Settings> {
        let number = |name| self.number(revision, name);
        Some(Settings {
            parameters: Parameters {
                inertia_kg_m2: number("crepitus.inertia_kg_m2")?,
                stiffness_nm_per_rad: number("crepitus.stiffness_nm_per_rad")?,
                kinetic_torque_nm: number("crepitus.kinetic_torque_nm")?,
                static_torque_nm: number("crepitus.static_torque_nm")?,
                // No device has damping.
                ..Parameters::default()
            },
            // The only convention that a device renders.
            convention: Convention::Frozen,
            restart: self
                .value(revision, "crepitus.restart")
                .and_then(|value| Restart::ALL.into_iter().find(|r| value == r.name()))
                .unwrap_or_default(),
        })
    }

    /// When other parameters took effect, s since the first sample, and in a
    /// few words which.
    pub fn changes(&self) -> Vec<(f64, String)> {
        let begin = self.parameters.first().map_or(0, |first| first.first_tick);
        self.parameters
            .windows(2)
            .map(|pair| {
                let (before, after) = (&pair[0], &pair[1]);
                let ticks = after.first_tick.saturating_sub(begin);
                #[expect(clippy::cast_precision_loss, reason = "centuries of ticks")]
                let at_s = ticks as f64 / f64::from(TICKS_PER_S);
                let changed: Vec<_> = after
                    .values
                    .iter()
                    .filter(|(name, value)| before.values.get(*name) != Some(value))
                    .collect();
                let what = match changed.as_slice() {
                    [(name, value)] => {
                        let short = name.split_once('.').map_or(name.as_str(), |(_, key)| key);
                        format!(": {short} = {value}")
                    }
                    [] => String::new(),
                    several => format!(": {} parameters", several.len()),
                };
                (at_s, format!("revision {}{what}", after.revision))
            })
            .collect()
    }

    /// The value of a number in the parameters of a revision.
    pub fn number(&self, revision: Revision, name: &str) -> Option<f64> {
        self.value(revision, name).and_then(Value::as_f64)
    }

    fn value(&self, revision: Revision, name: &str) -> Option<&Value> {
        self.parameters
            .iter()
            .find(|set| set.revision == revision.0)
            .and_then(|set| set.values.get(name))
    }
}

/// Values by name; choices by the name of what was chosen.
pub fn named_values(values: &Values) -> Map<String, Value> {
    values
        .iter()
        .map(|(parameter, value)| {
            let name = format!("{}.{}", parameter.group, parameter.key());
            let value = match parameter.kind {
                Kind::Number(_) => json!(value),
                Kind::Choice(choice) => choice
                    .names
                    .iter()
                    .zip(0_u8..)
                    .find(|(_, place)| f64::from(*place) == value)
                    .map_or(Value::Null, |(name, _)| json!(name)),
            };
            (name, value)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_of_parameters_have_a_time_and_a_name() {
        let identity = Identity::default();
        let mut sidecar = Sidecar::new("a knee", 0, &identity, None);
        assert_eq!(sidecar.changes(), []);
        let mut set = |revision, first_tick, kinetic: f64, stiffness: f64| {
            let values = json!({ "crepitus.kinetic_torque_nm": kinetic, "crepitus.stiffness_nm_per_rad": stiffness });
            let Value::Object(values) = values else {
                return;
            };
            sidecar.parameters.push(ParameterSet {
                revision,
                first_tick,
                values,
            });
        };
        set(2, 320, 0.2, 400.0);
        set(3, 80_320, 0.25, 400.0);
        set(4, 160_320, 0.2, 900.0);
        let named = |name: &str| name.to_owned();
        assert_eq!(
            sidecar.changes(),
            [
                (4.0, named("revision 3: kinetic_torque_nm = 0.25")),
                (8.0, named("revision 4: 2 parameters"))
            ]
        );
    }
}
