//! A record in RAM that survives a reset: start counter, and why the last
//! program ended.
//!
//! ```text
//! "kept" ‖ start counter ‖ reason ‖ detail ‖ CRC-32
//! ```
//!
//! RAM is undefined at power-on, so the record is valid only with its
//! checksum. This also distinguishes a brief drop of the supply, which leaves
//! RAM intact, from power-off.

use crepitus_protocol::frame::CRC;

/// Words of the record.
pub const WORDS: usize = 5;

const MAGIC: u32 = u32::from_le_bytes(*b"kept");

/// Reason for the end of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reason {
    /// No reason was stored.
    #[default]
    None,
    /// A reboot was requested.
    Asked,
    /// A panic; the detail is the line.
    Panic,
    /// A processor fault; the detail is the instruction's address, or 0 if the
    /// stack was unusable.
    Fault,
    /// An interrupt or an exception without a handler; the detail is its
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
pub struct ResetRecord {
    /// Start counter.
    pub start: u16,
    /// Reason for the end of the program.
    pub reason: Reason,
    /// Depends on the reason.
    pub detail: u32,
}

impl ResetRecord {
    /// Encodes the record as words of RAM.
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

    /// Decodes words of RAM, if they are a valid record.
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

pub(crate) fn checksum(words: &[u32]) -> u32 {
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
    fn only_a_stored_record_is_read() {
        for reason in Reason::ALL {
            let record = ResetRecord {
                start: 0xfffe,
                reason,
                detail: 0x0801_2345,
            };
            let words = record.words();
            assert_eq!(ResetRecord::of(words), Some(record));
            for place in 0..WORDS {
                for bit in 0..32 {
                    let mut other = words;
                    other[place] ^= 1 << bit;
                    assert_eq!(ResetRecord::of(other), None);
                }
            }
        }
        assert_eq!(ResetRecord::of([0; WORDS]), None);
        assert_eq!(ResetRecord::of([u32::MAX; WORDS]), None);
    }
}
