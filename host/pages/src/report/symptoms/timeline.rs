//! The torque of a symptom over time with its states and events: of the whole run,
//! or, where that is more than can be distinguished, of its first part.

use crate::plot::Thinned;
use crepitus_scene::trace::SymptomEvent;

/// A stretch of time, s, in a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stay {
    pub(crate) from_s: f64,
    pub(crate) to_s: f64,
    pub(crate) state: u16,
}

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Timeline {
    pub(crate) line: Thinned,
    pub(crate) stays: Vec<Stay>,
    pub(crate) events: Vec<SymptomEvent>,
    open: Option<Stay>,
    /// Time at which there were too many stays or events, s.
    until_s: Option<f64>,
}

impl Timeline {
    /// Most states that are distinguished on a chart, and most events.
    pub(crate) const MOST: usize = 600;
    /// Bins of the line: more than a chart has pixels.
    pub(crate) const LINE: usize = 1600;

    pub(crate) fn new() -> Self {
        Self {
            line: Thinned::new(Self::LINE),
            stays: Vec::new(),
            events: Vec::new(),
            open: None,
            until_s: None,
        }
    }

    pub(crate) fn push(&mut self, time_s: f64, nm: f64) {
        if self.until_s.is_none() {
            self.line.push(time_s, nm);
            if let Some(open) = &mut self.open {
                open.to_s = time_s;
            }
        }
    }

    /// The state from now on.
    pub(crate) fn state(&mut self, time_s: f64, state: u16) {
        if self.until_s.is_some() || self.open.is_some_and(|open| open.state == state) {
            return;
        }
        self.close(time_s);
        self.open = Some(Stay {
            from_s: time_s,
            to_s: time_s,
            state,
        });
    }

    /// Ends the state, which is not known any more.
    pub(crate) fn gap(&mut self) {
        if let Some(open) = self.open {
            self.close(open.to_s);
        }
    }

    pub(crate) fn event(&mut self, event: &SymptomEvent) {
        if self.until_s.is_none() {
            if self.events.len() == Self::MOST {
                self.until_s = Some(event.time_s);
            } else {
                self.events.push(*event);
            }
        }
    }

    fn close(&mut self, time_s: f64) {
        let Some(open) = self.open.take() else {
            return;
        };
        // At rest nothing is shaded.
        if open.state > 0 && time_s > open.from_s {
            self.stays.push(Stay {
                to_s: time_s,
                ..open
            });
        }
        if self.stays.len() == Self::MOST {
            self.until_s = Some(time_s);
        }
    }

    pub(crate) fn finish(mut self) -> Self {
        self.gap();
        self
    }

    /// Time of its end, if that is before the end of the run, s.
    pub(crate) fn until_s(&self) -> Option<f64> {
        self.until_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_that_change_without_end_end_the_line() {
        let mut timeline = Timeline::new();
        for i in 0..100_000_u32 {
            let time_s = f64::from(i) * 1e-3;
            timeline.state(time_s, u16::from(i % 10 < 5));
            timeline.push(time_s, 1.0);
        }
        let timeline = timeline.finish();
        assert_eq!(timeline.stays.len(), Timeline::MOST);
        let until_s = timeline.until_s().expect("too many");
        assert!((until_s - 6.0).abs() < 0.02, "{until_s}");
        let last = timeline.line.points().last().expect("a line").x;
        assert!(last <= until_s && until_s - last < 2e-3);
    }

    #[test]
    fn what_is_not_known_is_not_shaded() {
        let mut timeline = Timeline::new();
        for (time_s, state) in [(0.0, 0), (1.0, 1), (2.0, 1)] {
            timeline.state(time_s, state);
            timeline.push(time_s, 0.0);
        }
        timeline.gap();
        timeline.state(5.0, 2);
        timeline.push(5.0, 0.0);
        timeline.push(6.0, 0.0);
        let stays = timeline.finish().stays;
        let ends: Vec<_> = stays.iter().map(|s| (s.from_s, s.to_s, s.state)).collect();
        assert_eq!(ends, [(1.0, 2.0, 1), (5.0, 6.0, 2)]);
    }
}
