//! A host that speaks with a virtual device, byte by byte, and accounts for its samples.

#![allow(dead_code, reason = "each test uses its part")]

mod operations;
pub(crate) mod oracle;
pub(crate) mod random_values;

use crepitus_protocol::frame;
use crepitus_protocol::host::{Answer, Operation, Refusal, Reply, Request};
use crepitus_protocol::management::{self, Action, ManagementRequest};
use crepitus_protocol::parameters;
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block, Sample};
use crepitus_protocol::{Decoder, Lane, Nonce, Session, Values};
use crepitus_scene::{Overrides, Scene};
use crepitus_virtual_device::{Start, VirtualDevice};
use oracle::Oracle;
use std::cell::Cell;
use std::collections::HashMap;
use std::path::Path;

/// Ticks after which a request is repeated: 50 ms.
const PATIENCE_TICKS: u64 = 1_000;

/// A scene by its text.
pub(crate) fn scene(text: &str) -> Scene {
    changed(text, &[])
}

/// A scene by its text, with other numbers.
fn changed(text: &str, numbers: &[(&str, f64)]) -> Scene {
    let overrides = Overrides {
        set: numbers
            .iter()
            .map(|(path, value)| ((*path).to_owned(), value.to_string()))
            .collect(),
        ..Overrides::default()
    };
    Scene::parse(Path::new("test.toml"), text, &overrides).expect("a scene")
}

/// The paper's joint on a motor whose shaft a hand moves to and fro.
const EXAMINATION: &str = r#"
version = 1
title = "Passive examination"
duration_s = 60.0
[motion]
kind = "strokes"
from_deg = 10.0
to_deg = 80.0
peak_speed_deg_s = 60.0
pause_s = 0.2
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.crepitus]
preset = "coarse"
[effects.encoder]
[effects.motor]
[effects.drivetrain]
[effects.cuff]
[effects.limb]
[effects.hand]
"#;

pub(crate) fn examination() -> Scene {
    scene(EXAMINATION)
}

/// The examination at another speed, with another pause between two strokes.
pub(crate) fn examination_at(peak_speed_deg_s: f64, pause_s: f64) -> Scene {
    changed(
        EXAMINATION,
        &[
            ("motion.peak_speed_deg_s", peak_speed_deg_s),
            ("motion.pause_s", pause_s),
        ],
    )
}

/// The examination with a vibration actuator at the ankle.
pub(crate) fn with_actuator() -> Scene {
    scene(&[EXAMINATION, "[effects.shell]\n[effects.reaction-mass]\n"].concat())
}

/// The accounting of a subscription.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Accounting {
    pub(crate) first_tick: u64,
    pub(crate) received: u64,
    /// Samples that were not sent, as of the last block.
    pub(crate) dropped: u32,
    /// Samples that were not sent before the subscription, which are not of its accounting.
    pub(crate) dropped_before: u32,
    pub(crate) end_tick: u64,
    /// The number of the drive's start: with another one, accounting begins again.
    pub(crate) start: Option<u8>,
}

/// Messages that arrive, in their order.
#[derive(Clone, Debug)]
pub(crate) enum Heard {
    Reply(Box<Reply>),
    Block(Box<Block>),
}

pub(crate) struct Host {
    pub(crate) device: VirtualDevice,
    pub(crate) session: Session,
    pub(crate) number: u32,
    /// Bytes that were sent, if they are wanted, write by write.
    pub(crate) sent: Option<Vec<Vec<u8>>>,
    /// Nonces of the sessions that are open.
    nonces: HashMap<Session, Nonce>,
    decoder: Decoder,
    replies: Vec<Reply>,
    answers: Vec<management::Answer>,
    pub(crate) accounting: Option<Accounting>,
    /// Every sample, if they are wanted.
    pub(crate) samples: Option<Vec<Sample>>,
    pub(crate) last_block: Option<Block>,
    /// Replies and blocks in their order, if they are wanted.
    pub(crate) stream: Option<Vec<Heard>>,
    /// Ticks between two renewals; none without a lease.
    pub(crate) renew_every: Option<u64>,
    /// Frames that were invalid.
    pub(crate) discarded: u32,
    /// Looks at every tick and every block.
    pub(crate) oracle: Option<Oracle>,
    /// A number to compare with that of the tick before.
    pub(crate) watched: Cell<u32>,
}

impl Host {
    pub(crate) fn new(scene: &Scene, start: &Start) -> Self {
        let device = VirtualDevice::of(scene, start).expect("a device");
        Self {
            device,
            session: Session(0x1234),
            number: 0,
            sent: None,
            nonces: HashMap::new(),
            decoder: Decoder::new(),
            replies: Vec::new(),
            answers: Vec::new(),
            accounting: None,
            samples: None,
            last_block: None,
            stream: None,
            renew_every: None,
            discarded: 0,
            oracle: None,
            watched: Cell::default(),
        }
    }

    /// Runs everything for this number of ticks.
    pub(crate) fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    pub(crate) fn tick(&mut self) {
        if let Some(every) = self.renew_every
            && self.device.board().now().is_multiple_of(every)
        {
            self.number += 1;
            let renewal = self.request_of(self.session, self.number, Operation::Renew);
            self.say(&renewal);
        }
        self.device.tick();
        if let Some(oracle) = &mut self.oracle {
            oracle.look(self.device.board());
        }
        let Some(host) = self.device.host() else {
            return;
        };
        for byte in host.read_all() {
            match self.decoder.push(byte) {
                None => {}
                Some(Err(_)) => self.discarded += 1,
                Some(Ok(body)) => match body.lane() {
                    Some(Lane::Reply) => {
                        let reply: Reply = body.message().expect("a reply");
                        if let Some(stream) = &mut self.stream {
                            stream.push(Heard::Reply(Box::new(reply)));
                        }
                        self.replies.push(reply);
                    }
                    Some(Lane::ManagementAnswer) => {
                        let answer = management::Answer::of(body.payload);
                        self.answers.push(answer.expect("an answer"));
                    }
                    Some(Lane::Telemetry) => {
                        let block: Block = body.message().expect("a block");
                        if let Some(accounting) = &mut self.accounting {
                            accounting.block(&block);
                        }
                        if let Some(stream) = &mut self.stream {
                            stream.push(Heard::Block(Box::new(block)));
                        }
                        if let Some(samples) = &mut self.samples {
                            samples.extend(block.samples);
                        }
                        if let Some(oracle) = &mut self.oracle {
                            oracle.block(&block);
                        }
                        self.last_block = Some(block);
                    }
                    _ => {}
                },
            }
        }
    }

    pub(crate) fn say(&mut self, request: &Request) {
        let frame = frame::encode(Lane::Request, request).expect("a frame");
        self.send(&frame);
    }

    pub(crate) fn send(&mut self, bytes: &[u8]) {
        if let Some(sent) = &mut self.sent {
            sent.push(bytes.to_vec());
        }
        if let Some(host) = self.device.host() {
            host.queue(bytes);
        }
    }

    /// A request of a session, with its nonce.
    pub(crate) fn request_of(
        &self,
        session: Session,
        number: u32,
        operation: Operation,
    ) -> Request {
        Request {
            session,
            nonce: self.nonces.get(&session).copied().unwrap_or_default(),
            number,
            operation,
        }
    }

    /// The next request of this host, whose session it opens where needed.
    pub(crate) fn request(&mut self, operation: Operation) -> Request {
        if !self.nonces.contains_key(&self.session) {
            self.open();
        }
        self.number += 1;
        self.request_of(self.session, self.number, operation)
    }

    /// Asks until there is an answer, at most so many times. Opens the session
    /// first where that is needed.
    pub(crate) fn try_ask(
        &mut self,
        operation: Operation,
        times: u32,
    ) -> Option<Result<Answer, Refusal>> {
        if !self.nonces.contains_key(&self.session) {
            self.number += 1;
            self.try_open(self.session, self.number, times)?;
        }
        let request = self.request(operation);
        let answer = (0..times).find_map(|_| {
            self.say(&request);
            self.answer_to(&request)
        });
        if answer == Some(Err(Refusal::NotOpen)) {
            self.nonces.remove(&self.session);
            return self.try_ask(operation, times);
        }
        answer
    }

    /// Opens this host's session.
    pub(crate) fn open(&mut self) {
        self.number += 1;
        self.try_open(self.session, self.number, 40)
            .expect("an open session");
    }

    fn try_open(&mut self, session: Session, number: u32, times: u32) -> Option<()> {
        let request = self.request_of(session, number, Operation::Open);
        (0..times).find_map(|_| {
            self.say(&request);
            let answer = self.answer_to(&request)?;
            let Ok(Answer::Opened { nonce }) = answer else {
                panic!("not opened: {answer:?}");
            };
            self.nonces.insert(session, nonce);
            Some(())
        })
    }

    /// Asks as another host at the same port.
    pub(crate) fn ask_as(
        &mut self,
        session: Session,
        number: u32,
        operation: Operation,
    ) -> Option<Result<Answer, Refusal>> {
        if !self.nonces.contains_key(&session) {
            self.try_open(session, number - 1, 40);
        }
        let request = self.request_of(session, number, operation);
        self.say(&request);
        self.answer_to(&request)
    }

    /// A question of the lane that never changes, and its answer.
    pub(crate) fn manage(&mut self, action: Action, token: u8) -> Option<management::Answer> {
        let question = ManagementRequest { action, token };
        let frame = frame::encode_bytes(Lane::Management, &question.bytes()).expect("a frame");
        self.send(&frame);
        self.managed(token)
    }

    /// Waits for the answer with this token.
    pub(crate) fn managed(&mut self, token: u8) -> Option<management::Answer> {
        (0..PATIENCE_TICKS).find_map(|_| {
            self.tick();
            self.answers.drain(..).find(|a| a.token() == token)
        })
    }

    /// Replies that came and were not asked for.
    pub(crate) fn take_replies(&mut self) -> Vec<Reply> {
        std::mem::take(&mut self.replies)
    }

    /// Waits for the answer to a request.
    pub(crate) fn answer_to(&mut self, request: &Request) -> Option<Result<Answer, Refusal>> {
        for _ in 0..PATIENCE_TICKS {
            let found = self
                .replies
                .drain(..)
                .find(|r| r.session == request.session && r.number == request.number);
            if let Some(reply) = found {
                return Some(reply.answer);
            }
            self.tick();
        }
        None
    }

    pub(crate) fn ask(&mut self, operation: Operation) -> Result<Answer, Refusal> {
        self.try_ask(operation, 40)
            .expect("an answer within two seconds")
    }
}

/// Sets the value of this name.
pub(crate) fn set(values: &mut Values, name: &str, value: f64) {
    let (id, _) = parameters::find(name).expect("a parameter");
    values.set(id, value);
}

impl Accounting {
    fn block(&mut self, block: &Block) {
        let start = block.flags.start();
        if self.start.is_some_and(|known| known != start) {
            *self = Self {
                first_tick: block.first_tick,
                end_tick: block.first_tick,
                ..Self::default()
            };
        }
        self.start = Some(start);
        if block.first_tick < self.first_tick {
            return;
        }
        assert!(block.first_tick >= self.end_tick, "a block came twice");
        let due = block.first_tick - self.first_tick;
        let dropped = block.dropped.wrapping_sub(self.dropped_before);
        assert_eq!(
            due,
            self.received + u64::from(dropped),
            "the law of the accounting"
        );
        self.received += BLOCK_SAMPLES as u64;
        self.dropped = dropped;
        self.end_tick = block.end_tick();
    }
}
