//! Schema hash: compatibility of two programs.
//!
//! [`HASH`] is computed at compile time from the shape and the names of every
//! message and from the parameters, faults, counters and tasks, in their order; of parameters
//! with ranges and defaults: a commit leaves out values that are the default.
//! Programs with equal hashes are compatible; others only on the
//! [management lane](crate::management). The low byte is the tag of all other
//! frames, so that incompatible frames are rejected.

use crate::coil::COIL_FAULTS;
use crate::counters::{COMMS_COUNTERS, CounterSpec, DRIVE_COUNTERS};
use crate::fault::FAULTS;
use crate::host::{Reply, Request};
use crate::link::{FromDrive, ToDrive};
use crate::parameters::{Kind, PARAMETERS};
use crate::task_times::{COMMS_TASKS, DRIVE_TASKS, DeviceTimes};
use crate::telemetry::Block;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::key::Key;

/// Schema hash of this crate.
pub const HASH: u64 = hash();

/// Tag of all lanes but management.
pub const TAG: u8 = HASH.to_le_bytes()[0];

/// FNV-1a, 64 bits.
const fn update(mut hash: u64, bytes: &[u8]) -> u64 {
    let mut rest = bytes;
    while let [byte, tail @ ..] = rest {
        hash = (hash ^ *byte as u64).wrapping_mul(0x0100_0000_01b3);
        rest = tail;
    }
    // A separator: "ab", "c" differs from "a", "bc".
    (hash ^ 0xff).wrapping_mul(0x0100_0000_01b3)
}

const fn counted(mut hash: u64, mut list: &[CounterSpec]) -> u64 {
    while let [counter, tail @ ..] = list {
        hash = update(hash, counter.name.as_bytes());
        list = tail;
    }
    hash
}

const fn named(mut hash: u64, mut list: &[&str]) -> u64 {
    while let [name, tail @ ..] = list {
        hash = update(hash, name.as_bytes());
        list = tail;
    }
    hash
}

const fn numbers(mut hash: u64, mut list: &[f64]) -> u64 {
    while let [number, tail @ ..] = list {
        hash = update(hash, &number.to_bits().to_le_bytes());
        list = tail;
    }
    hash
}

const fn hash() -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325;
    hash = update(hash, &Key::for_path::<Request>("request").to_bytes());
    hash = update(hash, &Key::for_path::<Reply>("reply").to_bytes());
    hash = update(hash, &Key::for_path::<Block>("telemetry").to_bytes());
    hash = update(hash, &Key::for_path::<ToDrive>("to-drive").to_bytes());
    hash = update(hash, &Key::for_path::<FromDrive>("from-drive").to_bytes());
    hash = update(hash, &Key::for_path::<DeviceTimes>("times").to_bytes());
    let mut parameters: &[_] = &PARAMETERS;
    while let [parameter, tail @ ..] = parameters {
        hash = update(hash, parameter.group.as_bytes());
        match parameter.kind {
            Kind::Number(spec) => {
                hash = update(hash, spec.key.as_bytes());
                hash = numbers(hash, &[spec.default, spec.min, spec.max]);
            }
            Kind::Choice(choice) => {
                hash = update(hash, choice.key.as_bytes());
                let mut names = choice.names;
                while let [name, tail @ ..] = names {
                    hash = update(hash, name.as_bytes());
                    names = tail;
                }
                hash = update(hash, &[choice.default]);
            }
        }
        parameters = tail;
    }
    let mut faults: &[_] = &FAULTS;
    while let [fault, tail @ ..] = faults {
        hash = update(hash, &[fault.fault.code()]);
        hash = update(hash, fault.name.as_bytes());
        faults = tail;
    }
    let mut faults: &[_] = &COIL_FAULTS;
    while let [fault, tail @ ..] = faults {
        hash = update(hash, &[fault.fault.code()]);
        hash = update(hash, fault.name.as_bytes());
        faults = tail;
    }
    hash = counted(hash, &DRIVE_COUNTERS);
    hash = counted(hash, &COMMS_COUNTERS);
    hash = named(hash, &DRIVE_TASKS);
    named(hash, &COMMS_TASKS)
}

/// Bytes of the longest message.
pub const LONGEST_MESSAGE: usize = longest(&[
    Request::POSTCARD_MAX_SIZE,
    Reply::POSTCARD_MAX_SIZE,
    Block::POSTCARD_MAX_SIZE,
    ToDrive::POSTCARD_MAX_SIZE,
    FromDrive::POSTCARD_MAX_SIZE,
    DeviceTimes::POSTCARD_MAX_SIZE,
    crate::management::ANSWER_BYTES,
]);

const fn longest(mut lengths: &[usize]) -> usize {
    let mut longest = 0;
    while let [length, tail @ ..] = lengths {
        if *length > longest {
            longest = *length;
        }
        lengths = tail;
    }
    longest
}
