//! `link`, the task of lowest priority: what comms wants, and what it is told.

use crate::counters::Counters;
use crate::drive::command::Command;
use crate::drive::commits::Commits;
use crate::drive::link::Link;
use crate::drive::outgoing::{Outgoing, PIECE_SAMPLES};
use crate::drive::sampler::Sampler;
use crate::drive::vigil::Heard;
use core::borrow::BorrowMut;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::frame::{Made, Place};
use crepitus_protocol::link::{DriveRefusal, DriveStatus, Order, ToDrive};
use crepitus_protocol::management::{Identity, Question, What};
use crepitus_protocol::{Decoder, Fault, Lane, Revision, State};

/// What the task shares with the others. The firmware locks each for as long
/// as the work takes, so the work is short.
pub trait Shared {
    /// `command_motor`'s: state, faults, blocks.
    fn command<R>(&mut self, work: impl FnOnce(&mut Command) -> R) -> R;

    /// `sample_encoder`'s: the clock, the angle's zero.
    fn sampler<R>(&mut self, work: impl FnOnce(&mut Sampler) -> R) -> R;

    /// The idle loop's: commits that wait.
    fn commits<R>(&mut self, work: impl FnOnce(&mut Commits) -> R) -> R;
}

/// The drive's end of the link, and what is done about what comes. Frames are
/// made in places `P`.
#[derive(Debug)]
pub struct LinkTask<P> {
    identity: Identity,
    start: u16,
    decoder: Decoder,
    link: Link,
    outgoing: Outgoing<P>,
    wants_reboot: bool,
    /// Blocks that were complete before what the next status has to tell.
    blocks_first: usize,
    /// What the last status has said.
    told: (State, Option<Fault>, Revision, bool),
}

impl<P: BorrowMut<Place>> LinkTask<P> {
    /// Of a drive that has just started.
    pub fn new(identity: Identity, start: u16) -> Self {
        Self {
            identity,
            start,
            decoder: Decoder::new(),
            link: Link::default(),
            outgoing: Outgoing::default(),
            wants_reboot: false,
            blocks_first: 0,
            told: (State::Disarmed, None, Revision::NONE, false),
        }
    }

    /// A byte from comms.
    pub fn received(&mut self, byte: u8, shared: &mut impl Shared, counters: &Counters) {
        let Some(frame) = self.decoder.push(byte) else {
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
                    return self.hear(&message, shared, counters);
                }
            }
            Some(Lane::Management) => {
                if let Some(question) = Question::of(body.payload) {
                    counters.count(DriveCounter::Frames);
                    return self.manage(question, shared);
                }
            }
            _ => {}
        }
        counters.count(DriveCounter::Foreign);
    }

    /// A message; by reference, as a commit is long.
    fn hear(&mut self, message: &ToDrive, shared: &mut impl Shared, counters: &Counters) {
        match message {
            ToDrive::Heartbeat(heartbeat) => {
                let now = shared.sampler(|sampler| sampler.next_tick());
                let heard =
                    shared.command(|command| command.safety_mut().hear(now, heartbeat, counters));
                if heard == Heard::Restarted {
                    self.link.forget();
                    shared.commits(Commits::forget);
                }
            }
            ToDrive::Commit {
                revision,
                checksum,
                piece,
            } => {
                let in_force = shared.command(|command| command.revision());
                shared.commits(|commits| {
                    commits.receive(*revision, *checksum, piece, in_force, counters);
                });
                self.link.changed();
            }
            ToDrive::Command {
                seen_tick,
                number,
                order,
            } => {
                let now = shared.sampler(|sampler| sampler.next_tick());
                if self.link.accepts(now, *seen_tick, *number, counters)
                    && let Some(result) = obey(now, *order, shared)
                {
                    self.link.finish(result);
                }
            }
        }
    }

    /// Goes on with the frame that is being made for comms, a piece, or begins
    /// the next in a place from `spare`; gives the frame whose last piece it
    /// was.
    pub fn next_frame(
        &mut self,
        spare: impl FnOnce() -> Option<P>,
        shared: &mut impl Shared,
        counters: &Counters,
    ) -> Option<Made<P>> {
        self.look_for_news(shared);
        if self.outgoing.is_idle() {
            self.begin(spare, shared, counters);
            return None;
        }
        let Some(next) = self.outgoing.next_sample() else {
            return self.outgoing.piece();
        };
        let piece = shared.command(|command| {
            let samples = command.block()?.samples.get(next..)?;
            samples.first_chunk::<PIECE_SAMPLES>().copied()
        })?;
        let frame = self.outgoing.samples(&piece)?;
        shared.command(Command::pop_block);
        self.blocks_first = self.blocks_first.saturating_sub(1);
        Some(frame)
    }

    /// What a status has to tell at once.
    fn look_for_news(&mut self, shared: &mut impl Shared) {
        let is_refused = shared.commits(|commits| commits.refused().is_some());
        let (outcome, tells, waiting) = shared.command(|command| {
            let revision = command.revision();
            let waiting = command.waiting_blocks();
            let safety = command.safety_mut();
            let tells = (safety.state(), safety.fault(), revision, is_refused);
            (safety.take_outcome(), tells, waiting)
        });
        if let Some(result) = outcome {
            self.link.finish(result);
        }
        if tells != self.told {
            self.told = tells;
            self.link.changed();
            self.blocks_first = waiting;
        }
    }

    /// Begins the next frame, if one is due: answers first, then blocks and
    /// statuses, in the order in which what they tell has happened, however
    /// slow the wire: a commit shows in the blocks after its status only.
    fn begin(
        &mut self,
        spare: impl FnOnce() -> Option<P>,
        shared: &mut impl Shared,
        counters: &Counters,
    ) -> Option<()> {
        if self.link.has_answer() {
            let place = spare()?;
            let answer = self.link.take_answer()?;
            return self.outgoing.begin_answer(place, &answer).ok();
        }
        let now = shared.sampler(|sampler| sampler.next_tick());
        let is_status_due = self.link.is_status_due(now);
        let has_block = shared.command(|command| command.block().is_some());
        if has_block && !(is_status_due && self.blocks_first == 0) {
            let place = spare()?;
            let outgoing = &mut self.outgoing;
            return shared.command(|command| outgoing.begin_block(place, command.block()?).ok());
        }
        if is_status_due {
            let place = spare()?;
            self.link.status_told(now);
            let status = self.status(now, shared, counters);
            return self.outgoing.begin_status(place, &status).ok();
        }
        None
    }

    fn status(&self, now: u64, shared: &mut impl Shared, counters: &Counters) -> DriveStatus {
        let refused = shared.commits(|commits| commits.refused());
        shared.command(|command| {
            let safety = command.safety();
            DriveStatus {
                tick: now,
                start: self.start,
                heard: safety.heard_start(),
                state: safety.state(),
                fault: safety.fault().map_or(0, Fault::code),
                revision: command.revision(),
                refused,
                last: self.link.last(),
                zeroed: command.is_zeroed(),
                polarity_proven: safety.polarity_proven(),
                counters: counters.all(),
            }
        })
    }

    /// Whether it was asked to start anew; once. The board does it.
    pub fn take_reboot(&mut self) -> bool {
        core::mem::take(&mut self.wants_reboot)
    }

    fn manage(&mut self, question: Question, shared: &mut impl Shared) {
        let is_live = shared.command(|command| {
            if question.what == What::Stop {
                command.safety_mut().disarm();
            }
            command.safety().is_live()
        });
        let done = match question.what {
            What::Hello | What::Stop => true,
            What::Reboot => {
                self.wants_reboot = !is_live;
                self.wants_reboot
            }
        };
        self.link.answer(question, &self.identity, done);
    }
}

/// Carries out an order; none if its end is still to come.
fn obey(now: u64, order: Order, shared: &mut impl Shared) -> Option<Result<(), DriveRefusal>> {
    match order {
        Order::Arm => {
            let lost_ticks = shared.sampler(|sampler| sampler.lost_ticks());
            shared.command(|command| {
                if command.revision() == Revision::NONE {
                    return Some(Err(DriveRefusal::NoParameters));
                }
                // How arming ends is still to come.
                command.safety_mut().arm(now, lost_ticks).err().map(Err)
            })
        }
        Order::Zero => {
            let is_live = shared.command(|command| {
                let is_live = command.safety().is_live();
                if !is_live {
                    command.set_zeroed();
                }
                is_live
            });
            if is_live {
                return Some(Err(DriveRefusal::Armed));
            }
            shared.sampler(Sampler::zero);
            Some(Ok(()))
        }
        Order::ClearFault => Some(shared.command(|command| {
            let line_is_on = command.line_is_on();
            command.safety_mut().clear(line_is_on)
        })),
    }
}
