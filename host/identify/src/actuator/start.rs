//! Initial guess of the fit: resonance and damping on a grid, the rest by linear least squares,
//! since the impedance is linear in R, L and b.

use crate::actuator::bands::Mean;
use crepitus_plant::effects::reaction_mass::impedance::Impedance;
use crepitus_plant::spectrum::Complex;
use nalgebra::{Matrix3, Vector3};

/// Steps of the resonance over the band.
const STEPS: u32 = 120;

/// 2ζ of the mass without the coil. One that is negative is refused later, with its
/// number.
const TWO_ZETAS: [f64; 7] = [-0.05, 0.03, 0.08, 0.2, 0.4, 0.8, 1.6];

/// Returns the best impedance on the grid; `None` without bands.
pub(crate) fn start(means: &[Mean]) -> Option<Impedance> {
    let (low, high) = (means.first()?.omega, means.last()?.omega);
    let step = (high / low).ln() / f64::from(STEPS);
    let resonances = (0..=STEPS).map(|i| low * (step * f64::from(i)).exp());
    resonances
        .flat_map(|resonance| TWO_ZETAS.map(|two_zeta| (resonance, two_zeta * resonance)))
        .filter_map(|(resonance, damping)| linear(means, resonance, damping))
        // Bl²/m.
        .filter(|(candidate, _)| candidate.coupling > 0.0)
        .min_by(|(_, a), (_, b)| a.total_cmp(b))
        .map(|(candidate, _)| candidate)
}

/// Fits R, L and b for a resonance and a damping; returns the residual sum of squares, too.
fn linear(means: &[Mean], resonance: f64, damping: f64) -> Option<(Impedance, f64)> {
    let unit = Impedance {
        resistance: 0.0,
        inductance: 0.0,
        coupling: 1.0,
        resonance,
        damping,
        delay: 0.0,
    };
    let columns = |omega: f64| {
        [
            Complex::new(1.0, 0.0),
            Complex::new(0.0, omega),
            unit.at(omega),
        ]
    };
    let mut normal = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for mean in means {
        let columns = columns(mean.omega);
        for (i, a) in columns.iter().enumerate() {
            right[i] += mean.weight * (a.conj() * mean.impedance).re;
            for (j, b) in columns.iter().enumerate() {
                normal[(i, j)] += mean.weight * (a.conj() * b).re;
            }
        }
    }
    let solution = normal.cholesky()?.solve(&right);
    let found = Impedance {
        resistance: solution[0],
        inductance: solution[1],
        coupling: solution[2],
        ..unit
    };
    let left = means
        .iter()
        .map(|mean| mean.weight * (mean.impedance - found.at(mean.omega)).norm_sqr())
        .sum();
    Some((found, left))
}
