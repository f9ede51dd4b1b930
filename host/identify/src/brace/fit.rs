//! The numbers that explain all swings together: simulated and compared angle by angle.
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

use crate::brace::model::{Begin, STEP_S, swing};
use crate::brace::numbers::{LEAST, MOST, NUMBERS, place};
use crate::brace::prior::Prior;
use crate::brace::start;
use crate::brace::swing::Swing;
use nalgebra::{DMatrix, DVector};

/// Steps from one compared angle to the next: 2 ms.
pub(crate) const STRIDE: usize = 4;

/// Numbers of a swing's own.
const OWN: usize = 4;

/// Their deviation before: the bend of the cuffs beyond a steady one.
const OWN_DEVIATION: [f64; OWN] = [0.1, 3.0, 5e-3, 0.3];

/// Parts of a swing that are fitted, one after the other, s: its beginning, and all.
const EARLY_S: [f64; 2] = [0.7, 1.6];
const LATE_S: [f64; 2] = [3.5, f64::INFINITY];

/// Most steps in each, and the relative gain that ends them; and of the whole in the end.
const EARLY_STEPS: u32 = 12;
const EARLY_GAIN: f64 = 1e-3;
const MOST_STEPS: u32 = 30;
const SMALLEST_GAIN: f64 = 1e-6;

/// Other starts: factors for some numbers.
const AROUND: [[(usize, f64); 3]; 5] = [
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

/// With this left no other start is tried, rad rms: a count of the usual encoder is 36 µrad, and
/// leaves 10.
pub(crate) const GOOD_ENOUGH: f64 = 2e-5;

/// Deviation of an angle before it is known, rad, and the least: of a count.
const FIRST_DEVIATION: f64 = 2e-3;
const LEAST_DEVIATION: f64 = 1e-4;

/// A fit.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    /// Of the brace.
    pub(crate) numbers: [f64; NUMBERS],
    /// Their covariance.
    pub(crate) covariance: DMatrix<f64>,
    /// Measured minus simulated, rad, by swing, every [`STRIDE`] steps; NaN where no sample is.
    pub(crate) residuals: Vec<Vec<f64>>,
    /// Angle at which the weight hangs, by recording, rad.
    pub(crate) hangs_rad: Vec<f64>,
    /// Root mean square of the residuals, rad.
    pub(crate) rms_rad: f64,
}

/// Time between two residuals, s.
pub(crate) const RESIDUAL_S: f64 = STEP_S * STRIDE as f64;

/// Numbers that are a torque for something: in the vector as p·M₀/M, with M₀ as it was given.
fn is_torque(at: usize) -> bool {
    !matches!(at, place::LOAD_LOSS | place::GAP | place::MOMENT)
}

struct Problem<'s> {
    swings: &'s [Swing],
    recordings: usize,
    prior: Prior,
    /// Steps that are fitted.
    horizon: usize,
    /// Weight of a residual, 1/rad².
    weight: f64,
    /// Derivatives by differences to one side.
    is_rough: bool,
}

struct Equations {
    normal: DMatrix<f64>,
    right: DVector<f64>,
    left: f64,
    /// Gradient of each half swing.
    blocks: Vec<DVector<f64>>,
}

impl Fit {
    /// Fits all swings from the guess; `None` if the equations have no solution.
    pub(crate) fn of(swings: &[Swing], recordings: usize, prior: &Prior) -> Option<Self> {
        let mut problem = Problem::of(swings, recordings, prior);
        let guess = problem.start();
        let near = problem.near(guess)?;
        problem.whole(near)
    }

    /// The beginnings of all swings from many starts: what is left, rad rms, and where to go
    /// on.
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

    /// Goes on from one of these.
    pub(crate) fn from(
        swings: &[Swing],
        recordings: usize,
        prior: &Prior,
        near: DVector<f64>,
    ) -> Option<Self> {
        Problem::of(swings, recordings, prior).whole(near)
    }

    /// Standard deviation of a number.
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
            is_rough: false,
        }
    }

    /// The whole of all swings from a fit of their beginnings, and how well each number is known.
    fn whole(mut self, near: DVector<f64>) -> Option<Fit> {
        let mut vector = self.along(near, &LATE_S)?;
        self.weight = 1.0 / LEAST_DEVIATION.powi(2);
        vector = self.descend(vector, MOST_STEPS, EARLY_GAIN)?;
        // The weight of the data against what was known before follows from what is left.
        for _ in 0..3 {
            let deviation = effective_deviation(&self.residuals(&vector));
            self.weight = 1.0 / deviation.powi(2);
            vector = self.descend(vector, MOST_STEPS, SMALLEST_GAIN)?;
        }
        let equations = self.equations(&vector, true);
        let inverse = equations.normal.clone().cholesky()?.inverse();
        let mut covariance = &inverse * self.information(&vector) * &inverse;
        // What each half swing does to each number: errors of a model have the same sign from
        // one to the next, so they add up.
        let mut pulls = DVector::zeros(inverse.nrows());
        for block in &equations.blocks {
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
        })
    }

    /// From a start to the fit of the beginnings.
    fn near(&mut self, start: DVector<f64>) -> Option<DVector<f64>> {
        self.is_rough = true;
        let near = self.along(start, &EARLY_S);
        self.is_rough = false;
        near
    }

    /// From a shorter part of the swings to a longer one.
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

    /// The guess, and starts about it.
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

    fn own(&self, swing: usize) -> usize {
        NUMBERS + self.recordings + OWN * swing
    }

    fn length(&self) -> usize {
        self.own(self.swings.len())
    }

    fn start(&self) -> DVector<f64> {
        let hangs = start::hangs(self.swings, self.recordings);
        let numbers = start::numbers(self.swings, &hangs, &self.prior);
        let mut vector = DVector::zeros(self.length());
        vector.as_mut_slice()[..NUMBERS].copy_from_slice(&numbers);
        vector.as_mut_slice()[NUMBERS..][..self.recordings].copy_from_slice(&hangs);
        for (i, swing) in self.swings.iter().enumerate() {
            let own = self.own(i);
            vector[own] = swing.angles_rad.first().copied().unwrap_or(0.0);
            vector[own + 1] = swing.omega_rad_s;
        }
        vector
    }

    /// M over M₀.
    fn ratio(&self, vector: &DVector<f64>) -> f64 {
        vector[place::MOMENT] / self.prior.mean[place::MOMENT]
    }

    /// A number, or another entry, from the vector.
    fn number(&self, vector: &DVector<f64>, at: usize) -> f64 {
        if at < NUMBERS && is_torque(at) {
            vector[at] * self.ratio(vector)
        } else {
            vector[at]
        }
    }

    /// Its derivatives by entries of the vector.
    fn slopes(&self, vector: &DVector<f64>, at: usize) -> Vec<(usize, f64)> {
        if at < NUMBERS && is_torque(at) {
            let by_moment = vector[at] / self.prior.mean[place::MOMENT];
            vec![(at, self.ratio(vector)), (place::MOMENT, by_moment)]
        } else {
            vec![(at, 1.0)]
        }
    }

    /// Mean and deviation of each number before; hang angles are free.
    fn known(&self, at: usize) -> Option<(f64, f64)> {
        if at < NUMBERS {
            return Some((self.prior.mean[at], self.prior.deviation[at]));
        }
        let own = at.checked_sub(NUMBERS + self.recordings)? % OWN;
        // Angle and velocity are free, too.
        (own >= 2).then_some((0.0, OWN_DEVIATION[own]))
    }

    /// What was known before, as a matrix of information.
    fn information(&self, vector: &DVector<f64>) -> DMatrix<f64> {
        let n = self.length();
        let mut information = DMatrix::zeros(n, n);
        for at in 0..n {
            if let Some((_, deviation)) = self.known(at) {
                let slopes = self.slopes(vector, at);
                for (i, a) in &slopes {
                    for (j, b) in &slopes {
                        information[(*i, *j)] += a * b / (deviation * deviation);
                    }
                }
            }
        }
        information
    }

    /// A number's own size, for steps and differences.
    fn scale(&self, at: usize) -> f64 {
        match self.known(at) {
            Some((_, deviation)) => deviation,
            None if at < NUMBERS + self.recordings => 0.1,
            None => OWN_DEVIATION[(at - NUMBERS - self.recordings) % OWN],
        }
    }

    fn bounded(vector: &mut DVector<f64>) {
        for at in 0..NUMBERS {
            vector[at] = vector[at].clamp(LEAST[at], MOST[at]);
        }
    }

    fn simulate(&self, vector: &DVector<f64>, swing_at: usize) -> Vec<f64> {
        let it = &self.swings[swing_at];
        let mut numbers: [f64; NUMBERS] = std::array::from_fn(|i| vector[i]);
        numbers[place::MOMENT] = self.prior.mean[place::MOMENT];
        let own = self.own(swing_at);
        let begin = Begin {
            angle_rad: vector[own],
            omega_rad_s: vector[own + 1],
            deflection_rad: vector[own + 2],
            deflection_rad_s: vector[own + 3],
        };
        let steps = it.torques_nm.len().min(self.horizon);
        let hang = vector[NUMBERS + it.recording];
        let angles = swing(&numbers.into(), hang, &begin, &it.torques_nm[..steps]);
        std::iter::once(begin.angle_rad)
            .chain(angles)
            .step_by(STRIDE)
            .collect()
    }

    fn residual(&self, vector: &DVector<f64>, swing_at: usize) -> Vec<f64> {
        self.compared(&self.simulate(vector, swing_at), swing_at)
    }

    /// Measured minus simulated.
    fn compared(&self, simulated: &[f64], swing_at: usize) -> Vec<f64> {
        let measured = self.swings[swing_at].angles_rad.iter().step_by(STRIDE);
        measured.zip(simulated).map(|(m, s)| m - s).collect()
    }

    fn residuals(&self, vector: &DVector<f64>) -> Vec<Vec<f64>> {
        (0..self.swings.len())
            .map(|swing| self.residual(vector, swing))
            .collect()
    }

    /// What is to be least.
    fn cost(&self, vector: &DVector<f64>) -> f64 {
        let squares: f64 = (0..self.swings.len())
            .flat_map(|swing| self.residual(vector, swing))
            .filter(|r| !r.is_nan())
            .map(|r| r * r)
            .sum();
        let known: f64 = (0..vector.len())
            .filter_map(|at| self.known(at).map(|known| (at, known)))
            .map(|(at, (mean, deviation))| ((self.number(vector, at) - mean) / deviation).powi(2))
            .sum();
        self.weight * squares + known
    }

    fn equations(&self, vector: &DVector<f64>, with_blocks: bool) -> Equations {
        let n = self.length();
        let mut normal = self.information(vector);
        let mut right = DVector::zeros(n);
        for at in 0..n {
            if let Some((mean, deviation)) = self.known(at) {
                let off = (mean - self.number(vector, at)) / (deviation * deviation);
                for (i, slope) in self.slopes(vector, at) {
                    right[i] += slope * off;
                }
            }
        }
        let mut blocks = Vec::new();
        for swing_at in 0..self.swings.len() {
            let base = self.simulate(vector, swing_at);
            let residual = self.compared(&base, swing_at);
            let recording = NUMBERS + self.swings[swing_at].recording;
            let own = self.own(swing_at);
            let places: Vec<usize> = (0..NUMBERS)
                .chain([recording])
                .chain(own..own + OWN)
                .collect();
            let columns: Vec<Vec<f64>> = places
                .iter()
                .map(|at| self.slope(vector, swing_at, *at, &base))
                .collect();
            let is_good = |r: usize| !residual[r].is_nan();
            for (i, a) in places.iter().zip(&columns) {
                for (j, b) in places.iter().zip(&columns) {
                    if j > i {
                        continue;
                    }
                    let sum: f64 = (0..residual.len())
                        .filter(|r| is_good(*r))
                        .map(|r| a[r] * b[r])
                        .sum();
                    normal[(*i, *j)] += self.weight * sum;
                    if i != j {
                        normal[(*j, *i)] += self.weight * sum;
                    }
                }
            }
            // One after the other: a half swing ends at a turning point.
            let mut ends: Vec<usize> = self.swings[swing_at]
                .turn_steps
                .iter()
                .map(|step| step / STRIDE)
                .collect();
            ends.push(residual.len());
            let mut from = 0;
            for end in ends {
                let end = end.min(residual.len());
                let mut block = DVector::zeros(if with_blocks { n } else { 0 });
                for (i, a) in places.iter().zip(&columns) {
                    let sum: f64 = (from..end)
                        .filter(|r| is_good(*r))
                        .map(|r| a[r] * residual[r])
                        .sum();
                    right[*i] += self.weight * sum;
                    if with_blocks {
                        block[*i] = self.weight * sum;
                    }
                }
                if with_blocks {
                    blocks.push(block);
                }
                from = end.max(from);
            }
        }
        Equations {
            normal,
            right,
            left: self.cost(vector),
            blocks,
        }
    }

    /// Derivative of a swing's angles by one entry, by differences from `base` or to both sides.
    fn slope(&self, vector: &DVector<f64>, swing_at: usize, at: usize, base: &[f64]) -> Vec<f64> {
        if at == place::MOMENT {
            return vec![0.0; base.len()];
        }
        let step = 1e-4 * self.scale(at);
        let moved = |by: f64| {
            let mut moved = vector.clone();
            moved[at] += by;
            self.simulate(&moved, swing_at)
        };
        let up = moved(step);
        let is_at_end = at < NUMBERS && vector[at] - step < LEAST[at];
        let (down, way) = if self.is_rough || is_at_end {
            (base.to_vec(), step)
        } else {
            (moved(-step), 2.0 * step)
        };
        up.iter()
            .zip(down)
            .map(|(up, down)| (up - down) / way)
            .collect()
    }

    fn descend(
        &self,
        mut vector: DVector<f64>,
        steps: u32,
        least_gain: f64,
    ) -> Option<DVector<f64>> {
        let mut equations = self.equations(&vector, false);
        let mut caution = 1e-3;
        for _ in 0..steps {
            let mut cautious = equations.normal.clone();
            for i in 0..vector.len() {
                cautious[(i, i)] += caution * equations.normal[(i, i)];
            }
            let mut next = &vector + cautious.cholesky()?.solve(&equations.right);
            Self::bounded(&mut next);
            let left = self.cost(&next);
            if left < equations.left {
                let gain = (equations.left - left) / equations.left;
                vector = next;
                if gain < least_gain {
                    break;
                }
                equations = self.equations(&vector, false);
                caution = (caution / 10.0).max(1e-9);
            } else {
                caution *= 10.0;
                if caution > 1e8 {
                    break;
                }
            }
        }
        Some(vector)
    }
}

fn rms(residuals: &[Vec<f64>]) -> f64 {
    let all = residuals.iter().flatten().filter(|r| !r.is_nan());
    let (sum, n) = all.fold((0.0, 0.0), |(sum, n), r| (sum + r * r, n + 1.0));
    if n > 0.0 { f64::sqrt(sum / n) } else { 0.0 }
}

/// Deviation with which an angle counts: as if so many fewer had been compared as
/// neighbours err together.
fn effective_deviation(residuals: &[Vec<f64>]) -> f64 {
    let all = rms(residuals).max(LEAST_DEVIATION);
    let at = |lag: usize| -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        for swing in residuals {
            for (a, b) in swing.iter().zip(swing.iter().skip(lag)) {
                if !a.is_nan() && !b.is_nan() {
                    (sum, n) = (sum + a * b, n + 1.0);
                }
            }
        }
        if n > 0.0 { sum / n } else { 0.0 }
    };
    let zero = at(0).max(1e-30);
    let longest = residuals.iter().map(Vec::len).max().unwrap_or(1) / 4;
    let correlated: f64 = (1..longest)
        .map(|lag| at(lag) / zero)
        .take_while(|rho| *rho > 0.05)
        .sum();
    all * (1.0 + 2.0 * correlated).sqrt()
}
