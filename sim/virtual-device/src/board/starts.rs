//! Starts of the controllers, and their identities.

use super::{Board, Health};
use crepitus_device::comms::{self, Comms};
use crepitus_device::drive::{self, Drive};
use crepitus_device::self_test::SelfTest;
use crepitus_protocol::crash::{End, Head};
use crepitus_protocol::management::{Identity, ResetCause, Role};
use crepitus_protocol::schema;

pub(super) fn identity(role: Role, reset: ResetCause) -> Identity {
    let part = |text: &str| text.parse().unwrap_or(0);
    Identity {
        role,
        version: [
            part(env!("CARGO_PKG_VERSION_MAJOR")),
            part(env!("CARGO_PKG_VERSION_MINOR")),
            part(env!("CARGO_PKG_VERSION_PATCH")),
        ],
        schema: schema::HASH,
        serial: match role {
            Role::Drive => *b"SIM-DRIVE-01",
            _ => *b"SIM-COMMS-01",
        },
        image: 0,
        reset,
    }
}

impl Board {
    pub(super) fn start_due_controllers(&mut self) {
        if let Health::StartsAt(tick, cause) = self.drive_health
            && tick <= self.tick
        {
            if let Some(end) = end(cause) {
                let start = self.starts[0].wrapping_sub(1);
                self.drive_crash = Some(self.drive.ends(Head::new(start, end, 0)));
            }
            let boot = drive::Boot {
                identity: Identity {
                    schema: self.drive_schema,
                    ..identity(Role::Drive, cause)
                },
                start: self.starts[0],
                counter: self.leg.count().cast_unsigned(),
                crash: self.drive_crash,
                ..drive::Boot::default()
            };
            // The drive's defaults were valid at the first start.
            if let Ok(drive) = Drive::new(&boot) {
                self.drive = drive;
                self.drive_health = Health::Runs;
                self.starts[0] = self.starts[0].wrapping_add(1);
            }
        }
        if let Health::StartsAt(tick, cause) = self.comms_health
            && tick <= self.tick
        {
            self.storage.start();
            if let Some(end) = end(cause) {
                let start = self.starts[1].wrapping_sub(1);
                self.comms_crash = Some(Head::new(start, end, 0));
            }
            self.comms = Comms::new(&comms::Boot {
                self_test: SelfTest::default(),
                identity: identity(Role::Comms, cause),
                start: self.starts[1],
                entropy: u64::from(self.starts[1]),
                saved: self.storage.newest(),
                counters: 0,
                crash: self.comms_crash,
            });
            self.comms_health = Health::Runs;
            self.starts[1] = self.starts[1].wrapping_add(1);
            self.comms_has_restarted = true;
        }
    }
}

/// Kind of end of a program that was reset for this cause, if that is a crash.
fn end(cause: ResetCause) -> Option<End> {
    match cause {
        ResetCause::Watchdog => Some(End::Watchdog),
        ResetCause::Panic => Some(End::Panic),
        ResetCause::Power | ResetCause::Requested | ResetCause::BrownOut => None,
    }
}
