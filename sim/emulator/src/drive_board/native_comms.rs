//! Comms as the simulator runs it: native, without wires of its own.

use super::CommsSide;
use super::HALF;
use super::link_wires::{Down, Up};
use crate::character::Character;
use crate::time::Time;
use crepitus_device::comms::{Boot, Comms, Inputs};
use crepitus_device::self_test::SelfTest;
use crepitus_protocol::management::{Identity, ResetCause, Role};
use crepitus_protocol::{Revision, Values, schema};

/// Halves in a millisecond, the tick of comms.
const MILLISECOND_HALVES: u64 = 40;

/// Comms.
pub struct NativeComms {
    comms: Comms,
    line: bool,
    is_hung: bool,
    down: Down,
    up: Up,
    halves: u64,
}

fn identity() -> Identity {
    let part = |text: &str| text.parse().unwrap_or(0);
    Identity {
        role: Role::Comms,
        version: [
            part(env!("CARGO_PKG_VERSION_MAJOR")),
            part(env!("CARGO_PKG_VERSION_MINOR")),
            part(env!("CARGO_PKG_VERSION_PATCH")),
        ],
        schema: schema::HASH,
        serial: *b"EMU-COMMS-01",
        image: 0,
        reset: ResetCause::Power,
    }
}

impl NativeComms {
    /// Returns comms just switched on, with these parameters stored.
    pub fn new(saved: Option<(Revision, Values)>) -> Self {
        let comms = Comms::new(&Boot {
            self_test: SelfTest::default(),
            identity: identity(),
            start: 1,
            entropy: 1,
            saved,
            counters: 0,
            crash: None,
        });
        Self {
            comms,
            line: false,
            is_hung: false,
            down: Down::default(),
            up: Up::default(),
            halves: 0,
        }
    }

    /// Comms itself.
    pub fn comms(&self) -> &Comms {
        &self.comms
    }

    /// Comms itself, for what comes and goes by USB.
    pub fn comms_mut(&mut self) -> &mut Comms {
        &mut self.comms
    }

    /// Records the bytes of the link from now on, for [`Self::to_drive`] and
    /// [`Self::from_drive`].
    pub fn record_bytes(&mut self) {
        self.down.keeps = true;
        self.up.keeps = true;
    }

    /// Bytes to the drive, each with the end of its stop bit.
    pub fn to_drive(&self) -> &[Character] {
        &self.down.kept
    }

    /// Bytes from the drive.
    pub fn from_drive(&self) -> &[u8] {
        &self.up.kept
    }
}

impl CommsSide for NativeComms {
    fn run(&mut self, sent: Vec<Character>, end: Time, now: Time) -> Vec<Character> {
        let Self {
            comms, is_hung, up, ..
        } = self;
        let arrived = up.carry(sent, now);
        if !*is_hung {
            for byte in arrived {
                comms.link_received(byte);
            }
        }
        let next = || (!*is_hung).then(|| comms.link_to_send()).flatten();
        let characters = self.down.carry(end, end + HALF, next);
        if self.halves.is_multiple_of(MILLISECOND_HALVES) && !self.is_hung {
            let inputs = Inputs {
                enable_is_on: self.line,
            };
            self.line = self.comms.tick(&inputs).enable;
        }
        self.halves += 1;
        characters
    }

    fn line_is_on(&self) -> bool {
        self.line
    }

    fn set_hung(&mut self, is_hung: bool) {
        self.is_hung = is_hung;
    }
}
