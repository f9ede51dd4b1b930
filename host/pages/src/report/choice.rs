//! Selection of the windows for zoom charts, in one pass.
//!
//! Two: the onset, from the first break on, and the fastest stretch. For the
//! second, one candidate after the other is recorded, each of whole cycles,
//! and the better of two stays.

use std::collections::VecDeque;

use crepitus_model::EventKind;
use crepitus_scene::trace::EventRecord;

use crate::report::channels::Sample;
use crate::report::window::Window;

/// Whole cycles in a window.
pub(crate) const CYCLES: usize = 4;

#[derive(Debug)]
enum Onset {
    /// The latest rows before the first event, to lead in.
    Ahead(VecDeque<Sample>),
    Running(Window),
    Done(Window),
}

/// See the module.
#[derive(Debug)]
pub(crate) struct Choice {
    onset: Onset,
    candidate: Option<Window>,
    fastest: Option<Window>,
}

impl Choice {
    /// Rows kept to lead in to the first event.
    const LEAD: usize = 4096;

    pub(crate) fn new() -> Self {
        Self {
            onset: Onset::Ahead(VecDeque::new()),
            candidate: None,
            fastest: None,
        }
    }

    pub(crate) fn row(&mut self, sample: &Sample) {
        match &mut self.onset {
            Onset::Ahead(lead) => {
                if lead.len() == Self::LEAD {
                    lead.pop_front();
                }
                lead.push_back(*sample);
            }
            Onset::Running(window) => window.row(sample),
            Onset::Done(_) => {}
        }
        if let Some(window) = &mut self.candidate {
            window.row(sample);
        }
    }

    /// Rows are missing before the next one: no window reaches across.
    pub(crate) fn gap(&mut self) {
        self.candidate = None;
        self.onset = match std::mem::replace(&mut self.onset, Onset::Ahead(VecDeque::new())) {
            Onset::Running(window) => Onset::Done(window),
            Onset::Ahead(_) => Onset::Ahead(VecDeque::new()),
            done @ Onset::Done(_) => done,
        };
    }

    pub(crate) fn event(&mut self, event: &EventRecord) {
        self.onset_event(event);
        self.candidate_event(event);
    }

    fn onset_event(&mut self, event: &EventRecord) {
        self.onset = match std::mem::replace(&mut self.onset, Onset::Ahead(VecDeque::new())) {
            Onset::Ahead(lead) => {
                let mut window = Window::new();
                for sample in &lead {
                    window.row(sample);
                }
                window.event(event);
                Onset::Running(window)
            }
            Onset::Running(mut window) => {
                window.event(event);
                if window.count(EventKind::Break) > CYCLES || window.overflowed() {
                    Onset::Done(window)
                } else {
                    Onset::Running(window)
                }
            }
            done @ Onset::Done(_) => done,
        };
    }

    /// A candidate starts where a stick starts and ends where the stick
    /// `CYCLES` later breaks: whole cycles, and the last rise of the torque.
    fn candidate_event(&mut self, event: &EventRecord) {
        match &mut self.candidate {
            None if event.kind == EventKind::Stick => {
                let mut window = Window::new();
                window.event(event);
                self.candidate = Some(window);
            }
            None => {}
            Some(window) => {
                window.event(event);
                if window.overflowed() {
                    self.candidate = None;
                } else if event.kind == EventKind::Break && window.count(EventKind::Stick) > CYCLES
                {
                    let slower = |best: &Window| best.mean_speed() < window.mean_speed();
                    if self.fastest.as_ref().is_none_or(slower) {
                        self.fastest = self.candidate.take();
                    } else {
                        self.candidate = None;
                    }
                }
            }
        }
    }

    /// The onset, if anything happened, and the fastest stretch, if it is
    /// another one and clearly faster.
    pub(crate) fn finish(self) -> (Option<Window>, Option<Window>) {
        let onset = match self.onset {
            Onset::Ahead(_) => None,
            Onset::Running(window) | Onset::Done(window) => Some(window),
        };
        let fastest = self.fastest.filter(|fastest| {
            onset.as_ref().is_none_or(|onset| {
                fastest.time.low >= onset.time.high
                    && fastest.mean_speed() > 1.05 * onset.mean_speed()
            })
        });
        (onset, fastest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::channels::Channels;
    use crate::report::fixture::{Motion, Run};
    use std::cell::RefCell;

    fn choose(motion: Motion, duration: f64) -> (Option<Window>, Option<Window>) {
        let channels = Channels::find(&Run::columns(true, false));
        let choice = RefCell::new(Choice::new());
        Run::new(motion, duration, 5e-5).play(
            |row| choice.borrow_mut().row(&channels.sample(row)),
            |event| choice.borrow_mut().event(event),
        );
        choice.into_inner().finish()
    }

    #[test]
    fn windows_hold_whole_cycles() {
        let (onset, fastest) = choose(
            Motion::Sine {
                amplitude: 0.8,
                frequency: 0.25,
                phase: 2.0,
            },
            8.0,
        );
        let onset = onset.expect("there are events");
        assert_eq!(onset.count(EventKind::Break), CYCLES + 1);
        assert_eq!(onset.count(EventKind::Stick), CYCLES);
        let fastest = fastest.expect("a faster part follows");
        assert_eq!(fastest.count(EventKind::Break), CYCLES + 1);
        assert_eq!(fastest.count(EventKind::Stick), CYCLES + 1);
        let peak = 0.8 * std::f64::consts::TAU * 0.25;
        assert!(fastest.mean_speed() > 0.95 * peak);
        assert!(fastest.time.low > onset.time.high);
    }

    #[test]
    fn a_steady_run_has_one_window() {
        let (onset, fastest) = choose(Motion::Constant { speed: 1.0 }, 3.0);
        assert!(onset.is_some());
        assert!(fastest.is_none());
    }

    #[test]
    fn nothing_happens_nothing_is_chosen() {
        let (onset, fastest) = choose(
            Motion::Sine {
                amplitude: 5e-4,
                frequency: 1.0,
                phase: 0.0,
            },
            2.0,
        );
        assert!(onset.is_none());
        assert!(fastest.is_none());
    }
}
