//! Means over narrow bands of frequency: the measured impedance, as it is drawn
//! and as the fit begins from it.

use crate::actuator::spectrum::Line;
use crepitus_plant::spectrum::Complex;

/// Number of bands per octave.
const PER_OCTAVE: f64 = 24.0;

/// Weighted mean of the lines of a band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mean {
    /// Mean angular frequency, weighted by |I|², rad/s.
    pub(crate) omega: f64,
    /// Least-squares impedance V/I, Ω.
    pub(crate) impedance: Complex<f64>,
    /// Sum of |I|².
    pub(crate) weight: f64,
    /// Sum of |V|².
    pub(crate) excitation: f64,
}

/// Splits lines into bands; each has at least one line.
pub(crate) fn bands(lines: &[Line]) -> impl Iterator<Item = &[Line]> {
    lines.chunk_by(|a, b| band_of(a.omega) == band_of(b.omega))
}

fn band_of(omega: f64) -> f64 {
    (omega.log2() * PER_OCTAVE).floor()
}

impl Mean {
    /// Returns the mean of a band.
    pub(crate) fn of(band: &[Line]) -> Self {
        let weight: f64 = band.iter().map(|line| line.amperes.norm_sqr()).sum();
        let together: Complex<f64> = (band.iter())
            .map(|line| line.volts * line.amperes.conj())
            .sum();
        let excitation: f64 = band.iter().map(|line| line.volts.norm_sqr()).sum();
        let moment: f64 = (band.iter())
            .map(|line| line.volts.norm_sqr() * line.omega)
            .sum();
        Self {
            omega: moment / excitation,
            impedance: together / weight,
            weight,
            excitation,
        }
    }
}
