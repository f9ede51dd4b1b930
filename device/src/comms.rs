//! The comms controller: host requests, the lease, the parameters, supervision
//! of the drive, and an enable line of its own.
//!
//! ```text
//!  host ──> Requests ──> [`Parameters`] ──┐
//!             │   └────> [`Lease`] ───────┤
//!             │                           ├──> link ──> drive
//!             └────────> [`Supervision`] ─┘      │
//!  host <── [`Outbox`] <── [`Stream`] <──────────┘ blocks, status
//! ```
//!
//! [`Comms::tick`] runs every millisecond; bytes are received and sent in
//! between. Nothing blocks: bytes that the host does not read are dropped and
//! counted.

mod byte_ring;
pub mod drive_clock;
pub mod drive_view;
pub mod enable_line;
pub mod job;
pub mod lease;
mod management;
pub mod outbox;
pub mod parameters;
mod requests;
pub mod sample_checks;
pub mod sessions;
pub mod stream;
pub mod supervision;
mod to_drive;

use crate::counters::CommsCounters;
use crate::self_test::SelfTest;
use crate::usb_port::HostBytes;
use crepitus_protocol::counters::CommsCounter;
use crepitus_protocol::crash::Head;
use crepitus_protocol::frame::{self, Frame, SoftwareCrc, WordCrc};
use crepitus_protocol::link::FromDrive;
use crepitus_protocol::management::{Answer, Identity};
use crepitus_protocol::task_times::{DeviceTimes, TaskTimes};
use crepitus_protocol::telemetry::{BLOCK_TICKS, Block};
use crepitus_protocol::{Decoder, Fault, Lane, Revision, State, Values};
use drive_clock::DriveClock;
use drive_view::{Continuity, DriveView};
use job::Job;
use lease::Lease;
use outbox::Outbox;
use parameters::Parameters;
use sample_checks::SampleChecks;
use sessions::Sessions;
use stream::Stream;
use supervision::Supervision;
use to_drive::{ToDriveQueue, Wanted};

/// Boot-time inputs of comms.
#[derive(Clone, Copy, Debug, Default)]
pub struct Boot {
    /// Identity of this controller.
    pub identity: Identity,
    /// Result of the self-test.
    pub self_test: SelfTest,
    /// Boot counter.
    pub start: u16,
    /// Random bits, or at least another number at each start.
    pub entropy: u64,
    /// The saved parameters, if there are any.
    pub saved: Option<(Revision, Values)>,
    /// Initial value of all counters: 0, except in a test of their wrap.
    pub counters: u32,
    /// Post-mortem record of the last crash.
    pub crash: Option<Head>,
}

/// Inputs from the peripherals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// The enable line of comms, as read back.
    pub enable_is_on: bool,
}

/// Outputs to the peripherals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// The enable line of comms.
    pub enable: bool,
    /// Parameters to save; then call [`Comms::saved`].
    pub save: Option<(Revision, Values)>,
    /// Request to reboot.
    pub reboot: bool,
}

/// The comms controller.
#[derive(Debug)]
pub struct Comms {
    identity: Identity,
    start: u16,
    now_ms: u64,
    counters: CommsCounters,
    parameters: Parameters,
    lease: Lease,
    supervision: Supervision,
    /// The line of comms, as read back.
    line_is_on: bool,
    drive: DriveView,
    drive_clock: DriveClock,
    sample_checks: SampleChecks,
    to_drive: ToDriveQueue,
    from_drive: Decoder,
    from_host: Decoder,
    sessions: Sessions,
    /// The request that is being carried out.
    job: Option<Job>,
    stream: Stream,
    outbox: Outbox,
    save_is_due: bool,
    /// The revision that is being saved, from [`Outputs::save`] to [`Comms::saved`].
    saving: Option<Revision>,
    /// Post-mortem record of the last crash.
    crash: Option<Head>,
    /// Times of the tasks of comms, as of the last report.
    times: Option<TaskTimes>,
    /// Time of the requested reboot, ms.
    reboot_ms: Option<u64>,
}

impl Comms {
    /// The state after boot. Saved parameters that are invalid are ignored.
    pub fn new(boot: &Boot) -> Self {
        let mut counters = CommsCounters::default();
        counters.set_all(boot.counters);
        Self {
            identity: boot.identity,
            start: boot.start,
            now_ms: 0,
            counters,
            parameters: Parameters::new(boot.saved),
            lease: Lease::default(),
            supervision: Supervision::new(boot.identity.reset, boot.self_test),
            line_is_on: false,
            drive: DriveView::default(),
            drive_clock: DriveClock::default(),
            sample_checks: SampleChecks::default(),
            to_drive: ToDriveQueue::default(),
            from_drive: Decoder::new(),
            from_host: Decoder::new(),
            sessions: Sessions::new(boot.entropy),
            job: None,
            stream: Stream::default(),
            outbox: Outbox::default(),
            save_is_due: false,
            saving: None,
            crash: boot.crash,
            times: None,
            reboot_ms: None,
        }
    }

    /// Runs once a millisecond.
    pub fn tick(&mut self, inputs: &Inputs) -> Outputs {
        self.now_ms = self.now_ms.saturating_add(1);
        if self.lease.take_expiry(self.now_ms) {
            self.counters.count(CommsCounter::LeasesExpired);
        }
        let drive_is_silent = !self.drive.is_present(self.now_ms);
        let is_leased = self.lease.is_alive(self.now_ms);
        let before = self.supervision.fault();
        let enable =
            self.supervision
                .tick(inputs.enable_is_on, drive_is_silent, is_leased, &self.drive);
        if self.supervision.fault().is_some() && before.is_none() {
            self.counters.count(CommsCounter::Faults);
        }
        self.line_is_on = inputs.enable_is_on;
        self.poll_job();
        self.to_drive.tick(self.now_ms);
        Outputs {
            enable,
            save: self.take_save(),
            reboot: self.reboot_ms.is_some_and(|at| self.now_ms >= at),
        }
    }

    /// Reports the result of saving [`Outputs::save`].
    pub fn saved(&mut self, done: bool) {
        self.finish_save(done);
    }

    /// Stores a report of the tasks of comms.
    pub fn set_times(&mut self, times: &TaskTimes) {
        self.times = Some(*times);
    }

    /// Times of both controllers, as of their last reports.
    pub fn times(&self) -> DeviceTimes {
        DeviceTimes {
            drive: self.drive.times(),
            comms: self.times,
        }
    }

    /// Receives a byte from the drive.
    pub fn link_received(&mut self, byte: u8) {
        self.link_received_all(&mut SoftwareCrc, &[byte]);
    }

    /// Receives bytes from the drive, with most of the checksum by a unit.
    pub fn link_received_all(&mut self, unit: &mut impl WordCrc, bytes: &[u8]) {
        let mut rest = bytes;
        while !rest.is_empty() {
            let (taken, frame) = self.from_drive.extend_by(unit, rest);
            match frame {
                None => {}
                Some(Err(_)) => self.counters.count(CommsCounter::FromDriveDiscarded),
                // A message is decoded where it is handled: it is large.
                Some(Ok(body)) => match body.lane() {
                    Some(Lane::Telemetry) => {
                        let block = body.message();
                        self.known(block.as_ref(), |comms, block| comms.block(unit, block));
                    }
                    Some(Lane::FromDrive) => {
                        let message = body.message();
                        self.known(message.as_ref(), Self::drive_message);
                    }
                    Some(Lane::ManagementAnswer) => {
                        let answer = Answer::of(body.payload);
                        self.known(answer.as_ref(), Self::drive_answer);
                    }
                    _ => self.counters.count(CommsCounter::Foreign),
                },
            }
            rest = rest.get(taken..).unwrap_or_default();
        }
    }

    /// Counts a message, and handles it if it is one.
    fn known<T>(&mut self, message: Option<&T>, handle: impl FnOnce(&mut Self, &T)) {
        self.counters.count(match message {
            Some(_) => CommsCounter::FromDrive,
            None => CommsCounter::Foreign,
        });
        if let Some(message) = message {
            handle(self, message);
        }
    }

    fn drive_message(&mut self, message: &FromDrive) {
        match message {
            FromDrive::Status(status) => {
                self.drive.receive_status(status);
                // Replies that depend on it go out before the blocks that follow.
                self.poll_job();
            }
            FromDrive::CrashPart(part) => self.crash_part(part),
            FromDrive::Times(times) => {
                self.drive.receive_times(times);
                self.stream_times();
            }
        }
    }

    /// Sends the times to a host that has subscribed; one that does not read goes without.
    fn stream_times(&mut self) {
        if !self.sessions.has_subscriber() {
            return;
        }
        if let Ok(frame) = frame::encode(Lane::Times, &self.times()) {
            self.outbox.telemetry(&frame);
        }
    }

    fn drive_answer(&mut self, answer: &Answer) {
        if let Answer::Hello { own, .. } = answer {
            self.drive.set_identity(own);
            self.supervision.check_schema(own.schema);
        }
    }

    /// Returns the next frame for the drive, if one is due.
    pub fn link_to_send(&mut self) -> Option<Frame> {
        let heartbeat = crepitus_protocol::link::Heartbeat {
            seen_tick: self.drive.seen_tick(),
            lease_left: self
                .lease
                .remaining_ticks(self.drive.seen_tick(), self.now_ms),
            enable: self.supervision.is_enable_requested(),
            start: self.start,
            ..crepitus_protocol::link::Heartbeat::default()
        };
        let commit = self
            .parameters
            .to_send(self.drive.revision(self.now_ms, self.start))
            .filter(|_| self.drive.is_present(self.now_ms));
        let wanted = Wanted {
            commit,
            command: self.job.as_ref().and_then(Job::command),
            crash_part: self.job.as_ref().and_then(Job::crash_part),
            hello: self.drive.identity().is_none(),
        };
        self.to_drive.next_frame(heartbeat, &wanted)
    }

    /// State of the device.
    pub fn state(&self) -> State {
        self.supervision.state(&self.drive)
    }

    /// The latched fault of comms.
    pub fn fault(&self) -> Option<Fault> {
        self.supervision.fault()
    }

    /// Revision of the parameters committed last.
    pub fn revision(&self) -> Revision {
        self.parameters.revision()
    }

    /// Values of the parameters committed last.
    pub fn values(&self) -> &Values {
        self.parameters.values()
    }

    /// The counters of comms.
    pub fn counters(&self) -> &CommsCounters {
        &self.counters
    }

    fn block(&mut self, unit: &mut impl WordCrc, block: &Block) {
        let samples = BLOCK_TICKS;
        let continuity = self.drive.receive_block(block, self.now_ms);
        match continuity {
            Continuity::Stale => return,
            Continuity::Restarted => {
                self.counters.count(CommsCounter::DriveRestarts);
                self.supervision.drive_restarted();
                self.drive_clock.restart();
                self.sample_checks = SampleChecks::default();
                self.stream = Stream::new(block.first_tick);
            }
            Continuity::Next { lost } => self.counters.add(CommsCounter::LostSamples, lost),
        }
        self.supervise(block);
        self.counters.add(CommsCounter::ReceivedSamples, samples);
        if !self.sessions.has_subscriber() {
            return;
        }
        let counter = if self.stream.forward(unit, block, &mut self.outbox) {
            CommsCounter::SentSamples
        } else {
            CommsCounter::DroppedSamples
        };
        self.counters.add(counter, samples);
    }
}

impl Comms {
    /// Checks a block by itself, whatever the drive makes of it.
    fn supervise(&mut self, block: &Block) {
        self.parameters.shown(block);
        let bounds = self.parameters.bounds_in_force();
        let line_is_on = self.supervision.line_level();
        let fault = (self.sample_checks.check(block, &bounds, line_is_on))
            .or_else(|| self.drive_clock.check(self.now_ms, block.end_tick()));
        if let Some(fault) = fault
            && self.supervision.observed(fault)
        {
            self.counters.count(CommsCounter::Faults);
        }
    }
}

impl HostBytes for Comms {
    fn received(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.host_byte(*byte);
        }
    }

    fn to_send(&self) -> &[u8] {
        self.outbox.to_send()
    }

    fn sent(&mut self, count: usize) {
        self.outbox.sent(count);
    }

    fn host_lost(&mut self) {
        self.from_host.reset();
        self.sessions.unsubscribe_all();
        self.outbox.clear();
    }
}
