//! Lanes: the kinds of frames, by their first byte.

use crate::schema;

/// The kinds of frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Lane {
    /// Host to comms to drive: management request.
    Management,
    /// Answer to a management request.
    ManagementAnswer,
    /// Host to comms: [`Request`](crate::host::Request).
    Request,
    /// Comms to host: [`Reply`](crate::host::Reply).
    Reply,
    /// Drive to comms to host: [`Block`](crate::telemetry::Block).
    Telemetry,
    /// Comms to drive: [`ToDrive`](crate::link::ToDrive).
    ToDrive,
    /// Drive to comms: [`FromDrive`](crate::link::FromDrive).
    FromDrive,
    /// Comms to host, once a second beside blocks: [`DeviceTimes`](crate::task_times::DeviceTimes).
    Times,
}

/// The tag of the management lane, its version; it never changes.
pub const MANAGEMENT_TAG: u8 = b'1';

impl Lane {
    /// All lanes.
    pub const ALL: [Self; 8] = [
        Self::Management,
        Self::ManagementAnswer,
        Self::Request,
        Self::Reply,
        Self::Telemetry,
        Self::ToDrive,
        Self::FromDrive,
        Self::Times,
    ];

    /// The first byte of a frame: a letter, readable in a dump.
    pub const fn byte(self) -> u8 {
        match self {
            Self::Management => b'M',
            Self::ManagementAnswer => b'm',
            Self::Request => b'Q',
            Self::Reply => b'R',
            Self::Telemetry => b'T',
            Self::ToDrive => b'D',
            Self::FromDrive => b'S',
            Self::Times => b'C',
        }
    }

    /// The second byte: the version of the payload's format.
    pub const fn tag(self) -> u8 {
        match self {
            Self::Management | Self::ManagementAnswer => MANAGEMENT_TAG,
            _ => schema::TAG,
        }
    }

    /// The lane with this first byte.
    pub fn of(byte: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|lane| lane.byte() == byte)
    }
}
