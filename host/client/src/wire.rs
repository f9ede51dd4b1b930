//! Messages over a transport.

use crate::transport::{Transport, TransportError};
use crepitus_protocol::frame::{self, DELIMITER};
use crepitus_protocol::host::{Reply, Request};
use crepitus_protocol::management::{Answer, ManagementRequest};
use crepitus_protocol::task_times::DeviceTimes;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Decoder, Lane};
use std::time::Duration;

/// A received message.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Incoming {
    Block(Box<Block>),
    Reply(Box<Reply>),
    Answer(Answer),
    Times(Box<DeviceTimes>),
}

/// Sends and receives messages over a transport.
#[derive(Debug)]
pub(crate) struct Wire<T> {
    transport: T,
    inbox: Inbox,
}

/// Bytes that were received, and what they say. Of no transport: messages are decoded in one
/// place, compiled in this crate.
#[derive(Debug)]
struct Inbox {
    decoder: Decoder,
    bytes: Vec<u8>,
    /// Read position, and its end.
    at: usize,
    end: usize,
    frames: u64,
    foreign: u64,
}

impl<T: Transport> Wire<T> {
    pub(crate) fn new(transport: T) -> Self {
        Self {
            transport,
            inbox: Inbox {
                decoder: Decoder::new(),
                bytes: vec![0; 4_096],
                at: 0,
                end: 0,
                frames: 0,
                foreign: 0,
            },
        }
    }

    pub(crate) fn now(&self) -> Duration {
        self.transport.now()
    }

    pub(crate) fn name(&self) -> String {
        self.transport.name()
    }

    pub(crate) fn wait(&mut self, time: Duration) {
        self.transport.wait(time);
    }

    pub(crate) fn transport_mut(&mut self) -> &mut T {
        &mut self.transport
    }

    pub(crate) fn into_transport(self) -> T {
        self.transport
    }

    /// Counters: valid frames; discarded frames; frames of an unknown lane or
    /// with another schema tag.
    pub(crate) fn counts(&self) -> (u64, u64, u64) {
        let discarded = u64::from(self.inbox.decoder.discarded().total());
        (self.inbox.frames, discarded, self.inbox.foreign)
    }

    /// Reopens the connection and clears partial frames.
    pub(crate) fn reopen(&mut self) -> Result<(), TransportError> {
        self.inbox.hold(0);
        self.inbox.decoder.reset();
        self.transport.reopen()
    }

    /// Sends a delimiter, to end a partial frame at the device.
    pub(crate) fn delimit(&mut self) -> Result<(), TransportError> {
        self.transport.send(&[DELIMITER])
    }

    pub(crate) fn request(&mut self, request: &Request) -> Result<(), TransportError> {
        match encoded(request) {
            Ok(frame) => self.transport.send(&frame),
            // Cannot fail: the protocol checks at compile time that every message fits.
            Err(frame::TooLong) => Ok(()),
        }
    }

    pub(crate) fn management(
        &mut self,
        management: ManagementRequest,
    ) -> Result<(), TransportError> {
        match frame::encode_bytes(Lane::Management, &management.bytes()) {
            Ok(frame) => self.transport.send(&frame),
            Err(frame::TooLong) => Ok(()),
        }
    }

    /// Returns the next message until the deadline; a pending one even after it.
    pub(crate) fn next(&mut self, until: Duration) -> Result<Option<Incoming>, TransportError> {
        let mut is_first = true;
        loop {
            if let Some(heard) = self.inbox.next() {
                return Ok(Some(heard));
            }
            let patience = until.saturating_sub(self.now());
            if patience.is_zero() && !is_first {
                return Ok(None);
            }
            is_first = false;
            let count = self.transport.receive(&mut self.inbox.bytes, patience)?;
            if count == 0 {
                return Ok(None);
            }
            self.inbox.hold(count);
        }
    }
}

fn encoded(request: &Request) -> Result<frame::Frame, frame::TooLong> {
    frame::encode(Lane::Request, request)
}

impl Inbox {
    /// Holds `count` bytes from now on, none of them read.
    fn hold(&mut self, count: usize) {
        (self.at, self.end) = (0, count.min(self.bytes.len()));
    }

    /// The next message in it.
    fn next(&mut self) -> Option<Incoming> {
        while let Some(byte) = self.bytes.get(self.at..self.end)?.first() {
            self.at += 1;
            let Some(Ok(body)) = self.decoder.push(*byte) else {
                continue;
            };
            self.frames += 1;
            let heard = match body.lane() {
                Some(Lane::Telemetry) => {
                    body.message().map(|block| Incoming::Block(Box::new(block)))
                }
                Some(Lane::Reply) => body.message().map(|reply| Incoming::Reply(Box::new(reply))),
                Some(Lane::Times) => body.message().map(|times| Incoming::Times(Box::new(times))),
                Some(Lane::ManagementAnswer) => Answer::of(body.payload).map(Incoming::Answer),
                _ => None,
            };
            if heard.is_some() {
                return heard;
            }
            self.foreign += 1;
        }
        None
    }
}
