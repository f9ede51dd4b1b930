//! Time at which a slip of the reference solver meets the shaft's velocity.

use super::first_root::{Sample, Touch, first_root};
use super::rules::ROUNDINGS;
use super::{Reference, Slip};
use std::f64::consts::PI;
use std::ops::ControlFlow;

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
}

impl Reference<'_> {
    /// The next velocity match of a slip between two times.
    pub(super) fn find_match<B>(
        &mut self,
        slip: &Slip,
        (from_s, to_s): (f64, f64),
        poll: &mut impl FnMut() -> ControlFlow<B>,
    ) -> ControlFlow<B, Option<f64>> {
        let lead = slip.sense.of_signed(slip.x);
        // One that begins backwards ends where it begins, as the search finds.
        if self.is_steady(slip)
            && self.settings.parameters.damping_nms_per_rad == 0.0
            && lead >= -self.least_lead_rad()
        {
            let duration_s = self.undamped_duration_s(slip);
            self.keep(slip, duration_s, -slip.x);
            let time_s = duration_s.map(|duration_s| slip.start_s + duration_s);
            return ControlFlow::Continue(time_s.filter(|time_s| *time_s <= to_s));
        }
        let found = self.search(slip, (from_s, to_s), poll)?;
        if let Some(time_s) = found
            && self.is_steady(slip)
        {
            self.keep(
                slip,
                Some(time_s - slip.start_s),
                self.swing(slip, time_s).0,
            );
        }
        ControlFlow::Continue(found)
    }

    /// A slip without damping at a steady speed: (Ω, ωn·x) turns until its
    /// velocity is Ω again, by 2(π − atan(ωn·|x|/|Ω|)).
    ///
    /// None where the object does not leave the shaft's velocity, or only
    /// comes back to touch it.
    fn undamped_duration_s(&self, slip: &Slip) -> Option<f64> {
        let lead = slip.sense.of_signed(slip.x);
        if lead <= self.least_lead_rad() {
            return None;
        }
        let lag = (self.natural_rad_s * lead).atan2(slip.sense.of_signed(slip.v));
        Some(2.0 * (PI - lag) / self.natural_rad_s)
    }

    /// The |x| at the start of a slip that rounding can make of none, rad.
    fn least_lead_rad(&self) -> f64 {
        let p = &self.settings.parameters;
        ROUNDINGS * f64::EPSILON * p.static_torque_nm / p.stiffness_nm_per_rad
    }

    fn keep(&mut self, slip: &Slip, duration_s: Option<f64>, x_end: f64) {
        self.steady = duration_s.map(|duration_s| SteadySlip {
            x: slip.x,
            v: slip.v,
            duration_s,
            x_end,
        });
    }

    fn search<B>(
        &self,
        slip: &Slip,
        (from_s, to_s): (f64, f64),
        poll: &mut impl FnMut() -> ControlFlow<B>,
    ) -> ControlFlow<B, Option<f64>> {
        let bounds = self.piece.bounds(from_s, to_s);
        // With Ts = Tk a stick would break where it begins.
        let touch = if self.touches() {
            Touch::Passes
        } else {
            Touch::Counts {
                from_above: from_s > slip.start_s,
            }
        };
        first_root(from_s, to_s, touch, poll, |time_s| {
            let (x, v) = self.swing(slip, time_s);
            let s = self.piece.at(time_s);
            // Of the shaft's terms, and of its time.
            let shaft = s.omega_rad_s.abs() + bounds.omega_dot * self.piece.age_s(time_s);
            let noise = 2.0 * f64::EPSILON * (shaft + self.swing.oscillator().speed_bound(x, v));
            Sample {
                value: slip.sense.of_signed(s.omega_rad_s - v),
                slope: slip
                    .sense
                    .of_signed(s.omega_dot - self.swing.oscillator().acceleration(x, v)),
                bound: bounds.omega_ddot + self.swing.jerk_bound(x, v),
                noise,
                slack: noise,
            }
        })
    }

    /// θ − s·Tk/kr of the object where the slip ends now, rad.
    pub(super) fn met_at(&self, slip: &Slip) -> f64 {
        self.steady
            .and_then(|steady| steady.for_state(slip.x, slip.v))
            .filter(|(duration_s, _)| {
                self.is_steady(slip) && slip.start_s + duration_s == self.time_s
            })
            .map_or_else(|| self.swing(slip, self.time_s).0, |(_, x_end)| x_end)
    }

    /// Returns whether the shaft has kept, since the slip began, the constant velocity
    /// that the slip began with.
    fn is_steady(&self, slip: &Slip) -> bool {
        self.piece.is_steady()
            && slip.start_s >= self.piece.start_s
            && slip.v == self.piece.angle_and_velocity(slip.start_s).1
    }
}
