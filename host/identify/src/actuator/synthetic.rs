//! Recordings of a known impedance, for tests: chirp, current by the equation, noise.

use crate::actuator::{Band, Series};
use crepitus_model::control::chirp::{Chirp, ChirpSettings};
use crepitus_plant::effects::reaction_mass::impedance::Impedance;
use realfft::RealFftPlanner;
use std::f64::consts::TAU;

/// An actuator as the data sheet has it.
pub(crate) const NOMINAL: Impedance = Impedance {
    resistance: 1.8,
    inductance: 2e-4,
    coupling: 1.1 * 1.1 / 0.060,
    resonance: TAU * 35.0,
    damping: 2.0 * 0.105 * TAU * 35.0,
    delay: 0.0,
};

/// Disturbances of the current.
#[derive(Clone, Copy)]
pub(crate) struct Added {
    /// Half width of evenly distributed noise, A.
    pub(crate) noise_a: f64,
    /// Amplitude, A, and frequency, Hz.
    pub(crate) hum: (f64, f64),
    /// Lost against its direction, A.
    pub(crate) lost_a: f64,
}

pub(crate) const NOISE: Added = Added {
    noise_a: 0.003,
    hum: (0.0, 0.0),
    lost_a: 0.0,
};

/// The chirp from 8 Hz up to this frequency.
fn chirp(to_hz: f32) -> ChirpSettings {
    ChirpSettings {
        to_hz,
        ..ChirpSettings::default()
    }
}

/// The band of the chirp up to this frequency.
pub(crate) fn band(to_hz: f32) -> Band {
    let chirp = chirp(to_hz);
    Band::of_chirp(f64::from(chirp.from_hz), f64::from(chirp.to_hz))
}

/// Plays the chirp up to `to_hz`, with so many ticks of 50 µs averaged in a row.
pub(crate) fn played(z: &Impedance, to_hz: f32, ticks: usize, added: Added) -> Series {
    let settings = chirp(to_hz);
    let mut generator = Chirp::new(&settings).unwrap();
    let whole = 4_000 + settings.duration_ticks as usize + 12_000;
    let by_tick: Vec<f64> = (0..whole)
        .map(|tick| {
            if tick < 4_000 {
                0.0
            } else {
                f64::from(generator.tick())
            }
        })
        .collect();
    let volts: Vec<f64> = (by_tick.chunks_exact(ticks))
        .map(|row| row.iter().sum::<f64>() / ticks as f64)
        .collect();
    let step_s = 5e-5 * ticks as f64;
    let rows = volts.len();
    let mut planner = RealFftPlanner::<f64>::new();
    let forward = planner.plan_fft_forward(rows);
    let mut lines = forward.make_output_vec();
    forward.process(&mut volts.clone(), &mut lines).unwrap();
    let last = lines.len() - 1;
    for (i, line) in lines.iter_mut().enumerate() {
        *line *= z.admittance(TAU * i as f64 / (step_s * rows as f64)).0;
        if i == 0 || i == last {
            // Of a real signal; of the mean there is none.
            line.im = 0.0;
        }
    }
    let mut amperes = vec![0.0; rows];
    (planner.plan_fft_inverse(rows))
        .process(&mut lines, &mut amperes)
        .unwrap();
    let mut random = fastrand::Rng::with_seed(5);
    for (i, ampere) in amperes.iter_mut().enumerate() {
        let current = *ampere / rows as f64;
        let hum = added.hum.0 * (TAU * added.hum.1 * step_s * i as f64).sin();
        let lost = added.lost_a * (current / 1e-3).tanh();
        *ampere = current - lost + hum + added.noise_a * (2.0 * random.f64() - 1.0);
    }
    Series::new(step_s, &volts, &amperes).unwrap()
}
