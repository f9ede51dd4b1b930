//! Search for a second resonance that explains the residual of the fit.
//!
//! Something that swings beside the mass, as a cable, adds a term
//! b₂·s/(s² + γ₂·s + ω₂²) to the impedance. A ring of mass M that moves on what holds it, a
//! hand or a seat, lets the mass swing against both. To first order in μ = m/M that adds
//!
//! ```text
//! μ·b·s⁵/(D²·(s² + γ₂·s + ω₂²))        D = s² + γ·s + ω₀²
//! ```
//!
//! of which the first resonance takes over nearly all, with values that are off by
//! √(1 + μ) and more: little of it is left to see.
//!
//! The current changes by −Y/Z·V times such a term, and the numbers of the first
//! resonance move along with it. For every ω₂ and γ₂ of a grid the least squares of that
//! single column, with what the first resonance can take over projected away, is a
//! closed form: no second fit is needed to see one.

use crate::actuator::numbers::{Column, Square, stepped};
use crate::actuator::spectrum::Line;
use crepitus_plant::effects::reaction_mass::impedance::{Impedance, NUMBERS};
use crepitus_plant::spectrum::Complex;
use std::f64::consts::TAU;

/// Steps over the band, and 2ζ of the second resonance.
const STEPS: u32 = 60;
const TWO_ZETAS: [f64; 6] = [0.05, 0.2, 0.4, 0.7, 1.2, 2.0];

/// Damping 2ζ from which a term is no resonance: eddy currents look like it.
const BROAD: f64 = 1.0;

/// The second resonance that explains most of the residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Second {
    /// Frequency of the second resonance, Hz.
    pub(crate) hz: f64,
    /// Power of the residual that it explains, as a sum over the lines.
    pub(crate) power: f64,
    /// Height of its hump in the impedance over that of the first.
    pub(crate) height: f64,
    /// Largest relative error that it causes in resonance, damping ratio or force constant.
    pub(crate) moved: f64,
    /// Damped so strongly that it is no resonance.
    pub(crate) is_broad: bool,
}

/// Returns the best second resonance on the grid, of those that take power from the coil, as every
/// mass does.
pub(crate) fn second(lines: &[Line], first: &Impedance, normal: &Square) -> Option<Second> {
    let inverse = normal.cholesky()?.inverse();
    let (low, high) = (lines.first()?.omega, lines.last()?.omega);
    let step = (high / low).ln() / f64::from(STEPS);
    [Kind::Beside, Kind::Ring]
        .into_iter()
        .filter_map(|kind| {
            let prepared: Vec<Prepared> = (lines.iter())
                .map(|line| Prepared::of(line, first, kind))
                .collect();
            (0..=STEPS)
                .map(|i| low * (step * f64::from(i)).exp())
                .flat_map(|omega| TWO_ZETAS.map(|two_zeta| (omega, two_zeta)))
                .filter_map(|(omega, two_zeta)| {
                    tried(&prepared, first, &inverse, kind, omega, two_zeta)
                })
                .max_by(|a, b| a.power.total_cmp(&b.power))
        })
        .max_by(|a, b| a.power.total_cmp(&b.power))
}

/// Cause of the second resonance.
#[derive(Clone, Copy)]
enum Kind {
    /// Something beside the mass.
    Beside,
    /// The ring.
    Ring,
}

impl Kind {
    /// Returns the term at ω over s/(s² + γ₂·s + ω₂²).
    fn weight(self, first: &Impedance, omega: f64) -> Complex<f64> {
        match self {
            Self::Beside => Complex::new(1.0, 0.0),
            Self::Ring => {
                let s = Complex::i() * omega;
                (first.swing(s) * s).powi(2) * first.coupling
            }
        }
    }
}

/// Returns what a term of this frequency and damping explains, if it takes power from the coil.
fn tried(
    prepared: &[Prepared],
    first: &Impedance,
    inverse: &Square,
    kind: Kind,
    omega: f64,
    two_zeta: f64,
) -> Option<Second> {
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
    for line in prepared {
        let column = line.by_term * unit.at(line.omega);
        along += (column.conj() * line.residual).re;
        square += column.norm_sqr();
        for (shared, number) in shared.iter_mut().zip(line.columns) {
            *shared += (column.conj() * number).re;
        }
    }
    let taken = inverse * shared;
    let own = square - shared.dot(&taken);
    let size = along / own;
    (own > 0.0 && size > 0.0).then(|| Second {
        hz: omega / TAU,
        power: along * size,
        height: size * kind.weight(first, omega).norm()
            / damping
            / (first.coupling / first.damping),
        moved: moved(first, &(taken * size)),
        is_broad: two_zeta >= BROAD,
    })
}

/// Returns the greatest relative change that the first resonance has taken over.
fn moved(first: &Impedance, taken: &Column) -> f64 {
    let without = stepped(first, &-taken);
    let change = |of: &dyn Fn(&Impedance) -> f64| (of(&without) / of(first) - 1.0).abs();
    let coupling = 0.5 * change(&|z| z.coupling);
    change(&|z| z.resonance)
        .max(change(&Impedance::damping_ratio))
        .max(coupling)
}

/// A line with its derivatives.
struct Prepared {
    omega: f64,
    residual: Complex<f64>,
    columns: [Complex<f64>; NUMBERS],
    /// Derivative of the current with respect to the weight of the term.
    by_term: Complex<f64>,
}

impl Prepared {
    fn of(line: &Line, first: &Impedance, kind: Kind) -> Self {
        let (admittance, derivatives) = first.admittance(line.omega);
        let columns = derivatives.map(|derivative| derivative * line.volts);
        Self {
            omega: line.omega,
            residual: line.amperes - admittance * line.volts,
            columns,
            // R is a change of the impedance alike at all frequencies.
            by_term: columns[0] * kind.weight(first, line.omega),
        }
    }
}
