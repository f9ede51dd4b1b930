//! Messages made of bytes, mostly plausible.

use crate::bytes::Bytes;
use crepitus_protocol::chirp::PlayedChirp;
use crepitus_protocol::crash::Controller;
use crepitus_protocol::host::Operation;
use crepitus_protocol::management::Action;
use crepitus_protocol::parameters::{Kind, PARAMETERS};
use crepitus_protocol::{Revision, Values};

/// A tick that is about now: mostly now, or a little earlier.
pub(crate) fn near(bytes: &mut Bytes<'_>, now: u64) -> u64 {
    match bytes.byte() {
        0..=127 => now,
        back @ 128..=223 => now.saturating_sub(u64::from(back - 128) * 8),
        ahead @ 224..=239 => now.saturating_add(u64::from(ahead - 223)),
        240..=247 => u64::MAX - u64::from(bytes.byte()),
        _ => u64::from(bytes.u16()),
    }
}

/// Values of which some are not the defaults, mostly allowed.
pub(crate) fn values(bytes: &mut Bytes<'_>) -> Values {
    let mut values = Values::default();
    for _ in 0..bytes.byte() % 4 {
        let parameter = &PARAMETERS[usize::from(bytes.byte()) % PARAMETERS.len()];
        let how = bytes.byte();
        let value = match parameter.kind {
            _ if how >= 240 => bytes.double(),
            Kind::Choice(_) => f64::from(how % 3),
            // Near the default, since most values go with some others only.
            Kind::Number(spec) if how < 120 => spec.default * f64::from(how) / 60.0,
            Kind::Number(spec) => bytes.between(spec.min, spec.max),
        };
        values.set(parameter.id, value);
    }
    values
}

/// An operation; a commit is mostly made from `revision`.
pub(crate) fn operation(bytes: &mut Bytes<'_>, revision: Revision) -> Operation {
    match bytes.byte() % 16 {
        0 | 1 => Operation::Renew,
        2 => Operation::Open,
        3 if bytes.byte() < 128 => Operation::Status,
        3 if bytes.byte() < 128 => Operation::Times,
        3 => Operation::Counters,
        4 => Operation::Parameters,
        5 | 6 => Operation::Commit {
            base: if bytes.byte() < 224 {
                revision
            } else {
                Revision(u32::from(bytes.byte()))
            },
            values: values(bytes),
        },
        7 => Operation::Save,
        8 => Operation::Zero,
        9..=11 => Operation::Arm,
        12 => Operation::Disarm,
        13 => Operation::ClearFault,
        14 => Operation::Subscribe,
        _ if bytes.byte() < 128 => Operation::Unsubscribe,
        _ if bytes.byte() < 128 => Operation::PlayChirp(chirp(bytes)),
        _ => Operation::ReadCrash {
            controller: bytes.choice(&[Controller::Drive, Controller::Comms]),
            part: bytes.byte() % 32,
        },
    }
}

/// A chirp, mostly one that an actuator bears.
pub(crate) fn chirp(bytes: &mut Bytes<'_>) -> PlayedChirp {
    let tenth = u16::from(bytes.byte());
    PlayedChirp {
        amplitude_mv: 10 * u16::from(bytes.byte()),
        from_dhz: tenth,
        to_dhz: 10 + 40 * tenth,
        duration_ms: 400 + 4 * u16::from(bytes.byte()),
    }
}

/// A duration, ms: mostly as short as what needs no timeout, up to that of a
/// lease.
pub(crate) fn milliseconds(bytes: &mut Bytes<'_>) -> u16 {
    match u16::from(bytes.byte()) {
        short @ 0..64 => short,
        short @ 64..240 => short % 16,
        long => (long - 239) * 16,
    }
}

/// A question of the lane that never changes.
pub(crate) fn action(bytes: &mut Bytes<'_>) -> Action {
    bytes.choice(&[Action::Hello, Action::Stop, Action::Reboot])
}
