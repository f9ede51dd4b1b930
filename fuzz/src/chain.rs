//! Host, comms, link and drive: the real [`Comms`](crepitus_device::Comms) and
//! [`Drive`](crepitus_device::Drive), joined by a link that loses, changes,
//! delays and repeats frames; three sessions on a wire that loses frames, and
//! restarts of either controller:
//!
//! - **the lease**: the drive commands no torque later than 5,000 ticks after the
//!   last renewal of the session that may hold the lease, or arming. The motor is
//!   driven only after a request to arm to this start of comms, and at most a
//!   millisecond after a stop or disarming has reached it;
//! - a request of before a restart of comms, or of before, is not executed;
//! - **the accounting**: every block at the host continues those before it: samples
//!   produced are those received, those that its count says were dropped, and
//!   those that this wire has lost, by the client's own accounting; none comes
//!   twice. Comms counts what the link has lost;
//! - a sample is that of the drive's tick: torques to the bit, phase, current or
//!   none;
//! - **revisions**: what the drive renders with was committed or saved, and is
//!   valid. What is reported as committed is what the drive had in force.

mod device;
mod oracle;
mod samples;
mod wire;

use crate::bytes::Bytes;
use crate::from_comms::Frames;
use crate::host_oracle::HostOracle;
use crate::known_values::KnownValues;
use crate::lease_oracle::LeaseOracle;
use crate::link_inputs;
use crepitus_protocol::frame::Frame;
use crepitus_protocol::host::{Operation, Request};
use crepitus_protocol::management::{ManagementRequest, ResetCause};
use crepitus_protocol::{LEASE_TICKS, Revision, Session, Values};
use device::{COMMS_TICKS, Device, Readings};
use std::collections::BTreeMap;
use wire::Fault;

/// The most ticks of one input: arming, and a lease that ends; in one of four also what needs
/// half a second, until nobody waits any more for what the drive should have said.
const MOST_TICKS: u64 = 8_000;
const MORE_TICKS: u64 = 14_000;

/// The most restarts: blocks carry five bits of the drive's count of them.
const MOST_RESTARTS: u16 = 30;

/// Sessions of hosts.
const SESSIONS: [Session; 3] = [Session(0), Session(7), Session(0x1001)];

/// Numbers of their first requests, also after a restart of comms: so requests
/// of before are not just older.
const NUMBERS: [u32; SESSIONS.len()] = [0, 0x7ffe, 0xfffe];

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let saved = (bytes.byte() > 127).then(|| {
        let revision = bytes.choice(&[1, 7, u32::MAX - 1]);
        (Revision(revision), link_inputs::values(&mut bytes))
    });
    let mut chain = Chain::new(saved);
    if data.len().is_multiple_of(4) {
        chain.most_ticks = MORE_TICKS;
    }
    while !bytes.is_empty() && chain.device.tick < chain.most_ticks {
        chain.step(&mut bytes);
    }
    chain.run(2, Readings::GOOD);
}

/// A request that was sent.
struct Sent {
    request: Request,
    frame: Frame,
    /// The start of comms that has received it.
    comms_start: u16,
}

/// The device and its hosts, and an oracle.
struct Chain {
    most_ticks: u64,
    device: Device,
    host: HostOracle,
    frames: Frames,
    numbers: [u32; SESSIONS.len()],
    /// All requests that comms has received.
    sent: Vec<Sent>,
    /// Frames to the host that will be lost.
    host_losses: u8,
    /// Bytes that the host reads in a millisecond.
    reads: usize,
    lease: LeaseOracle,
    /// Tick at which the end of torque was requested last.
    stopped: u64,
    values: KnownValues,
    /// Commits that were sent to this start of comms, until they are answered.
    commits: BTreeMap<(u32, u32), Values>,
    /// Values that were in force, by revision.
    in_force: BTreeMap<u32, Values>,
    revision: Option<Revision>,
}

impl Chain {
    fn new(saved: Option<(Revision, Values)>) -> Self {
        Self {
            most_ticks: MOST_TICKS,
            device: Device::new(saved),
            host: HostOracle::default(),
            frames: Frames::default(),
            numbers: NUMBERS,
            sent: Vec::new(),
            host_losses: 0,
            reads: usize::MAX,
            lease: LeaseOracle::new(LEASE_TICKS),
            stopped: 0,
            values: KnownValues::new(saved.map(|(_, values)| values)),
            commits: BTreeMap::new(),
            in_force: BTreeMap::new(),
            revision: None,
        }
    }

    fn step(&mut self, bytes: &mut Bytes<'_>) {
        match bytes.byte() % 10 {
            0 => {
                let readings = Readings {
                    turn: bytes.byte().cast_signed() / 16,
                    ..Readings::GOOD
                };
                self.run(link_inputs::milliseconds(bytes), readings);
            }
            1 | 2 => {
                let place = usize::from(bytes.byte()) % SESSIONS.len();
                let revision = self.device.comms.revision();
                let operation = link_inputs::operation(bytes, revision);
                self.ask(place, operation);
            }
            // A host that renews, for longer than a lease.
            3 => {
                let place = usize::from(bytes.byte()) % SESSIONS.len();
                let period_ms = u16::from(bytes.byte()) + 1;
                for _ in 0..bytes.byte() % 8 {
                    self.ask(place, Operation::Renew);
                    self.run(period_ms, Readings::GOOD);
                }
            }
            // All that arming needs.
            4 => {
                let place = usize::from(bytes.byte()) % SESSIONS.len();
                self.run(10, Readings::GOOD);
                self.ask(place, Operation::Zero);
                self.run(4, Readings::GOOD);
                self.ask(place, Operation::Arm);
                self.run(40, Readings::GOOD);
            }
            5 => {
                let request = ManagementRequest {
                    action: link_inputs::action(bytes),
                    token: bytes.byte(),
                };
                self.manage(request);
            }
            6 => {
                let (which, count) = (bytes.byte(), bytes.byte());
                let fault = match bytes.byte() % 4 {
                    0 => Fault::Lose,
                    1 => Fault::Corrupt(bytes.byte()),
                    // Staleness ends what comms has sent; what the drive has
                    // sent is not delayed for longer than comms takes to restart.
                    2 if which % 2 == 0 => Fault::Delay(u16::from(bytes.byte()) * 4),
                    2 => Fault::Delay(u16::from(bytes.byte()) % 20),
                    _ => Fault::Duplicate,
                };
                let Device { down, up, .. } = &mut self.device;
                let wire = if which % 2 == 0 { down } else { up };
                wire.set_fault(fault, count);
            }
            7 => match bytes.byte() {
                lost @ 0..=63 => self.host_losses = lost % 8,
                64..=127 => self.replay(bytes.byte()),
                128..=159 => self.unplug(),
                160..=175 => self.device.save_works = !self.device.save_works,
                reads => {
                    self.reads = if reads < 208 {
                        usize::from(reads)
                    } else {
                        usize::MAX
                    }
                }
            },
            8 => {
                let cause = bytes.choice(&ResetCause::ALL);
                let ticks = COMMS_TICKS * (2 + u64::from(bytes.byte() % 16));
                if bytes.byte().is_multiple_of(2) {
                    self.restart_comms(cause, ticks);
                } else {
                    self.device.restart_drive(cause, ticks);
                }
            }
            _ => {
                let how = bytes.byte();
                let readings = Readings {
                    turn: if how & 1 == 0 {
                        0
                    } else {
                        bytes.byte().cast_signed()
                    },
                    has_current: how & 2 == 0,
                    has_tripped: how & 4 != 0,
                    is_late: how & 8 != 0,
                    line: (how & 16 != 0).then_some(how & 32 != 0),
                };
                for _ in 0..bytes.byte() % 64 {
                    self.tick(readings);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::State;

    /// Without torque most of the chain would never be searched.
    #[test]
    fn all_that_arming_needs_arms() {
        let mut chain = Chain::new(None);
        chain.step(&mut Bytes::new(&[4, 0]));
        assert_eq!(chain.device.drive.state(), State::Armed);
    }
}
