//! The lane whose bytes never change: who is there, stop, reboot.
//!
//! Sides of any two versions understand it. It is not postcard: every byte
//! stands here.
//!
//! ```text
//! question  'M' '1' what token                        what: 'H' hello, 'S' stop, 'B' reboot
//! answer    'm' '1' 'H' token comms[32] drive[32]     identities; 32 zeros if the drive has not said
//!           'm' '1' 'S' token done                    1
//!           'm' '1' 'B' token done                    1; or 0: refused while there is torque
//!
//! identity  role ‖ version[3] ‖ schema hash[8] ‖ serial number[12] ‖ image[4] ‖ reset ‖ 0[3]
//! ```
//!
//! Numbers are little endian. The token comes back as it was sent. What is
//! longer than this is a later version's: the rest is ignored.

/// Who.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Role {
    /// Nobody, or nobody known.
    #[default]
    Unknown,
    /// The comms controller.
    Comms,
    /// The drive controller.
    Drive,
}

/// Why a controller has started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ResetCause {
    /// Power was switched on.
    #[default]
    Power,
    /// Its reset pin, or a reboot that was asked for.
    Asked,
    /// Its watchdog.
    Watchdog,
    /// Its supply fell.
    BrownOut,
    /// Its panic or fault handler.
    Panic,
}

impl ResetCause {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 5] = [
        Self::Power,
        Self::Asked,
        Self::Watchdog,
        Self::BrownOut,
        Self::Panic,
    ];

    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Power => "power",
            Self::Asked => "reset",
            Self::Watchdog => "watchdog",
            Self::BrownOut => "brown-out",
            Self::Panic => "panic",
        }
    }

    fn number(self) -> u8 {
        match self {
            Self::Power => 0,
            Self::Asked => 1,
            Self::Watchdog => 2,
            Self::BrownOut => 3,
            Self::Panic => 4,
        }
    }
}

/// A controller and its program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Who.
    pub role: Role,
    /// Version of the program: major, minor, patch.
    pub version: [u8; 3],
    /// [`schema::HASH`](crate::schema::HASH) of the program.
    pub schema: u64,
    /// Number of the chip.
    pub serial: [u8; 12],
    /// CRC-32 of the program's image; 0 where there is none.
    pub image: u32,
    /// Why it has started.
    pub reset: ResetCause,
}

/// Bytes of an [`Identity`].
pub const IDENTITY_BYTES: usize = 32;

/// Bytes of the longest answer.
pub const ANSWER_BYTES: usize = 4 + 2 * IDENTITY_BYTES;

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum What {
    /// Who is there?
    Hello,
    /// No more torque.
    Stop,
    /// Start anew.
    Reboot,
}

/// A question, with the token that its answer will have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Question {
    /// What is asked.
    pub what: What,
    /// Comes back with the answer.
    pub token: u8,
}

/// An answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Who is there.
    Hello {
        /// The question's token.
        token: u8,
        /// The controller that answers.
        own: Identity,
        /// The drive, where comms answers and knows it.
        drive: Identity,
    },
    /// Whether there is no more torque.
    Stop {
        /// The question's token.
        token: u8,
        /// Whether it was done.
        done: bool,
    },
    /// Whether it starts anew.
    Reboot {
        /// The question's token.
        token: u8,
        /// Whether it will be done.
        done: bool,
    },
}

impl What {
    fn byte(self) -> u8 {
        match self {
            Self::Hello => b'H',
            Self::Stop => b'S',
            Self::Reboot => b'B',
        }
    }

    fn of(byte: u8) -> Option<Self> {
        [Self::Hello, Self::Stop, Self::Reboot]
            .into_iter()
            .find(|what| what.byte() == byte)
    }
}

impl Question {
    /// Its bytes, after lane and tag.
    pub fn bytes(self) -> [u8; 2] {
        [self.what.byte(), self.token]
    }

    /// From bytes after lane and tag.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let [what, token, ..] = *bytes else {
            return None;
        };
        What::of(what).map(|what| Self { what, token })
    }
}

impl Identity {
    /// Its bytes.
    pub fn bytes(&self) -> [u8; IDENTITY_BYTES] {
        let role = match self.role {
            Role::Unknown => 0,
            Role::Comms => 1,
            Role::Drive => 2,
        };
        let mut bytes = [0; IDENTITY_BYTES];
        let parts = [role]
            .into_iter()
            .chain(self.version)
            .chain(self.schema.to_le_bytes())
            .chain(self.serial)
            .chain(self.image.to_le_bytes())
            .chain([self.reset.number()]);
        for (place, byte) in bytes.iter_mut().zip(parts) {
            *place = byte;
        }
        bytes
    }

    /// From its bytes.
    pub fn of(bytes: &[u8; IDENTITY_BYTES]) -> Self {
        let mut rest = bytes.iter().copied();
        let mut next = || rest.next().unwrap_or(0);
        Self {
            role: match next() {
                1 => Role::Comms,
                2 => Role::Drive,
                _ => Role::Unknown,
            },
            version: core::array::from_fn(|_| next()),
            schema: u64::from_le_bytes(core::array::from_fn(|_| next())),
            serial: core::array::from_fn(|_| next()),
            image: u32::from_le_bytes(core::array::from_fn(|_| next())),
            reset: {
                let number = next();
                ResetCause::ALL
                    .into_iter()
                    .find(|cause| cause.number() == number)
                    .unwrap_or_default()
            },
        }
    }
}

/// The bytes of an answer, after lane and tag.
pub type AnswerBytes = heapless::Vec<u8, ANSWER_BYTES>;

impl Answer {
    /// Its bytes, after lane and tag.
    pub fn bytes(&self) -> AnswerBytes {
        let mut bytes = heapless::Vec::new();
        let head = match *self {
            Self::Hello { token, .. } => [b'H', token],
            Self::Stop { token, .. } => [b'S', token],
            Self::Reboot { token, .. } => [b'B', token],
        };
        // The capacity is that of the longest answer.
        let _ = bytes.extend_from_slice(&head);
        let _ = match self {
            Self::Hello { own, drive, .. } => bytes
                .extend_from_slice(&own.bytes())
                .and_then(|()| bytes.extend_from_slice(&drive.bytes())),
            Self::Stop { done, .. } | Self::Reboot { done, .. } => {
                bytes.extend_from_slice(&[u8::from(*done)])
            }
        };
        bytes
    }

    /// From bytes after lane and tag.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let [what, token, rest @ ..] = bytes else {
            return None;
        };
        let token = *token;
        Some(match What::of(*what)? {
            What::Hello => {
                let (own, rest) = rest.split_first_chunk()?;
                let drive = rest.first_chunk()?;
                Self::Hello {
                    token,
                    own: Identity::of(own),
                    drive: Identity::of(drive),
                }
            }
            What::Stop => Self::Stop {
                token,
                done: *rest.first()? == 1,
            },
            What::Reboot => Self::Reboot {
                token,
                done: *rest.first()? == 1,
            },
        })
    }

    /// The token of its question.
    pub fn token(&self) -> u8 {
        match *self {
            Self::Hello { token, .. } | Self::Stop { token, .. } | Self::Reboot { token, .. } => {
                token
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_and_answered_comes_back() {
        for what in [What::Hello, What::Stop, What::Reboot] {
            let question = Question { what, token: 9 };
            assert_eq!(Question::of(&question.bytes()), Some(question));
        }
        let own = Identity {
            role: Role::Comms,
            version: [1, 2, 3],
            schema: 0x0123_4567_89ab_cdef,
            serial: *b"0123456789ab",
            image: 0xdead_beef,
            reset: ResetCause::Watchdog,
        };
        for drive in [
            Identity::default(),
            Identity {
                role: Role::Drive,
                ..own
            },
        ] {
            let answer = Answer::Hello {
                token: 7,
                own,
                drive,
            };
            assert_eq!(Answer::of(&answer.bytes()), Some(answer));
            // A later version may say more.
            let mut longer = answer.bytes().to_vec();
            longer.extend([1, 2, 3]);
            assert_eq!(Answer::of(&longer), Some(answer));
            for cut in 0..answer.bytes().len() {
                assert_eq!(Answer::of(&answer.bytes()[..cut]), None);
            }
        }
        for done in [false, true] {
            let stop = Answer::Stop { token: 1, done };
            let reboot = Answer::Reboot { token: 2, done };
            assert_eq!(Answer::of(&stop.bytes()), Some(stop));
            assert_eq!(Answer::of(&reboot.bytes()), Some(reboot));
        }
        assert_eq!(Question::of(b"X1"), None);
        assert_eq!(Question::of(b"H"), None);
    }
}
