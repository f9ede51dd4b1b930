//! When a slip of the reference solver meets the shaft's velocity.

use super::first_root::{Sample, first_root};
use super::{Reference, Slip};

/// A slip at a steady speed that began with the velocity of the shaft: one that
/// begins like it ends like it. At a constant speed every slip does.
#[derive(Clone, Copy, Debug)]
pub(super) struct SteadySlip {
    x: f64,
    v: f64,
    duration_s: f64,
    x_end: f64,
}

impl SteadySlip {
    /// Duration, s, and x at its end, if it began with this x and v.
    pub(super) fn for_state(&self, x: f64, v: f64) -> Option<(f64, f64)> {
        (x == self.x && v == self.v).then_some((self.duration_s, self.x_end))
    }

    /// Whether `slip` is this one again.
    fn repeats(&self, slip: &Slip, reference: &Reference<'_>) -> bool {
        slip.x == self.x && slip.v == self.v && reference.is_steady(slip)
    }
}

impl Reference<'_> {
    /// The next velocity match of a slip up to `to_s`.
    pub(super) fn find_match(&mut self, slip: &Slip, to_s: f64) -> Option<f64> {
        if let Some(steady) = self.steady.filter(|s| s.repeats(slip, self)) {
            let time_s = slip.start_s + steady.duration_s;
            if time_s <= to_s {
                return Some(time_s);
            }
        }
        let time_s = self.search(slip, to_s)?;
        if self.is_steady(slip) {
            self.steady = Some(SteadySlip {
                x: slip.x,
                v: slip.v,
                duration_s: time_s - slip.start_s,
                x_end: self.swing(slip, time_s).0,
            });
        }
        Some(time_s)
    }

    fn search(&self, slip: &Slip, to_s: f64) -> Option<f64> {
        let from_s = self.time_s.max(slip.apart_s);
        if from_s > to_s {
            return None;
        }
        let motion_bound = self.piece.bounds(from_s, to_s).omega_ddot;
        first_root(from_s, to_s, |time_s| {
            let (x, v) = self.swing(slip, time_s);
            let s = self.piece.at(time_s);
            let speed = s.omega_rad_s.abs() + self.oscillator.speed_bound(x, v);
            let noise = 2.0 * f64::EPSILON * speed;
            Sample {
                value: slip.sense.of_signed(s.omega_rad_s - v),
                slope: slip
                    .sense
                    .of_signed(s.omega_dot - self.oscillator.acceleration(x, v)),
                bound: motion_bound + self.oscillator.jerk_bound(x, v),
                noise,
                slack: noise,
            }
        })
    }

    /// θ − s·Tk/kr of the object where the slip ends now, rad.
    pub(super) fn met_at(&self, slip: &Slip) -> f64 {
        match self.steady.filter(|s| s.repeats(slip, self)) {
            Some(steady) if slip.start_s + steady.duration_s == self.time_s => steady.x_end,
            _ => self.swing(slip, self.time_s).0,
        }
    }

    /// Whether the shaft has kept, since the slip began, the constant velocity
    /// that the slip began with.
    fn is_steady(&self, slip: &Slip) -> bool {
        self.piece.is_steady()
            && slip.start_s >= self.piece.start_s
            && slip.apart_s == slip.start_s
            && slip.v == self.piece.angle_and_velocity(slip.start_s).1
    }
}
