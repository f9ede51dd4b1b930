//! Post-mortem record: what a controller keeps over a reset of how its last
//! program ended.
//!
//! ```text
//! words   0           1        2 … 9       10 … 25   26 … 33   34 … 353
//!         start, end  detail   registers   stack     place     64 ticks of 5: the drive's only
//!
//! tick    number ‖ count ‖ model torque ‖ torque ‖ current, flags     as in a sample
//! ```
//!
//! The ticks are a ring: one is at its number's remainder. The record is read in
//! parts of 16 words, by [`Operation::ReadCrash`], and stays until the next crash or
//! until power is off.
//!
//! [`Operation::ReadCrash`]: crate::host::Operation::ReadCrash

use crate::telemetry::{Sample, SampleFlags};
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Ticks of the drive that are kept: 3.2 ms. Comms has none.
pub const TICKS: usize = 64;

/// Words of a tick.
pub const TICK_WORDS: usize = 5;

/// Words of the stack that are kept, from the stack pointer up.
pub const STACK_WORDS: usize = 16;

/// Bytes of the place of a panic: the end of the file's name.
pub const PLACE_BYTES: usize = 32;

/// The registers that are kept, in this order; 0 where a program could not store
/// them: all of them after a watchdog reset, all but SP after a panic.
pub const REGISTERS: [(&str, &str); 8] = [
    ("PC", "instruction that failed"),
    ("LR", "return address of its function"),
    ("SP", "stack pointer"),
    (
        "xPSR",
        "flags, number of the exception in the lowest 9 bits",
    ),
    ("CFSR", "kind of the fault"),
    ("HFSR", "why it became a HardFault"),
    (
        "MMFAR",
        "address of a memory fault, if CFSR says that it is valid",
    ),
    (
        "BFAR",
        "address of a bus fault, if CFSR says that it is valid",
    ),
];

const REGISTERS_AT: usize = 2;
const STACK_AT: usize = REGISTERS_AT + REGISTERS.len();
const PLACE_AT: usize = STACK_AT + STACK_WORDS;

/// Words of a record without ticks.
pub const HEAD_WORDS: usize = PLACE_AT + PLACE_BYTES / 4;

/// Words of a record with ticks.
pub const WORDS: usize = HEAD_WORDS + TICKS * TICK_WORDS;

/// Words of a part.
pub const PART_WORDS: usize = 16;

/// The last ticks: one is at its number's remainder.
pub type Ring = [[u32; TICK_WORDS]; TICKS];

/// A controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
pub enum Controller {
    /// The drive.
    Drive,
    /// Comms.
    Comms,
}

/// A part of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Part {
    /// Index of the part, from 0 on.
    pub number: u8,
    /// Words of the part; 0 beyond the end. `None`: there is no record, or no such part.
    pub words: Option<[u32; PART_WORDS]>,
}

impl Part {
    /// A part of the record whose word at a place is `word`, if there is one.
    pub fn of(number: u8, word: impl Fn(usize) -> Option<u32>) -> Self {
        let begin = usize::from(number).saturating_mul(PART_WORDS);
        let words = word(begin).map(|_| {
            let mut part = [0; PART_WORDS];
            for (to, place) in part.iter_mut().zip(begin..) {
                *to = word(place).unwrap_or(0);
            }
            part
        });
        Self { number, words }
    }

    /// The message [`FromDrive::CrashPart`] up to its words, for an incremental
    /// encoder, which appends them one by one.
    ///
    /// [`FromDrive::CrashPart`]: crate::link::FromDrive::CrashPart
    pub fn head(&self) -> impl Serialize + use<> {
        const CRASH_PART: u8 = 1;
        (CRASH_PART, self.number, u8::from(self.words.is_some()))
    }
}

crepitus_model::named! {
    /// Kind of end of a program.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum End {
        /// A panic; the detail is the line.
        Panic => "panic",
        /// A processor fault.
        Fault => "processor fault",
        /// An interrupt or an exception without a handler; the detail is its number.
        Unhandled => "interrupt without a handler",
        /// The program hung until the watchdog reset it.
        Watchdog => "reset by the watchdog",
    }
}

impl End {
    fn number(self) -> u32 {
        match self {
            Self::Panic => 0,
            Self::Fault => 1,
            Self::Unhandled => 2,
            Self::Watchdog => 3,
        }
    }
}

/// A tick of the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tick {
    /// Number of the tick, its lowest 32 bits.
    pub number: u32,
    /// Sample of the tick.
    pub sample: Sample,
}

/// Number of a tick that there was not yet.
const NO_TICK: u32 = u32::MAX;

/// The words of a tick that there was not yet.
pub const NO_TICK_WORDS: [u32; TICK_WORDS] = [NO_TICK, 0, 0, 0, 0];

impl Tick {
    /// Place of the tick in the ring of the last ticks.
    #[inline]
    pub fn slot(&self) -> usize {
        self.number as usize % TICKS
    }

    /// Words of the tick.
    #[inline]
    pub fn words(&self) -> [u32; TICK_WORDS] {
        let sample = &self.sample;
        let [low, high] = sample.current_ma.to_le_bytes();
        [
            self.number,
            sample.count.cast_unsigned(),
            sample.model_torque_nm.to_bits(),
            sample.torque_nm.to_bits(),
            u32::from(sample.flags.0) << 16 | u32::from(u16::from_le_bytes([low, high])),
        ]
    }

    /// The tick of these words, if there was one.
    pub fn of(words: [u32; TICK_WORDS]) -> Option<Self> {
        let [number, count, model_torque, torque, last] = words;
        let [c0, c1, f0, f1] = last.to_le_bytes();
        (number != NO_TICK).then_some(Self {
            number,
            sample: Sample {
                count: count.cast_signed(),
                model_torque_nm: f32::from_bits(model_torque),
                torque_nm: f32::from_bits(torque),
                current_ma: i16::from_le_bytes([c0, c1]),
                flags: SampleFlags(u16::from_le_bytes([f0, f1])),
            },
        })
    }
}

/// A record without ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Head {
    /// Boot counter of the program that ended.
    pub start: u16,
    /// Kind of its end.
    pub end: End,
    /// Depends on the end.
    pub detail: u32,
    /// The [`REGISTERS`].
    pub registers: [u32; REGISTERS.len()],
    /// The stack from the stack pointer up.
    pub stack: [u32; STACK_WORDS],
    /// The end of the name of the file of a panic; zeros before it.
    pub place: [u8; PLACE_BYTES],
}

impl Head {
    /// A program that could store nothing else.
    pub fn new(start: u16, end: End, detail: u32) -> Self {
        Self {
            start,
            end,
            detail,
            registers: [0; REGISTERS.len()],
            stack: [0; STACK_WORDS],
            place: [0; PLACE_BYTES],
        }
    }

    /// Words of the head.
    pub fn words(&self) -> [u32; HEAD_WORDS] {
        let head = [u32::from(self.start) | self.end.number() << 16, self.detail];
        let place = self.place.as_chunks().0.iter().copied();
        let all = head
            .into_iter()
            .chain(self.registers)
            .chain(self.stack)
            .chain(place.map(u32::from_le_bytes));
        let mut words = [0; HEAD_WORDS];
        for (place, word) in words.iter_mut().zip(all) {
            *place = word;
        }
        words
    }

    /// Decodes the first words of a record; `None` if they are invalid.
    pub fn of(words: &[u32]) -> Option<Self> {
        let words = words.first_chunk::<HEAD_WORDS>()?;
        let [first, detail, ..] = *words;
        let [s0, s1, end, rest] = first.to_le_bytes();
        let end = *End::ALL.get(usize::from(end))?;
        let mut head = Self::new(u16::from_le_bytes([s0, s1]), end, detail);
        copy(&mut head.registers, words.get(REGISTERS_AT..)?);
        copy(&mut head.stack, words.get(STACK_AT..)?);
        let place = words.get(PLACE_AT..)?.iter().map(|word| word.to_le_bytes());
        for (bytes, from) in head.place.as_chunks_mut().0.iter_mut().zip(place) {
            *bytes = from;
        }
        (rest == 0).then_some(head)
    }

    /// The place of a panic, for people: the end of the file's name.
    pub fn file(&self) -> Option<&str> {
        let begin = self.place.iter().position(|byte| *byte != 0)?;
        core::str::from_utf8(self.place.get(begin..)?).ok()
    }
}

/// The ticks of a record's words, the oldest first; none without.
pub fn ticks(words: &[u32]) -> impl Iterator<Item = Tick> + use<> {
    let mut ring = [NO_TICK_WORDS; TICKS];
    if let Some(rest) = words.get(HEAD_WORDS..WORDS) {
        copy(ring.as_flattened_mut(), rest);
    }
    in_order(ring).into_iter().filter_map(Tick::of)
}

/// The ring with the oldest tick first: the newest is the one that the next slot
/// does not continue.
fn in_order(mut ring: Ring) -> Ring {
    let number = |slot: &[u32; TICK_WORDS]| {
        let [number, ..] = *slot;
        number
    };
    let following = ring.iter().cycle().skip(1);
    let newest = ring.iter().zip(following).position(|(slot, next)| {
        number(slot) != NO_TICK && number(next) != number(slot).wrapping_add(1)
    });
    ring.rotate_left(newest.map_or(0, |newest| newest.saturating_add(1) % TICKS));
    ring
}

/// The end of a file's name, for [`Head::place`].
pub fn place(file: &str) -> [u8; PLACE_BYTES] {
    let mut place = [0; PLACE_BYTES];
    for (to, from) in place.iter_mut().rev().zip(file.bytes().rev()) {
        *to = from;
    }
    place
}

fn copy(to: &mut [u32], from: &[u32]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = *from;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tick(number: u32) -> Tick {
        Tick {
            number,
            sample: Sample {
                count: -5,
                model_torque_nm: -0.25,
                torque_nm: 1.5,
                current_ma: -1_234,
                flags: SampleFlags(0xa5c3),
            },
        }
    }

    fn head() -> Head {
        Head {
            registers: core::array::from_fn(|n| u32::try_from(n).unwrap() + 1),
            stack: core::array::from_fn(|n| u32::try_from(n).unwrap() + 100),
            place: place("device/src/drive/command.rs"),
            ..Head::new(0xfffe, End::Panic, 77)
        }
    }

    fn words(head: &Head, ring: &Ring) -> std::vec::Vec<u32> {
        let mut words = head.words().to_vec();
        words.extend(ring.as_flattened());
        words
    }

    fn parts(words: &[u32]) -> std::vec::Vec<u32> {
        let part = |number| Part::of(number, |place| words.get(place).copied()).words;
        (0..).map_while(part).flatten().collect()
    }

    #[test]
    fn a_record_comes_back_from_its_parts() {
        let ring = core::array::from_fn(|n| tick(u32::try_from(n).unwrap()).words());
        for end in End::ALL {
            let head = Head { end, ..head() };
            let come = parts(&words(&head, &ring));
            assert_eq!(come[..WORDS], words(&head, &ring));
            assert!(come.len() - WORDS < PART_WORDS);
            assert!(come[WORDS..].iter().all(|word| *word == 0));
            assert_eq!(Head::of(&come), Some(head));
            assert!(ticks(&come).eq((0..64).map(tick)));
            // Without ticks.
            let come = parts(&head.words());
            assert_eq!(Head::of(&come), Some(head));
            assert_eq!(ticks(&come).count(), 0);
        }
        assert_eq!(Part::of(0, |_| None).words, None);
        assert_eq!(head().file(), Some("device/src/drive/command.rs"));
        assert_eq!(Head::new(1, End::Watchdog, 0).file(), None);
    }

    #[test]
    fn a_long_name_keeps_its_end() {
        let head = Head {
            place: place("/somewhere/far/away/device/src/drive/command.rs"),
            ..head()
        };
        assert_eq!(head.file(), Some("away/device/src/drive/command.rs"));
    }

    #[test]
    fn words_that_are_no_record_are_none() {
        let mut words = head().words();
        assert_eq!(Head::of(&words[1..]), None);
        words[0] = 4 << 16;
        assert_eq!(Head::of(&words), None);
        words[0] = 1 << 24;
        assert_eq!(Head::of(&words), None);
    }

    #[test]
    fn the_ring_is_put_in_order_wherever_it_ended() {
        for end in [0_u32, 1, 5, 63, 64, 65, 130, 1_000, 63_999, 64_000] {
            let mut ring = [NO_TICK_WORDS; TICKS];
            for number in 0..end {
                ring[tick(number).slot()] = tick(number).words();
            }
            let expected = end.saturating_sub(64)..end;
            let ordered = ticks(&words(&head(), &ring));
            assert!(ordered.eq(expected.map(tick)), "{end}");
        }
    }
}
