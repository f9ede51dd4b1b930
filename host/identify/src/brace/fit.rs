//! Nonlinear least-squares fit of the simulated angles to those of all swings together.
//!
//! Levenberg–Marquardt over the numbers of the brace, the angle at which the weight hangs
//! in each recording, and angle, velocity and bend of the cuffs as each swing begins. What
//! is known before ([`Prior`]) counts as one more measurement of each number. The first
//! part of each swing is fitted before the whole: a guess that is off by a tenth loses
//! the phase of the tenth half swing.
//!
//! Gravity alone has a torque, so a swing without the motor shows ratios to the weight's moment
//! M only, and one with it those of the motor's torque to M. So the fit is over ratios, of
//! which the angles depend, and over M, of which they do not: it is what a person has
//! measured, or the motor's torque constant if that is known better.
//!
//! The errors are no white noise: a count is off by where the shaft is in it, a model by
//! the same at each angle. So a residual counts with its integral time of correlation,
//! and the covariance is that of a sandwich over half swings,
//!
//! ```text
//! H = Σ JᵀJ/σ² + P,   cov = H⁻¹·(Σ g·gᵀ + P)·H⁻¹,   g = Jᵀr/σ² of a half swing
//! ```
//!
//! of which a deviation is never taken below that of H⁻¹, nor below Σ |H⁻¹·g|: the errors of
//! a model have the same sign in one half swing and the next, and do not average out.

use crate::brace::numbers::{NUMBERS, place};
use crate::brace::prior::Prior;
use crate::brace::problem::{Problem, Sought};
use crate::brace::residuals::{LEAST_DEVIATION, effective_deviation, rms};
use crate::brace::swing::Swing;
use crate::descent::{Ending, LeastSquares, descend};
use crate::parallel::in_parallel;
use crepitus_plant::swing::STEP_S;
use nalgebra::{DMatrix, DVector};

/// Lengths of the beginning of a swing that are fitted before the whole, s.
const EARLY_S: [f64; 2] = [0.7, 1.6];
const LATE_S: [f64; 2] = [3.5, f64::INFINITY];

/// Most iterations and relative decrease of the cost at convergence, of the beginnings; and of the
/// whole.
const EARLY_STEPS: u32 = 12;
const FIRST_STEPS: u32 = 8;
const EARLY_GAIN: f64 = 1e-3;
const MOST_STEPS: u32 = 30;
const SMALLEST_GAIN: f64 = 1e-6;

/// Factors of some parameters for other initial guesses.
const AROUND: [[(usize, f64); 3]; 6] = [
    // A weight that is bolted to the brace.
    [
        (place::STIFFNESS, 40.0),
        (place::DAMPING, 5.0),
        (place::GAP, 1.0),
    ],
    [
        (place::ROTOR, 1.4),
        (place::STIFFNESS, 1.6),
        (place::GAP, 1.5),
    ],
    [
        (place::ROTOR, 0.7),
        (place::STIFFNESS, 0.7),
        (place::GAP, 0.7),
    ],
    [
        (place::ROTOR, 0.7),
        (place::STIFFNESS, 1.4),
        (place::GAP, 0.6),
    ],
    [
        (place::ROTOR, 1.4),
        (place::DAMPING, 0.6),
        (place::BRACE, 1.6),
    ],
    [
        (place::GAP, 0.5),
        (place::DAMPING, 1.5),
        (place::BRACE, 0.6),
    ],
];

/// RMS residual below which no other start is tried, rad: the counts of the usual encoder, 36 µrad,
/// leave 10 µrad.
pub(crate) const GOOD_ENOUGH: f64 = 2e-5;

/// Initial standard deviation of an angle, rad.
const FIRST_DEVIATION: f64 = 2e-3;

/// Fitted parameters with covariance and residuals.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    /// Parameters of the brace, in the order of [`place`].
    pub(crate) numbers: [f64; NUMBERS],
    /// Covariance of the parameters.
    pub(crate) covariance: DMatrix<f64>,
    /// Residuals by swing: measured minus simulated angle every [`STRIDE`] steps, rad; NaN where no
    /// sample is.
    pub(crate) residuals: Vec<Vec<f64>>,
    /// Angle at which the weight hangs, by recording, rad.
    pub(crate) hangs_rad: Vec<f64>,
    /// Root mean square of the residuals, rad.
    pub(crate) rms_rad: f64,
    /// Standard deviation of an angle in the cost, rad.
    deviation_rad: f64,
    /// All that was fitted.
    vector: DVector<f64>,
}

/// Starts of the imperfections: compliance before friction slips, and of the teeth, rad/(N·m).
const COMPLIANT: [(f64, f64); 3] = [(2e-5, 3e-5), (2e-5, 3e-4), (1e-4, 3e-5)];

impl Fit {
    /// Fits all swings from the initial guess; `None` if the equations have no solution.
    pub(crate) fn of(swings: &[Swing], recordings: usize, prior: &Prior) -> Option<Self> {
        let mut problem = Problem::of(swings, recordings, prior);
        let guess = problem.start();
        let near = problem.near(guess)?;
        problem.whole(near)
    }

    /// Fits the beginnings of all swings from many starts; returns the RMS residual, rad, and the
    /// parameters of each.
    pub(crate) fn candidates(
        swings: &[Swing],
        recordings: usize,
        prior: &Prior,
    ) -> Vec<(f64, DVector<f64>)> {
        let mut problem = Problem::of(swings, recordings, prior);
        (problem.starts().into_iter())
            .filter_map(|start| {
                let near = problem.near(start)?;
                Some((rms(&problem.residuals(&near)), near))
            })
            .collect()
    }

    /// Fits all swings from a candidate.
    pub(crate) fn from(
        swings: &[Swing],
        recordings: usize,
        prior: &Prior,
        near: DVector<f64>,
    ) -> Option<Self> {
        Problem::of(swings, recordings, prior).whole(near)
    }

    /// Fits the imperfections, too, from a fit without.
    pub(crate) fn refined(
        &self,
        swings: &[Swing],
        recordings: usize,
        prior: &Prior,
        sought: Sought,
    ) -> Option<Self> {
        let problem = || {
            let mut problem = Problem::of(swings, recordings, prior);
            (problem.sought, problem.horizon) = (sought, usize::MAX);
            problem.weight = 1.0 / self.deviation_rad.powi(2);
            problem.is_rough = true;
            problem
        };
        // From one that has them already, on from there.
        let is_first = self.vector[place::TEETH] == 0.0;
        let starts = &COMPLIANT[..if is_first { COMPLIANT.len() } else { 1 }];
        let near = in_parallel(starts, |(presliding, teeth)| {
            let mut start = self.vector.clone();
            if is_first {
                (start[place::PRESLIDING], start[place::TEETH]) = (*presliding, *teeth);
            }
            let near = problem().descend(start, FIRST_STEPS, EARLY_GAIN)?;
            Some((problem().cost(&near), near))
        });
        let (_, near) = (near.into_iter().flatten()).min_by(|a, b| a.0.total_cmp(&b.0))?;
        problem().ended(near)
    }

    /// Returns whether one step towards a wrong scale of the encoder is worth a fit.
    pub(crate) fn suspects_encoder(
        &self,
        swings: &[Swing],
        recordings: usize,
        prior: &Prior,
    ) -> bool {
        /// Step of the scale, as a share, and in standard deviations.
        const SOME: f64 = 0.003;
        const UNLIKELY: f64 = 1.5;
        let mut problem = Problem::of(swings, recordings, prior);
        (problem.sought, problem.horizon) = (Sought::OfEncoder, usize::MAX);
        problem.weight = 1.0 / self.deviation_rad.powi(2);
        let equations = problem.equations(&self.vector);
        let Some(inverse) = equations
            .normal
            .cholesky()
            .map(|cholesky| cholesky.inverse())
        else {
            return false;
        };
        let step = (inverse.row(place::ENCODER) * &equations.right)[0];
        let deviation = inverse[(place::ENCODER, place::ENCODER)].max(0.0).sqrt();
        step.abs() > SOME && step.abs() > UNLIKELY * deviation
    }

    /// Returns the standard deviation of a parameter.
    pub(crate) fn deviation(&self, at: usize) -> f64 {
        self.covariance[(at, at)].max(0.0).sqrt()
    }
}

impl<'s> Problem<'s> {
    fn of(swings: &'s [Swing], recordings: usize, prior: &Prior) -> Self {
        Self {
            swings,
            recordings,
            prior: *prior,
            horizon: 0,
            weight: 1.0 / FIRST_DEVIATION.powi(2),
            sought: Sought::Nothing,
            is_rough: false,
        }
    }

    /// Fits the whole of all swings from a fit of their beginnings, and computes the covariance.
    fn whole(mut self, near: DVector<f64>) -> Option<Fit> {
        let mut vector = self.along(near, &LATE_S)?;
        self.weight = 1.0 / LEAST_DEVIATION.powi(2);
        vector = self.descend(vector, MOST_STEPS, EARLY_GAIN)?;
        self.ended(vector)
    }

    /// Settles the weight of the data, and computes the covariance.
    fn ended(mut self, mut vector: DVector<f64>) -> Option<Fit> {
        let mut deviation_rad = LEAST_DEVIATION;
        // The weight of the data against what was known before follows from what is left.
        for _ in 0..3 {
            deviation_rad = effective_deviation(&self.residuals(&vector));
            self.weight = 1.0 / deviation_rad.powi(2);
            vector = self.descend(vector, MOST_STEPS, SMALLEST_GAIN)?;
        }
        self.is_rough = false;
        let (equations, blocks) = self.equations_by_half_swing(&vector, true);
        let inverse = equations.normal.cholesky()?.inverse();
        let mut covariance = &inverse * self.information(&vector) * &inverse;
        // What each half swing does to each number: errors of a model have the same sign from
        // one to the next, so they add up.
        let mut pulls = DVector::zeros(inverse.nrows());
        for block in &blocks {
            pulls += (&inverse * block).abs();
            covariance += &inverse * block * block.transpose() * &inverse;
        }
        for i in 0..covariance.nrows() {
            let least = inverse[(i, i)].max(pulls[i].powi(2));
            let more = (least / covariance[(i, i)]).max(1.0).sqrt();
            covariance.row_mut(i).scale_mut(more);
            covariance.column_mut(i).scale_mut(more);
        }
        let residuals = self.residuals(&vector);
        let to_numbers = DMatrix::from_fn(NUMBERS, covariance.nrows(), |i, j| {
            self.slopes(&vector, i)
                .into_iter()
                .filter(|(at, _)| *at == j)
                .map(|(_, s)| s)
                .sum::<f64>()
        });
        Some(Fit {
            numbers: std::array::from_fn(|i| self.number(&vector, i)),
            covariance: &to_numbers * covariance * to_numbers.transpose(),
            hangs_rad: (0..self.recordings).map(|r| vector[NUMBERS + r]).collect(),
            rms_rad: rms(&residuals),
            residuals,
            deviation_rad,
            vector,
        })
    }

    /// Fits the beginnings from a start.
    fn near(&mut self, start: DVector<f64>) -> Option<DVector<f64>> {
        self.is_rough = true;
        let near = self.along(start, &EARLY_S);
        self.is_rough = false;
        near
    }

    /// Fits longer and longer parts of the swings.
    fn along(&mut self, mut vector: DVector<f64>, horizons_s: &[f64]) -> Option<DVector<f64>> {
        self.weight = 1.0 / FIRST_DEVIATION.powi(2);
        for horizon_s in horizons_s {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a cast from float saturates"
            )]
            let horizon = (horizon_s / STEP_S) as usize;
            self.horizon = horizon;
            vector = self.descend(vector, EARLY_STEPS, EARLY_GAIN)?;
        }
        Some(vector)
    }

    /// Returns the initial guess, and starts around it.
    fn starts(&self) -> Vec<DVector<f64>> {
        let guess = self.start();
        let moved = AROUND.iter().map(|factors| {
            let mut start = guess.clone();
            for (at, factor) in factors {
                start[*at] *= factor;
            }
            start
        });
        std::iter::once(guess.clone()).chain(moved).collect()
    }

    fn descend(&self, vector: DVector<f64>, steps: u32, gain: f64) -> Option<DVector<f64>> {
        let ending = Ending {
            steps,
            gain,
            caution: (1e-9, 1e8),
        };
        descend(self, vector, ending)
    }
}
