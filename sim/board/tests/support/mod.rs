//! A host that speaks with a virtual device, byte by byte, and keeps books.

#![allow(dead_code, reason = "each test uses its part")]

use crepitus_board::{Start, VirtualDevice};
use crepitus_protocol::frame;
use crepitus_protocol::host::{Answer, Ask, Refusal, Reply, Request, Status};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block, Sample};
use crepitus_protocol::{Decoder, Lane, Revision, Session, Values};
use crepitus_scene::{Overrides, Scene};
use std::path::Path;

/// Ticks after which a request is repeated: 50 ms.
const PATIENCE_TICKS: u64 = 1_000;

/// A scene by its text.
pub(crate) fn scene(text: &str) -> Scene {
    Scene::parse(Path::new("test.toml"), text, &Overrides::default()).expect("a scene")
}

/// The paper's joint on a motor whose shaft a hand moves to and fro.
pub(crate) fn examination() -> Scene {
    scene(
        r#"
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
"#,
    )
}

/// The books of a subscription.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Books {
    pub(crate) first_tick: u64,
    pub(crate) received: u64,
    /// What the last block said.
    pub(crate) dropped: u32,
    pub(crate) end_tick: u64,
}

pub(crate) struct Host {
    pub(crate) device: VirtualDevice,
    pub(crate) session: Session,
    pub(crate) number: u16,
    decoder: Decoder,
    replies: Vec<Reply>,
    pub(crate) books: Option<Books>,
    /// Every sample, if they are wanted.
    pub(crate) samples: Option<Vec<Sample>>,
    pub(crate) last_block: Option<Block>,
    /// Ticks between two renewals; none without a lease.
    pub(crate) renew_every: Option<u64>,
    /// Called after every tick.
    pub(crate) discarded: u32,
}

impl Host {
    pub(crate) fn new(scene: &Scene, start: &Start) -> Self {
        let device = VirtualDevice::of(scene, start).expect("a device");
        Self {
            device,
            session: Session(0x1234),
            number: 0,
            decoder: Decoder::new(),
            replies: Vec::new(),
            books: None,
            samples: None,
            last_block: None,
            renew_every: None,
            discarded: 0,
        }
    }

    /// So many ticks of everything.
    pub(crate) fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    pub(crate) fn tick(&mut self) {
        if let Some(every) = self.renew_every
            && self.device.board().now().is_multiple_of(every)
        {
            self.say(&Request {
                session: self.session,
                number: 0,
                ask: Ask::Renew,
            });
        }
        self.device.tick();
        let Some(host) = self.device.host() else {
            return;
        };
        for byte in host.read_all() {
            match self.decoder.push(byte) {
                None => {}
                Some(Err(_)) => self.discarded += 1,
                Some(Ok(body)) => match body.lane() {
                    Some(Lane::Reply) => self.replies.push(body.message().expect("a reply")),
                    Some(Lane::Telemetry) => {
                        let block: Block = body.message().expect("a block");
                        if let Some(books) = &mut self.books {
                            books.book(&block);
                        }
                        if let Some(samples) = &mut self.samples {
                            samples.extend(block.samples);
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
        if let Some(host) = self.device.host() {
            host.queue(bytes);
        }
    }

    /// Asks until there is an answer, at most so many times.
    pub(crate) fn try_ask(&mut self, ask: Ask, times: u32) -> Option<Result<Answer, Refusal>> {
        self.number = self.number.wrapping_add(1);
        let request = Request {
            session: self.session,
            number: self.number,
            ask,
        };
        for _ in 0..times {
            self.say(&request);
            for _ in 0..PATIENCE_TICKS {
                self.tick();
                let found = self
                    .replies
                    .drain(..)
                    .find(|r| r.session == request.session && r.number == request.number);
                if let Some(reply) = found {
                    return Some(reply.answer);
                }
            }
        }
        None
    }

    pub(crate) fn ask(&mut self, ask: Ask) -> Result<Answer, Refusal> {
        self.try_ask(ask, 40).expect("an answer within two seconds")
    }

    pub(crate) fn status(&mut self) -> Status {
        match self.ask(Ask::Status) {
            Ok(Answer::Status(status)) => status,
            other => panic!("no status but {other:?}"),
        }
    }

    pub(crate) fn parameters(&mut self) -> (Revision, Values) {
        match self.ask(Ask::Parameters) {
            Ok(Answer::Parameters { revision, values }) => (revision, values),
            other => panic!("no parameters but {other:?}"),
        }
    }

    pub(crate) fn commit(&mut self, change: impl FnOnce(&mut Values)) -> Result<Revision, Refusal> {
        let (base, mut values) = self.parameters();
        change(&mut values);
        self.ask(Ask::Commit { base, values })
            .map(|answer| match answer {
                Answer::Committed { revision } => revision,
                other => panic!("no commit but {other:?}"),
            })
    }

    pub(crate) fn subscribe(&mut self) {
        // Blocks that were on their way belong to nobody's books.
        self.books = None;
        match self.ask(Ask::Subscribe) {
            Ok(Answer::Subscribed { first_tick }) => {
                self.books = Some(Books {
                    first_tick,
                    end_tick: first_tick,
                    ..Books::default()
                });
            }
            other => panic!("no subscription but {other:?}"),
        }
    }

    /// Waits until the drive has its parameters, then arms and keeps the lease.
    pub(crate) fn arm(&mut self) {
        self.renew_every = Some(1_000);
        let armed = (0..20).any(|_| {
            let answer = self.ask(Ask::Arm);
            if answer != Ok(Answer::Done) {
                assert_eq!(answer, Err(Refusal::Busy), "arming");
                self.run(200);
            }
            answer.is_ok()
        });
        assert!(armed);
    }
}

impl Books {
    fn book(&mut self, block: &Block) {
        if block.first_tick < self.first_tick {
            return;
        }
        assert!(block.first_tick >= self.end_tick, "a block came twice");
        let due = block.first_tick - self.first_tick;
        assert_eq!(
            due,
            self.received + u64::from(block.dropped),
            "the law of the books"
        );
        self.received += BLOCK_SAMPLES as u64;
        self.dropped = block.dropped;
        self.end_tick = block.end_tick();
    }
}
