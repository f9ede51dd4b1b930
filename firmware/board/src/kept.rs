//! What is kept in RAM over a reset: which start this is, and why the last
//! program ended.
//!
//! ```text
//! "kept" ‖ number of the start ‖ reason ‖ detail ‖ CRC-32
//! ```
//!
//! RAM comes up with anything in it, so the record counts only with its
//! checksum. It also tells a supply that fell for a moment, which leaves RAM
//! as it was, from one that was off.

use crepitus_protocol::frame::CRC;

/// Words of the record.
pub const WORDS: usize = 5;

const MAGIC: u32 = u32::from_le_bytes(*b"kept");

/// Why a program has ended, where it could say so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reason {
    /// It has not ended by itself.
    #[default]
    None,
    /// Somebody asked for a new start.
    Asked,
    /// It has panicked; the detail is the line.
    Panic,
    /// The processor could not go on; the detail is the instruction's address,
    /// or 0 if the stack was of no use.
    Fault,
    /// An interrupt or an exception that nobody handles; the detail is its
    /// number.
    Unhandled,
}

impl Reason {
    const ALL: [Self; 5] = [
        Self::None,
        Self::Asked,
        Self::Panic,
        Self::Fault,
        Self::Unhandled,
    ];

    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Asked => "asked",
            Self::Panic => "panic at line",
            Self::Fault => "fault at address",
            Self::Unhandled => "unhandled interrupt",
        }
    }
}

/// The record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kept {
    /// Which start this is.
    pub start: u16,
    /// Why the program has ended.
    pub reason: Reason,
    /// More about it.
    pub detail: u32,
}

impl Kept {
    /// As words of RAM.
    pub fn words(&self) -> [u32; WORDS] {
        let place = Reason::ALL.iter().position(|reason| *reason == self.reason);
        let reason = place.and_then(|place| u32::try_from(place).ok());
        let body = [
            MAGIC,
            u32::from(self.start),
            reason.unwrap_or_default(),
            self.detail,
        ];
        let [magic, start, reason, detail] = body;
        [magic, start, reason, detail, checksum(&body)]
    }

    /// From words of RAM, if they are a record.
    pub fn of(words: [u32; WORDS]) -> Option<Self> {
        let [magic, start, reason, detail, sum] = words;
        let is_record = magic == MAGIC && sum == checksum(&[magic, start, reason, detail]);
        is_record.then_some(Self {
            start: u16::try_from(start).ok()?,
            reason: *Reason::ALL.get(usize::try_from(reason).ok()?)?,
            detail,
        })
    }
}

fn checksum(words: &[u32]) -> u32 {
    let mut digest = CRC.digest();
    for word in words {
        digest.update(&word.to_le_bytes());
    }
    digest.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_comes_back_and_nothing_else() {
        for reason in Reason::ALL {
            let kept = Kept {
                start: 0xfffe,
                reason,
                detail: 0x0801_2345,
            };
            let words = kept.words();
            assert_eq!(Kept::of(words), Some(kept));
            for place in 0..WORDS {
                for bit in 0..32 {
                    let mut other = words;
                    other[place] ^= 1 << bit;
                    assert_eq!(Kept::of(other), None);
                }
            }
        }
        assert_eq!(Kept::of([0; WORDS]), None);
        assert_eq!(Kept::of([u32::MAX; WORDS]), None);
    }
}
