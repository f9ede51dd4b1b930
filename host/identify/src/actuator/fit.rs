//! Nonlinear least-squares fit of the impedance to the current.
//!
//! Each line of the spectrum says
//!
//! ```text
//! I(ω) = Y(iω)·V(ω) + noise
//! ```
//!
//! with the noise of the current alone, white and as great in every line: the
//! voltage is known. So plain least squares over all lines are the most likely
//! impedance, and σ²·(JᵀJ)⁻¹ is the covariance of its numbers.

use crate::actuator::bands::{Mean, bands};
use crate::actuator::numbers::{Column, Square, stepped};
use crate::actuator::second::second;
use crate::actuator::spectrum::{Line, Spectrum};
use crate::actuator::start::start;
use crate::descent::{Ending, Equations, LeastSquares, descend};
use crepitus_plant::effects::reaction_mass::impedance::{Impedance, NUMBERS};
use crepitus_plant::spectrum::Complex;
use nalgebra::Const;

/// End of the descent; about ten steps are usual.
const ENDING: Ending = Ending {
    steps: 100,
    gain: 1e-12,
    caution: (1e-12, 1e12),
};

/// Uncertainty of noise and residual, each estimated from a few thousand spectral lines: two standard
/// errors of 2 %.
const NOISE_UNSURE: f64 = 0.04;

/// A fitted impedance with its covariance and residual.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub(crate) impedance: Impedance,
    /// Covariance of the parameters, in the order of [`NUMBERS`].
    pub(crate) covariance: Square,
    /// Residual of the current in the band.
    pub(crate) residual: Residual,
    /// Relative residual of each narrow band: ω, rad/s, and share of the current.
    pub(crate) misfits: Vec<(f64, f64)>,
}

/// Residual of the current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Residual {
    /// RMS beyond the noise, as a share of the RMS current in the band.
    pub(crate) beyond_noise: f64,
    /// RMS over the RMS noise; `None` if the noise is unknown.
    pub(crate) over_noise: Option<f64>,
    /// Largest mean over a narrow band, as a share of the current there.
    pub(crate) systematic: f64,
    /// [`systematic`](Self::systematic) over its standard deviation.
    pub(crate) deviations: f64,
    /// Frequency of [`systematic`](Self::systematic), Hz.
    pub(crate) systematic_hz: f64,
    /// Strongest steady frequency.
    pub(crate) hum: Option<Hum>,
    /// Second resonance that would explain most of the residual.
    pub(crate) second: Option<Explained>,
    /// RMS noise of a current sample, A, from the residual.
    pub(crate) noise_a: f64,
}

/// A frequency of the current that the voltage does not have: two neighbouring lines, as it lies
/// between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hum {
    /// Frequency of the stronger line, Hz.
    pub(crate) hz: f64,
    /// Share of the power beyond the noise.
    pub(crate) share: f64,
}

/// A second resonance, as far as the residual shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Explained {
    /// Frequency of the second resonance, Hz.
    pub(crate) hz: f64,
    /// Height of its hump in the impedance over that of the first.
    pub(crate) height: f64,
    /// [`height`](Self::height) over its standard deviation.
    pub(crate) deviations: f64,
    /// Largest relative error that it causes in resonance, damping ratio or force constant.
    pub(crate) moved: f64,
    /// Share of the power surely beyond the noise that it explains.
    pub(crate) share: f64,
    /// Damped so strongly that it is no resonance.
    pub(crate) is_broad: bool,
}

impl Fit {
    /// Fits a spectrum; `None` if the current shows no resonance.
    pub(crate) fn of(spectrum: &Spectrum) -> Option<Self> {
        let lines = &spectrum.lines;
        let means: Vec<Mean> = bands(lines).map(Mean::of).collect();
        let impedance = descend(&Lines(lines), start(&means)?, ENDING)?;
        let normal = Lines(lines).equations(&impedance).normal;
        let degrees = (2 * lines.len()).checked_sub(NUMBERS).filter(|n| *n > 0)?;
        let variance = Lines(lines).cost(&impedance) / degrees as f64;
        let residual = Residual::of(spectrum, &impedance, &normal, variance);
        let covariance =
            normal.cholesky()?.inverse() * (variance * correlation(lines, &impedance, variance));
        let misfits = bands(lines)
            .map(|band| common(band, &impedance))
            .map(|common| (common.omega, common.share()))
            .collect();
        Some(Self {
            impedance,
            covariance,
            residual,
            misfits,
        })
    }
}

/// The squares of what each line leaves of the current.
struct Lines<'l>(&'l [Line]);

impl LeastSquares<Const<NUMBERS>> for Lines<'_> {
    type Point = Impedance;

    fn equations(&self, impedance: &Impedance) -> Equations<Const<NUMBERS>> {
        let (mut normal, mut right) = (Square::zeros(), Column::zeros());
        for line in self.0 {
            let (admittance, derivatives) = impedance.admittance(line.omega);
            let residual = line.amperes - admittance * line.volts;
            let columns = derivatives.map(|derivative| derivative * line.volts);
            for i in 0..NUMBERS {
                right[i] += (columns[i].conj() * residual).re;
                for j in 0..=i {
                    normal[(i, j)] += (columns[i].conj() * columns[j]).re;
                }
            }
        }
        for i in 0..NUMBERS {
            for j in 0..i {
                normal[(j, i)] = normal[(i, j)];
            }
        }
        Equations { normal, right }
    }

    fn cost(&self, impedance: &Impedance) -> f64 {
        let residual = |line: &Line| line.amperes - impedance.admittance(line.omega).0 * line.volts;
        self.0.iter().map(|line| residual(line).norm_sqr()).sum()
    }

    fn stepped(&self, impedance: &Impedance, step: &Column) -> Impedance {
        stepped(impedance, step)
    }
}

/// Residual of a narrow band that is coherent with the voltage.
struct Common {
    omega: f64,
    /// Mean residual admittance, A/V.
    admittance: Complex<f64>,
    /// Variance of the mean over that of a line.
    variance: f64,
    /// Magnitude of the fitted admittance, A/V.
    expected: f64,
}

impl Common {
    /// Returns the residual as a share of the current.
    fn share(&self) -> f64 {
        self.admittance.norm() / self.expected
    }
}

fn common(band: &[Line], impedance: &Impedance) -> Common {
    let mean = Mean::of(band);
    let sum: Complex<f64> = (band.iter())
        .map(|line| {
            let residual = line.amperes - impedance.admittance(line.omega).0 * line.volts;
            residual * line.volts.conj()
        })
        .sum();
    Common {
        omega: mean.omega,
        admittance: sum / mean.excitation,
        variance: 1.0 / mean.excitation,
        expected: impedance.admittance(mean.omega).0.norm(),
    }
}

impl Residual {
    /// Returns the residual after a fit. `variance` is that of the real part of a line.
    fn of(spectrum: &Spectrum, impedance: &Impedance, normal: &Square, variance: f64) -> Self {
        let lines = &spectrum.lines;
        let of_current: f64 = lines.iter().map(|line| line.amperes.norm_sqr()).sum();
        // Where the noise is unknown, a residual may be noise.
        let noise = spectrum.noise_square.unwrap_or(2.0 * variance);
        let beyond = (2.0 * variance - noise).max(0.0) * lines.len() as f64;
        let most_noise = (1.0 + NOISE_UNSURE) * noise;
        let surely_beyond = (2.0 * variance - most_noise) * lines.len() as f64;
        let worst = bands(lines)
            .map(|band| common(band, impedance))
            .max_by(|a, b| a.share().total_cmp(&b.share()));
        let samples = spectrum.samples as f64;
        Self {
            beyond_noise: (beyond / of_current).sqrt(),
            over_noise: spectrum
                .noise_square
                .map(|noise| (2.0 * variance / noise).sqrt()),
            systematic: worst.as_ref().map_or(0.0, Common::share),
            deviations: (worst.as_ref()).map_or(0.0, |c| {
                c.admittance.norm() / (2.0 * variance * c.variance).sqrt()
            }),
            systematic_hz: worst.map_or(0.0, |c| c.omega / std::f64::consts::TAU),
            hum: hum(lines, impedance, noise).map(|(hz, power)| Hum {
                hz,
                share: power / beyond.max(power),
            }),
            second: second(lines, impedance, normal).map(|second| Explained {
                hz: second.hz,
                height: second.height,
                moved: second.moved,
                is_broad: second.is_broad,
                deviations: (second.power / variance).sqrt(),
                share: second.power / surely_beyond.max(second.power),
            }),
            // A line of n samples of noise has n times its variance.
            noise_a: (2.0 * variance / samples).sqrt(),
        }
    }
}

/// Least power of a steady frequency over the noise of a line: noise alone reaches ten.
const HUM_OVER_NOISE: f64 = 30.0;

/// Returns the strongest two neighbouring lines of the residual, if they are more than noise:
/// frequency, Hz, and power beyond the noise.
fn hum(lines: &[Line], impedance: &Impedance, noise: f64) -> Option<(f64, f64)> {
    let power = |line: &Line| {
        (line.amperes - impedance.admittance(line.omega).0 * line.volts).norm_sqr() - noise
    };
    let powers: Vec<(f64, f64)> = lines.iter().map(|l| (l.omega, power(l))).collect();
    (powers.windows(2))
        .map(|pair| {
            let stronger = if pair[0].1 > pair[1].1 {
                pair[0]
            } else {
                pair[1]
            };
            (stronger.0 / std::f64::consts::TAU, pair[0].1 + pair[1].1)
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, power)| *power > HUM_OVER_NOISE * noise)
}

/// Returns the factor for the covariance where residuals of neighbouring lines are correlated: mean
/// square of the coherent residuals of narrow bands, over that of white noise.
fn correlation(lines: &[Line], impedance: &Impedance, variance: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for band in bands(lines) {
        let common = common(band, impedance);
        sum += common.admittance.norm_sqr() / (2.0 * variance * common.variance);
        count += 1.0;
    }
    // The fit takes its own share of what is common.
    let free = f64::max(count - 0.5 * NUMBERS as f64, 1.0);
    (sum / free).max(1.0)
}
