//! Orders of convergence: the slope of log error on log step.
//!
//! Fitted by least squares over the f64 points at steps of at least 20 µs
//! whose events all match. An error at the level of rounding says nothing
//! about the method and is left out; if all are, the method is exact. A rung
//! that divides an angle by the step squared shows the rounding of that angle
//! instead of its order below a quarter of a millisecond.

use crate::accuracy::point::Point;
use crepitus_model::solver::Solver;
use serde::Serialize;

/// The shortest step of a fit, s.
const SHORTEST_STEP_S: f64 = 2e-5;

/// The shortest step of a fit of a rung that needs the exact motion, s.
const SHORTEST_EXACT_STEP_S: f64 = 2.5e-4;

/// The fewest points that a slope is fitted to.
const LEAST_POINTS: usize = 3;

/// Errors below this are rounding, relative or in s.
const ROUNDING: f64 = 1e-12;

/// Measured orders of one rung on one scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Orders {
    /// Name of the scene.
    pub scene: String,
    /// Convention.
    pub convention: &'static str,
    /// The rung.
    pub solver: &'static str,
    /// Order of the relative error of the cycle frequency.
    pub frequency: Order,
    /// Order of the worst error of an event's time.
    pub event_time: Order,
    /// Order of the root mean square error of the events' times.
    pub event_time_rms: Order,
}

/// A measured order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Order {
    /// The slope, over this many points.
    Slope {
        /// The order.
        order: f64,
        /// Number of points.
        points: usize,
    },
    /// Every error is rounding: there is nothing to converge.
    RoundOff {
        /// Number of points.
        points: usize,
    },
    /// Fewer than three points above rounding.
    TooFewPoints {
        /// Number of points.
        points: usize,
    },
}

/// The orders of every scene, convention and rung among `points`, in their
/// order.
pub fn orders(points: &[Point]) -> Vec<Orders> {
    let mut orders: Vec<Orders> = Vec::new();
    for point in points.iter().filter(|p| p.is_exact()) {
        let is_same = |scene: &str, convention: &str, solver: &str| {
            scene == point.scene && convention == point.convention && solver == point.solver
        };
        if orders
            .iter()
            .any(|o| is_same(&o.scene, o.convention, o.solver))
        {
            continue;
        }
        let matched: Vec<&Point> = points
            .iter()
            .filter(|p| is_same(&p.scene, p.convention, p.solver))
            .filter(|p| p.is_exact() && p.precision == "f64" && p.unmatched == 0)
            .filter(|p| p.step_s >= shortest_step_s(p.solver) * (1.0 - 1e-9))
            .collect();
        let order_of = |error: fn(&Point) -> f64| {
            let errors: Vec<_> = matched.iter().map(|p| (p.step_s, error(p))).collect();
            order(&errors)
        };
        orders.push(Orders {
            scene: point.scene.clone(),
            convention: point.convention,
            solver: point.solver,
            frequency: order_of(|p| p.frequency_error_rel),
            event_time: order_of(|p| p.max_event_error_s),
            event_time_rms: order_of(|p| p.rms_event_error_s),
        });
    }
    orders
}

/// The shortest step of a fit of the rung of this name, s.
pub(super) fn shortest_step_s(name: &str) -> f64 {
    let needs_exact = |s: &Solver| s.name() == name && s.needs_exact_motion();
    if Solver::ALL.iter().any(needs_exact) {
        SHORTEST_EXACT_STEP_S
    } else {
        SHORTEST_STEP_S
    }
}

/// The order of (step, error) pairs; NaN errors are skipped.
pub(super) fn order(errors: &[(f64, f64)]) -> Order {
    let known = errors.iter().filter(|(_, e)| !e.is_nan()).count();
    let above: Vec<(f64, f64)> = errors
        .iter()
        .filter(|(_, e)| *e > ROUNDING)
        .map(|(h, e)| (h.ln(), e.ln()))
        .collect();
    if known >= LEAST_POINTS && above.is_empty() {
        return Order::RoundOff { points: known };
    }
    match slope(&above) {
        Some(order) if above.len() >= LEAST_POINTS => Order::Slope {
            order,
            points: above.len(),
        },
        _ => Order::TooFewPoints {
            points: above.len(),
        },
    }
}

/// Least-squares slope; `None` if all x are the same.
fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let n = f64::from(u32::try_from(points.len()).ok()?);
    let x = points.iter().map(|p| p.0).sum::<f64>() / n;
    let y = points.iter().map(|p| p.1).sum::<f64>() / n;
    let spread: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    let product: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    (spread > 0.0).then_some(product / spread)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::point::tests::point;

    const STEPS: [f64; 6] = [1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5];

    fn measured(change: impl Fn(&mut Point)) -> Orders {
        let points: Vec<_> = STEPS
            .iter()
            .map(|&h| {
                let mut p = point("exact", h);
                p.precision = "f64";
                p.frequency_error_rel = 3e3 * h * h;
                p.max_event_error_s = 0.7 * h;
                change(&mut p);
                p
            })
            .collect();
        let orders = orders(&points);
        assert_eq!(orders.len(), 1);
        orders[0].clone()
    }

    fn is(order: Order, expected: f64, count: usize) -> bool {
        matches!(order, Order::Slope { order, points } if (order - expected).abs() < 1e-9 && points == count)
    }

    #[test]
    fn a_power_law_has_its_exponent() {
        let o = measured(|_| ());
        assert!(is(o.frequency, 2.0, 6) && is(o.event_time, 1.0, 6), "{o:?}");
    }

    #[test]
    fn unmatched_points_and_short_steps_are_left_out() {
        let o = measured(|p| {
            if p.step_s >= 1e-3 {
                p.unmatched = 1;
                p.frequency_error_rel = 1.0;
            }
            if p.step_s < 3e-5 {
                p.step_s = 1e-5;
                p.frequency_error_rel = 1.0;
            }
        });
        assert!(is(o.frequency, 2.0, 4), "{o:?}");
    }

    #[test]
    fn the_rounding_of_an_angle_is_no_convergence() {
        let o = measured(|p| {
            p.solver = "exact-hermite";
            if p.step_s < 2e-4 {
                p.max_event_error_s = 1e-19 / p.step_s / p.step_s;
            }
        });
        assert_eq!(o.event_time, Order::TooFewPoints { points: 2 });
    }

    #[test]
    fn the_encoder_has_no_order() {
        let mut points = [point("exact", 1e-3), point("exact", 1e-4)];
        points[0].input = "encoder";
        assert_eq!(orders(&points).len(), 1);
        assert!(orders(&points[..1]).is_empty());
    }

    #[test]
    fn single_precision_is_left_out() {
        let o = measured(|p| p.precision = "f32");
        assert_eq!(o.frequency, Order::TooFewPoints { points: 0 });
    }

    #[test]
    fn rounding_is_no_convergence() {
        let o = measured(|p| {
            p.frequency_error_rel = 1e-16;
            if p.step_s < 1.5e-4 {
                p.max_event_error_s = 0.0;
            }
        });
        assert_eq!(o.frequency, Order::RoundOff { points: 6 });
        assert!(is(o.event_time, 1.0, 3), "{o:?}");
    }
}
