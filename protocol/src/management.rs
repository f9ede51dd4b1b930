//! The management lane, whose bytes never change: hello, stop, reboot.
//!
//! All versions are compatible on it. It is not postcard: every byte is defined
//! here.
//!
//! ```text
//! request   'M' '1' action token                      action: 'H' hello, 'S' stop, 'B' reboot
//! answer    'm' '1' 'H' token comms[32] drive[32]     identities; 32 zeros until the drive has reported
//!           'm' '1' 'S' token done                    1
//!           'm' '1' 'B' token done                    1; or 0: rejected while armed
//!
//! identity  role ‖ version[3] ‖ schema hash[8] ‖ serial number[12] ‖ image[4] ‖ reset ‖ 0[3]
//! ```
//!
//! Numbers are little endian. The answer repeats the token. Extra bytes, from a
//! later version, are ignored.

/// Role of a controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Role {
    /// Unknown, or no controller.
    #[default]
    Unknown,
    /// The comms controller.
    Comms,
    /// The drive controller.
    Drive,
}

crepitus_model::named! {
    /// Cause of a reset.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum ResetCause {
        /// Power-on.
        #[default]
        Power => "power",
        /// Reset pin, or a requested reboot.
        Requested => "reset",
        /// Watchdog.
        Watchdog => "watchdog",
        /// Brown-out of the supply.
        BrownOut => "brown-out",
        /// Panic or fault handler.
        Panic => "panic",
    }
}

impl ResetCause {
    fn number(self) -> u8 {
        match self {
            Self::Power => 0,
            Self::Requested => 1,
            Self::Watchdog => 2,
            Self::BrownOut => 3,
            Self::Panic => 4,
        }
    }
}

/// Identity of a controller and its program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// Role.
    pub role: Role,
    /// Version of the program: major, minor, patch.
    pub version: [u8; 3],
    /// [`schema::HASH`](crate::schema::HASH) of the program.
    pub schema: u64,
    /// Serial number of the chip.
    pub serial: [u8; 12],
    /// CRC-32 of the program's image; 0 if there is none.
    pub image: u32,
    /// Cause of the last reset.
    pub reset: ResetCause,
}

/// Serial number of an emulated chip: X 1, Y 2, wafer 3, lot `EMUL405`.
pub const EMULATED_SERIAL: [u8; 12] = *b"\x01\x00\x02\x00\x03EMUL405";

/// Bytes of an [`Identity`].
pub const IDENTITY_BYTES: usize = 32;

/// Bytes of the longest answer.
pub const ANSWER_BYTES: usize = 4 + 2 * IDENTITY_BYTES;

/// Management actions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Action {
    /// Identifies both controllers.
    Hello,
    /// Turns torque off.
    Stop,
    /// Reboots both controllers.
    Reboot,
}

/// Request on the management lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ManagementRequest {
    /// The requested action.
    pub action: Action,
    /// Repeated in the answer.
    pub token: u8,
}

/// Answer on the management lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The identities.
    Hello {
        /// The request's token.
        token: u8,
        /// The controller that answers.
        own: Identity,
        /// The drive, if comms answers and knows it.
        drive: Identity,
    },
    /// Result of a stop.
    Stop {
        /// The request's token.
        token: u8,
        /// Whether torque is off.
        done: bool,
    },
    /// Result of a reboot request.
    Reboot {
        /// The request's token.
        token: u8,
        /// Whether the controllers will reboot.
        done: bool,
    },
}

impl Action {
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
            .find(|action| action.byte() == byte)
    }
}

impl ManagementRequest {
    /// Encodes it, without lane and tag.
    pub fn bytes(self) -> [u8; 2] {
        [self.action.byte(), self.token]
    }

    /// Decodes bytes after lane and tag.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let [action, token, ..] = *bytes else {
            return None;
        };
        Action::of(action).map(|action| Self { action, token })
    }
}

impl Identity {
    /// Returns whether its chip is emulated: then its cycles are no measurement.
    pub fn is_emulated(&self) -> bool {
        self.serial == EMULATED_SERIAL
    }

    /// Encodes it.
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

    /// Decodes an identity.
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

/// Encoded answer, without lane and tag.
pub type AnswerBytes = heapless::Vec<u8, ANSWER_BYTES>;

impl Answer {
    /// Encodes it, without lane and tag.
    pub fn bytes(&self) -> AnswerBytes {
        let mut bytes = heapless::Vec::new();
        let head = match *self {
            Self::Hello { token, .. } => [b'H', token],
            Self::Stop { token, .. } => [b'S', token],
            Self::Reboot { token, .. } => [b'B', token],
        };
        // Cannot fail: the capacity is that of the longest answer.
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

    /// Decodes bytes after lane and tag.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let [action, token, rest @ ..] = bytes else {
            return None;
        };
        let token = *token;
        Some(match Action::of(*action)? {
            Action::Hello => {
                let (own, rest) = rest.split_first_chunk()?;
                let drive = rest.first_chunk()?;
                Self::Hello {
                    token,
                    own: Identity::of(own),
                    drive: Identity::of(drive),
                }
            }
            Action::Stop => Self::Stop {
                token,
                done: *rest.first()? == 1,
            },
            Action::Reboot => Self::Reboot {
                token,
                done: *rest.first()? == 1,
            },
        })
    }

    /// The request's token.
    pub fn token(&self) -> u8 {
        match *self {
            Self::Hello { token, .. } | Self::Stop { token, .. } | Self::Reboot { token, .. } => {
                token
            }
        }
    }
}
