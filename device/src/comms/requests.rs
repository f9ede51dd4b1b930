//! Requests of a host: authorisation, execution, reply.

use crate::comms::Comms;
use crate::comms::job::{Job, JobState};
use crate::comms::sessions::{RenewalClass, RequestClass};
use crepitus_protocol::chirp::PlayedChirp;
use crepitus_protocol::counters::CommsCounter;
use crepitus_protocol::crash::{Controller, Part};
use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::host::{Answer, Counters, Operation, Refusal, Reply, Request, Status};
use crepitus_protocol::link::{DriveRefusal, DriveStatus, Order};
use crepitus_protocol::management::ManagementRequest;
use crepitus_protocol::{Fault, Lane, Revision, Session, State, Values};

/// A decoded frame from a host.
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
enum HostMessage {
    Management(ManagementRequest),
    Request(Request),
}

/// Immediate result of a request: a reply, or a job that will send it.
type StartResult = Result<Started, Refusal>;

#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
enum Started {
    Replied(Answer),
    Pending(JobState),
}

impl Comms {
    /// Receives a byte from the host.
    pub(super) fn host_byte(&mut self, byte: u8) {
        let known = match self.from_host.push(byte) {
            None => return,
            Some(Err(_)) => return self.counters.count(CommsCounter::FromHostDiscarded),
            Some(Ok(body)) => match body.lane() {
                Some(Lane::Management) => {
                    ManagementRequest::of(body.payload).map(HostMessage::Management)
                }
                Some(Lane::Request) => body.message().map(HostMessage::Request),
                _ => None,
            },
        };
        self.counters.count(match &known {
            Some(_) => CommsCounter::FromHost,
            None => CommsCounter::Foreign,
        });
        match known {
            None => {}
            Some(HostMessage::Management(question)) => self.answer_management(question),
            Some(HostMessage::Request(request)) => self.request(&request),
        }
    }

    fn request(&mut self, request: &Request) {
        if request.operation == Operation::Renew {
            return self.renew(request);
        }
        match self.sessions.classify(request) {
            RequestClass::Ignore => {}
            RequestClass::NotOpen => {
                self.counters.count(CommsCounter::NotOpen);
                self.send(&Reply {
                    session: request.session,
                    number: request.number,
                    answer: Err(Refusal::NotOpen),
                });
            }
            RequestClass::Open => {
                self.counters.count(CommsCounter::Requests);
                let needed = [
                    self.lease.holder(self.now_ms),
                    self.job.map(|job| job.session),
                ];
                let reply = self.sessions.open(request, needed);
                self.send(&reply);
            }
            RequestClass::Repeat(reply) => {
                self.counters.count(CommsCounter::RepeatedRequests);
                self.send(&reply);
            }
            RequestClass::New => {
                self.counters.count(CommsCounter::Requests);
                match self.begin(request) {
                    Ok(Started::Replied(answer)) => {
                        self.reply(request.session, request.number, &Ok(answer));
                    }
                    Ok(Started::Pending(state)) => {
                        self.job = Some(Job::new(request, self.now_ms, state));
                    }
                    Err(refusal) => self.reply(request.session, request.number, &Err(refusal)),
                }
            }
        }
    }

    /// Renews the lease, without a reply.
    fn renew(&mut self, request: &Request) {
        let seen_tick = self.drive.seen_tick();
        match self.sessions.renew(request) {
            RenewalClass::NotOpen => self.counters.count(CommsCounter::NotOpen),
            RenewalClass::New if self.lease.renew(request.session, self.now_ms, seen_tick) => {
                self.counters.count(CommsCounter::Renewals);
            }
            _ => {}
        }
    }

    // On its own: inlined, the compiler knows that `Open` was handled before, and puts
    // a trap in its place.
    #[inline(never)]
    fn begin(&mut self, request: &Request) -> StartResult {
        let answered = |answer| Ok(Started::Replied(answer));
        match &request.operation {
            // Handled before.
            Operation::Renew | Operation::Open => answered(Answer::Done),
            Operation::Status => answered(Answer::Status(self.status())),
            Operation::Counters => answered(Answer::Counters(Counters {
                drive: self.drive.counters(),
                comms: self.counters.all(),
            })),
            Operation::Times => answered(Answer::Times(self.times())),
            Operation::Parameters => answered(Answer::Parameters {
                revision: self.parameters.revision(),
                values: *self.parameters.values(),
            }),
            Operation::Subscribe => {
                // Before, the first tick of the stream is not known.
                let start = self.drive.start().ok_or(Refusal::DriveSilent)?;
                let first_tick = self.drive.next_tick();
                self.sessions.subscribe(request.session, true);
                answered(Answer::Subscribed {
                    first_tick,
                    dropped: self.stream.dropped_before(first_tick),
                    start,
                })
            }
            Operation::Unsubscribe => {
                self.sessions.subscribe(request.session, false);
                answered(Answer::Done)
            }
            Operation::Disarm => {
                self.check_lease(request.session)?;
                self.release(Refusal::Aborted);
                answered(Answer::Done)
            }
            Operation::Commit { base, values } => self.commit(*base, values),
            Operation::Save => self.save(request),
            Operation::ReadCrash { controller, part } => self.read_crash(*controller, *part),
            Operation::Zero => self.command(request, Order::Zero),
            Operation::ClearFault => self.clear_fault(request),
            Operation::Arm => self.arm(request),
            Operation::PlayChirp(chirp) => self.play_chirp(request, *chirp),
        }
    }

    /// Commits also while another session holds the lease: a teacher changes the
    /// knee that somebody else examines.
    fn commit(&mut self, base: Revision, values: &Values) -> StartResult {
        if self.job.is_some() {
            return Err(Refusal::Busy);
        }
        let revision = self.parameters.revision();
        if base != revision {
            return Err(Refusal::Stale { revision });
        }
        match self.drive.revision(self.now_ms, self.start) {
            None => return Err(Refusal::DriveSilent),
            // The previous commit is still being sent.
            Some(active) if active != revision => return Err(Refusal::Busy),
            Some(_) => {}
        }
        let revision = self
            .parameters
            .propose(values, self.supervision.is_enable_requested())
            .map_err(Refusal::Values)?;
        Ok(Started::Pending(JobState::Commit { revision }))
    }

    fn save(&mut self, request: &Request) -> StartResult {
        self.authorize(request.session)?;
        if self.supervision.is_enable_requested() {
            return Err(Refusal::Armed);
        }
        self.save_is_due = true;
        Ok(Started::Pending(JobState::Save))
    }

    /// Reading changes nothing, so it needs no lease.
    fn read_crash(&self, controller: Controller, part: u8) -> StartResult {
        if controller == Controller::Comms {
            let words = self.crash.map(|head| head.words());
            let part = Part::of(part, |place| words?.get(place).copied());
            return Ok(Started::Replied(Answer::CrashPart(part)));
        }
        if self.supervision.is_enable_requested() {
            return Err(Refusal::Armed);
        }
        if self.job.is_some() {
            return Err(Refusal::Busy);
        }
        if !self.drive.is_present(self.now_ms) {
            return Err(Refusal::DriveSilent);
        }
        Ok(Started::Pending(JobState::CrashPart(part)))
    }

    /// Ends the job of a part that the drive has sent.
    pub(super) fn crash_part(&mut self, part: &Part) {
        if let Some(job) = self.job
            && job.crash_part() == Some(part.number)
        {
            self.finish(&job, &Ok(Answer::CrashPart(*part)));
        }
    }

    /// Sends an order to the drive.
    fn command(&mut self, request: &Request, order: Order) -> StartResult {
        self.authorize(request.session)?;
        if !self.drive.is_present(self.now_ms) {
            return Err(Refusal::DriveSilent);
        }
        let number = self.to_drive.next_number();
        Ok(Started::Pending(JobState::Command { number, order }))
    }

    fn clear_fault(&mut self, request: &Request) -> StartResult {
        self.authorize(request.session)?;
        if self.supervision.is_enable_requested() {
            return Err(Refusal::Armed);
        }
        if let Some(fault) = self.supervision.clear(self.line_is_on) {
            return Err(Refusal::Faulted { code: fault.code() });
        }
        self.drive_clock.restart();
        let has_fault = |status: &DriveStatus| status.fault != 0 || status.coil_fault != 0;
        if self.drive.status().is_some_and(has_fault) {
            self.command(request, Order::ClearFault)
        } else {
            Ok(Started::Replied(Answer::Done))
        }
    }

    fn arm(&mut self, request: &Request) -> StartResult {
        self.authorize(request.session)?;
        if self.supervision.is_enable_requested() {
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
        // A reboot is pending, or the drive has not finished disarming, or has not said yet
        // which messages it understands.
        let is_at_rest = !matches!(self.drive.state(), State::Arming | State::Armed);
        if self.reboot_ms.is_some() || !is_at_rest || self.drive.identity().is_none() {
            return Err(Refusal::Busy);
        }
        if self.drive.revision(self.now_ms, self.start) != Some(self.parameters.revision()) {
            return Err(Refusal::Busy);
        }
        let seen_tick = self.drive.seen_tick();
        self.lease.acquire(request.session, self.now_ms, seen_tick);
        self.supervision.request_enable();
        Ok(Started::Pending(JobState::ProveLine))
    }

    /// Plays a chirp for the holder of the lease only: without a holder nobody watches what moves.
    fn play_chirp(&mut self, request: &Request, chirp: PlayedChirp) -> StartResult {
        self.check_lease(request.session)?;
        if self.lease.holder(self.now_ms).is_none() {
            return Err(Refusal::Drive(DriveRefusal::NotArmed));
        }
        self.command(request, Order::PlayChirp(chirp))
    }

    /// Rejects a change while another host holds the lease or a job is pending.
    fn authorize(&self, session: Session) -> Result<(), Refusal> {
        self.check_lease(session)?;
        if self.job.is_some() {
            return Err(Refusal::Busy);
        }
        Ok(())
    }

    /// Rejects a request while another host holds the lease.
    fn check_lease(&self, session: Session) -> Result<(), Refusal> {
        match self.lease.other_holder(session, self.now_ms) {
            Some(by) => Err(Refusal::Leased { by }),
            None => Ok(()),
        }
    }

    /// Advances the pending job; runs once a millisecond.
    pub(super) fn poll_job(&mut self) {
        let Some(job) = self.job else {
            self.reissue_rejected();
            return;
        };
        if let Some(answer) = self.advance(&job) {
            self.finish(&job, &answer);
        }
    }

    /// Reissues the committed values under a new revision where the drive accepts theirs no more:
    /// it has rejected it, because it was armed, or a newer one is in force after all, which
    /// was rejected before the drive restarted and has waited on the link.
    fn reissue_rejected(&mut self) {
        let revision = self.parameters.revision();
        let refused = self.drive.refused(self.start);
        let is_refused = refused.is_some_and(|(refused, _)| refused == revision);
        let active = self.drive.revision(self.now_ms, self.start);
        let active = active.filter(|active| *active != Revision::NONE);
        if is_refused || active.is_some_and(|active| revision.is_before(active)) {
            self.parameters.renumber(active.unwrap_or(revision));
        }
    }

    /// Advances a job; returns its result when it has ended.
    fn advance(&mut self, job: &Job) -> Option<Result<Answer, Refusal>> {
        let is_silent = !self.drive.is_present(self.now_ms);
        match job.state {
            JobState::ProveLine => {
                if let Some(fault) = self.supervision.fault() {
                    return Some(Err(Refusal::Faulted { code: fault.code() }));
                }
                if self.supervision.line_is_tested() {
                    let number = self.to_drive.next_number();
                    let order = Order::Arm;
                    self.job = Some(Job {
                        state: JobState::Command { number, order },
                        ..*job
                    });
                    return None;
                }
            }
            JobState::Command { number, order } => {
                let outcome = self.drive.outcome(self.start);
                if let Some(outcome) = outcome.filter(|outcome| outcome.number == number) {
                    if order == Order::Arm && outcome.result.is_ok() {
                        self.supervision.confirm_armed();
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
            JobState::Commit { revision } => {
                if self.drive.revision(self.now_ms, self.start) == Some(revision) {
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
                    // The drive may have applied it already; commit it here too.
                    self.parameters.accept();
                    return Some(Err(Refusal::Unconfirmed));
                }
                return None;
            }
            JobState::Save | JobState::CrashPart(_) => {}
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

    fn finish(&mut self, job: &Job, answer: &Result<Answer, Refusal>) {
        self.job = None;
        let was_arming = matches!(
            job.state,
            JobState::ProveLine
                | JobState::Command {
                    order: Order::Arm,
                    ..
                }
        );
        if was_arming && answer.is_err() {
            self.supervision.release();
            self.lease.release();
        }
        self.reply(job.session, job.number, answer);
    }

    /// Takes the save that is due: the committed values with the revision that they have
    /// now, as a drive that restarts gives them another one.
    pub(super) fn take_save(&mut self) -> Option<(Revision, Values)> {
        if !core::mem::take(&mut self.save_is_due) {
            return None;
        }
        self.saving = Some(self.parameters.revision());
        Some((self.parameters.revision(), *self.parameters.values()))
    }

    /// Ends the job of a save. What was not handed out cannot have been saved.
    pub(super) fn finish_save(&mut self, done: bool) {
        let Some(revision) = self.saving.take() else {
            return;
        };
        if done {
            self.parameters.mark_saved(revision);
        }
        let Some(job) = self.job.filter(|job| job.state == JobState::Save) else {
            return;
        };
        let answer = if done {
            Ok(Answer::Done)
        } else {
            Err(Refusal::Storage)
        };
        self.finish(&job, &answer);
    }

    /// Turns torque off for any host. A pending arm request fails with
    /// `refusal`.
    pub(super) fn release(&mut self, refusal: Refusal) {
        self.supervision.release();
        self.lease.release();
        // The heartbeat that disarms goes before all other frames.
        self.to_drive.heartbeat_now();
        if let Some(job) = self.job.filter(|job| {
            job.state == JobState::ProveLine || matches!(job.command(), Some((_, Order::Arm)))
        }) {
            self.finish(&job, &Err(refusal));
        }
    }

    fn status(&self) -> Status {
        let drive = self.drive.status().copied().unwrap_or_default();
        Status {
            state: self.state(),
            drive_fault: drive.fault,
            coil_fault: drive.coil_fault,
            comms_fault: self.supervision.fault().map_or(0, Fault::code),
            drive_present: self.drive.is_present(self.now_ms),
            tick: self.drive.seen_tick(),
            uptime_ms: self.now_ms,
            revision: self.parameters.revision(),
            in_force: self.drive.known_revision(self.start),
            saved: self.parameters.saved(),
            lease: self.lease.holder(self.now_ms),
            zeroed: drive.zeroed,
            polarity_proven: drive.polarity_proven,
            measured: drive.measured,
        }
    }

    fn reply(&mut self, session: Session, number: u32, answer: &Result<Answer, Refusal>) {
        let reply = Reply {
            session,
            number,
            answer: *answer,
        };
        self.sessions.store_reply(&reply);
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
