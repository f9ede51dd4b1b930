//! Synthetic recordings: a few sines, noise and quantisation, smoothed.

use super::joint::Scale;
use super::{log_uniform, sign, uniform};
use crepitus_plant::Motion;
use crepitus_plant::recording::{Samples, smooth};
use fastrand::Rng;
use std::f64::consts::TAU;

pub(super) fn draw(rng: &mut Rng, scale: Scale) -> Option<(Motion, f64)> {
    let Scale {
        speed_rad_s,
        duration_s,
    } = scale;
    let rows = rng.u32(12..200);
    let step_s = duration_s / f64::from(rows - 1);
    let offset_rad = if rng.bool() { 0.0 } else { rng.f64() };
    let waves: Vec<[f64; 3]> = (0..3)
        .map(|_| {
            let frequency_hz = log_uniform(rng, 0.3, f64::from(rows) / 6.0) / duration_s;
            let amplitude = speed_rad_s * rng.f64() / (TAU * frequency_hz);
            [sign(rng) * amplitude, frequency_hz, rng.f64()]
        })
        .collect();
    let span = speed_rad_s * duration_s;
    let noise_rad = match rng.u32(0..3) {
        0 => span * log_uniform(rng, 1e-6, 1e-2),
        _ => 0.0,
    };
    let quantum_rad = match rng.u32(0..5) {
        0 => span * log_uniform(rng, 1e-5, 1e-2),
        _ => 0.0,
    };
    let time_s: Vec<f64> = (0..rows).map(|i| f64::from(i) * step_s).collect();
    let angle_rad = time_s
        .iter()
        .map(|t| {
            let angle = waves
                .iter()
                .map(|[a, f, p]| a * (TAU * (f * t + p)).sin())
                .sum::<f64>()
                + noise_rad * uniform(rng, -1.0, 1.0);
            let angle = if quantum_rad > 0.0 {
                (angle / quantum_rad).round() * quantum_rad
            } else {
                angle
            };
            offset_rad + angle
        })
        .collect();
    let samples = Samples {
        time_s,
        angle_rad,
        ..Samples::default()
    };
    let cutoff_hz = samples.nyquist_hz() * log_uniform(rng, 0.03, 0.95);
    let segments = smooth(&samples, cutoff_hz).ok()?;
    let end_s = segments.last()?.end_s;
    let duration_s = if rng.bool() {
        end_s
    } else {
        end_s * uniform(rng, 0.4, 1.0)
    };
    Some((Motion::recording(&segments), duration_s))
}
