//! A torque of the angle that is asked for at angles which hardly move: its functions are
//! computed at an anchor, and near it the torque is its series about that. A series is never made
//! from another, so that nothing accumulates.

use super::AngleTorque;
use std::cell::Cell;

/// The furthest from an anchor, rad.
const REACH_RAD: f64 = 1.0 / 512.0;

/// Terms of a series. Of what grows by a factor of e in 0.116 rad, the fastest, those left out are
/// 3e-22 of the torque at the reach, and 7e-17 of its bend: what is left is rounding.
pub(super) const TERMS: usize = 9;

/// Coefficients of a torque's series, N·m/radᵏ.
pub(super) type Series = [f64; TERMS];

/// The next coefficient of a series of `growth`ᵏ/k!, which begins with `share`.
pub(super) fn term(k: usize, share: &mut f64, growth: f64) -> f64 {
    const WHOLE: Series = [1.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
    if k > 0 {
        *share *= growth / WHOLE[k];
    }
    *share
}

/// A torque with its present anchor.
#[derive(Clone)]
pub(super) struct Anchored<T> {
    torque: T,
    /// The anchor, rad; NaN before the first.
    at_rad: Cell<f64>,
    series: Cell<Series>,
}

impl<T: AngleTorque> Anchored<T> {
    pub(super) fn new(torque: T) -> Self {
        Self {
            torque,
            at_rad: Cell::new(f64::NAN),
            series: Cell::new([0.0; TERMS]),
        }
    }

    /// The torque itself.
    pub(super) fn of(&self) -> &T {
        &self.torque
    }

    /// See [`AngleTorque::range_rad`].
    pub(super) fn range_rad(&self) -> (f64, f64) {
        self.torque.range_rad()
    }

    /// Torque, slope and bend: see [`AngleTorque::expand`].
    #[inline]
    pub(super) fn expand(&self, angle_rad: f64) -> [f64; 3] {
        let away_rad = angle_rad - self.at_rad.get();
        if away_rad.abs() <= REACH_RAD {
            sums(&self.series.get(), away_rad)
        } else {
            self.expand_afar(angle_rad)
        }
    }

    /// Torque, slope and bend beyond reach: here is the next anchor, but near an end of the range.
    #[cold]
    fn expand_afar(&self, angle_rad: f64) -> [f64; 3] {
        let (low, high) = self.torque.range_rad();
        if angle_rad - REACH_RAD >= low && angle_rad + REACH_RAD <= high {
            let series = self.torque.series(angle_rad);
            self.at_rad.set(angle_rad);
            self.series.set(series);
            sums(&series, 0.0)
        } else {
            self.torque.expand(angle_rad)
        }
    }
}

/// Sum of a series, its derivative and its second derivative, by Horner's rule.
#[inline]
fn sums(series: &Series, x: f64) -> [f64; 3] {
    let (mut sum, mut slope, mut half_bend) = (0.0, 0.0, 0.0);
    for coefficient in series.iter().rev() {
        half_bend = half_bend * x + slope;
        slope = slope * x + sum;
        sum = sum * x + coefficient;
    }
    [sum, slope, 2.0 * half_bend]
}

#[cfg(test)]
mod tests {
    use super::super::{Passive, Pendulum};
    use super::*;

    /// A leg that is moved over its range and beyond, there and back, at all speeds.
    #[test]
    fn an_anchored_torque_is_the_torque_to_rounding() {
        let pendulum = Pendulum {
            weight_nm: 10.9,
            turned_rad: 0.3,
        };
        let torque = (pendulum, Passive::for_hip_deg(90.0));
        let anchored = Anchored::new(torque);
        let mut anchors = 0;
        let mut last = f64::NAN;
        for n in 0..200_000 {
            let angle = 1.2 + 1.9 * (f64::from(n) * 1e-4).sin();
            let (near, exact) = (anchored.expand(angle), torque.expand(angle));
            for (near, exact) in near.iter().zip(exact) {
                assert!(
                    (near - exact).abs() <= 1e-14 * (60.0 + exact.abs()),
                    "{near} {exact} at {angle}"
                );
            }
            if anchored.at_rad.get() != last {
                anchors += 1;
                last = anchored.at_rad.get();
            }
        }
        assert!((1_000..20_000).contains(&anchors), "{anchors}");
    }
}
