//! Random symptoms, and hands.

use super::rig::on;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::cogwheel::CogwheelSettings;
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::texture::TextureSettings;
use proptest::prelude::*;

/// One symptom, with parameters from these shares of their ranges.
pub(crate) fn symptom(kind: usize, x: &[f64]) -> EffectSettings {
    let at = |i: usize, low: f64, high: f64| low + (high - low) * x[i];
    match kind {
        0 => {
            let loss = at(0, 0.1, 0.8);
            let stiffness = at(1, 1.0, (1000.0 * (1.0 - loss)).min(600.0));
            let cap = at(2, 0.1, 6.5);
            let most = (1000.0 * (1.0 - loss)).powi(2) - stiffness * stiffness;
            let stiffening = (0.99 * x[3] * most / (4.0 * cap)).min(5000.0);
            let low = at(4, -4.0, 90.0);
            on!(range_limit: RangeLimitSettings {
                extension_limit_deg: low,
                flexion_limit_deg: low + at(5, 5.0, 40.0),
                extension_stiffness_nm_per_rad: stiffness,
                extension_stiffening_nm_per_rad2: stiffening,
                extension_loss: loss,
                extension_torque_nm: cap,
                flexion_stiffness_nm_per_rad: stiffness,
                flexion_stiffening_nm_per_rad2: stiffening,
                flexion_loss: loss,
                flexion_torque_nm: cap,
            })
        }
        1 => on!(lead_pipe: LeadPipeSettings {
            torque_nm: at(0, 0.1, 4.5),
            presliding_deg: at(1, 0.3, 10.0),
            ..LeadPipeSettings::default()
        }),
        2 => on!(cogwheel: CogwheelSettings {
            mode: u8::from(x[0] > 0.5),
            torque_nm: at(1, 0.1, 4.5),
            presliding_deg: at(2, 0.3, 10.0),
            low_share: x[3],
            frequency_hz: at(4, 3.0, 12.0),
            duty: at(5, 0.1, 0.9),
            pitch_deg: at(4, 1.0, 30.0),
            ..CogwheelSettings::default()
        }),
        3 => on!(spasticity: SpasticitySettings {
            muscles: u8::from(x[0] > 0.5),
            threshold_deg: at(1, 30.0, 90.0),
            threshold_velocity_deg_s: at(2, 5.0, 60.0),
            velocity_torque_nms_per_rad: at(3, 0.0, 2.0),
            residual_share: x[4],
            stiffness_nm_per_rad: at(5, 0.0, 10.0),
            release_s: at(0, 0.01, 1.0),
            catch_stiffness_nm_per_rad: at(1, 10.0, 300.0),
            rearm_deg: at(2, 2.0, 30.0),
            ..SpasticitySettings::default()
        }),
        4 => {
            let flexors = x[0] > 0.5;
            let (low, high) = (at(1, 20.0, 60.0), at(2, 61.0, 100.0));
            on!(clasp_knife: ClaspKnifeSettings {
                muscles: u8::from(flexors),
                trigger: u8::from(x[3] > 0.5),
                onset_deg: if flexors { high } else { low },
                release_deg: if flexors { low } else { high },
                onset_torque_nm: at(4, 0.0, 4.5),
                slope_nm_per_rad: at(5, 0.0, 10.0),
                residual_share: at(0, 0.0, 0.9),
                collapse_s: at(1, 0.005, 0.3),
                rearm_deg: at(2, 2.0, 30.0),
                catch_stiffness_nm_per_rad: at(3, 10.0, 300.0),
                release_torque_nm: at(4, 0.2, 4.5),
            })
        }
        _ => {
            let (pitch, width) = (at(0, 0.5, 15.0), at(1, 0.1, 1.0));
            let stiffness = at(2, 50.0, 400.0);
            let most = 0.5 * stiffness * width * pitch.to_radians();
            let base = at(3, 0.0, 1.0);
            on!(texture: TextureSettings {
                base_nm: base,
                peak_nm: base + (2.0 * x[4]).min(most),
                pitch_deg: pitch,
                width_share: width,
                irregularity: 0.9 * x[5],
                stiffness_nm_per_rad: stiffness,
                ..TextureSettings::default()
            })
        }
    }
}

pub(crate) const KINDS: usize = 6;

/// Minimum-jerk moves of a hand through these angles, deg, each of this many ticks.
pub(crate) fn hand(points: &[(f64, u32)]) -> Vec<f64> {
    let mut from = 60.0;
    let mut angles = vec![from];
    for &(to, ticks) in points {
        for i in 1..=ticks {
            let u = f64::from(i) / f64::from(ticks);
            angles.push(from + (to - from) * u * u * u * (10.0 + u * (6.0 * u - 15.0)));
        }
        from = to;
    }
    angles.into_iter().map(f64::to_radians).collect()
}

pub(crate) fn parameters() -> impl Strategy<Value = (usize, Vec<f64>)> {
    (0..KINDS, prop::collection::vec(0.0..1.0_f64, 6))
}

pub(crate) fn points() -> impl Strategy<Value = Vec<(f64, u32)>> {
    prop::collection::vec((20.0..100.0_f64, 1500..6000_u32), 2..8)
}

/// Small moves about a place, as a hand in contact makes.
pub(crate) fn tremble() -> impl Strategy<Value = Vec<(f64, u32)>> {
    (
        30.0..90.0_f64,
        prop::collection::vec((-6.0..6.0_f64, 300..1500_u32), 4..20),
    )
        .prop_map(|(at, moves)| moves.into_iter().map(|(deg, n)| (at + deg, n)).collect())
}
