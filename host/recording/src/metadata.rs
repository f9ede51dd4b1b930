//! Identity of a recording: title, device, program.

use crepitus_protocol::management::Identity;
use crepitus_protocol::{TICKS_PER_S, schema};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};
use std::time::{SystemTime, UNIX_EPOCH};

/// Version of recordings, the layout of blocks and the meaning of their flags
/// included. 1 was a CSV file with a JSON file beside it.
pub(crate) const FORMAT: u32 = 5;

/// Identity of a controller.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
        Self {
            version: format!("{major}.{minor}.{patch}"),
            schema: format!("{:016x}", identity.schema),
            serial: crepitus_files::output::hex(&identity.serial),
            image: format!("{:08x}", identity.image),
        }
    }
}

/// Identity of a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Metadata {
    /// Version of recordings.
    pub format: u32,
    /// Identifier of this recording alone.
    pub id: String,
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
    /// Meaning of each column, with its unit.
    pub columns: Map<String, Value>,
}

impl Metadata {
    /// Metadata of a recording that begins now.
    pub fn new(title: &str, comms: &Identity, drive: Option<&Identity>) -> Self {
        let now = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default();
        let what = format!("{now:?} {} {:?}", std::process::id(), comms.serial);
        Self {
            format: FORMAT,
            id: crepitus_files::output::hex(&Sha256::digest(what)[..8]),
            title: title.to_owned(),
            begun_unix_s: now.as_secs(),
            recorder: env!("CARGO_PKG_VERSION").to_owned(),
            schema: format!("{:016x}", schema::HASH),
            comms: comms.into(),
            drive: drive.map(Controller::from),
            ticks_per_s: TICKS_PER_S,
            columns: columns(),
        }
    }

    /// Metadata of a recording whose header is damaged. What every recording of this format has is
    /// known all the same.
    pub(crate) fn unknown() -> Self {
        Self {
            title: "A recording whose header is damaged".to_owned(),
            ticks_per_s: TICKS_PER_S,
            columns: columns(),
            ..Self::default()
        }
    }
}

fn columns() -> Map<String, Value> {
    let columns = crate::column::COLUMNS.iter();
    columns
        .map(|column| (column.name.to_owned(), json!(column.about)))
        .collect()
}
