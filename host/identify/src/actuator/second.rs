//! Search for a second resonance that explains the residual of the fit.
//!
//! A ring that moves in its clamp adds a term b₂·s/(s² + γ₂·s + ω₂²) to the impedance.
//! To first order the current then changes by −Y/Z·V times that term, and the
//! numbers of the first resonance move along with it. For every ω₂ and γ₂ of a grid
//! the least squares of that single column, with what the first resonance can take over
//! projected away, is a closed form: no second fit is needed to see one.

use crate::actuator::fit::{Column, Square};
use crate::actuator::impedance::{Impedance, NUMBERS};
use crate::actuator::spectrum::Line;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;

/// Steps over the band, and 2ζ of the second resonance.
const STEPS: u32 = 60;
const TWO_ZETAS: [f64; 4] = [0.05, 0.2, 0.6, BROAD];

/// Damping 2ζ from which a term is no resonance: eddy currents look like it.
const BROAD: f64 = 2.0;

/// The second resonance that explains most of the residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Second {
    /// Its frequency, Hz.
    pub(crate) hz: f64,
    /// Power of the residual that it explains, as a sum over the lines.
    pub(crate) power: f64,
    /// Height of its hump in the impedance over that of the first.
    pub(crate) height: f64,
    /// Damped so strongly that it is no resonance.
    pub(crate) is_broad: bool,
}

/// Returns the best second resonance on the grid, of those that take power from the coil, as every
/// mass does.
pub(crate) fn second(lines: &[Line], first: &Impedance, normal: &Square) -> Option<Second> {
    let inverse = normal.cholesky()?.inverse();
    let prepared: Vec<Prepared> = lines.iter().map(|line| Prepared::of(line, first)).collect();
    let (low, high) = (lines.first()?.omega, lines.last()?.omega);
    let step = (high / low).ln() / f64::from(STEPS);
    (0..=STEPS)
        .map(|i| low * (step * f64::from(i)).exp())
        .flat_map(|omega| TWO_ZETAS.map(|two_zeta| (omega, two_zeta)))
        .filter_map(|(omega, two_zeta)| {
            let damping = two_zeta * omega;
            let unit = Impedance {
                resistance: 0.0,
                inductance: 0.0,
                coupling: 1.0,
                resonance: omega,
                damping,
                delay: 0.0,
            };
            let (mut along, mut square, mut shared) = (0.0, 0.0, Column::zeros());
            for line in &prepared {
                let column = line.by_impedance * unit.at(line.omega);
                along += (column.conj() * line.residual).re;
                square += column.norm_sqr();
                for (shared, number) in shared.iter_mut().zip(line.columns) {
                    *shared += (column.conj() * number).re;
                }
            }
            let own = square - (shared.transpose() * inverse * shared)[(0, 0)];
            let coupling = along / own;
            (own > 0.0 && coupling > 0.0).then(|| Second {
                hz: omega / TAU,
                power: along * coupling,
                height: (coupling / damping) / (first.coupling / first.damping),
                is_broad: two_zeta >= BROAD,
            })
        })
        .max_by(|a, b| a.power.total_cmp(&b.power))
}

/// A line with its derivatives.
struct Prepared {
    omega: f64,
    residual: Complex<f64>,
    columns: [Complex<f64>; NUMBERS],
    /// Derivative of the current with respect to the impedance.
    by_impedance: Complex<f64>,
}

impl Prepared {
    fn of(line: &Line, first: &Impedance) -> Self {
        let (admittance, derivatives) = first.admittance(line.omega);
        let columns = derivatives.map(|derivative| derivative * line.volts);
        Self {
            omega: line.omega,
            residual: line.amperes - admittance * line.volts,
            columns,
            // R is a change of the impedance alike at all frequencies.
            by_impedance: columns[0],
        }
    }
}
