//! A device that speaks this side's language.
//!
//! | part | look in |
//! |---|---|
//! | asking, repeating, the lease | `asking.rs` |
//! | what can be asked | `requests.rs` |
//! | what comes unasked | `pump.rs` |
//! | a line that was lost | `reconnect.rs` |

use crate::accounting::Accounting;
use crate::errors::Error;
use crate::event::Event;
use crate::handshake::Handshake;
use crate::management::Management;
use crate::reconnect::Loss;
use crate::request_kind::RequestKind;
use crate::round_trips::RoundTrips;
use crate::session::Options;
use crate::transport::Transport;
use crate::wire::Wire;
use crepitus_protocol::host::Status;
use crepitus_protocol::management::Identity;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Session, State};
use std::collections::VecDeque;
use std::time::Duration;

/// Talks to a device. Nothing happens between calls: [`Self::pump`] has to be
/// called regularly, every 50 ms or more often while the device is armed.
#[derive(Debug)]
pub struct Client<T> {
    pub(crate) wire: Wire<T>,
    pub(crate) session: Session,
    /// Of the last request, and of the last question of the lane that never
    /// changes.
    pub(crate) number: u16,
    pub(crate) token: u8,
    handshake: Handshake,
    pub(crate) lease: Lease,
    pub(crate) renewed_at: Duration,
    pub(crate) watch: Watch,
    pub(crate) telemetry: Telemetry,
    pub(crate) events: VecDeque<Event>,
    /// What is being asked.
    pub(crate) asking: Option<RequestKind>,
    /// The line was lost, with this.
    pub(crate) loss: Option<Loss>,
    pub(crate) round_trips: RoundTrips,
    pub(crate) counts: Counts,
}

/// Whether this client renews the lease.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Lease {
    #[default]
    None,
    /// Arming was asked for.
    Taking,
    /// The device is armed, as far as is known.
    Held,
}

/// Looks after the state: a status is asked for from within a pump, and not
/// waited for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Watch {
    /// Number of the request that is not answered yet.
    pub(crate) asked: Option<u16>,
    pub(crate) asked_at: Duration,
    /// When it is to be asked, apart from regularly.
    pub(crate) due_at: Option<Duration>,
    pub(crate) known: Option<Status>,
}

/// The subscription.
#[derive(Clone, Debug, Default)]
pub(crate) struct Telemetry {
    pub(crate) is_subscribed: bool,
    pub(crate) books: Option<Accounting>,
    /// Blocks that come while the beginning of the subscription is not known.
    pub(crate) early: Option<Vec<Block>>,
    pub(crate) state: Option<State>,
    pub(crate) heard_at: Duration,
    /// The silence was told of.
    pub(crate) is_silent: bool,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Counts {
    pub(crate) strays: u64,
    pub(crate) repeats: u64,
    pub(crate) renewals: u64,
    pub(crate) stalls: u64,
    pub(crate) unasked_blocks: u64,
    pub(crate) unread_blocks: u64,
}

/// What a client has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Frames that were in order.
    pub frames: u64,
    /// Frames that were too long, malformed, or had a wrong checksum.
    pub discarded_frames: u64,
    /// Frames of a lane or a language that this side does not speak.
    pub foreign_frames: u64,
    /// Answers that nobody waited for: late, twice, or another host's.
    pub stray_answers: u64,
    /// Requests that were sent again because no answer came in time.
    pub repeats: u64,
    /// Renewals of the lease that were sent.
    pub renewals: u64,
    /// Frames that were not sent because nothing took them.
    pub stalls: u64,
    /// Blocks that nobody has subscribed to: of an earlier program.
    pub unasked_blocks: u64,
    /// Blocks that were thrown away because nobody pumps; the books of the
    /// subscription show them as lost on the line.
    pub unread_blocks: u64,
}

impl<T: Transport> Client<T> {
    /// Finds out who is there, on a line that is open.
    ///
    /// # Errors
    /// [`Error::Mismatch`] if comms speaks another language: [`Management`]
    /// talks to such a device. [`Error::NoAnswer`], [`Error::Transport`].
    pub fn connect(transport: T) -> Result<Self, Error> {
        Self::connect_with(transport, Options::default())
    }

    /// The same, with a session of one's own.
    ///
    /// # Errors
    /// As [`Self::connect`].
    pub fn connect_with(transport: T, options: Options) -> Result<Self, Error> {
        let mut management = Management::with(transport, options);
        let handshake = management.identify()?;
        management.into_client(handshake)
    }

    /// One that has not found out who is there.
    pub(crate) fn unchecked(transport: T, options: Options) -> Self {
        Self {
            wire: Wire::new(transport),
            session: options.session,
            number: options.first_number.wrapping_sub(1),
            token: 0,
            handshake: Handshake {
                comms: Identity::default(),
                drive: None,
            },
            lease: Lease::None,
            renewed_at: Duration::ZERO,
            watch: Watch::default(),
            telemetry: Telemetry::default(),
            events: VecDeque::new(),
            asking: None,
            loss: None,
            round_trips: RoundTrips::default(),
            counts: Counts::default(),
        }
    }

    /// The same, if that handshake is one of a device that it can talk to.
    pub(crate) fn checked(mut self, handshake: Handshake) -> Result<Self, Error> {
        self.accept(handshake)?;
        // From here on, changes can be told.
        self.status()?;
        Ok(self)
    }

    pub(crate) fn accept(&mut self, handshake: Handshake) -> Result<(), Error> {
        match handshake.mismatch() {
            Some(mismatch) if handshake.comms_differs() => Err(mismatch.into()),
            _ => {
                self.handshake = handshake;
                Ok(())
            }
        }
    }

    /// Who is there.
    pub fn handshake(&self) -> &Handshake {
        &self.handshake
    }

    /// The number by which the device knows this client.
    pub fn session(&self) -> Session {
        self.session
    }

    /// The transport's name.
    pub fn port(&self) -> String {
        self.wire.name()
    }

    /// The transport's time.
    pub fn now(&self) -> Duration {
        self.wire.now()
    }

    /// Whether this client has armed the device and, as far as is known, it
    /// still is.
    pub fn is_armed(&self) -> bool {
        self.lease == Lease::Held
    }

    /// Whether the line is open.
    pub fn is_connected(&self) -> bool {
        self.loss.is_none()
    }

    /// The books of the last subscription.
    pub fn accounting(&self) -> Option<&Accounting> {
        self.telemetry.books.as_ref()
    }

    /// How long answers take.
    pub fn round_trips(&self) -> &RoundTrips {
        &self.round_trips
    }

    /// What was counted.
    pub fn tally(&self) -> Tally {
        let (frames, discarded_frames, foreign_frames) = self.wire.counts();
        let Counts {
            strays,
            repeats,
            renewals,
            stalls,
            unasked_blocks,
            unread_blocks,
        } = self.counts;
        Tally {
            frames,
            discarded_frames,
            foreign_frames,
            stray_answers: strays,
            repeats,
            renewals,
            stalls,
            unasked_blocks,
            unread_blocks,
        }
    }

    /// The transport, for what only it can do.
    pub fn transport_mut(&mut self) -> &mut T {
        self.wire.transport_mut()
    }

    /// Gives the transport back, and nothing else: an armed device faults as
    /// its lease ends. See [`Self::close`].
    pub fn into_transport(self) -> T {
        self.wire.into_transport()
    }

    /// Ends what this client has begun: disarms, unsubscribes.
    ///
    /// # Errors
    /// As the requests'.
    pub fn close(mut self) -> Result<T, Error> {
        if self.is_armed() {
            self.disarm()?;
        }
        if self.telemetry.is_subscribed {
            self.unsubscribe()?;
        }
        Ok(self.into_transport())
    }
}
