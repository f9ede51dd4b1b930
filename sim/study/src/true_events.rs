//! Events with their times, and the true ones of a scene.

use crepitus_model::{Event, EventKind, Phase, Real, Sense, Settings, Validated};
use crepitus_plant::Motion;
use crepitus_scene::reference::Reference;

/// An event as it is compared: when, what, and which way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedEvent {
    /// Time since the start of the run, s.
    pub time_s: f64,
    /// What happened.
    pub kind: EventKind,
    /// Of the slip that begins with it, or ends with it.
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

    /// Whether both are the same kind of event in the same sense.
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
    let mut events = Vec::new();
    Reference::new(settings, motion).advance(duration_s, |event| {
        events.push(TrueEvent {
            // The reference has no step: its fraction is the time.
            event: TimedEvent::new(event.fraction, &event),
            theta_rad: event.theta_rad,
            torque_before_nm: event.torque_before_nm,
            torque_after_nm: event.torque_after_nm,
        });
    });
    events
}
