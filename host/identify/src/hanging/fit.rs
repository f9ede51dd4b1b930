//! Least-squares fit of torque constant, losses and friction to the mean currents, with 95 %
//! confidence intervals.

use super::way::Mean;
use crate::Estimate;
use crate::descent::{Ending, Equations, LeastSquares, descend};
use crate::estimate::DEVIATIONS;
use nalgebra::{Const, SMatrix, SVector};

/// Parameters of the fit: K/M (1/A), μ, F/M, φ₀ (rad), c·M (rad).
type Numbers = SVector<f64, 5>;
type Square = SMatrix<f64, 5, 5>;

/// Fewest means of a fit, in either sense of the motion.
const LEAST_MEANS: usize = 12;

/// Smallest range of the load: largest less smallest |sin(φw − φ₀)|.
const LEAST_LOAD: f64 = 0.25;

/// Half width of the range around the hanging weight that is left out, rad: the teeth of the gear
/// change sides there.
const LEFT_OUT_RAD: f64 = 0.07;

/// Allowances for model errors in the 95 % intervals: share of K, share of F, and absolute for μ.
const MODEL: [f64; 3] = [0.01, 0.03, 0.015];

/// Reason why the currents give no torque constant.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// Too little motion.
    #[error(
        "the weight was moved over {up} degrees one way and {down} back, {LEAST_MEANS} each are needed: it is too heavy for the motor, \
         or the brace is at a stop"
    )]
    Short {
        /// Number of whole degrees on the way up.
        up: usize,
        /// Number of whole degrees on the way down.
        down: usize,
    },
    /// The load hardly changes.
    #[error(
        "the weight's torque changed by {share:.0} % of its greatest only, 25 % are needed: begin with the weight hanging, not held aside"
    )]
    Flat {
        /// Range of the load, % of the moment.
        share: f64,
    },
    /// The currents are not those of a weight.
    #[error(
        "the currents are not those of a weight that is lifted and let down: the fit leaves {residual_a:.3} A of {greatest_a:.3} A; \
         did something else touch the arm, or does the weight swing on its hook?"
    )]
    Misfit {
        /// RMS residual of the current, A.
        residual_a: f64,
        /// Largest mean current, A.
        greatest_a: f64,
    },
    /// A fitted value is impossible for motor, gear or weight.
    #[error(
        "the fit ends at {what}, which no brace has: is a weight on the arm at all, and is the polarity proven?"
    )]
    Implausible {
        /// Name of the implausible quantity.
        what: &'static str,
    },
}

/// Values identified from the hanging weight, with 95 % confidence intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct HangingFit {
    /// Torque at the joint per ampere, without losses, N·m/A.
    pub nm_per_a: Estimate,
    /// Share of the motor's torque that the gear loses.
    pub load_loss: Estimate,
    /// Dry friction, N·m; includes viscous friction at the speed of the motion.
    pub friction_nm: Estimate,
    /// Encoder's angle at which the weight hangs, rad.
    pub hangs_rad: Estimate,
    /// RMS residual of the current, A.
    pub residual_a: f64,
    /// Angle, rad, measured current, A, and fitted current, A, of each mean.
    pub curve: Vec<[f64; 3]>,
    /// Whether the compliance of the brace was identified; otherwise it is an assumption, and the
    /// interval wider.
    pub tells_stiffness: bool,
}

/// Returns the modelled current of a mean, A.
fn current_a(n: &Numbers, mean: &Mean) -> f64 {
    let [scale, loss, friction, hangs, gives] = [n[0], n[1], n[2], n[3], n[4]];
    let mut load = (mean.angle_rad - hangs).sin();
    // What gives way is small: this converges by its cube.
    for _ in 0..3 {
        load = (mean.angle_rad - gives * load - hangs).sin();
    }
    let torque = load + friction * mean.sense;
    let share = 1.0 - loss * torque.signum() * mean.sense;
    torque / (scale * share)
}

/// Fits torque constant, losses and friction. `moment_nm` is the moment of the horizontal weight
/// with its 95 % confidence interval; `hangs_rad` and `nm_per_a` are initial guesses of the angle
/// at which it hangs, rad, and of the torque per ampere, N·m/A.
///
/// # Errors
/// [`Refusal`]: what the currents show instead.
pub fn found(
    means: &[Mean],
    moment_nm: Estimate,
    hangs_rad: f64,
    nm_per_a: f64,
) -> Result<HangingFit, Refusal> {
    let count = |sense: f64| means.iter().filter(|m| m.sense * sense > 0.0).count();
    let away = means.first().map_or(1.0, |mean| mean.sense);
    let (up, down) = (count(away), count(-away));
    if up.min(down) < LEAST_MEANS {
        return Err(Refusal::Short { up, down });
    }
    let moment = moment_nm.value;
    // Stiffer than 100 N·m/rad, softer than rigid.
    let gives = 0.005 * moment;
    let prior = Numbers::from([nm_per_a / moment, 0.25, 0.4 / moment, hangs_rad, gives]);
    let weights = Numbers::from([0.0, 0.25_f64.powi(-2), 0.0, 0.0, gives.powi(-2)]);
    let mut numbers = prior;
    let mut used: Vec<Mean> = means.to_vec();
    // The first time with all, then without what is near where the weight hangs.
    for _ in 0..2 {
        numbers = fitted(&used, numbers, &prior, &weights);
        used = means
            .iter()
            .filter(|m| (m.angle_rad - numbers[3]).abs() > LEFT_OUT_RAD)
            .copied()
            .collect();
    }
    let numbers = fitted(&used, numbers, &prior, &weights);
    let loads = used.iter().map(|m| (m.angle_rad - numbers[3]).sin().abs());
    let (least, most) = loads.fold((1.0_f64, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    if most - least < LEAST_LOAD {
        return Err(Refusal::Flat {
            share: 100.0 * (most - least),
        });
    }
    let residuals: Vec<f64> = used
        .iter()
        .map(|m| m.current_a - current_a(&numbers, m))
        .collect();
    let square: f64 = residuals.iter().map(|r| r * r).sum();
    let residual_a = (square / residuals.len() as f64).sqrt();
    let greatest_a = used.iter().map(|m| m.current_a.abs()).fold(0.0, f64::max);
    for (what, is_wrong) in [
        (
            "no torque for an ampere",
            !(numbers[0] * moment > 0.05 && numbers[0].is_finite()),
        ),
        (
            "a loss of more than 70 % or less than none",
            !(-0.1..0.7).contains(&numbers[1]),
        ),
        ("friction of less than none", numbers[2] < -0.02),
        (
            "a friction that is greater than the weight",
            numbers[2] > 0.9,
        ),
        (
            "a weight that hangs somewhere else",
            (numbers[3] - hangs_rad).abs() > 1.0,
        ),
    ] {
        if is_wrong {
            return Err(Refusal::Implausible { what });
        }
    }
    if residual_a > 0.06 * greatest_a {
        return Err(Refusal::Misfit {
            residual_a,
            greatest_a,
        });
    }
    let (covariance, data) = covariance(&used, &numbers, &weights, &residuals);
    let half = |at: usize| DEVIATIONS * covariance[(at, at)].max(0.0).sqrt();
    let together = |parts: [f64; 3]| parts.iter().map(|part| part * part).sum::<f64>().sqrt();
    let by_weight = moment_nm.share();
    let (scale, friction) = (numbers[0] * moment, numbers[2] * moment);
    Ok(HangingFit {
        nm_per_a: Estimate {
            value: scale,
            half_width: together([half(0) * moment, scale * by_weight, scale * MODEL[0]]),
        },
        load_loss: Estimate {
            value: numbers[1],
            half_width: together([half(1), MODEL[2], 0.0]),
        },
        friction_nm: Estimate {
            value: friction,
            half_width: together([half(2) * moment, friction * by_weight, friction * MODEL[1]]),
        },
        hangs_rad: Estimate {
            value: numbers[3],
            half_width: half(3),
        },
        residual_a,
        curve: used
            .iter()
            .map(|m| [m.angle_rad, m.current_a, current_a(&numbers, m)])
            .collect(),
        tells_stiffness: data > 4.0 * weights[4],
    })
}

/// Returns the derivatives of the current with respect to the parameters.
fn slopes(numbers: &Numbers, mean: &Mean) -> Numbers {
    Numbers::from_fn(|at, _| {
        let step = 1e-6 * numbers[at].abs().max(1e-2);
        let (mut less, mut more) = (*numbers, *numbers);
        less[at] -= step;
        more[at] += step;
        (current_a(&more, mean) - current_a(&less, mean)) / (2.0 * step)
    })
}

/// Approximate noise of a mean, A, which weighs the assumptions against the data.
const NOISE_A: f64 = 0.005;

/// The squares of what the means leave of the current, and of the deviations from what is assumed.
struct Problem<'m> {
    means: &'m [Mean],
    prior: &'m Numbers,
    weights: &'m Numbers,
}

impl LeastSquares<Const<5>> for Problem<'_> {
    type Point = Numbers;

    fn equations(&self, numbers: &Numbers) -> Equations<Const<5>> {
        let mut normal = Square::from_diagonal(self.weights);
        let mut right = (self.prior - numbers).component_mul(self.weights);
        for mean in self.means {
            let slope = slopes(numbers, mean) / NOISE_A;
            normal += slope * slope.transpose();
            right += slope * ((mean.current_a - current_a(numbers, mean)) / NOISE_A);
        }
        Equations { normal, right }
    }

    fn cost(&self, numbers: &Numbers) -> f64 {
        let off = numbers - self.prior;
        let misfit = |mean: &Mean| (mean.current_a - current_a(numbers, mean)).powi(2);
        let misfit: f64 = self.means.iter().map(misfit).sum();
        misfit / NOISE_A.powi(2) + off.component_mul(&off).dot(self.weights)
    }

    fn stepped(&self, numbers: &Numbers, step: &Numbers) -> Numbers {
        numbers + step
    }
}

/// Returns the numbers that fit the means best, from a guess; the guess where the currents say
/// nothing about them.
fn fitted(means: &[Mean], from: Numbers, prior: &Numbers, weights: &Numbers) -> Numbers {
    let problem = Problem {
        means,
        prior,
        weights,
    };
    let ending = Ending {
        steps: 100,
        gain: 1e-9,
        caution: (1e-12, 1e9),
    };
    descend(&problem, from, ending).unwrap_or(from)
}

/// Returns the covariance of the parameters, scaled by the residual, and the information of the data
/// on c·M, 1/rad², marginal over the other parameters.
fn covariance(
    means: &[Mean],
    numbers: &Numbers,
    weights: &Numbers,
    residuals: &[f64],
) -> (Square, f64) {
    let free = (residuals.len() as f64 - 5.0).max(1.0);
    let square: f64 = residuals.iter().map(|r| r * r).sum();
    // Neighbours err alike: as many fewer means count.
    let pairs: f64 = residuals.windows(2).map(|w| w[0] * w[1]).sum();
    let alike = (pairs / square.max(1e-30)).clamp(0.0, 0.95);
    let noise = (square / free).max(1e-8) * (1.0 + alike) / (1.0 - alike);
    let data = means
        .iter()
        .map(|m| slopes(numbers, m))
        .fold(Square::zeros(), |sum, s| sum + s * s.transpose())
        / noise;
    let all = data + Square::from_diagonal(weights);
    let others = all.remove_row(4).remove_column(4);
    let to = all.column(4).remove_row(4);
    let hidden = others.lu().solve(&to).map_or(0.0, |x| to.dot(&x));
    let of_gives = all[(4, 4)] - weights[4] - hidden;
    (
        all.try_inverse()
            .unwrap_or_else(|| Square::from_diagonal_element(f64::INFINITY)),
        of_gives,
    )
}

#[cfg(test)]
mod tests;
