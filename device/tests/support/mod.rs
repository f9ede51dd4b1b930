//! Shared by the tests of the device: both controllers, the wires between them
//! and an ideal motor.

#![allow(dead_code, reason = "each test program uses its part")]

mod motor;

use crepitus_device::comms::{self, Comms};
use crepitus_device::drive::exchange::Rendered;
use crepitus_device::drive::motor::Bridge;
use crepitus_device::drive::slow_checks::SlowInput;
use crepitus_device::drive::{self, Drive};
use crepitus_device::usb_port::HostBytes;
use crepitus_protocol::frame::FRAME_BYTES;
use crepitus_protocol::host::{Answer, Operation, Refusal, Reply, Request};
use crepitus_protocol::management::{Identity, Role};
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Decoder, Lane, Nonce, Session, TICK_US, frame, schema};
use motor::Motor;
use std::collections::VecDeque;

/// Ticks of the drive in a millisecond.
pub(crate) const TICKS_PER_MS: u32 = 20;

/// Bytes that the link carries in a tick: 4.2 Mbaud, ten bits a byte.
const LINK_BYTES: usize = 21;

/// Identity of a controller.
pub(crate) fn identity(role: Role) -> Identity {
    Identity {
        role,
        schema: schema::HASH,
        ..Identity::default()
    }
}

/// Boot-time inputs of both.
#[derive(Clone, Copy, Default)]
pub(crate) struct Boots {
    pub(crate) drive: drive::Boot,
    pub(crate) comms: comms::Boot,
}

impl Boots {
    pub(crate) fn new() -> Self {
        let mut boots = Self::default();
        boots.drive.identity = identity(Role::Drive);
        boots.comms.identity = identity(Role::Comms);
        boots
    }
}

/// A device on a bench, and the bytes that a host has received.
pub(crate) struct Bench {
    pub(crate) drive: Drive,
    pub(crate) comms: Comms,
    pub(crate) motor: Motor,
    to_drive: VecDeque<u8>,
    to_comms: VecDeque<u8>,
    enable: [bool; 2],
    from_comms: Decoder,
    pub(crate) session: Session,
    pub(crate) number: u32,
    nonce: Nonce,
    replies: Vec<Reply>,
    pub(crate) blocks: Vec<Block>,
    /// The request of comms for the drive's version is lost.
    pub(crate) loses_hello: bool,
    /// Prescribed encoder counts and velocities of the next ticks.
    pub(crate) script: VecDeque<(i32, f64)>,
    /// Outputs of `render_torque` for those ticks.
    pub(crate) rendered: Vec<Rendered>,
    ms: u32,
}

impl Bench {
    pub(crate) fn new(boots: &Boots) -> Self {
        Self {
            drive: Drive::new(&boots.drive).unwrap(),
            comms: Comms::new(&boots.comms),
            motor: Motor::at(boots.drive.counter),
            to_drive: VecDeque::new(),
            to_comms: VecDeque::new(),
            enable: [false; 2],
            from_comms: Decoder::new(),
            session: Session(0x1234),
            number: 0,
            nonce: Nonce::NONE,
            replies: Vec::new(),
            blocks: Vec::new(),
            loses_hello: false,
            script: VecDeque::new(),
            rendered: Vec::new(),
            ms: 0,
        }
    }

    /// One millisecond; the host reads afterwards.
    pub(crate) fn millisecond(&mut self) {
        self.device_millisecond();
        let mut bytes = Vec::new();
        while !self.comms.to_send().is_empty() {
            let run = self.comms.to_send().to_vec();
            self.comms.sent(run.len());
            bytes.extend(run);
        }
        self.host_reads(&bytes);
    }

    /// One millisecond in which the host does not read.
    pub(crate) fn device_millisecond(&mut self) {
        self.ms += 1;
        for _ in 0..TICKS_PER_MS {
            self.tick();
        }
        let inputs = comms::Inputs {
            enable_is_on: self.enable[1],
        };
        let outputs = self.comms.tick(&inputs);
        self.enable[1] = outputs.enable;
        if outputs.save.is_some() {
            self.comms.saved(true);
        }
    }

    fn tick(&mut self) {
        let next = self.script.pop_front();
        self.motor.turned = next.or(self.motor.turned);
        self.drive.sample_encoder(self.motor.counter());
        self.drive.render_torque();
        if next.is_some() {
            self.rendered.extend(self.drive.rendered());
        }
        let outputs = self.drive.command_motor(&drive::command::Inputs {
            current_a: Some(self.motor.current_a()),
            monitor_a: Some(self.motor.current_a()),
            interval_us: TICK_US,
            enable_is_on: self.enable[0],
            comms_enable_is_on: self.enable[1],
            has_tripped: false,
            slow: SlowInput::in_turn(self.drive.next_tick(), 24.0, 25.0, 0.0),
            // No actuator is connected.
            coil_a: Some(0.0),
            coil_has_tripped: false,
        });
        self.enable[0] = outputs.enable;
        let is_powered = self.enable == [true; 2];
        self.motor.tick(if is_powered {
            outputs.bridge
        } else {
            Bridge::Float
        });
        self.drive.prepare();
        let has_place = self.to_comms.len() < FRAME_BYTES;
        self.to_comms
            .extend(self.drive.link_to_send(has_place).into_iter().flatten());
        if self.to_drive.len() < LINK_BYTES
            && let Some(frame) = self.comms.link_to_send()
            && !(self.loses_hello && is_management(&frame))
        {
            self.to_drive.extend(frame);
        }
        for byte in drain(&mut self.to_drive) {
            self.drive.link_received(byte);
        }
        for byte in drain(&mut self.to_comms) {
            self.comms.link_received(byte);
        }
    }

    /// Bytes that the host has received.
    fn host_reads(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let Some(Ok(body)) = self.from_comms.push(*byte) else {
                continue;
            };
            match body.lane() {
                Some(Lane::Reply) => self.replies.push(body.message().unwrap()),
                Some(Lane::Telemetry) => self.blocks.push(body.message().unwrap()),
                _ => {}
            }
        }
    }

    /// Sends comms a request without reply.
    pub(crate) fn tell(&mut self, operation: Operation) {
        let request = Request {
            session: self.session,
            nonce: self.nonce,
            number: self.number,
            operation,
        };
        let frame = frame::encode(Lane::Request, &request).unwrap();
        self.comms.received(&frame);
    }

    /// Sends a request and runs until the reply arrives.
    /// Opens the session first where it is not open.
    pub(crate) fn ask(&mut self, operation: Operation) -> Result<Answer, Refusal> {
        if self.nonce == Nonce::NONE && operation != Operation::Open {
            self.open();
        }
        self.number += 1;
        self.tell(operation);
        for _ in 0..700 {
            self.millisecond();
            let (session, number) = (self.session, self.number);
            let is_ours = |r: &Reply| (r.session, r.number) == (session, number);
            if let Some(place) = self.replies.iter().position(is_ours) {
                return self.replies.remove(place).answer;
            }
        }
        panic!("no answer to {operation:?}");
    }

    /// Opens the session.
    pub(crate) fn open(&mut self) {
        match self.ask(Operation::Open) {
            Ok(Answer::Opened { nonce }) => self.nonce = nonce,
            other => panic!("not opened: {other:?}"),
        }
    }

    /// Runs for this many milliseconds, renewing the lease.
    pub(crate) fn run_leased(&mut self, ms: u32) {
        for n in 0..ms {
            if n % 50 == 0 {
                self.number += 1;
                self.tell(Operation::Renew);
            }
            self.millisecond();
        }
    }

    /// Runs until the drive has applied the parameters of comms.
    pub(crate) fn settle(&mut self) {
        for _ in 0..200 {
            self.millisecond();
            if self.drive.revision() == self.comms.revision() {
                return self.run_leased(20);
            }
        }
        panic!("the drive was given no parameters");
    }
}

fn is_management(frame: &[u8]) -> bool {
    let mut decoder = Decoder::new();
    frame.iter().any(|byte| {
        matches!(decoder.push(*byte), Some(Ok(body)) if body.lane() == Some(Lane::Management))
    })
}

/// Takes from the queue what the link carries in a tick.
fn drain(queue: &mut VecDeque<u8>) -> Vec<u8> {
    queue.drain(..LINK_BYTES.min(queue.len())).collect()
}
