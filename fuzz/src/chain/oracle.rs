//! Actions of the hosts, and the checks after each tick.

use crate::chain::device::{COMMS_TICKS, Readings};
use crate::chain::{Chain, MOST_RESTARTS, NUMBERS, SESSIONS, Sent};
use crate::from_comms::FromComms;
use crepitus_device::usb_port::HostBytes;
use crepitus_protocol::counters::CommsCounter;
use crepitus_protocol::host::{Answer, Operation, Refusal, Reply, Request};
use crepitus_protocol::management::{Action, ManagementRequest, ResetCause};
use crepitus_protocol::{LEASE_TICKS, Lane, Nonce, frame};

impl Chain {
    /// A request of a session, which is opened first if it is not.
    pub(super) fn ask(&mut self, place: usize, operation: Operation) {
        if !self.device.comms_runs() {
            return;
        }
        let session = SESSIONS[place];
        if self.host.nonce(session) == Nonce::NONE && operation != Operation::Open {
            self.ask(place, Operation::Open);
            self.read(usize::MAX);
        }
        self.numbers[place] += 1;
        let request = Request {
            session,
            nonce: self.host.nonce(session),
            number: self.numbers[place],
            operation,
        };
        self.host.requested(&request);
        if operation == Operation::Subscribe {
            self.device.samples.end(session.0);
        }
        let frame = frame::encode(Lane::Request, &request).expect("every message fits");
        let may_be = operation == Operation::Open || self.host.is_open(session);
        let executed = self.receive(&frame);
        assert!(may_be || executed == [0, 0], "{request:?} of before");
        self.requested(&request, executed);
        self.sent.push(Sent {
            request,
            frame,
            comms_start: self.device.comms_start,
        });
    }

    /// Bytes for comms; returns how many requests and renewals were executed.
    fn receive(&mut self, frame: &[u8]) -> [u32; 2] {
        let before = self.executed();
        self.device.comms.received(frame);
        let after = self.executed();
        [after[0] - before[0], after[1] - before[1]]
    }

    fn executed(&self) -> [u32; 2] {
        let counters = self.device.comms.counters();
        [CommsCounter::Requests, CommsCounter::Renewals].map(|counter| counters.get(counter))
    }

    fn requested(&mut self, request: &Request, executed: [u32; 2]) {
        let (session, now) = (request.session, self.device.tick);
        if request.operation == Operation::Renew {
            return self.renewed(request);
        }
        if executed[0] == 0 {
            return;
        }
        match request.operation {
            // Whether or not it is refused.
            Operation::Arm => {
                self.lease.arm(session, request.number, now);
            }
            Operation::Disarm => {
                self.lease.disarm(session);
                self.stopped = now;
            }
            Operation::Commit { values, .. } => {
                self.values.add(&values);
                self.commits.insert((session.0, request.number), values);
            }
            _ => {}
        }
    }

    /// A request of the management lane.
    pub(super) fn manage(&mut self, request: ManagementRequest) {
        if !self.device.comms_runs() {
            return;
        }
        let frame = frame::encode_bytes(Lane::Management, &request.bytes());
        self.receive(&frame.expect("a short frame"));
        if request.action == Action::Stop {
            self.lease.stop();
            self.stopped = self.device.tick;
        }
    }

    /// A frame of before again: nothing of it is executed, but for a session that is
    /// opened again, by a frame of before a restart.
    pub(super) fn replay(&mut self, which: u8) {
        if self.sent.is_empty() || !self.device.comms_runs() {
            return;
        }
        let Sent {
            request,
            ref frame,
            comms_start,
        } = self.sent[usize::from(which) % self.sent.len()];
        let frame = frame.clone();
        let is_old = comms_start != self.device.comms_start;
        self.host.repeated(&request);
        let [requests, renewals] = self.receive(&frame);
        let may_open = is_old && request.operation == Operation::Open;
        assert!(requests == 0 || may_open, "{request:?} of before");
        assert!(renewals == 0, "{request:?} again");
    }

    fn renewed(&mut self, request: &Request) {
        let now = self.device.tick;
        if request.nonce == self.host.nonce(request.session) && self.host.is_open(request.session) {
            self.lease.renew(request.session, now);
        }
    }

    /// The host's plug is pulled and put in again.
    pub(super) fn unplug(&mut self) {
        if self.device.comms_runs() {
            self.device.comms.host_lost();
            self.cut();
        }
    }

    fn cut(&mut self) {
        self.frames.cut();
        self.host.cut();
        self.device.samples.cut();
    }

    pub(super) fn restart_comms(&mut self, cause: ResetCause, ticks: u64) {
        if self.device.comms_start < MOST_RESTARTS {
            self.device.restart_comms(cause, ticks);
            self.comms_restarted();
        }
    }

    fn comms_restarted(&mut self) {
        self.cut();
        self.host.closed();
        self.lease.stop();
        self.commits.clear();
        self.numbers = NUMBERS;
        self.stopped = self.device.tick.saturating_sub(COMMS_TICKS);
    }

    pub(super) fn run(&mut self, milliseconds: u16, readings: Readings) {
        for _ in 0..u64::from(milliseconds) * COMMS_TICKS {
            if self.device.tick < self.most_ticks {
                self.tick(readings);
            }
        }
    }

    pub(super) fn tick(&mut self, readings: Readings) {
        let now = self.device.tick;
        if self.device.tick(readings) {
            self.comms_restarted();
        }
        if now.is_multiple_of(COMMS_TICKS) && self.device.comms_runs() {
            self.read(self.reads);
        }
        self.check_torque(now);
        self.check_values();
    }

    fn check_torque(&mut self, now: u64) {
        if self.device.commands_torque() {
            let renewed = self.lease.last().expect("torque before arming");
            assert!(now - renewed < LEASE_TICKS - 1, "the lease has ended");
        }
        if self.device.is_driven() {
            let may_be = self.lease.is_wanted() && self.lease.is_alive(now);
            assert!(
                may_be || now - self.stopped < COMMS_TICKS,
                "nobody wants it"
            );
        }
    }

    /// Parameters in force were committed or saved.
    fn check_values(&mut self) {
        let revision = self.device.drive.revision();
        if self.revision == Some(revision) {
            return;
        }
        // None: the next ones are prepared already.
        if let Some(values) = self.device.drive.values() {
            assert!(self.values.has(values), "{revision} was never committed");
            self.in_force.insert(revision.0, *values);
            self.revision = Some(revision);
        }
    }

    /// Takes this many bytes of comms.
    pub(super) fn read(&mut self, count: usize) {
        let mut left = count;
        let mut messages = Vec::new();
        while left > 0 && !self.device.comms.to_send().is_empty() {
            let run = self.device.comms.to_send();
            let run = &run[..run.len().min(left)];
            let frames = &mut self.frames;
            frames.split(run, |frame| messages.push(FromComms::of(frame)));
            let count = run.len();
            self.device.comms.sent(count);
            left -= count;
        }
        for message in messages {
            let arrives = self.host_losses == 0;
            self.host_losses = self.host_losses.saturating_sub(1);
            match message {
                FromComms::Block(block) => {
                    self.host.block(&block);
                    self.device.samples.block(&block, arrives);
                }
                FromComms::Reply(reply) => self.replied(&reply, arrives),
                FromComms::Answer => {}
            }
        }
    }

    /// A reply; only the oracle sees one that is lost.
    fn replied(&mut self, reply: &Reply, arrives: bool) {
        let begins = self.host.reply(reply, &self.values);
        if let (true, true, Ok(answer)) = (begins, arrives, &reply.answer) {
            self.device.samples.subscribed(reply.session.0, answer);
        }
        let key = (reply.session.0, reply.number);
        match reply.answer {
            Err(Refusal::NotOpen) => self.host.forget(reply.session),
            // The request may still come into effect.
            Err(Refusal::Unconfirmed) => {}
            Err(Refusal::Leased { .. }) => self.lease.refused(reply.session, reply.number),
            Err(_) => {
                if let Some(values) = self.commits.remove(&key) {
                    self.values.withdraw(&values);
                }
            }
            Ok(Answer::Committed { revision }) => {
                if let Some(values) = self.commits.remove(&key) {
                    let in_force = self.in_force.get(&revision.0);
                    assert_eq!(in_force, Some(&values), "{revision} is not in force");
                }
            }
            Ok(_) => {}
        }
    }
}
