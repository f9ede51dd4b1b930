//! Messages between programs that share a device: frames of a lane that the
//! device does not have. The hub never passes them on.

use crate::sharing::left_open::LeftOpen;
use crepitus_protocol::Session;
use crepitus_protocol::decoder::Body;
use crepitus_protocol::frame::{self, BODY_BYTES, Frame};
use serde::{Deserialize, Serialize};

/// The lane's byte.
const LANE: u8 = b'H';

/// The version of the messages.
const TAG: u8 = b'1';

/// Most characters of a program's name: a note fits a frame.
const NAME_CHARACTERS: usize = 60;

/// A program that is connected to a device.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Name that it gives itself: its command line.
    pub name: String,
    /// Process id.
    pub pid: u32,
    /// Session of the program, once it has opened one.
    pub session: Option<Session>,
    /// The program renews the lease: the device is armed for it.
    pub is_armed: bool,
}

impl Program {
    /// This program.
    pub fn this(name: &str) -> Self {
        let plain = |c: char| if c.is_control() { ' ' } else { c };
        Self {
            name: name.chars().map(plain).take(NAME_CHARACTERS).collect(),
            pid: std::process::id(),
            ..Self::default()
        }
    }
}

/// A message between programs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Note {
    /// Greeting to the hub: the program that connects. Answered by [`Note::Welcome`].
    Hello(Program),
    /// Subscription and lease that the previous hub was asked for: to the hub, before it is greeted.
    LeftOpen(LeftOpen),
    /// The hub serves.
    Welcome,
    /// Question to the hub: who is connected? Answered by [`Note::Member`]s and
    /// [`Note::End`].
    Who,
    /// A program that is connected.
    Member(Program),
    /// The end of an answer.
    End,
    /// Subscription and lease that the program that serves has left open: to all others, after each of
    /// its requests. If it is killed, they give both to the next hub, which ends them.
    Heir {
        /// Subscription of the program.
        open: LeftOpen,
        /// Lease of the program.
        is_armed: bool,
    },
    /// The hub ends: connect again.
    Leaving,
    /// A message of another version.
    Other,
}

impl Note {
    /// The frame; nothing if it is too long for one.
    pub(crate) fn frame(&self) -> Option<Frame> {
        let mut body = vec![LANE, TAG];
        serde_json::to_writer(&mut body, self).ok()?;
        if body.len() > BODY_BYTES {
            return None;
        }
        frame::encode_body(&body).ok()
    }

    /// The message of a body, if it is of this lane.
    pub(crate) fn of(body: &Body<'_>) -> Option<Self> {
        if body.lane != LANE {
            return None;
        }
        let note = serde_json::from_slice(body.payload).ok();
        Some(note.filter(|_| body.tag == TAG).unwrap_or(Self::Other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::{Decoder, Lane};

    #[test]
    fn a_note_comes_back_and_is_on_no_lane_of_the_device() {
        let longest = Program {
            pid: u32::MAX,
            session: Some(Session(u32::MAX)),
            is_armed: true,
            ..Program::this(&"\u{1f980}".repeat(1_000))
        };
        for note in [
            Note::Hello(longest),
            Note::LeftOpen(LeftOpen::default()),
            Note::Heir {
                open: LeftOpen::default(),
                is_armed: true,
            },
            Note::Welcome,
            Note::Who,
            Note::Leaving,
        ] {
            let mut decoder = Decoder::new();
            let mut back = None;
            for byte in note.frame().unwrap() {
                if let Some(Ok(body)) = decoder.push(byte) {
                    assert_eq!(body.lane(), None);
                    back = Note::of(&body);
                }
            }
            assert_eq!(back, Some(note));
        }
        assert!(Lane::of(LANE).is_none());
    }
}
