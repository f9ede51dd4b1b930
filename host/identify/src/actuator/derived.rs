//! Quantities derived from a fit, with first-order error propagation.

use crate::actuator::fit::Fit;
use crate::estimate::{DEVIATIONS, Estimate};
use crepitus_plant::effects::reaction_mass::impedance::{Impedance, NUMBERS};

/// Returns a function of the fitted parameters with its 95 % confidence interval, to first order.
pub(crate) fn derived(fit: &Fit, of: impl Fn(&Impedance) -> f64) -> Estimate {
    Estimate {
        value: of(&fit.impedance),
        half_width: DEVIATIONS * variance(fit, of).sqrt(),
    }
}

/// Returns the variance of a function of the fitted parameters, to first order.
pub(crate) fn variance(fit: &Fit, of: impl Fn(&Impedance) -> f64) -> f64 {
    let numbers = <[f64; NUMBERS]>::from(fit.impedance);
    let mut gradient = nalgebra::SVector::<f64, NUMBERS>::zeros();
    for place in 0..NUMBERS {
        // A fraction of the deviation: the quantity is as good as linear there.
        let step = 1e-3 * fit.covariance[(place, place)].sqrt();
        let moved = |by: f64| {
            let mut moved = numbers;
            moved[place] += by;
            of(&moved.into())
        };
        if step > 0.0 {
            gradient[place] = (moved(step) - moved(-step)) / (2.0 * step);
        }
    }
    (gradient.transpose() * fit.covariance * gradient)[(0, 0)]
}
