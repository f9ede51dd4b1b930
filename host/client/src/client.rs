//! Client of a device with the same schema hash.
//!
//! | part | look in |
//! |---|---|
//! | request and reply, retries, the lease | `exchange.rs` |
//! | requests | `requests.rs` |
//! | events | `pump.rs` |
//! | reconnecting | `reconnect.rs` |

use crate::accounting::Accounting;
use crate::errors::Error;
use crate::event::Event;
use crate::handshake::Handshake;
use crate::loss::Loss;
use crate::request_kind::RequestKind;
use crate::round_trips::RoundTrips;
use crate::session::Options;
use crate::transport::Transport;
use crate::wire::Wire;
use crepitus_protocol::host::Status;
use crepitus_protocol::management::Identity;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Nonce, Session, State};
use std::collections::VecDeque;
use std::time::Duration;

/// Client of a device. It works only during calls: call [`Self::pump`]
/// regularly, every 50 ms or more often while the device is armed.
#[derive(Debug)]
pub struct Client<T> {
    pub(crate) wire: Wire<T>,
    pub(crate) session: Session,
    /// Drawn by the device when the session was opened.
    pub(crate) nonce: Nonce,
    /// Sequence number of the last request, and token of the last management
    /// request.
    pub(crate) number: u32,
    pub(crate) token: u8,
    handshake: Handshake,
    pub(crate) lease: Lease,
    pub(crate) renewed_at: Duration,
    pub(crate) watch: Watch,
    pub(crate) telemetry: Telemetry,
    pub(crate) events: VecDeque<Event>,
    pub(crate) pace: Pace,
    /// The request that waits for its reply.
    pub(crate) pending_request: Option<RequestKind>,
    /// The error that ended the connection.
    pub(crate) loss: Option<Loss>,
    pub(crate) round_trips: RoundTrips,
    /// Without the frames, which the wire counts.
    pub(crate) tally: Tally,
}

/// Whether this client renews the lease.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Lease {
    #[default]
    None,
    /// Arming was requested.
    Taking,
    /// The device is armed, as of the last status.
    Held,
}

/// Polls the status from within a pump, without waiting.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Watch {
    /// Sequence number of the pending request.
    pub(crate) asked: Option<u32>,
    pub(crate) asked_at: Duration,
    /// Requests in a row without a reply.
    pub(crate) unanswered: u8,
    /// Time of an additional request.
    pub(crate) due_at: Option<Duration>,
    pub(crate) known: Option<Status>,
}

/// Receives, while events wait for the program, for as long as the program takes for events. On a computer
/// that is slow at receiving, a pump would otherwise do little else.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pace {
    /// Time at which the last pump returned.
    pub(crate) pumped_at: Duration,
    /// Excess of the time spent receiving over the time that the program took.
    pub(crate) ahead: Duration,
}

/// The subscription.
#[derive(Clone, Debug, Default)]
pub(crate) struct Telemetry {
    pub(crate) is_subscribed: bool,
    pub(crate) accounting: Option<Accounting>,
    /// Blocks received before the first tick of the subscription is known.
    pub(crate) early: Option<Vec<Block>>,
    pub(crate) state: Option<State>,
    pub(crate) heard_at: Duration,
    /// The silence was reported.
    pub(crate) is_silent: bool,
}

/// Samples that are always under way, at most: 100 ms of them.
const UNDER_WAY: u64 = 2_000;

/// Duration of [`UNDER_WAY`] samples.
const SHORT_SILENCE: Duration = Duration::from_millis(100);

/// Telemetry that had stopped while the device went on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unheard {
    /// Time for which nothing has come.
    pub silence: Duration,
    /// Number of samples produced since the last one that came; none if the device does not answer.
    pub samples: Option<u64>,
}

/// Counters of a client.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Valid frames.
    pub frames: u64,
    /// Frames that were too long, malformed, or had a wrong checksum.
    pub discarded_frames: u64,
    /// Frames of an unknown lane or with another schema tag.
    pub foreign_frames: u64,
    /// Unexpected replies: late, repeated, or another host's.
    pub stray_answers: u64,
    /// Retries after a timeout.
    pub repeats: u64,
    /// Lease renewals sent.
    pub renewals: u64,
    /// Frames that were not sent because the port stalled.
    pub stalls: u64,
    /// Blocks without a subscription, from an earlier program.
    pub unasked_blocks: u64,
    /// Blocks dropped because the event queue was full; the accounting shows
    /// them as lost on the connection.
    pub unread_blocks: u64,
}

impl<T: Transport> Client<T> {
    /// Handshake with a device on an open transport.
    ///
    /// # Errors
    /// [`Error::Mismatch`] if comms has another schema hash: use
    /// [`Management`](crate::Management) for such a device. [`Error::NoAnswer`],
    /// [`Error::Transport`].
    pub fn connect(transport: T) -> Result<Self, Error> {
        Self::connect_with(transport, Options::default())
    }

    /// [`Self::connect`] with a given session.
    ///
    /// # Errors
    /// As [`Self::connect`].
    pub fn connect_with(transport: T, options: Options) -> Result<Self, Error> {
        let mut client = Self::unchecked(transport, options);
        let handshake = client.identify()?;
        client.checked(handshake)
    }

    /// A client before the handshake.
    pub(crate) fn unchecked(transport: T, options: Options) -> Self {
        Self {
            wire: Wire::new(transport),
            session: options.session,
            nonce: Nonce::NONE,
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
            pace: Pace::default(),
            pending_request: None,
            loss: None,
            round_trips: RoundTrips::default(),
            tally: Tally::default(),
        }
    }

    /// Completes the handshake if the schema hashes match.
    pub(crate) fn checked(mut self, handshake: Handshake) -> Result<Self, Error> {
        self.accept(handshake)?;
        self.open()?;
        // Changes are reported relative to this status.
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

    /// The handshake.
    pub fn handshake(&self) -> &Handshake {
        &self.handshake
    }

    /// Session of this client.
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

    /// Returns whether this client has armed the device and, as of the last status, it
    /// still is.
    pub fn is_armed(&self) -> bool {
        self.lease == Lease::Held
    }

    /// Ends the subscription, if there is one, before the client is given up. Where that fails the
    /// device has gone, and sends nobody anything.
    pub fn end_telemetry(&mut self) {
        if self.telemetry.is_subscribed && self.is_connected() {
            let _gone = self.unsubscribe();
        }
    }

    /// Telemetry that the device has produced and nobody has heard, if that is more than what is always
    /// under way. A program that passes everything on may hang while the device goes on.
    pub fn unheard(&mut self) -> Option<Unheard> {
        self.accounting()?;
        if !self.telemetry.is_subscribed {
            return None;
        }
        let status = if self.is_connected() {
            self.status().ok()
        } else {
            None
        };
        // With what came before the answer, or instead of it. A slow link lags, and loses much, but is
        // not silent.
        let silence = self.now().saturating_sub(self.telemetry.heard_at);
        if self.is_connected() && silence < SHORT_SILENCE {
            return None;
        }
        let next_tick = self.accounting()?.next_tick();
        let samples = status.map(|status| status.tick.saturating_sub(next_tick));
        (samples.is_none_or(|samples| samples > UNDER_WAY)).then_some(Unheard { silence, samples })
    }

    /// Returns whether the connection is open.
    pub fn is_connected(&self) -> bool {
        self.loss.is_none()
    }

    /// Accounting of the last subscription.
    pub fn accounting(&self) -> Option<&Accounting> {
        self.telemetry.accounting.as_ref()
    }

    /// Round-trip times.
    pub fn round_trips(&self) -> &RoundTrips {
        &self.round_trips
    }

    /// The counters of this client.
    pub fn tally(&self) -> Tally {
        let (frames, discarded_frames, foreign_frames) = self.wire.counts();
        Tally {
            frames,
            discarded_frames,
            foreign_frames,
            ..self.tally
        }
    }

    /// The transport.
    pub fn transport_mut(&mut self) -> &mut T {
        self.wire.transport_mut()
    }

    /// Returns the transport and does nothing else: an armed device faults when
    /// its lease expires. See [`Self::close`].
    pub fn into_transport(self) -> T {
        self.wire.into_transport()
    }

    /// Disarms and unsubscribes.
    ///
    /// # Errors
    /// As for the requests.
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
