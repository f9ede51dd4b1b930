//! Followers of a run of the reference: its events, and a way to end it.

use crepitus_model::Event;
use std::convert::Infallible;
use std::ops::ControlFlow;

/// Follows a run of the reference from event to event.
///
/// A closure `FnMut(Event<f64>)` follows to the end.
pub trait Follow {
    /// Reason for the early end of the run.
    type Stop;

    /// An event; its `fraction` is the time since the start of the run, s.
    fn event(&mut self, event: Event<f64>) -> ControlFlow<Self::Stop>;

    /// Called now and then where nothing happens, at `time_s` or later: a
    /// search may be long.
    fn poll(&mut self, time_s: f64) -> ControlFlow<Self::Stop>;
}

impl<F: FnMut(Event<f64>)> Follow for F {
    type Stop = Infallible;

    fn event(&mut self, event: Event<f64>) -> ControlFlow<Infallible> {
        self(event);
        ControlFlow::Continue(())
    }

    fn poll(&mut self, _: f64) -> ControlFlow<Infallible> {
        ControlFlow::Continue(())
    }
}
