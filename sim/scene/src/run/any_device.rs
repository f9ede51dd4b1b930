//! A device of any type behind one interface, so that the loop around it is compiled once for
//! each plant and not for each device, too.

use super::command::{Command, Stage};
use super::held_back::TankTotals;
use super::reached::Reached;
use super::recorder::Happened;
use super::tally::Tally;
use crate::walk::{Cut, Walk};
use crepitus_model::render::Shown;
use crepitus_plant::Motion;
use crepitus_plant::chain::Body;
use crepitus_plant::mechanics::Driven;

/// A tick, or a part of one, and what the shaft does in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) start_s: f64,
    pub(super) length_s: f64,
    pub(super) from: Body,
    pub(super) to: Body,
}

impl Span {
    /// Parts of the span, between breaks of the motion; one at its start only tells what it starts
    /// with.
    pub(super) fn parts(&self, cuts: &[Cut]) -> Vec<Self> {
        let mut parts = Vec::with_capacity(cuts.len() + 1);
        let mut rest = *self;
        for cut in cuts {
            let length_s = cut.time_s - rest.start_s;
            if length_s > 0.0 {
                parts.push(Self {
                    length_s,
                    to: cut.before,
                    ..rest
                });
            }
            rest.start_s = cut.time_s;
            rest.length_s -= length_s;
            rest.from = cut.after;
        }
        parts.push(rest);
        parts
    }
}

/// The device's renderer, on the shaft as measured.
pub(super) trait Device: Send {
    /// Copy with its state.
    fn boxed(&self) -> Box<dyn Device>;

    /// Output from now to the end of the next tick.
    fn shown(&self) -> Shown<f64>;

    /// Command of that output, which is noted in the stages that the scene lists.
    fn command(&self, stages: &mut [Stage]) -> Command;

    /// One tick, which began at `start_s` and in which the shaft moved so. What
    /// happens is added to `events`, of each effect in the order of time. Returns the next
    /// command, and accounts for this tick in `stages`.
    fn tick(
        &mut self,
        start_s: f64,
        shaft: (&Body, &Body),
        stages: &mut [Stage],
        events: &mut Vec<Happened>,
    ) -> Command;

    /// As many ticks in one go as can be: up to tick `until`, a break of the motion, or one in
    /// which something happens, whose events are in `events` and whose end is not yet accounted
    /// for in `at`. A device that knows no short cut makes none.
    fn go_ahead<M: Driven>(
        &mut self,
        _plant: &mut M,
        _walk: &mut Walk<&Motion>,
        _at: &mut Reached,
        _until: u64,
        _stages: &mut [Stage],
        _events: &mut Vec<Happened>,
    ) where
        Self: Sized,
    {
    }

    /// One tick of a bare solver, in the parts that the motion breaks it into.
    fn tick_in_parts(
        &mut self,
        tick: &Span,
        cuts: &[Cut],
        stages: &mut [Stage],
        events: &mut Vec<Happened>,
    ) -> Command;

    /// Writes its columns.
    fn write(&self, row: &mut Vec<f64>);

    /// Account of what the tank held back so far.
    fn tank(&self) -> TankTotals;

    /// Returns whether its state is still numbers.
    fn is_finite(&self) -> bool;

    /// Completes the energy balance of the object, if there is one, and returns in how many
    /// steps it had as many events as a step may have.
    fn finish(self: Box<Self>, time_s: f64) -> Option<(Tally, u64)>;
}

impl Clone for Box<dyn Device> {
    fn clone(&self) -> Self {
        self.as_ref().boxed()
    }
}

impl Device for Box<dyn Device> {
    fn boxed(&self) -> Box<dyn Device> {
        self.clone()
    }

    fn shown(&self) -> Shown<f64> {
        self.as_ref().shown()
    }

    fn command(&self, stages: &mut [Stage]) -> Command {
        self.as_ref().command(stages)
    }

    #[inline]
    fn tick(
        &mut self,
        start_s: f64,
        shaft: (&Body, &Body),
        stages: &mut [Stage],
        events: &mut Vec<Happened>,
    ) -> Command {
        self.as_mut().tick(start_s, shaft, stages, events)
    }

    fn tick_in_parts(
        &mut self,
        tick: &Span,
        cuts: &[Cut],
        stages: &mut [Stage],
        events: &mut Vec<Happened>,
    ) -> Command {
        self.as_mut().tick_in_parts(tick, cuts, stages, events)
    }

    fn write(&self, row: &mut Vec<f64>) {
        self.as_ref().write(row);
    }

    fn tank(&self) -> TankTotals {
        self.as_ref().tank()
    }

    fn is_finite(&self) -> bool {
        self.as_ref().is_finite()
    }

    fn finish(self: Box<Self>, time_s: f64) -> Option<(Tally, u64)> {
        Device::finish(*self, time_s)
    }
}
