//! `link`, the task of lowest priority: what comms wants, and what it is told.

use crate::counters::Counters;
use crate::drive::command::Command;
use crate::drive::commits::Commits;
use crate::drive::link::{Inbound, Link};
use crate::drive::sampler::Sampler;
use crate::drive::vigil::Heard;
use crepitus_protocol::frame::Frame;
use crepitus_protocol::link::{DriveRefusal, DriveStatus, Order, Outcome, ToDrive};
use crepitus_protocol::management::{Identity, Question, What};
use crepitus_protocol::{Fault, Revision, State};

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

/// The drive's end of the link, and what is done about what comes.
#[derive(Clone, Debug)]
pub struct LinkTask {
    identity: Identity,
    start: u16,
    link: Link,
    wants_reboot: bool,
    /// What the last status has said.
    told: (State, Option<Fault>, Revision, bool),
}

impl LinkTask {
    /// Of a drive that has just started.
    pub fn new(identity: Identity, start: u16) -> Self {
        Self {
            identity,
            start,
            link: Link::default(),
            wants_reboot: false,
            told: (State::Disarmed, None, Revision::NONE, false),
        }
    }

    /// A byte from comms.
    pub fn received(&mut self, byte: u8, shared: &mut impl Shared, counters: &Counters) {
        match self.link.receive(byte, counters) {
            None => {}
            Some(Inbound::Management(question)) => self.manage(question, shared),
            Some(Inbound::Message(ToDrive::Heartbeat(heartbeat))) => {
                let now = shared.sampler(|sampler| sampler.next_tick());
                let heard =
                    shared.command(|command| command.safety_mut().hear(now, &heartbeat, counters));
                if heard == Heard::Restarted {
                    self.link.forget();
                    shared.commits(Commits::forget);
                }
            }
            Some(Inbound::Message(ToDrive::Commit { revision, values })) => {
                let in_force = shared.command(|command| command.revision());
                shared.commits(|commits| commits.hear(revision, &values, in_force, counters));
                self.link.changed();
            }
            Some(Inbound::Message(ToDrive::Command {
                seen_tick,
                number,
                order,
            })) => {
                let now = shared.sampler(|sampler| sampler.next_tick());
                if self.link.accepts(now, seen_tick, number, counters)
                    && let Some(result) = obey(now, order, shared)
                {
                    self.link.finish(result);
                }
            }
        }
    }

    /// The next frame for comms, if there is one.
    pub fn next_frame(&mut self, shared: &mut impl Shared, counters: &Counters) -> Option<Frame> {
        let now = shared.sampler(|sampler| sampler.next_tick());
        let refused = shared.commits(|commits| commits.refused());
        let (start, told) = (self.start, self.told);
        let (outcome, mut status) = shared.command(|command| {
            let revision = command.revision();
            let zeroed = command.is_zeroed();
            let safety = command.safety_mut();
            let status = DriveStatus {
                tick: now,
                start,
                heard: safety.heard_start(),
                state: safety.state(),
                fault: safety.fault().map_or(0, Fault::code),
                revision,
                refused,
                last: None,
                zeroed,
                polarity_proven: safety.polarity_proven(),
                counters: counters.all(),
            };
            (safety.take_outcome(), (status, safety.fault()))
        });
        if let Some(result) = outcome {
            self.link.finish(result);
        }
        let tells = (
            status.0.state,
            status.1,
            status.0.revision,
            refused.is_some(),
        );
        if tells != told {
            self.told = tells;
            self.link.changed();
        }
        self.link.next_frame(
            now,
            |last: Option<Outcome>| {
                status.0.last = last;
                status.0
            },
            || shared.command(Command::pop_block),
        )
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
