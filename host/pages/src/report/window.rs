//! A stretch of a run recorded closely enough to zoom into, in bounded
//! memory: lines, the phases with their edges at event times, the events.

use crepitus_model::{EventKind, Phase};
use crepitus_plant::Extremes;
use crepitus_scene::trace::EventRecord;

use crate::plot::Thinned;
use crate::report::channels::Sample;
use crate::report::orbit::Orbit;

/// A stretch of time in one phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) phase: Phase,
}

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Window {
    pub(crate) torque: Thinned,
    pub(crate) omega: Thinned,
    pub(crate) theta_dot: Thinned,
    pub(crate) motor: Thinned,
    pub(crate) hand_fast: Thinned,
    pub(crate) orbit: Orbit,
    /// Times of its first and last row or event.
    pub(crate) time: Extremes<f64>,
    events: Vec<EventRecord>,
    /// No phase: the object is off.
    changes: Vec<(f64, Option<Phase>)>,
    overflowed: bool,
    speed_sum: f64,
    speed_count: u64,
}

impl Window {
    /// Bins of each line: about twice the pixels across a chart.
    const LINE: usize = 1600;
    /// More events than this cannot be distinguished in one chart.
    pub(crate) const EVENTS: usize = 120;

    pub(crate) fn new() -> Self {
        Self {
            torque: Thinned::new(Self::LINE),
            omega: Thinned::new(Self::LINE),
            theta_dot: Thinned::new(Self::LINE),
            motor: Thinned::new(Self::LINE),
            hand_fast: Thinned::new(Self::LINE),
            orbit: Orbit::new(),
            time: Extremes::default(),
            events: Vec::new(),
            changes: Vec::new(),
            overflowed: false,
            speed_sum: 0.0,
            speed_count: 0,
        }
    }

    pub(crate) fn row(&mut self, sample: &Sample) {
        self.time.add(sample.time);
        self.torque.push(sample.time, sample.torque);
        self.count_speed(sample.omega);
        if self.overflowed {
            return;
        }
        self.omega.push(sample.time, sample.omega);
        self.theta_dot.push(sample.time, sample.theta_dot);
        self.motor.push(sample.time, sample.motor_torque);
        self.hand_fast.push(sample.time, sample.hand_fast);
        self.orbit.row(sample);
        // With events, only they end a phase, unless the object goes off.
        if sample.is_off {
            self.change(sample.time, None);
        } else if (self.events.is_empty() || self.is_off())
            && let Some(phase) = sample.phase
        {
            self.change(sample.time, Some(phase));
        }
    }

    pub(crate) fn event(&mut self, event: &EventRecord) {
        let time = event.time_s;
        self.time.add(time);
        // Both sides of the jump, so that it is upright however far apart the
        // rows are.
        self.torque.push(time, event.torque_before_nm);
        self.torque.push(time, event.torque_after_nm);
        self.count_speed(event.omega_rad_s);
        self.overflowed |= self.events.len() >= Self::EVENTS;
        if self.overflowed {
            return;
        }
        self.omega.push(time, event.omega_rad_s);
        if event.kind != EventKind::Reverse {
            // At both ends of a stick the object moves with the shaft.
            self.theta_dot.push(time, event.omega_rad_s);
        }
        self.orbit.event(event);
        if self.changes.is_empty() || self.is_off() {
            self.change(time, Some(Phase::from_sign(event.from)));
        }
        self.events.push(*event);
        self.change(time, Some(Phase::from_sign(event.to)));
    }

    fn count_speed(&mut self, omega: f64) {
        if omega.is_finite() {
            self.speed_sum += omega.abs();
            self.speed_count += 1;
        }
    }

    /// Returns whether crepitus was off in the last row.
    fn is_off(&self) -> bool {
        self.changes
            .last()
            .is_some_and(|(_, phase)| phase.is_none())
    }

    fn change(&mut self, time: f64, phase: Option<Phase>) {
        if self.changes.last().map(|(_, last)| *last) == Some(phase) {
            return;
        }
        if self.changes.len() >= 2 * Self::EVENTS {
            self.overflowed = true;
        } else {
            self.changes.push((time, phase));
        }
    }

    /// Returns whether more happened than one chart can show. From then on only the
    /// torque is recorded.
    pub(crate) fn overflowed(&self) -> bool {
        self.overflowed
    }

    pub(crate) fn events(&self) -> &[EventRecord] {
        &self.events
    }

    pub(crate) fn count(&self, kind: EventKind) -> usize {
        self.events.iter().filter(|e| e.kind == kind).count()
    }

    /// Mean of |Ω|, rad/s; zero without rows.
    pub(crate) fn mean_speed(&self) -> f64 {
        if self.speed_count == 0 {
            0.0
        } else {
            self.speed_sum / self.speed_count as f64
        }
    }

    /// The phases between two times.
    pub(crate) fn spans(&self, from: f64, to: f64) -> Vec<Span> {
        let ends = self
            .changes
            .iter()
            .skip(1)
            .map(|(time, _)| *time)
            .chain([self.time.high]);
        self.changes
            .iter()
            .zip(ends)
            .filter_map(|(&(start, phase), end)| {
                Some(Span {
                    from: start.max(from),
                    to: end.min(to),
                    phase: phase?,
                })
            })
            .filter(|span| span.to > span.from)
            .collect()
    }

    /// The time worth showing: the events and at most one cycle around them,
    /// so that a long rest before or after does not squeeze them.
    pub(crate) fn view(&self) -> (f64, f64) {
        let (Some(first), Some(last)) = (self.events.first(), self.events.last()) else {
            return (self.time.low, self.time.high);
        };
        let cycle = (last.time_s - first.time_s) / (self.count(EventKind::Break).max(2) - 1) as f64;
        if cycle > 0.0 {
            (
                self.time.low.max(first.time_s - cycle),
                self.time.high.min(last.time_s + cycle),
            )
        } else {
            (self.time.low, self.time.high)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::{Motion, Run};

    #[test]
    fn phases_change_at_event_times_not_at_rows() {
        let mut window = Window::new();
        let channels = crate::report::channels::Channels::find(&Run::columns(true, false));
        Run::new(Motion::Constant { speed: 1.0 }, 0.1, 1e-3)
            .play(|row| window.row(&channels.sample(row)), |_| {});
        let by_rows = window.spans(0.0, 1.0);
        assert!(
            by_rows
                .iter()
                .all(|s| (s.from / 1e-3).fract().abs() < 1e-6
                    || (s.from / 1e-3).fract() > 1.0 - 1e-6)
        );

        let run = Run::new(Motion::Constant { speed: 1.0 }, 0.1, 1e-3);
        let window = std::cell::RefCell::new(Window::new());
        run.play(
            |row| window.borrow_mut().row(&channels.sample(row)),
            |event| window.borrow_mut().event(event),
        );
        let window = window.into_inner();
        let spans = window.spans(0.0, 1.0);
        let expected: Vec<f64> = window.events().iter().map(|e| e.time_s).collect();
        let edges: Vec<f64> = spans.iter().skip(1).map(|s| s.from).collect();
        assert_eq!(edges, expected);
        assert!(!window.overflowed());
    }

    #[test]
    fn no_phase_is_shaded_while_the_object_is_off() {
        let at = |time, phase, is_off| Sample {
            time,
            phase,
            is_off,
            ..Sample::nothing()
        };
        let stick = Some(Phase::Stick);
        let span = |from, to| Span {
            from,
            to,
            phase: Phase::Stick,
        };
        let window = |before: Option<&EventRecord>| {
            let mut window = Window::new();
            window.row(&at(0.0, stick, false));
            if let Some(event) = before {
                window.event(event);
            }
            for sample in [
                at(1.0, None, true),
                at(2.0, None, true),
                at(3.0, stick, false),
                at(4.0, stick, false),
            ] {
                window.row(&sample);
            }
            window.spans(0.0, 9.0)
        };
        assert_eq!(window(None), [span(0.0, 1.0), span(3.0, 4.0)]);
        let slipped = EventRecord {
            time_s: 0.5,
            kind: EventKind::Break,
            from: 0,
            to: 1,
            theta_rad: 0.0,
            omega_rad_s: 1.0,
            torque_before_nm: 0.4,
            torque_after_nm: 0.2,
        };
        let slip = Span {
            phase: Phase::from_sign(1),
            ..span(0.5, 1.0)
        };
        let expected = [span(0.0, 0.5), slip, span(3.0, 4.0)];
        assert_eq!(window(Some(&slipped)), expected);
        // A row without the column is no object that is off.
        let mut without = Window::new();
        without.row(&at(0.0, None, false));
        without.event(&slipped);
        without.row(&at(1.0, None, false));
        assert_eq!(
            without.spans(0.0, 9.0),
            [Span {
                from: 0.5,
                to: 1.0,
                ..slip
            }]
        );
    }

    #[test]
    fn more_events_than_fit_are_flagged_not_stored() {
        let channels = crate::report::channels::Channels::find(&Run::columns(true, false));
        let window = std::cell::RefCell::new(Window::new());
        Run::new(Motion::Constant { speed: 1.0 }, 10.0, 1e-3).play(
            |row| window.borrow_mut().row(&channels.sample(row)),
            |event| window.borrow_mut().event(event),
        );
        let window = window.into_inner();
        assert!(window.overflowed());
        assert_eq!(window.events().len(), Window::EVENTS);
        assert!(window.torque.stored() <= Window::LINE);
    }
}
