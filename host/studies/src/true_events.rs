//! Events with their times, and the true ones of a scene.

use crepitus_model::{Event, EventKind, Phase, Real, Sense, Settings, Validated};
use crepitus_plant::Motion;
use crepitus_scene::reference::{Follow, Reference};
use std::convert::Infallible;
use std::ops::ControlFlow;

/// Number of events between two polls.
const EVENTS_PER_POLL: usize = 1 << 12;

/// An event for comparison: time, kind and sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedEvent {
    /// Time since the start of the run, s.
    pub time_s: f64,
    /// Kind of the event.
    pub kind: EventKind,
    /// Sense of the slip that begins or ends with it.
    pub sense: Sense,
}

impl TimedEvent {
    /// An event of a joint at `time_s`.
    pub fn new<F: Real>(time_s: f64, event: &Event<F>) -> Self {
        let sense = match (event.to, event.from) {
            (Phase::Slip(sense), _) | (Phase::Stick, Phase::Slip(sense)) => sense,
            // No event leads from stick to stick.
            (Phase::Stick, Phase::Stick) => Sense::Positive,
        };
        Self {
            time_s,
            kind: event.kind,
            sense,
        }
    }

    /// Returns whether both are the same kind of event in the same sense.
    pub fn is_like(&self, other: &Self) -> bool {
        self.kind == other.kind && self.sense == other.sense
    }
}

/// A true event with the torque on both sides of it and the object after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrueEvent {
    /// The event.
    pub event: TimedEvent,
    /// Angle θ of the object just after, rad.
    pub theta_rad: f64,
    /// Torque shown just before, N·m.
    pub torque_before_nm: f64,
    /// Torque shown just after, N·m.
    pub torque_after_nm: f64,
}

/// The events of the reference within `duration_s`, in the order of time.
pub fn true_events(
    settings: &Validated<Settings>,
    motion: &Motion,
    duration_s: f64,
) -> Vec<TrueEvent> {
    match true_events_while(settings, motion, duration_s, || Ok::<_, Infallible>(())) {
        Ok(events) => events,
    }
}

/// [`true_events`] with calls of `poll` now and then.
///
/// # Errors
/// Error of `poll`.
pub fn true_events_while<E>(
    settings: &Validated<Settings>,
    motion: &Motion,
    duration_s: f64,
    poll: impl FnMut() -> Result<(), E>,
) -> Result<Vec<TrueEvent>, E> {
    let mut collected = Collected {
        events: Vec::new(),
        poll,
    };
    match Reference::new(settings, motion).follow(duration_s, &mut collected) {
        ControlFlow::Continue(()) => Ok(collected.events),
        ControlFlow::Break(error) => Err(error),
    }
}

/// Collects events until `poll` ends it.
struct Collected<G> {
    events: Vec<TrueEvent>,
    poll: G,
}

impl<E, G: FnMut() -> Result<(), E>> Collected<G> {
    fn ask(&mut self) -> ControlFlow<E> {
        match (self.poll)() {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => ControlFlow::Break(error),
        }
    }
}

impl<E, G: FnMut() -> Result<(), E>> Follow for Collected<G> {
    type Stop = E;

    fn event(&mut self, event: Event<f64>) -> ControlFlow<E> {
        self.events.push(TrueEvent {
            // The reference has no step: its fraction is the time.
            event: TimedEvent::new(event.fraction, &event),
            theta_rad: event.theta_rad,
            torque_before_nm: event.torque_before_nm,
            torque_after_nm: event.torque_after_nm,
        });
        if self.events.len().is_multiple_of(EVENTS_PER_POLL) {
            self.ask()?;
        }
        ControlFlow::Continue(())
    }

    fn poll(&mut self, _: f64) -> ControlFlow<E> {
        self.ask()
    }
}
