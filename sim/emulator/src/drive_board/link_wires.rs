//! The two wires of the link, byte by byte.

use crate::character::Character;
use crate::time::Time;
use crepitus_protocol::frame::Frame;

/// A character at 4.2 Mbaud: ten bits.
const CHARACTER: Time = Time::from_units(800);

/// Wire from comms, which sends one frame after the other, as DMA does.
#[derive(Debug, Default)]
pub(super) struct Down {
    /// End of the last frame.
    free: Time,
    pub(super) keeps: bool,
    pub(super) kept: Vec<Character>,
}

impl Down {
    /// Characters that begin between `begin` and `end`.
    pub(super) fn carry(
        &mut self,
        begin: Time,
        end: Time,
        mut next: impl FnMut() -> Option<Frame>,
    ) -> Vec<Character> {
        let mut characters = Vec::new();
        self.free = self.free.max(begin);
        while self.free < end
            && let Some(frame) = next()
        {
            for byte in &frame {
                self.free += CHARACTER;
                characters.push(Character {
                    at: self.free.units(),
                    byte: *byte,
                    is_broken: false,
                });
            }
        }
        if self.keeps {
            self.kept.extend(&characters);
        }
        characters
    }
}

/// Wire from the drive.
#[derive(Debug, Default)]
pub(super) struct Up {
    waiting: Vec<Character>,
    pub(super) keeps: bool,
    pub(super) kept: Vec<u8>,
}

impl Up {
    /// Bytes that have arrived by `now`.
    pub(super) fn carry(&mut self, sent: Vec<Character>, now: Time) -> Vec<u8> {
        self.waiting.extend(sent);
        let is_here = |character: &Character| character.at <= now.units();
        let count = self.waiting.partition_point(is_here);
        let arrived: Vec<u8> = self
            .waiting
            .drain(..count)
            .map(|character| character.byte)
            .collect();
        if self.keeps {
            self.kept.extend(&arrived);
        }
        arrived
    }
}
