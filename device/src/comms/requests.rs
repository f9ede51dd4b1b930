//! What a host asks, and what becomes of it.

use crate::comms::Comms;
use crate::comms::order::{Job, Work};
use crate::comms::sessions::Verdict;
use crate::comms::subscription::Subscription;
use crepitus_protocol::counters::CommsCounter;
use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::host::{Answer, Ask, Counters, Refusal, Reply, Request, Status};
use crepitus_protocol::link::Order;
use crepitus_protocol::management::Question;
use crepitus_protocol::{Fault, Lane, Revision, Session, State, Values};

/// A frame of a host.
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
enum Said {
    Management(Question),
    Request(Request),
}

/// What becomes of a request at once: an answer, or work.
type Step = Result<Progress, Refusal>;

#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
enum Progress {
    Answered(Answer),
    Working(Work),
}

impl Comms {
    /// A byte of the host.
    pub(super) fn host_byte(&mut self, byte: u8) {
        let known = match self.from_host.push(byte) {
            None => return,
            Some(Err(_)) => return self.counters.count(CommsCounter::FromHostDiscarded),
            Some(Ok(body)) => match body.lane() {
                Some(Lane::Management) => Question::of(body.payload).map(Said::Management),
                Some(Lane::Request) => body.message().map(Said::Request),
                _ => None,
            },
        };
        self.counters.count(match &known {
            Some(_) => CommsCounter::FromHost,
            None => CommsCounter::Foreign,
        });
        match known {
            None => {}
            Some(Said::Management(question)) => self.host_asks(question),
            Some(Said::Request(request)) => self.request(&request),
        }
    }

    fn request(&mut self, request: &Request) {
        if request.ask == Ask::Renew {
            let seen_tick = self.drive.seen_tick();
            if self.lease.renew(request.session, self.now_ms, seen_tick) {
                self.counters.count(CommsCounter::Renewals);
            }
            return;
        }
        match self.sessions.judge(request) {
            Verdict::Ignore => {}
            Verdict::Again(reply) => {
                self.counters.count(CommsCounter::RepeatedRequests);
                self.send(&reply);
            }
            Verdict::New => {
                self.counters.count(CommsCounter::Requests);
                match self.begin(request) {
                    Ok(Progress::Answered(answer)) => {
                        self.reply(request.session, request.number, Ok(answer));
                    }
                    Ok(Progress::Working(work)) => {
                        self.job = Some(Job::new(request, self.now_ms, work));
                    }
                    Err(refusal) => self.reply(request.session, request.number, Err(refusal)),
                }
            }
        }
    }

    fn begin(&mut self, request: &Request) -> Step {
        let answered = |answer| Ok(Progress::Answered(answer));
        match &request.ask {
            Ask::Renew => answered(Answer::Done),
            Ask::Status => answered(Answer::Status(self.status())),
            Ask::Counters => answered(Answer::Counters(Counters {
                drive: self.drive.counters(),
                comms: self.counters.all(),
            })),
            Ask::Parameters => answered(Answer::Parameters {
                revision: self.parameters.revision(),
                values: *self.parameters.values(),
            }),
            // Where the books begin is not known.
            Ask::Subscribe if !self.drive.is_known() => Err(Refusal::DriveSilent),
            Ask::Subscribe => {
                let first_tick = self.drive.next_tick();
                self.subscription = Some(Subscription::new(first_tick));
                answered(Answer::Subscribed { first_tick })
            }
            Ask::Unsubscribe => {
                self.subscription = None;
                answered(Answer::Done)
            }
            Ask::Disarm => {
                self.let_go(Refusal::Aborted);
                answered(Answer::Done)
            }
            Ask::Commit { base, values } => self.commit(request, *base, values),
            Ask::Save => self.save(request),
            Ask::Zero => self.command(request, Order::Zero),
            Ask::ClearFault => self.clear_fault(request),
            Ask::Arm => self.arm(request),
        }
    }

    fn commit(&mut self, request: &Request, base: Revision, values: &Values) -> Step {
        self.may_change(request.session)?;
        let revision = self.parameters.revision();
        if base != revision {
            return Err(Refusal::Stale { revision });
        }
        match self.drive.revision(self.now_ms) {
            None => return Err(Refusal::DriveSilent),
            // It is still being given what was committed before.
            Some(in_force) if in_force != revision => return Err(Refusal::Busy),
            Some(_) => {}
        }
        let revision = self
            .parameters
            .propose(values, self.supervision.is_wanted())
            .map_err(Refusal::Values)?;
        Ok(Progress::Working(Work::Commit { revision }))
    }

    fn save(&mut self, request: &Request) -> Step {
        self.may_change(request.session)?;
        if self.supervision.is_wanted() {
            return Err(Refusal::Armed);
        }
        self.save = Some((self.parameters.revision(), *self.parameters.values()));
        Ok(Progress::Working(Work::Save))
    }

    /// Something for the drive to do.
    fn command(&mut self, request: &Request, order: Order) -> Step {
        self.may_change(request.session)?;
        if !self.drive.is_present(self.now_ms) {
            return Err(Refusal::DriveSilent);
        }
        let number = self.to_drive.next_number();
        Ok(Progress::Working(Work::Command { number, order }))
    }

    fn clear_fault(&mut self, request: &Request) -> Step {
        self.may_change(request.session)?;
        if self.supervision.is_wanted() {
            return Err(Refusal::Armed);
        }
        if let Some(fault) = self.supervision.clear(self.line_is_on) {
            return Err(Refusal::Faulted { code: fault.code() });
        }
        if self.drive.status().is_some_and(|status| status.fault != 0) {
            self.command(request, Order::ClearFault)
        } else {
            Ok(Progress::Answered(Answer::Done))
        }
    }

    fn arm(&mut self, request: &Request) -> Step {
        self.may_change(request.session)?;
        if self.supervision.is_wanted() {
            return Err(Refusal::Armed);
        }
        let drive_fault = self.drive.status().map_or(0, |status| status.fault);
        let code = self.supervision.fault().map_or(drive_fault, Fault::code);
        if code != 0 {
            return Err(Refusal::Faulted { code });
        }
        if !self.drive.is_present(self.now_ms) {
            return Err(Refusal::DriveSilent);
        }
        // It starts anew; or the drive has not let go yet, a moment ago disarmed.
        if self.reboot_ms.is_some() || matches!(self.drive.state(), State::Arming | State::Armed) {
            return Err(Refusal::Busy);
        }
        if self.drive.revision(self.now_ms) != Some(self.parameters.revision()) {
            return Err(Refusal::Busy);
        }
        let seen_tick = self.drive.seen_tick();
        self.lease.take(request.session, self.now_ms, seen_tick);
        self.supervision.want();
        Ok(Progress::Working(Work::ProveLine))
    }

    /// What changes something is for the host that has the lease, one at a
    /// time.
    fn may_change(&self, session: Session) -> Result<(), Refusal> {
        if let Some(by) = self.lease.other_than(session, self.now_ms) {
            return Err(Refusal::Leased { by });
        }
        if self.job.is_some() {
            return Err(Refusal::Busy);
        }
        Ok(())
    }

    /// Once a millisecond: what is being done goes on.
    pub(super) fn go_on(&mut self) {
        let Some(job) = self.job else {
            self.insist();
            return;
        };
        if let Some(answer) = self.progress(&job) {
            self.finish(&job, answer);
        }
    }

    /// The drive has refused, while it had torque, what was taken for
    /// committed before that was heard: what was refused once stays refused, so
    /// it gets another number.
    fn insist(&mut self) {
        let refused = self.drive.refused(self.start);
        if refused.is_some_and(|(refused, _)| refused == self.parameters.revision()) {
            self.parameters.renumber();
        }
    }

    /// What has become of a job, if it has ended.
    fn progress(&mut self, job: &Job) -> Option<Result<Answer, Refusal>> {
        let is_silent = !self.drive.is_present(self.now_ms);
        match job.work {
            Work::ProveLine => {
                if let Some(fault) = self.supervision.fault() {
                    return Some(Err(Refusal::Faulted { code: fault.code() }));
                }
                if self.supervision.line_is_proven() {
                    let number = self.to_drive.next_number();
                    let order = Order::Arm;
                    self.job = Some(Job {
                        work: Work::Command { number, order },
                        ..*job
                    });
                    return None;
                }
            }
            Work::Command { number, order } => {
                let outcome = self.drive.outcome(self.start);
                if let Some(outcome) = outcome.filter(|outcome| outcome.number == number) {
                    if order == Order::Arm && outcome.result.is_ok() {
                        self.supervision.armed();
                    }
                    return Some(match outcome.result {
                        Ok(()) => Ok(Answer::Done),
                        Err(refusal) => Err(Refusal::Drive(refusal)),
                    });
                }
                if let Some(fault) = self.supervision.fault().filter(|_| order == Order::Arm) {
                    return Some(Err(Refusal::Faulted { code: fault.code() }));
                }
            }
            Work::Commit { revision } => {
                if self.drive.revision(self.now_ms) == Some(revision) {
                    self.parameters.accept();
                    return Some(Ok(Answer::Committed { revision }));
                }
                match self.drive.refused(self.start) {
                    Some((refused, error)) if refused == revision => {
                        self.parameters.reject();
                        return Some(Err(Refusal::Values(error)));
                    }
                    _ => {}
                }
                if self.now_ms >= job.end_ms {
                    // It may have come into force, so it has to.
                    self.parameters.accept();
                    return Some(Err(Refusal::Unconfirmed));
                }
                return None;
            }
            Work::Save => {}
        }
        if self.now_ms < job.end_ms {
            return None;
        }
        Some(Err(if is_silent {
            Refusal::DriveSilent
        } else {
            Refusal::Unconfirmed
        }))
    }

    fn finish(&mut self, job: &Job, answer: Result<Answer, Refusal>) {
        self.job = None;
        let was_arming = matches!(
            job.work,
            Work::ProveLine
                | Work::Command {
                    order: Order::Arm,
                    ..
                }
        );
        if was_arming && answer.is_err() {
            self.supervision.let_go();
            self.lease.release();
        }
        self.reply(job.session, job.number, answer);
    }

    /// Parameters were kept, or not.
    pub(super) fn finish_save(&mut self, done: bool) {
        let Some(job) = self.job.filter(|job| job.work == Work::Save) else {
            return;
        };
        if done {
            self.parameters.keep(self.parameters.revision());
        }
        let answer = if done {
            Ok(Answer::Done)
        } else {
            Err(Refusal::Storage)
        };
        self.finish(&job, answer);
    }

    /// No more torque, whoever asks; who was arming is told.
    pub(super) fn let_go(&mut self, refusal: Refusal) {
        self.supervision.let_go();
        self.lease.release();
        // The drive hears of it before anything that follows.
        self.to_drive.heartbeat_now();
        if let Some(job) = self.job.filter(|job| {
            job.work == Work::ProveLine || matches!(job.command(), Some((_, Order::Arm)))
        }) {
            self.finish(&job, Err(refusal));
        }
    }

    fn status(&self) -> Status {
        let drive = self.drive.status().copied().unwrap_or_default();
        Status {
            state: self.state(),
            drive_fault: drive.fault,
            comms_fault: self.supervision.fault().map_or(0, Fault::code),
            drive_present: self.drive.is_present(self.now_ms),
            tick: self.drive.seen_tick(),
            uptime_ms: self.now_ms,
            revision: self.parameters.revision(),
            in_force: drive.revision,
            saved: self.parameters.saved(),
            lease: self.lease.holder(self.now_ms),
            zeroed: drive.zeroed,
            polarity_proven: drive.polarity_proven,
        }
    }

    fn reply(&mut self, session: Session, number: u16, answer: Result<Answer, Refusal>) {
        let reply = Reply {
            session,
            number,
            answer,
        };
        self.sessions.answered(&reply);
        self.send(&reply);
    }

    fn send(&mut self, reply: &Reply) {
        if let Ok(frame) = frame::encode(Lane::Reply, reply) {
            self.queue_reply(&frame);
        }
    }

    pub(super) fn queue_reply(&mut self, frame: &Frame) {
        if !self.outbox.reply(frame) {
            self.counters.count(CommsCounter::DroppedReplies);
        }
    }
}
