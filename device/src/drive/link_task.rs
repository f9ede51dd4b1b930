//! `link`, the task of lowest priority: executes messages of comms, sends
//! telemetry, status and replies.

use crate::counters::Counters;
use crate::drive::command::Command;
use crate::drive::commits::Commits;
use crate::drive::heartbeat_monitor::Freshness;
use crate::drive::link::Link;
use crate::drive::outgoing::{BlockPiece, Outgoing, PIECE_SAMPLES, first_phases, last_phases};
use crate::drive::slow_checks::SlowReadings;
use core::borrow::BorrowMut;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::crash::Part;
use crepitus_protocol::frame::{DELIMITER, EncodedFrame, FrameBuffer, WordCrc};
use crepitus_protocol::link::{DriveRefusal, DriveStatus, Order, ToDrive};
use crepitus_protocol::management::{Action, Identity, ManagementRequest};
use crepitus_protocol::measured::Measured;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{CoilFault, Decoder, Fault, Lane, Revision, State};

/// Resources shared with the other tasks. The firmware holds a lock while
/// `work` runs, so `work` is short.
pub trait Shared {
    /// Owned by `command_motor`: the clock, state, faults, blocks, the zero.
    fn command<R>(&mut self, work: impl FnOnce(&mut Command) -> R) -> R;

    /// Owned by the idle loop: pending commits.
    fn commits<R>(&mut self, work: impl FnOnce(&mut Commits) -> R) -> R;
}

/// State, the codes of both faults, and whether a commit was refused and arming waits, as
/// four bytes: compared in one go, in every tick. And the revision.
type Reported = ([u8; 4], Revision);

/// The drive's end of the link. Frames are encoded in buffers `P`.
#[derive(Debug)]
pub struct LinkTask<P> {
    identity: Identity,
    start: u16,
    decoder: Decoder,
    link: Link,
    outgoing: Outgoing<P>,
    reboot_requested: bool,
    /// The part of the post-mortem record that comms has asked for.
    crash_part: Option<u8>,
    /// Blocks to send before the next status: they precede the change that it
    /// reports.
    blocks_before_status: usize,
    /// A status for the next frame: gathered in one run, encoded in the next, since
    /// both take long.
    is_gathered: bool,
    /// The state that was reported last.
    reported: Reported,
}

impl<P: BorrowMut<FrameBuffer>> LinkTask<P> {
    /// The state after boot.
    pub fn new(identity: Identity, start: u16) -> Self {
        Self {
            identity,
            start,
            decoder: Decoder::new(),
            link: Link::default(),
            outgoing: Outgoing::default(),
            reboot_requested: false,
            crash_part: None,
            blocks_before_status: 0,
            is_gathered: false,
            reported: ([State::Disarmed as u8, 0, 0, 0], Revision::NONE),
        }
    }

    /// Receives bytes from comms: those up to a delimiter, and it, but none behind it.
    pub fn received(
        &mut self,
        unit: &mut impl WordCrc,
        bytes: &[u8],
        shared: &mut impl Shared,
        counters: &Counters,
    ) {
        let Some((&DELIMITER, part)) = bytes.split_last() else {
            return self.decoder.add_part(unit, bytes);
        };
        self.decoder.add_part(unit, part);
        let Some(frame) = self.decoder.end(unit) else {
            return;
        };
        let Ok(body) = frame else {
            counters.count(DriveCounter::Discarded);
            return;
        };
        match body.lane() {
            Some(Lane::ToDrive) => {
                if let Some(message) = body.message() {
                    counters.count(DriveCounter::Frames);
                    return self.handle(&message, shared, counters);
                }
            }
            Some(Lane::Management) => {
                if let Some(question) = ManagementRequest::of(body.payload) {
                    counters.count(DriveCounter::Frames);
                    return self.handle_management(question, shared);
                }
            }
            _ => {}
        }
        counters.count(DriveCounter::Foreign);
    }

    /// Handles a message; by reference, because a commit is long.
    fn handle(&mut self, message: &ToDrive, shared: &mut impl Shared, counters: &Counters) {
        match message {
            ToDrive::Heartbeat(heartbeat) => {
                let freshness = shared.command(|command| {
                    let now = command.next_tick();
                    command
                        .safety_mut()
                        .receive_heartbeat(now, heartbeat, counters)
                });
                if freshness == Freshness::Started {
                    self.link.clear();
                    shared.commits(|commits| commits.restart(heartbeat.start));
                }
            }
            ToDrive::Commit {
                revision,
                seal,
                pieces,
                piece,
            } => {
                let is_decided = shared.commits(|commits| {
                    commits.receive(*revision, (*seal, *pieces), piece, counters)
                });
                if is_decided {
                    self.link.request_status();
                }
            }
            ToDrive::Command {
                seen_tick,
                number,
                order,
            } => {
                let now = shared.command(|command| command.next_tick());
                if self.link.accepts(now, *seen_tick, *number, counters)
                    && let Some(result) = execute(*order, shared)
                {
                    self.link.finish(result);
                }
            }
            // Not under torque: its ticks have enough to do.
            ToDrive::ReadCrash { part } => {
                let is_live = shared.command(|command| command.safety().is_live());
                self.crash_part = (!is_live).then_some(*part);
            }
        }
    }

    /// Encodes one piece of the current frame for comms, or starts the next
    /// frame in a buffer from `spare`. `crash` reads a part of the post-mortem record.
    /// Returns a finished frame.
    pub fn next_frame(
        &mut self,
        unit: &mut impl WordCrc,
        crash: impl FnOnce(u8) -> Part,
        spare: impl FnOnce() -> Option<P>,
        shared: &mut impl Shared,
        counters: &Counters,
    ) -> Option<EncodedFrame<P>> {
        self.poll_changes(shared);
        if self.outgoing.is_idle() {
            self.start_frame(crash, spare, shared, counters);
            return None;
        }
        match self.outgoing.block_piece() {
            None => self.outgoing.piece(unit),
            Some(BlockPiece::Samples(next)) => {
                let piece = shared.command(|command| {
                    let samples = command.block()?.samples.get(next..)?;
                    samples.first_chunk::<PIECE_SAMPLES>().copied()
                })?;
                self.outgoing.samples(unit, &piece).ok()?;
                None
            }
            Some(BlockPiece::FirstPhases) => {
                let piece = shared.command(|command| first_phases(command.block()?).copied())?;
                self.outgoing.first_phases(unit, &piece).ok()?;
                None
            }
            Some(BlockPiece::LastPhases) => {
                let piece = shared.command(|command| last_phases(command.block()?).copied())?;
                let frame = self.outgoing.last_phases(unit, &piece)?;
                shared.command(Command::pop_block);
                self.blocks_before_status = self.blocks_before_status.saturating_sub(1);
                Some(frame)
            }
        }
    }

    /// Schedules a status if the state or a command's outcome has changed.
    fn poll_changes(&mut self, shared: &mut impl Shared) {
        let is_refused = shared.commits(|commits| commits.refused().is_some());
        let (outcome, current, queued) = shared.command(|command| {
            let revision = command.revision();
            let queued = command.queued_blocks();
            let coil_fault = command.coil().fault().map_or(0, CoilFault::code);
            let safety = command.safety_mut();
            let fault = safety.fault().map_or(0, Fault::code);
            let flags = u8::from(is_refused) | u8::from(safety.awaits_comms()) << 1;
            let current = ([safety.state() as u8, fault, coil_fault, flags], revision);
            (safety.take_outcome(), current, queued)
        });
        if let Some(result) = outcome {
            self.link.finish(result);
        }
        if current != self.reported {
            self.reported = current;
            self.link.request_status();
            self.blocks_before_status = queued;
        }
    }

    /// Starts the next frame, if one is due: management replies first, then
    /// blocks and statuses in the order of their events, however slow the wire:
    /// a new revision appears only in blocks after its status.
    fn start_frame(
        &mut self,
        crash: impl FnOnce(u8) -> Part,
        spare: impl FnOnce() -> Option<P>,
        shared: &mut impl Shared,
        counters: &Counters,
    ) -> Option<()> {
        if self.link.has_answer() {
            let buffer = spare()?;
            let answer = self.link.take_answer()?;
            return self.outgoing.begin_answer(buffer, &answer).ok();
        }
        if let Some(number) = self.crash_part {
            let buffer = spare()?;
            let begun = self.outgoing.begin_crash_part(buffer, &crash(number)).ok();
            self.crash_part = None;
            return begun;
        }
        if counters.times().is_pending() {
            let buffer = spare()?;
            counters.times().take(self.outgoing.times_mut());
            return self.outgoing.begin_times(buffer).ok();
        }
        if self.is_gathered {
            let begun = self.outgoing.begin_status(spare()?).ok();
            self.is_gathered = false;
            return begun;
        }
        let (now, head) =
            shared.command(|command| (command.next_tick(), command.block().map(Block::head)));
        let is_status_due = self.link.is_status_due(now);
        if let Some(head) = head
            && !(is_status_due && self.blocks_before_status == 0)
        {
            return self.outgoing.begin_block(spare()?, &head).ok();
        }
        if is_status_due {
            self.link.status_sent(now);
            self.gather(shared, counters);
            self.is_gathered = true;
        }
        None
    }

    /// Gathers a status, in its place: a copy of it would take as long as the rest.
    fn gather(&mut self, shared: &mut impl Shared, counters: &Counters) {
        let DriveStatus {
            tick,
            start,
            comms_start,
            state,
            fault,
            coil_fault,
            revision,
            refused,
            last,
            zeroed,
            polarity_proven,
            awaits_comms,
            measured: readings,
            counters: counts,
        } = self.outgoing.status_mut();
        *refused = shared.commits(|commits| commits.refused());
        *readings = measured(&shared.command(|command| command.slow_readings()));
        (*start, *last) = (self.start, self.link.last());
        shared.command(|command| {
            let safety = command.safety();
            *tick = command.next_tick();
            *comms_start = safety.comms_start();
            *state = safety.state();
            *fault = safety.fault().map_or(0, Fault::code);
            *coil_fault = command.coil().fault().map_or(0, CoilFault::code);
            *revision = command.known_revision();
            *zeroed = command.is_zeroed();
            *polarity_proven = safety.polarity_proven();
            *awaits_comms = safety.awaits_comms();
        });
        counters.read(counts);
    }

    /// Returns a pending reboot request, once. The board executes it.
    pub fn take_reboot(&mut self) -> bool {
        core::mem::take(&mut self.reboot_requested)
    }

    fn handle_management(&mut self, question: ManagementRequest, shared: &mut impl Shared) {
        let is_live = shared.command(|command| {
            if question.action == Action::Stop {
                command.safety_mut().disarm();
            }
            command.safety().is_live()
        });
        let done = match question.action {
            Action::Hello | Action::Stop => true,
            Action::Reboot => {
                self.reboot_requested = !is_live;
                self.reboot_requested
            }
        };
        self.link.answer(question, &self.identity, done);
    }
}

/// Converts the readings to the form in which they are sent.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "rounded, for people; a cast from float saturates"
)]
fn measured(readings: &SlowReadings) -> Measured {
    Measured {
        supply_cv: (readings.supply_v * 100.0 + 0.5) as u16,
        motor_c: readings.motor_c as i16,
        joint_cdeg: (readings.joint_span).map(|turns| (turns * 36_000.0 + 0.5) as u16),
    }
}

/// Executes an order; `None` while its result is pending.
fn execute(order: Order, shared: &mut impl Shared) -> Option<Result<(), DriveRefusal>> {
    shared.command(|command| match order {
        // The result of arming comes later.
        Order::Arm => command.arm().err().map(Err),
        Order::Zero => Some(command.zero()),
        Order::ClearFault => Some(command.clear_fault()),
        Order::PlayChirp(chirp) => Some(command.play_chirp(&chirp)),
    })
}

#[cfg(test)]
mod tests;
