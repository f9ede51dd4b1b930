//! Cost function of the fit: residuals of all swings and prior, with their derivatives.

use crate::brace::numbers::{LEAST, MOST, NUMBERS, place, weighted_brace};
use crate::brace::prior::Prior;
use crate::brace::start;
use crate::brace::swing::Swing;
use crate::descent::{Equations, LeastSquares};
use crepitus_plant::swing::{Begin, STEP_S, swing};
use nalgebra::{DMatrix, DVector, Dyn};

/// Steps from one compared angle to the next: 2 ms.
pub(crate) const STRIDE: usize = 4;

/// Number of parameters of the initial state of a swing.
pub(crate) const OWN: usize = 4;

/// Prior standard deviations of the initial state, in the order of [`Begin`]: rad, rad/s, rad,
/// rad/s.
pub(crate) const OWN_DEVIATION: [f64; OWN] = [0.1, 3.0, 5e-3, 0.3];

/// Step of a difference quotient in a compliance, rad/(N·m).
const COMPLIANCE_STEP: f64 = 4e-6;

/// Time between two residuals, s.
pub(crate) const RESIDUAL_S: f64 = STEP_S * STRIDE as f64;

/// Returns whether a parameter is a torque per something: it is in the vector as p·M₀/M, with M₀
/// the given moment.
pub(crate) fn is_torque(at: usize) -> bool {
    at <= place::TORQUE_SCALE && !matches!(at, place::LOAD_LOSS | place::GAP | place::MOMENT)
}

/// Imperfections that a fit looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Sought {
    /// None: rigid parts, Coulomb friction.
    Nothing,
    /// All of the brace's.
    OfBrace,
    /// And a wrong scale of the encoder.
    OfEncoder,
}

impl Sought {
    /// Returns whether a parameter is fitted.
    fn includes(self, at: usize) -> bool {
        at <= place::TORQUE_SCALE
            || match self {
                Self::Nothing => false,
                Self::OfBrace => at != place::ENCODER,
                Self::OfEncoder => true,
            }
    }
}

pub(crate) struct Problem<'s> {
    pub(crate) swings: &'s [Swing],
    pub(crate) recordings: usize,
    pub(crate) prior: Prior,
    /// Number of fitted steps of each swing.
    pub(crate) horizon: usize,
    /// Weight of a residual, 1/rad².
    pub(crate) weight: f64,
    /// Which imperfections are fitted.
    pub(crate) sought: Sought,
    /// One-sided differences instead of central ones.
    pub(crate) is_rough: bool,
}

impl Problem<'_> {
    pub(crate) fn own(&self, swing: usize) -> usize {
        NUMBERS + self.recordings + OWN * swing
    }

    pub(crate) fn length(&self) -> usize {
        self.own(self.swings.len())
    }

    pub(crate) fn start(&self) -> DVector<f64> {
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

    /// Returns M/M₀.
    pub(crate) fn ratio(&self, vector: &DVector<f64>) -> f64 {
        vector[place::MOMENT] / self.prior.mean[place::MOMENT]
    }

    /// Returns a parameter, or another entry, from the vector.
    pub(crate) fn number(&self, vector: &DVector<f64>, at: usize) -> f64 {
        if at < NUMBERS && is_torque(at) {
            vector[at] * self.ratio(vector)
        } else {
            vector[at]
        }
    }

    /// Returns the derivatives of a parameter with respect to entries of the vector.
    pub(crate) fn slopes(&self, vector: &DVector<f64>, at: usize) -> Vec<(usize, f64)> {
        if at < NUMBERS && is_torque(at) {
            let by_moment = vector[at] / self.prior.mean[place::MOMENT];
            vec![(at, self.ratio(vector)), (place::MOMENT, by_moment)]
        } else {
            vec![(at, 1.0)]
        }
    }

    /// Returns prior mean and standard deviation of an entry; `None` for hang angles, which are
    /// free.
    pub(crate) fn known(&self, at: usize) -> Option<(f64, f64)> {
        if at < NUMBERS {
            return Some((self.prior.mean[at], self.prior.deviation[at]));
        }
        let own = at.checked_sub(NUMBERS + self.recordings)? % OWN;
        // Angle and velocity are free, too.
        (own >= 2).then_some((0.0, OWN_DEVIATION[own]))
    }

    /// Returns the information matrix of the prior.
    pub(crate) fn information(&self, vector: &DVector<f64>) -> DMatrix<f64> {
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

    /// Returns the scale of an entry, for steps and finite differences.
    pub(crate) fn scale(&self, at: usize) -> f64 {
        match self.known(at) {
            Some((_, deviation)) => deviation,
            None if at < NUMBERS + self.recordings => 0.1,
            None => OWN_DEVIATION[(at - NUMBERS - self.recordings) % OWN],
        }
    }

    pub(crate) fn simulate(&self, vector: &DVector<f64>, swing_at: usize) -> Vec<f64> {
        let it = &self.swings[swing_at];
        let mut numbers: [f64; NUMBERS] = std::array::from_fn(|i| vector[i]);
        numbers[place::MOMENT] = self.prior.mean[place::MOMENT];
        let own = self.own(swing_at);
        let encoder = 1.0 + vector[place::ENCODER];
        let begin = Begin {
            angle_rad: vector[own] / encoder,
            omega_rad_s: vector[own + 1] / encoder,
            deflection_rad: vector[own + 2],
            deflection_rad_s: vector[own + 3],
        };
        let steps = it.torques_nm.len().min(self.horizon);
        let hang = vector[NUMBERS + it.recording] / encoder;
        let scale = numbers[place::TORQUE_SCALE];
        let torques_nm: Vec<f64> = it.torques_nm[..steps].iter().map(|t| scale * t).collect();
        let angles = swing(&weighted_brace(&numbers), hang, &begin, &torques_nm);
        std::iter::once(begin.angle_rad)
            .chain(angles)
            .step_by(STRIDE)
            .map(|angle| encoder * angle)
            .collect()
    }

    pub(crate) fn residual(&self, vector: &DVector<f64>, swing_at: usize) -> Vec<f64> {
        self.compared(&self.simulate(vector, swing_at), swing_at)
    }

    /// Returns the residuals of a swing, measured minus simulated angle, rad.
    pub(crate) fn compared(&self, simulated: &[f64], swing_at: usize) -> Vec<f64> {
        let measured = self.swings[swing_at].angles_rad.iter().step_by(STRIDE);
        measured.zip(simulated).map(|(m, s)| m - s).collect()
    }

    pub(crate) fn residuals(&self, vector: &DVector<f64>) -> Vec<Vec<f64>> {
        (0..self.swings.len())
            .map(|swing| self.residual(vector, swing))
            .collect()
    }

    /// Returns the normal equations, and the gradients of the half swings if they are wanted.
    pub(crate) fn equations_by_half_swing(
        &self,
        vector: &DVector<f64>,
        with_blocks: bool,
    ) -> (Equations<Dyn>, Vec<DVector<f64>>) {
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
        (Equations { normal, right }, blocks)
    }

    /// Returns the derivative of a swing's angles with respect to one entry, by differences from
    /// `base` or by central differences.
    pub(crate) fn slope(
        &self,
        vector: &DVector<f64>,
        swing_at: usize,
        at: usize,
        base: &[f64],
    ) -> Vec<f64> {
        if at == place::MOMENT || (at < NUMBERS && !self.sought.includes(at)) {
            return vec![0.0; base.len()];
        }
        let step = match at {
            // A softer spring than the stiffest that a step can follow.
            place::PRESLIDING | place::TEETH => COMPLIANCE_STEP,
            _ => 1e-4 * self.scale(at),
        };
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
}

impl LeastSquares<Dyn> for Problem<'_> {
    type Point = DVector<f64>;

    fn equations(&self, vector: &DVector<f64>) -> Equations<Dyn> {
        self.equations_by_half_swing(vector, false).0
    }

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

    fn stepped(&self, vector: &DVector<f64>, step: &DVector<f64>) -> DVector<f64> {
        let mut next = vector + step;
        for at in (0..NUMBERS).filter(|at| self.sought.includes(*at)) {
            next[at] = next[at].clamp(LEAST[at], MOST[at]);
        }
        next
    }
}
