//! Location of the end of a phase: one file a rung of the ladder.
//!
//! A stick ends where its torque reaches the static limit; a slip ends where
//! the shaft's velocity meets the object's. A locator finds the time of
//! either within the part of a step that is left.

mod end_of_step;
mod exact;
mod exact_break;
mod hermite;
mod interpolated;

pub use end_of_step::EndOfStep;
pub use exact::ExactEvents;
pub use exact_break::ExactBreak;
pub use hermite::ExactHermite;
pub use interpolated::Interpolated;

use crate::joint::Sense;
use crate::joint::oscillator::Oscillator;
use crate::joint::shaft::{Linear, VelocityShape};
use crate::real::Real;
use crate::solver::propagate::Propagate;

/// The torque of a stick over the rest of a step: the parabola
/// T(u) = torque + rate·u + curvature·u²/2, or with a quadratic Ω the cubic
/// that has kr·Ω̈·u³/6 in addition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickPath<F, V = Linear> {
    /// T at the start, N·m.
    pub torque_nm: F,
    /// Ṫ at the start, N·m/s.
    pub rate: F,
    /// T̈ at the start, N·m/s².
    pub curvature: F,
    /// The third derivative, N·m/s³.
    pub shape: V,
}

impl<F: Real, V: VelocityShape<F>> StickPath<F, V> {
    /// T(u), N·m.
    #[inline]
    pub fn at(&self, time_s: F) -> F {
        let slope = self.rate + F::HALF * self.curvature * time_s;
        self.torque_nm
            + time_s
                * self
                    .shape
                    .plus(slope, || F::from_f64(1.0 / 6.0) * time_s * time_s)
    }

    /// The path, begun `time_s` later.
    #[must_use]
    #[inline]
    pub fn from(&self, time_s: F) -> Self {
        Self {
            torque_nm: self.at(time_s),
            rate: self.shape.plus(self.rate + self.curvature * time_s, || {
                F::HALF * time_s * time_s
            }),
            curvature: self.shape.plus(self.curvature, || time_s),
            shape: self.shape,
        }
    }
}

/// A slip over the rest of a step.
#[derive(Clone, Copy, Debug)]
pub struct SlipPath<'a, F, P, V = Linear> {
    /// Moves the object.
    pub propagator: &'a P,
    /// Accelerations and their bound.
    pub oscillator: &'a Oscillator<F>,
    /// The sense of the slip.
    pub sense: Sense,
    /// x = θ − s·Tk/kr at the start, rad.
    pub x: F,
    /// Velocity of the object at the start, rad/s.
    pub v: F,
    /// Ω at the start, rad/s.
    pub omega: F,
    /// Ω̇ at the start, rad/s².
    pub omega_dot: F,
    /// Course of Ω̇ over time.
    pub shape: V,
}

impl<F: Real, P: Propagate<F>, V: VelocityShape<F>> SlipPath<'_, F, P, V> {
    /// The speed s·(Ω − v) by which the shaft overtakes the object when that
    /// moves with `v`, `time_s` later.
    #[inline]
    pub fn overtaking(&self, time_s: F, v: F) -> F {
        let omega = self.shape.plus(self.omega + self.omega_dot * time_s, || {
            F::HALF * time_s * time_s
        });
        self.sense.of_signed(omega - v)
    }

    /// Returns whether the shaft has fallen back to the object at the end of the
    /// stretch, for those who look only there.
    ///
    /// A slip begins with equal velocities, and where its first stretch is
    /// very short rounding can make them look met: a lead that never was
    /// cannot be lost.
    #[inline]
    pub fn has_met(&self, length_s: F, v_end: F) -> bool {
        let end = self.overtaking(length_s, v_end);
        if end > F::ZERO {
            return false;
        }
        let noise = F::from_f64(8.0) * F::EPSILON * (self.omega.abs() + v_end.abs());
        end < -noise || self.overtaking(F::ZERO, self.v) > noise
    }
}

/// Finds the end of a phase.
pub trait Locate<F: Real>: Copy + Send + 'static {
    /// The path that the shaft is taken to follow within the step.
    type Shape: VelocityShape<F>;

    /// True if no match is looked for in a step at whose ends the shaft leads by more than the lead can dip:
    /// see [`SlipLane::stepped`](crate::joint::SlipLane::stepped).
    const LEAVES_OUT_CHORDS: bool = false;

    /// The first time in [0, `length_s`] at which s·T reaches `limit_nm`
    /// outwards; 0 if it is beyond the limit from the start.
    fn break_time(
        path: &StickPath<F, Self::Shape>,
        sense: Sense,
        limit_nm: F,
        length_s: F,
    ) -> Option<F>;

    /// The first time in [0, `length_s`] at which the shaft's velocity falls
    /// to the object's, which is `v_end` when all of it has passed.
    fn match_time<P: Propagate<F>>(
        slip: &SlipPath<'_, F, P, Self::Shape>,
        length_s: F,
        v_end: F,
    ) -> Option<F>;
}

/// The earlier of the breaks in either sense that a stick path can have within
/// `length_s`: its time and sense.
#[inline(always)]
#[expect(clippy::inline_always, reason = "a call takes a tenth of its time")]
pub fn first_break<F: Real, L: Locate<F>>(
    stick: &StickPath<F, L::Shape>,
    limit_nm: F,
    length_s: F,
) -> Option<(F, Sense)> {
    let at = |sense| L::break_time(stick, sense, limit_nm, length_s).map(|t| (t, sense));
    earlier(at(Sense::Positive), at(Sense::Negative))
}

/// The earlier of two breaks, the first if they are at one time.
#[inline]
pub fn earlier<F: Real>(a: Option<(F, Sense)>, b: Option<(F, Sense)>) -> Option<(F, Sense)> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.0 < a.0 { b } else { a }),
        (a, b) => a.or(b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::shaft::Quadratic;

    #[test]
    fn the_earlier_of_two_breaks_wins() {
        let (p, n) = (Sense::Positive, Sense::Negative);
        let at = |time_s: f64, sense| Some((time_s, sense));
        assert_eq!(earlier(at(1.0, p), at(2.0, n)), at(1.0, p));
        assert_eq!(earlier(at(2.0, p), at(1.0, n)), at(1.0, n));
        assert_eq!(earlier(at(1.0, p), at(1.0, n)), at(1.0, p));
        assert_eq!(earlier(None, at(1.0, n)), at(1.0, n));
        assert_eq!(earlier(at(1.0, p), None), at(1.0, p));
        assert_eq!(earlier::<f64>(None, None), None);
    }

    #[test]
    fn a_torque_is_a_parabola_wherever_one_begins() {
        let path = StickPath {
            torque_nm: 0.1,
            rate: -2.0,
            curvature: 8.0,
            shape: Linear,
        };
        assert!((path.at(0.5) - 0.1).abs() < 1e-15);
        let later = path.from(0.5);
        assert_eq!(
            (later.torque_nm, later.rate, later.curvature),
            (path.at(0.5), 2.0, 8.0)
        );
        assert!((later.at(0.25) - path.at(0.75)).abs() < 1e-15);
    }

    #[test]
    fn a_torque_is_a_cubic_wherever_one_begins() {
        let path = StickPath {
            torque_nm: 0.1,
            rate: -2.0,
            curvature: 8.0,
            shape: Quadratic { omega_ddot: 12.0 },
        };
        // 0.1 − 1 + 1 + 2/8.
        assert!((path.at(0.5) - 0.35).abs() < 1e-15);
        let later = path.from(0.5);
        assert_eq!((later.rate, later.curvature), (3.5, 14.0));
        assert!((later.at(0.25) - path.at(0.75)).abs() < 1e-15);
    }

    #[test]
    fn the_shaft_overtakes_the_object_with_what_it_is_faster() {
        let oscillator = Oscillator::<f64>::of(&crate::Parameters::default());
        for sense in [Sense::Positive, Sense::Negative] {
            let slip = SlipPath {
                propagator: &NoMotion,
                oscillator: &oscillator,
                sense,
                x: 0.0,
                v: 0.0,
                omega: 2.0,
                omega_dot: -3.0,
                shape: Quadratic { omega_ddot: 12.0 },
            };
            // Ω = 2 − 3u + 12u²/2 rad/s.
            for (time_s, omega) in [(0.0, 2.0), (0.5, 2.0), (0.25, 1.625), (1.5, 11.0)] {
                let found = slip.overtaking(time_s, 0.5);
                assert_eq!(found, sense.of_signed(omega - 0.5), "{sense:?} {time_s}");
            }
        }
    }

    /// A stretch on which the shaft keeps `omega` and the object goes from `v`
    /// to `v_end`: has it been fallen back to?
    fn met(omega: f64, v: f64, v_end: f64) -> [bool; 2] {
        let parameters = crate::Parameters::default();
        let oscillator = Oscillator::of(&parameters);
        [Sense::Positive, Sense::Negative].map(|sense| {
            let slip = SlipPath {
                propagator: &NoMotion,
                oscillator: &oscillator,
                sense,
                x: 0.0,
                v: sense.of_signed(v),
                omega: sense.of_signed(omega),
                omega_dot: 0.0,
                shape: Linear,
            };
            slip.has_met(1e-3, sense.of_signed(v_end))
        })
    }

    #[derive(Clone, Copy)]
    struct NoMotion;
    impl Propagate<f64> for NoMotion {
        fn new(_: &crate::StepCoefficients<f64>) -> Self {
            Self
        }
        fn step(&self, x: f64, v: f64) -> (f64, f64) {
            (x, v)
        }
        fn part(&self, x: f64, v: f64, _: f64) -> (f64, f64) {
            (x, v)
        }
    }

    #[test]
    fn a_lead_that_is_gone_is_met() {
        assert_eq!(met(1.0, 0.5, 0.9), [false; 2]);
        // Equal is met, however close, and beyond is.
        for v_end in [1.0, 1.0 + f64::EPSILON, 1.5] {
            assert_eq!(met(1.0, 0.5, v_end), [true; 2], "{v_end}");
        }
    }

    #[test]
    fn a_lead_that_never_was_is_not_lost_by_rounding() {
        for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
            let beyond = |parts: f64| met(scale, scale, scale * (1.0 + parts * f64::EPSILON));
            for rounding in [-1.0, 0.0, 1.0, 4.0] {
                assert_eq!(beyond(rounding), [false; 2], "{scale} {rounding}");
            }
            // More than rounding: the object has been ahead from the start.
            for more in [64.0, 1e6] {
                assert_eq!(beyond(more), [true; 2], "{scale} {more}");
            }
        }
        assert_eq!(met(0.0, 0.0, 0.0), [false; 2]);
    }
}
