//! Both events located exactly on the cubic (Hermite) path of the shaft, whose
//! acceleration is of second order at the ends of the step.
//!
//! Under `physical` the torque of a stick contains J·Ω̇, so what a path makes of
//! Ω̇ is the error of the break:
//!
//! ```text
//! linear Ω      J·Ω̈·h/2 / Ṫ           first order: exact-events
//! quadratic Ω   J·|d³Ω/dt³|·h²/12 / Ṫ  second order
//! ```
//!
//! T is then a cubic in time without a useful closed form of its roots; the
//! break is found like the match, by lower-bounding parabolas.

use super::exact::{SEARCH_STEPS, first_match, only_touches, touch_nm};
use super::{Locate, SlipPath, StickPath};
use crate::joint::Sense;
use crate::joint::shaft::{Quadratic, VelocityShape};
use crate::real::Real;
use crate::solver::propagate::Propagate;

/// Both events located on the cubic path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactHermite;

impl<F: Real> Locate<F> for ExactHermite {
    type Shape = Quadratic<F>;

    #[inline]
    fn break_time(
        path: &StickPath<F, Quadratic<F>>,
        sense: Sense,
        limit_nm: F,
        length_s: F,
    ) -> Option<F> {
        let outwards = StickPath {
            torque_nm: sense.of_signed(path.torque_nm),
            rate: sense.of_signed(path.rate),
            curvature: sense.of_signed(path.curvature),
            shape: path.shape.times(sense.of_signed(F::ONE)),
        };
        let left = limit_nm - outwards.torque_nm;
        let time_s = if left > F::ZERO {
            first_reach(&outwards, limit_nm, length_s)?
        } else if left < -(F::LIMIT_SLACK * limit_nm) || outwards.rate > F::ZERO {
            if left >= -(F::LIMIT_SLACK * limit_nm) && turns_back(&outwards, left, limit_nm) {
                return None;
            }
            F::ZERO
        } else {
            way_back(&outwards)?
        };
        (time_s <= length_s).then_some(time_s)
    }

    #[inline]
    fn match_time<P: Propagate<F>>(
        slip: &SlipPath<'_, F, P, Quadratic<F>>,
        length_s: F,
        v_end: F,
    ) -> Option<F> {
        first_match(slip, length_s, v_end)
    }
}

/// The first time in [0, `length_s`] at which a torque below `limit_nm` is at
/// it.
fn first_reach<F: Real>(path: &StickPath<F, Quadratic<F>>, limit_nm: F, length_s: F) -> Option<F> {
    let bound = path.curvature.abs() + path.shape.omega_ddot.abs() * length_s;
    let noise = F::TWO * F::EPSILON * limit_nm;
    let mut time_s = F::ZERO;
    for _ in 0..SEARCH_STEPS {
        let here = path.from(time_s);
        let left = limit_nm - here.torque_nm;
        let touch_nm = touch_nm(limit_nm);
        if left <= touch_nm && turns_back(&here, left, limit_nm) {
            // Beyond its top, to where it is further from the limit than a touch.
            let down_s = (F::from_f64(8.0) * touch_nm / -here.curvature).sqrt();
            time_s += (here.rate / -here.curvature).at_least(F::ZERO) + down_s;
            if time_s <= length_s {
                continue;
            }
            return None;
        }
        if left <= noise {
            // What rounding hides of the way is a straight line.
            let rest_s = if here.rate > F::ZERO {
                left.at_least(F::ZERO) / here.rate
            } else {
                F::ZERO
            };
            return Some((time_s + rest_s).at_most(length_s));
        }
        // left − rate·d − bound·d²/2 is above zero up to here.
        let root = (here.rate * here.rate + F::TWO * bound * left).sqrt();
        time_s += if here.rate < F::ZERO {
            (root - here.rate) / bound
        } else {
            F::TWO * left / (root + here.rate)
        };
        // (Without any way to go it is infinite or NaN.)
        if time_s <= length_s {
            continue;
        }
        return None;
    }
    None
}

/// Returns whether the torque turns back at its limit, which it only touches.
fn turns_back<F: Real>(here: &StickPath<F, Quadratic<F>>, left: F, limit_nm: F) -> bool {
    let square = here.rate * here.rate + F::TWO * here.curvature * left;
    only_touches(square, here.curvature, limit_nm)
}

/// Time at which a torque that leaves its limit inwards, or along it, is back there on
/// its way out: the first u ≥ 0 from which on rate + T̈·u/2 + T⃛·u²/6 is above
/// zero.
fn way_back<F: Real>(path: &StickPath<F, Quadratic<F>>) -> Option<F> {
    let square = F::from_f64(1.0 / 6.0) * path.shape.omega_ddot;
    let line = F::HALF * path.curvature;
    let discriminant = line * line - F::from_f64(4.0) * square * path.rate;
    if discriminant < F::ZERO || (square <= F::ZERO && line <= F::ZERO) {
        return None;
    }
    let root = discriminant.sqrt();
    if line <= F::ZERO {
        return Some((root - line) / (F::TWO * square));
    }
    Some(-(F::TWO * path.rate) / (line + root))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::shaft::Linear;
    use crate::solver::locate::{ExactEvents, first_break};

    fn cubic([torque_nm, rate, curvature, omega_ddot]: [f64; 4]) -> StickPath<f64, Quadratic<f64>> {
        StickPath {
            torque_nm,
            rate,
            curvature,
            shape: Quadratic { omega_ddot },
        }
    }

    /// Time at which the cubic reaches `limit` within a second, and its mirror image
    /// −`limit`.
    fn reaches(path: [f64; 4], limit: f64) -> Option<f64> {
        let found = ExactHermite::break_time(&cubic(path), Sense::Positive, limit, 1.0);
        let mirrored = path.map(|x| -x);
        assert_eq!(
            found,
            ExactHermite::break_time(&cubic(mirrored), Sense::Negative, limit, 1.0)
        );
        found
    }

    #[test]
    fn without_a_cubic_term_it_is_the_parabolas_root() {
        for torque_nm in [-0.5, 0.0, 0.25, 0.5, 0.5 + 1e-11, 0.51] {
            for rate in [-3.0, -1.0, 0.0, 1e-3, 1.0, 3.0] {
                for curvature in [-8.0, -1.0, 0.0, 2.0, 8.0] {
                    let parabola = StickPath {
                        torque_nm,
                        rate,
                        curvature,
                        shape: Linear,
                    };
                    let expected =
                        first_break::<f64, ExactEvents>(&parabola, 0.5, 1.0).map(|(t, _)| t);
                    let path = cubic([torque_nm, rate, curvature, 0.0]);
                    let found = first_break::<f64, ExactHermite>(&path, 0.5, 1.0).map(|(t, _)| t);
                    let near = match (found, expected) {
                        // A touch is known to the root of rounding only.
                        (Some(a), Some(b)) if (rate + curvature * b).abs() < 1e-6 => {
                            (a - b).abs() < 2e-8
                        }
                        (Some(a), Some(b)) => (a - b).abs() < 1e-12,
                        (a, b) => a == b,
                    };
                    assert!(
                        near,
                        "{torque_nm} {rate} {curvature}: {found:?} {expected:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_break_is_the_first_root_of_the_cubic() {
        for (path, expected) in [
            // u³ = 0.5.
            ([0.0, 0.0, 0.0, 6.0], Some(0.5_f64.cbrt())),
            // 0.5 + 12(u − 0.2)(u − 0.4)(u − 0.9): up, down, and up again.
            ([-0.364, 7.44, -36.0, 72.0], Some(0.2)),
            ([1.364, -7.44, 36.0, -72.0], Some(0.0)),
            // Down first, and only then up: −u + 4u³ = 0.5.
            ([0.0, -1.0, 0.0, 24.0], Some(0.662_358_98)),
            // A hump that stays below: u − u³ is 0.385 at most.
            ([0.0, 1.0, 0.0, -6.0], None),
            ([0.12, 1.0, 0.0, -6.0], Some(0.523_311_12)),
            ([0.115, 1.0, 0.0, -6.0], None),
        ] {
            let found = reaches(path, 0.5);
            assert_eq!(found.is_some(), expected.is_some(), "{path:?}: {found:?}");
            let (Some(found), Some(expected)) = (found, expected) else {
                continue;
            };
            let off = (found - expected).abs();
            assert!(off < 1e-8, "{path:?}: {found}");
            let torque = cubic(path).at(found);
            assert!((torque - 0.5).abs() < 1e-14 || found == 0.0, "{path:?}");
        }
    }

    #[test]
    fn at_the_limit_it_is_the_way_out_that_counts() {
        for (rate, curvature, third, expected) in [
            (0.0, 0.0, 6.0, Some(0.0)),
            (0.0, 0.0, -6.0, None),
            (0.0, 0.0, 0.0, None),
            (0.0, 2.0, -6.0, Some(0.0)),
            // −u² + 4u³/3 is back at 3/4.
            (0.0, -2.0, 8.0, Some(0.75)),
            // −u + 4u³ at 1/2.
            (-1.0, 0.0, 24.0, Some(0.5)),
            // −2u + 8u² − 8u³ touches at 1/2; with a little less it does not.
            (-2.0, 16.0, -48.0, Some(0.5)),
            (-2.1, 16.0, -48.0, None),
        ] {
            let found = reaches([0.5, rate, curvature, third], 0.5);
            assert_eq!(found, expected, "{rate} {curvature} {third}");
        }
    }
}
