//! Spectral lines of voltage and current in the band of the chirp.

use crate::actuator::{Band, Series};
use crepitus_plant::spectrum::{Complex, forward_transform};

/// Voltage and current at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    /// ω, rad/s.
    pub(crate) omega: f64,
    /// Voltage, V times samples.
    pub(crate) volts: Complex<f64>,
    /// Current, A times samples.
    pub(crate) amperes: Complex<f64>,
}

/// Lines in the band, with the noise of the current above it.
#[derive(Clone, Debug)]
pub(crate) struct Spectrum {
    pub(crate) lines: Vec<Line>,
    /// Mean square of a line of the current above the band; `None` if the recording has none there.
    pub(crate) noise_square: Option<f64>,
    /// Number of transformed samples.
    pub(crate) samples: usize,
}

/// Start of the noise band, as a multiple of the end of the band.
const NOISE_FROM: f64 = 1.4;

/// Fewest lines of a noise estimate.
const FEWEST_LINES: usize = 50;

impl Spectrum {
    /// Least sampling rate, Hz: half of it is above the band by the fewest lines of noise.
    pub(crate) fn least_rate(band: Band, duration_s: f64) -> f64 {
        2.0 * (NOISE_FROM * band.to_hz + FEWEST_LINES as f64 / duration_s)
    }

    /// Transforms the whole recording, without a window, since it begins and ends at rest.
    pub(crate) fn of(series: &Series, band: Band) -> Self {
        let (volts, amperes) = (transformed(series.volts()), transformed(series.amperes()));
        let step = std::f64::consts::TAU / series.duration_s();
        let omega = |i: usize| step * i as f64;
        let (from, to) = (band.from_hz, band.to_hz);
        let (from, to) = (std::f64::consts::TAU * from, std::f64::consts::TAU * to);
        let lines = (volts.iter().zip(&amperes).enumerate())
            .map(|(i, (volts, amperes))| Line {
                omega: omega(i),
                volts: volts * series.hold().map_or(1.0, |hold| hold.factor(omega(i))),
                amperes: *amperes,
            })
            .filter(|line| (from..=to).contains(&line.omega))
            .collect();
        let mut noise: Vec<f64> = (amperes.iter().enumerate())
            .filter(|(i, _)| omega(*i) > NOISE_FROM * to)
            .map(|(_, line)| line.norm_sqr())
            .collect();
        noise.sort_by(f64::total_cmp);
        let is_known = noise.len() >= FEWEST_LINES;
        Self {
            lines,
            // Squares of noise have an exponential distribution: the median is ln 2 of the mean.
            noise_square: is_known.then(|| noise[noise.len() / 2] / std::f64::consts::LN_2),
            samples: series.volts().len(),
        }
    }
}

fn transformed(values: &[f64]) -> Vec<Complex<f64>> {
    let fft = forward_transform(values.len());
    let mut input = values.to_vec();
    let mut output = fft.make_output_vec();
    // Fails for buffers of another length only, and these are the plan's.
    let done = fft.process(&mut input, &mut output);
    debug_assert!(done.is_ok());
    output
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_stands_in_its_line_and_noise_beside_the_band() {
        let mut random = fastrand::Rng::with_seed(3);
        let rows = 4000;
        let turn = std::f64::consts::TAU * 100.0 / 4000.0;
        let volts: Vec<f64> = (0..rows).map(|i| (turn * f64::from(i)).sin()).collect();
        let amperes: Vec<f64> = (0..rows).map(|_| random.f64() - 0.5).collect();
        let series = Series::new(1.0 / 4000.0, &volts, &amperes).unwrap();
        let band = Band {
            from_hz: 50.0,
            to_hz: 150.0,
        };
        let spectrum = Spectrum::of(&series, band);
        assert_eq!(spectrum.lines.len(), 101);
        let greatest = (spectrum.lines.iter())
            .max_by(|a, b| a.volts.norm().total_cmp(&b.volts.norm()))
            .unwrap();
        assert!((greatest.omega / std::f64::consts::TAU - 100.0).abs() < 1e-9);
        assert!((greatest.volts.norm() - 2000.0).abs() < 1e-6);
        // White noise of variance 1/12 in n samples: n/12 a line.
        let noise = spectrum.noise_square.unwrap() / (4000.0 / 12.0);
        assert!((noise - 1.0).abs() < 0.1, "{noise}");
    }
}
