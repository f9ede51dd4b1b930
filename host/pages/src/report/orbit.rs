//! The path of the imaginary object against the shaft angle over a stretch
//! of time, in bounded memory.
//!
//! Points at events are kept; of the rows between them every second goes
//! whenever the memory is full.

use crepitus_model::Phase;
use crepitus_scene::trace::EventRecord;

use crate::plot::Point;
use crate::report::channels::Sample;

#[derive(Clone, Copy, Debug)]
struct Stop {
    time: f64,
    angle: f64,
    theta: f64,
    /// The phase that starts here, where it changes.
    begins: Option<Phase>,
}

/// A stretch of the path in one phase: (angle, θ), rad.
#[derive(Clone, Debug)]
pub(crate) struct Segment {
    pub(crate) phase: Phase,
    pub(crate) points: Vec<Point>,
}

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Orbit {
    stops: Vec<Stop>,
    stride: u64,
    seen: u64,
    /// Time, angle and velocity of the last row, to place the next event.
    last: Option<(f64, f64, f64)>,
    phase: Option<Phase>,
}

impl Orbit {
    const CAPACITY: usize = 4000;

    pub(crate) fn new() -> Self {
        Self {
            stops: Vec::new(),
            stride: 1,
            seen: 0,
            last: None,
            phase: None,
        }
    }

    pub(crate) fn row(&mut self, sample: &Sample) {
        if !(sample.time.is_finite() && sample.angle.is_finite() && sample.theta.is_finite()) {
            return;
        }
        self.last = Some((sample.time, sample.angle, sample.omega));
        let begins = if self.phase.is_none() {
            sample.phase
        } else {
            None
        };
        self.phase = self.phase.or(sample.phase);
        if self.seen.is_multiple_of(self.stride) || begins.is_some() {
            self.push(Stop {
                time: sample.time,
                angle: sample.angle,
                theta: sample.theta,
                begins,
            });
        }
        self.seen += 1;
    }

    pub(crate) fn event(&mut self, event: &EventRecord) {
        let to = Phase::from_sign(event.to);
        self.phase = Some(to);
        let Some((time, angle, omega)) = self.last else {
            return;
        };
        let angle = angle + omega * (event.time_s - time);
        if angle.is_finite() && event.theta_rad.is_finite() {
            self.push(Stop {
                time: event.time_s,
                angle,
                theta: event.theta_rad,
                begins: Some(to),
            });
        }
    }

    fn push(&mut self, stop: Stop) {
        if self.stops.len() >= Self::CAPACITY {
            let mut odd = false;
            self.stops.retain(|stop| {
                odd = !odd;
                odd || stop.begins.is_some()
            });
            self.stride = self.stride.saturating_mul(2);
        }
        // Full of events, which a window bounds: more would show nothing new.
        if self.stops.len() < Self::CAPACITY {
            self.stops.push(stop);
        }
    }

    /// The path between two times, cut where the phase changes.
    pub(crate) fn segments(&self, from: f64, to: f64) -> Vec<Segment> {
        let mut segments: Vec<Segment> = Vec::new();
        let mut phase = Phase::Stick;
        for stop in &self.stops {
            let point = Point::new(stop.angle, stop.theta);
            if let Some(begins) = stop.begins {
                phase = begins;
            }
            if stop.time < from || stop.time > to {
                continue;
            }
            match segments.last_mut() {
                Some(segment) => {
                    segment.points.push(point);
                    if stop.begins.is_some() {
                        segments.push(Segment {
                            phase,
                            points: vec![point],
                        });
                    }
                }
                None => segments.push(Segment {
                    phase,
                    points: vec![point],
                }),
            }
        }
        segments.retain(|segment| segment.points.len() > 1);
        segments
    }

    #[cfg(test)]
    pub(crate) fn stored(&self) -> usize {
        self.stops.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::EventKind;

    fn sample(time: f64, theta: f64) -> Sample {
        Sample {
            time,
            angle: time,
            omega: 1.0,
            phase: Some(Phase::Stick),
            theta,
            theta_dot: 1.0,
            torque: 0.0,
            ..Sample::nothing()
        }
    }

    #[test]
    fn events_cut_the_path_and_survive_thinning() {
        let mut orbit = Orbit::new();
        for i in 0..20_000_u32 {
            let time = f64::from(i) * 1e-3;
            if i == 5001 {
                orbit.event(&EventRecord {
                    time_s: 5.0005,
                    kind: EventKind::Break,
                    from: 0,
                    to: 1,
                    theta_rad: 3.0,
                    omega_rad_s: 1.0,
                    torque_before_nm: 0.4,
                    torque_after_nm: 0.2,
                });
            }
            orbit.row(&sample(time, if i == 0 { f64::NAN } else { 0.0 }));
        }
        assert!(orbit.stored() <= Orbit::CAPACITY);
        let segments = orbit.segments(0.0, 100.0);
        assert_eq!(segments.len(), 2);
        assert_eq!(segments[0].points.last(), Some(&Point::new(5.0005, 3.0)));
        assert_eq!(segments[1].points.first(), Some(&Point::new(5.0005, 3.0)));
        assert_eq!(segments[1].phase.sign(), 1);
    }
}
