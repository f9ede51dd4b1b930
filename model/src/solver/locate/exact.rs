//! Both events located exactly: the break as the root of a parabola, the
//! velocity match by a search that cannot step over the first root.
//!
//! The search goes by the lower-bounding parabola: with |g̈| ≤ M,
//! g(u + d) ≥ g + ġ·d − M·d²/2, so no root lies before
//! d = (ġ + √(ġ² + 2M·g))/M. Near a simple root this is Newton's step, so it
//! converges quadratically, and always from the same side.

use super::{Locate, SlipPath, StickPath};
use crate::joint::Sense;
use crate::joint::shaft::{Linear, VelocityShape};
use crate::real::Real;
use crate::solver::propagate::Propagate;

/// Both events located.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactEvents;

/// The most trial points of one search. Five or six find a match of ordinary
/// slope; a near miss halves its distance with each, so this reaches rounding
/// in f64 as well.
pub(super) const SEARCH_STEPS: u32 = 64;

impl<F: Real> Locate<F> for ExactEvents {
    type Shape = Linear;

    const LEAVES_OUT_CHORDS: bool = true;

    #[inline]
    fn break_time(path: &StickPath<F>, sense: Sense, limit_nm: F, length_s: F) -> Option<F> {
        let left = limit_nm - sense.of_signed(path.torque_nm);
        let rate = sense.of_signed(path.rate);
        let curvature = sense.of_signed(path.curvature);
        let time_s = if left > F::ZERO {
            // Most sticks are nowhere near: no root is needed to see it, and
            // far enough that rounding does not matter.
            let reach = (rate.abs() + F::HALF * curvature.abs() * length_s) * length_s;
            if left > F::TWO * reach || (rate <= F::ZERO && curvature <= F::ZERO) {
                return None;
            }
            if curvature == F::ZERO {
                return Some(left / rate).filter(|u| *u <= length_s);
            }
            // Smallest u > 0 with rate·u + curvature·u²/2 = left, without
            // cancellation.
            let square = rate * rate + F::TWO * curvature * left;
            if square < F::ZERO || (!F::IS_SINGLE && only_touches(square, curvature, limit_nm)) {
                return None;
            }
            let denominator = rate + square.sqrt();
            if denominator <= F::ZERO {
                return None;
            }
            F::TWO * left / denominator
        } else if left < -(F::LIMIT_SLACK * limit_nm) || rate > F::ZERO {
            let square = rate * rate + F::TWO * curvature * left;
            if !F::IS_SINGLE
                && left >= -(F::LIMIT_SLACK * limit_nm)
                && only_touches(square, curvature, limit_nm)
            {
                return None;
            }
            F::ZERO
        } else if curvature > F::ZERO {
            // At the limit, first inwards and then out again.
            -(F::TWO * rate) / curvature
        } else {
            return None;
        };
        (time_s <= length_s).then_some(time_s)
    }

    #[inline]
    fn match_time<P: Propagate<F>>(slip: &SlipPath<'_, F, P>, length_s: F, v_end: F) -> Option<F> {
        first_match(slip, length_s, v_end)
    }
}

/// Returns whether a torque that turns back has its top at the limit, to rounding: `square` is
/// rate² + 2·curvature·left, twice the curvature times what it lacks there. The limit itself still
/// sticks. Rounding in f32 is coarser than what could be told apart: there a top at the limit breaks.
#[inline]
pub(super) fn only_touches<F: Real>(square: F, curvature: F, limit_nm: F) -> bool {
    curvature < F::ZERO && square <= -(F::TWO * curvature * touch_nm(limit_nm))
}

/// Rounding of a torque at its limit, N·m: that of an angle which is a thousand times that of the spring.
#[inline]
pub(super) fn touch_nm<F: Real>(limit_nm: F) -> F {
    F::from_f64(4096.0) * F::EPSILON * limit_nm
}

/// The first velocity match in [0, `length_s`], on a path of either shape.
#[inline]
pub(super) fn first_match<F: Real, P: Propagate<F>, V: VelocityShape<F>>(
    slip: &SlipPath<'_, F, P, V>,
    length_s: F,
    v_end: F,
) -> Option<F> {
    let start = slip.overtaking(F::ZERO, slip.v);
    let end = slip.overtaking(length_s, v_end);
    let bound = slip.shape.bound(slip.oscillator.jerk_bound(slip.x, slip.v));
    // A curve that bends by less than `bound` dips below its chord by at most
    // bound·h²/8.
    let dip = bound * length_s * length_s * F::from_f64(0.125);
    if start > dip && end > dip {
        return None;
    }
    search(slip, length_s, bound)
}

/// The first root of g(u) = s·(Ω(u) − v(u)) in [0, `length_s`], where |g̈| ≤
/// `bound`.
fn search<F: Real, P: Propagate<F>, V: VelocityShape<F>>(
    slip: &SlipPath<'_, F, P, V>,
    length_s: F,
    bound: F,
) -> Option<F> {
    let rounding = F::from_f64(4.0) * F::EPSILON;
    let mut time_s = F::ZERO;
    let (mut x, mut v) = (slip.x, slip.v);
    for _ in 0..SEARCH_STEPS {
        let gained = slip
            .shape
            .plus(slip.omega_dot * time_s, || F::HALF * time_s * time_s);
        let omega_dot = slip.shape.plus(slip.omega_dot, || time_s);
        let omega = slip.omega + gained;
        let v_dot = slip.oscillator.acceleration(x, v);
        let g = slip.sense.of_signed(omega - v).at_least(F::ZERO);
        let g_dot = slip.sense.of_signed(omega_dot - v_dot);
        // Ω may be the small difference of two large numbers.
        let size = slip.omega.abs() + gained.abs() + slip.oscillator.speed_bound(x, v);
        let noise = rounding * size;
        let advance = if g <= noise {
            if g_dot.abs() <= rounding * (omega_dot.abs() + v_dot.abs()) {
                // A touch: the velocities meet without crossing. Leave it, if
                // they part again: g ≥ g̈·d²/2 − |g⃛|·d³/6 stays above zero up
                // to d = 3·g̈/|g⃛|.
                let bend = slip
                    .shape
                    .plus(-slip.oscillator.acceleration(v, v_dot), || F::ONE);
                let parting = slip.sense.of_signed(bend);
                if parting <= F::ZERO {
                    return Some(time_s);
                }
                F::from_f64(3.0) * parting / slip.oscillator.snap_bound(x, v)
            } else if g_dot < F::ZERO {
                // What rounding hides of the way is a straight line.
                return Some((time_s - g / g_dot).at_most(length_s));
            } else {
                // A slip that has just begun.
                F::TWO * g_dot / bound
            }
        } else {
            let root = (g_dot * g_dot + F::TWO * bound * g).sqrt();
            if g_dot > F::ZERO {
                (g_dot + root) / bound
            } else {
                F::TWO * g / (root - g_dot)
            }
        };
        time_s += advance;
        if time_s < length_s {
            (x, v) = slip.propagator.part(slip.x, slip.v, time_s);
        } else {
            return None;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::counted::{Counted, operations};
    use crate::solver::propagate::Exact;
    use crate::{Settings, StepCoefficients};

    /// Time at which T(u) = torque + rate·u + curvature·u²/2 reaches 0.5 N·m within a
    /// second, and its mirror image −0.5 N·m.
    fn reaches([torque_nm, rate, curvature]: [f64; 3], limit: f64) -> Option<f64> {
        let path = |s: f64| StickPath {
            torque_nm: s * torque_nm,
            rate: s * rate,
            curvature: s * curvature,
            shape: Linear,
        };
        let found = ExactEvents::break_time(&path(1.0), Sense::Positive, limit, 1.0);
        let mirrored = ExactEvents::break_time(&path(-1.0), Sense::Negative, limit, 1.0);
        assert_eq!(found, mirrored);
        found
    }

    #[test]
    fn a_break_is_the_first_root_of_the_parabola() {
        for (path, expected) in [
            // A straight line that gets there, just gets there, does not.
            ([0.25, 1.0, 0.0], Some(0.25)),
            ([-0.5, 1.0, 0.0], Some(1.0)),
            ([-0.5, 0.999, 0.0], None),
            ([0.25, -1.0, 0.0], None),
            ([0.25, 0.0, 0.0], None),
            // 0.5 = 3u + 4u² and 0.5 = −3u + 4u²/2.
            ([0.0, 3.0, 8.0], Some((17.0_f64.sqrt() - 3.0) / 8.0)),
            ([0.0, 0.0, 4.0], Some(0.5)),
            ([0.0, -1.0, 6.0], Some((1.0 + 7.0_f64.sqrt()) / 6.0)),
            // Over the top at 0.5 s: beyond the limit, at it and back, below.
            ([0.0, 3.0, -6.0], Some((3.0 - 3.0_f64.sqrt()) / 6.0)),
            ([0.0, 2.0, -4.0], None),
            ([0.0, 1.9, -4.0], None),
            // Falling faster and faster.
            ([0.0, -1.0, -1.0], None),
        ] {
            let found = reaches(path, 0.5);
            assert_eq!(found.is_some(), expected.is_some(), "{path:?}: {found:?}");
            if let (Some(found), Some(expected)) = (found, expected) {
                assert!((found - expected).abs() < 1e-15, "{path:?}: {found}");
            }
        }
    }

    #[test]
    fn at_the_limit_it_is_the_way_out_that_counts() {
        for (rate, curvature, expected) in [
            (2.0, 0.0, Some(0.0)),
            (2.0, -8.0, Some(0.0)),
            (0.0, 0.0, None),
            (0.0, -1.0, None),
            (-2.0, 0.0, None),
            (-2.0, -8.0, None),
            // First inwards and then out again: 3u = 8u²/2.
            (-3.0, 8.0, Some(0.75)),
            (-5.0, 8.0, None),
        ] {
            for torque in [0.5, 0.5 + 1e-11] {
                let found = reaches([torque, rate, curvature], 0.5);
                assert_eq!(found, expected, "{torque}, {rate}, {curvature}");
            }
        }
        // Without any limit, nothing is beyond it.
        assert_eq!(reaches([0.0, -1.0, 0.0], 0.0), None);
    }

    #[test]
    fn beyond_the_limit_by_more_than_its_slack_it_breaks_at_once() {
        for limit in [1e-3, 0.5, 1e3] {
            let beyond = |parts: f64| reaches([limit * (1.0 + parts), -limit, 0.0], limit);
            assert_eq!(beyond(1e-10), None, "{limit}");
            assert_eq!(beyond(1e-8), Some(0.0), "{limit}");
        }
    }

    /// The paper's object through x = 0 with v = 1 rad/s, and the shaft ahead
    /// by `lead`, falling back by `rate` at first.
    fn meets(lead: f64, rate: f64, length_s: f64) -> Option<f64> {
        let coefficients =
            StepCoefficients::new(&Settings::default().validate().unwrap(), 1e-3).unwrap();
        let propagator = Exact::new(&coefficients);
        let slip = SlipPath {
            propagator: &propagator,
            oscillator: &coefficients.oscillator,
            sense: Sense::Positive,
            x: 0.0,
            v: 1.0,
            omega: 1.0 + lead,
            omega_dot: rate,
            shape: Linear,
        };
        let (_, v_end) = propagator.part(0.0, 1.0, length_s);
        ExactEvents::match_time(&slip, length_s, v_end)
    }

    #[test]
    fn velocities_that_meet_and_part_again_within_a_step_have_met() {
        // lead + rate·u + 1 − cos ωn·u at ωn = 200 rad/s: about 2e4·u² with
        // its lowest point at rate/4e4.
        for (length_s, rate, lead) in [
            (1e-3, -8.0, 4e-4),
            (1e-3, -8.0, 7e-4),
            (1e-4, -0.8, 4e-6),
            (1e-4, -0.8, 7.9e-6),
        ] {
            let g = |u: f64| lead + rate * u + 2.0 * libm::pow(libm::sin(100.0 * u), 2.0);
            let (mut low, mut high) = (0.0, -rate / 4e4);
            assert!(g(high) < 0.0 && g(length_s) > 0.0);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                *(if g(middle) > 0.0 { &mut low } else { &mut high }) = middle;
            }
            let found = meets(lead, rate, length_s);
            assert!(
                found.is_some_and(|u| (u - low).abs() < 1e-9 * length_s),
                "{lead}: {found:?}, not {low}"
            );
        }
        // A near miss is a miss.
        assert_eq!(meets(8.1e-4, -8.0, 1e-3), None);
        assert_eq!(meets(8.1e-6, -0.8, 1e-4), None);
    }

    /// Case of most ticks in stick.
    #[test]
    fn a_stick_that_cannot_reach_its_limit_costs_no_root() {
        let f = Counted::from_f64;
        let (rate, curvature, length_s) = (1.0, 100.0, 1e-3);
        let gains_nm = (rate + 0.5 * curvature * length_s) * length_s;
        for sense in [Sense::Positive, Sense::Negative] {
            let path = StickPath {
                torque_nm: f(sense.of_signed(0.5 - 2.02 * gains_nm)),
                rate: f(sense.of_signed(rate)),
                curvature: f(sense.of_signed(curvature)),
                shape: Linear,
            };
            let (found, done) =
                operations(|| ExactEvents::break_time(&path, sense, f(0.5), f(length_s)));
            assert_eq!((found, done.slow), (None, 0), "{sense:?}");
        }
    }

    /// Case of most ticks in a slip: velocities that are further apart than what lies between can bend.
    #[test]
    fn a_slip_that_cannot_meet_costs_no_trial_point() {
        let f = Counted::from_f64;
        let settings = Settings::default().validate().unwrap();
        let coefficients = StepCoefficients::<Counted>::new(&settings, 1e-3).unwrap();
        let propagator = Exact::new(&coefficients);
        let cost = |start: f64, end: f64| {
            let slip = SlipPath {
                propagator: &propagator,
                oscillator: &coefficients.oscillator,
                sense: Sense::Positive,
                x: f(0.0),
                v: f(1.0),
                omega: f(1.0 + start),
                omega_dot: f(0.0),
                shape: Linear,
            };
            let v_end = f(1.0 + start - end);
            let (found, done) = operations(|| ExactEvents::match_time(&slip, f(1e-3), v_end));
            assert_eq!(found, None, "{start} {end}");
            done.slow
        };
        // |v̈| ≤ (200 rad/s)²·1 rad/s, so at most 4e4·h²/8 = 5 mrad/s below the chord.
        let (above, below) = (5.05e-3, 4.95e-3);
        assert_eq!(cost(above, above), 0);
        assert!(cost(below, below) > 0);
        assert!(cost(above, below) > 0 && cost(below, above) > 0);
    }
}
