//! Simulated patients whose knees somebody bends and straightens at several speeds.
//!
//! Half of them are as the fit believes: the passive moment of Riener and Edrich, gravity, inertia and damping, a
//! law of the model, white noise. The other half shares nothing with it but words: another passive moment,
//! damping that grows with the square of the speed, Dahl's friction, symptoms written for this test, with
//! jitter, and noise that drifts, breathes and comes in whole steps of a converter.

pub(crate) mod other;

use crepitus_identify::knee::{Examination, Symptom};
use crepitus_model::render::effects::Timing;
use crepitus_model::render::effects::clasp_knife::{ClaspKnife, ClaspKnifeSettings};
use crepitus_model::render::effects::clonus::{Clonus, ClonusSettings};
use crepitus_model::render::effects::cogwheel::{Cogwheel, CogwheelSettings};
use crepitus_model::render::effects::lead_pipe::{LeadPipe, LeadPipeSettings};
use crepitus_model::render::effects::range_limit::{RangeLimit, RangeLimitSettings};
use crepitus_model::render::effects::spasticity::{Spasticity, SpasticitySettings};
use crepitus_model::render::effects::symptom::Law;
use crepitus_model::render::position::{Sensing, Travel};
use crepitus_plant::effects::limb::Passive;

/// Time between two samples, s.
pub(crate) const STEP_S: f64 = 1e-3;

/// A patient: the examination, and what is true of it.
pub(crate) struct Patient {
    pub(crate) examination: Examination,
    pub(crate) symptom: Symptom,
    /// Values by their keys.
    pub(crate) truth: Vec<(&'static str, f64)>,
}

/// A path of minimum-jerk strokes there and back with holds, sampled: angle, rad, and velocity, rad/s.
pub(crate) struct Path {
    pub(crate) angle: Vec<f64>,
    pub(crate) omega: Vec<f64>,
    pub(crate) alpha: Vec<f64>,
}

impl Path {
    /// Strokes at these peak speeds, deg/s, each with the hold after flexion, s.
    pub(crate) fn examined(speeds: &[(f64, f64)], random: &mut fastrand::Rng) -> Self {
        let mut path = Self {
            angle: Vec::new(),
            omega: Vec::new(),
            alpha: Vec::new(),
        };
        let low = 4.0 + 3.0 * random.f64();
        path.hold(low, 0.4);
        for (speed, hold_s) in speeds {
            let speed = speed * (0.93 + 0.14 * random.f64());
            let high = 106.0 + 6.0 * random.f64();
            path.stroke(low, high, speed);
            path.hold(high, *hold_s);
            path.stroke(high, low, speed * (0.8 + 0.2 * random.f64()));
            path.hold(low, 0.5);
        }
        path
    }

    /// A usual one: slow, quicker, quick and as quick as a hand can.
    pub(crate) fn usual(random: &mut fastrand::Rng) -> Self {
        let speeds = [
            (30.0, 0.5),
            (60.0, 0.5),
            (110.0, 1.5),
            (160.0, 1.5),
            (220.0, 2.5),
            (45.0, 0.5),
            (90.0, 0.8),
            (190.0, 2.5),
            (140.0, 1.5),
            (230.0, 2.5),
        ];
        Self::examined(&speeds, random)
    }

    fn hold(&mut self, deg: f64, for_s: f64) {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a count"
        )]
        let count = (for_s / STEP_S) as usize;
        self.angle
            .extend(std::iter::repeat_n(deg.to_radians(), count));
        self.omega.extend(std::iter::repeat_n(0.0, count));
        self.alpha.extend(std::iter::repeat_n(0.0, count));
    }

    fn stroke(&mut self, from: f64, to: f64, peak_deg_s: f64) {
        let way = (to - from).to_radians();
        let lasts = 1.875 * way.abs() / peak_deg_s.to_radians();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a count"
        )]
        let count = (lasts / STEP_S) as usize;
        for i in 0..count {
            let x = i as f64 / count as f64;
            self.angle
                .push(from.to_radians() + way * x.powi(3) * (10.0 + x * (6.0 * x - 15.0)));
            self.omega
                .push(way / lasts * 30.0 * x * x * (1.0 - x).powi(2));
            self.alpha
                .push(way / lasts.powi(2) * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x));
        }
    }
}

/// A standard normal number.
pub(crate) fn normal(random: &mut fastrand::Rng) -> f64 {
    (0..12).map(|_| random.f64()).sum::<f64>() - 6.0
}

fn followed<L: Law<Real = f64>>(settings: &L::Settings, path: &Path) -> Vec<f64> {
    let timing = Timing {
        step_s: STEP_S,
        delay_ticks: 0,
        sensing: Sensing::IDEAL,
    };
    let mut law = L::new(L::coefficients(settings, &timing).expect("settings"));
    law.rest(&Sensing::IDEAL.position(path.angle[0]));
    let mut torques = vec![0.0];
    for i in 1..path.angle.len() {
        let travel = Travel {
            to: Sensing::IDEAL.position(path.angle[i]),
            delta_rad: path.angle[i] - path.angle[i - 1],
            omega_start_rad_s: path.omega[i - 1],
            omega_end_rad_s: path.omega[i],
            bend_rad: 0.5 * (path.omega[i] - path.omega[i - 1]) * STEP_S,
            ticks: 1,
            length: 1.0,
            rad_per_count: Sensing::IDEAL.rad_per_count,
        };
        torques.push(law.follow(&travel, &mut ()));
    }
    torques
}

/// A patient of the model.
#[allow(clippy::too_many_lines, reason = "a paragraph for each symptom")]
pub(crate) fn modelled(symptom: Symptom, random: &mut fastrand::Rng) -> Patient {
    let path = Path::usual(random);
    let mut between = |low: f64, high: f64| low + (high - low) * random.f64();
    let (torques, truth) = match symptom {
        Symptom::Healthy => (vec![0.0; path.angle.len()], Vec::new()),
        Symptom::LeadPipe => {
            let torque_nm = between(0.6, 4.0);
            let settings = LeadPipeSettings {
                torque_nm,
                ..LeadPipeSettings::default()
            };
            (
                followed::<LeadPipe<f64>>(&settings, &path),
                vec![("torque_nm", torque_nm)],
            )
        }
        Symptom::Cogwheel => {
            let (torque_nm, frequency_hz) = (between(1.0, 4.0), between(5.0, 8.0));
            let settings = CogwheelSettings {
                torque_nm,
                frequency_hz,
                ..CogwheelSettings::default()
            };
            let truth = vec![("torque_nm", torque_nm), ("frequency_hz", frequency_hz)];
            (followed::<Cogwheel<f64>>(&settings, &path), truth)
        }
        Symptom::Catch => {
            let settings = SpasticitySettings {
                threshold_deg: between(60.0, 95.0),
                velocity_shift_s: between(0.15, 0.3),
                velocity_torque_nms_per_rad: between(0.3, 1.2),
                residual_share: between(0.1, 0.8),
                ..SpasticitySettings::default()
            };
            let truth = vec![
                ("threshold_deg", settings.threshold_deg),
                ("velocity_shift_s", settings.velocity_shift_s),
                (
                    "velocity_torque_nms_per_rad",
                    settings.velocity_torque_nms_per_rad,
                ),
                ("residual_share", settings.residual_share),
            ];
            (followed::<Spasticity<f64>>(&settings, &path), truth)
        }
        Symptom::Reflex => {
            let settings = SpasticitySettings {
                form: 1,
                threshold_deg: between(60.0, 95.0),
                velocity_shift_s: between(0.2, 0.35),
                gain_nm_per_rad: between(0.8, 4.0),
                delay_s: between(0.03, 0.07),
                torque_nm: 6.5,
                ..SpasticitySettings::default()
            };
            let truth = vec![
                ("threshold_deg", settings.threshold_deg),
                ("velocity_shift_s", settings.velocity_shift_s),
                ("gain_nm_per_rad", settings.gain_nm_per_rad),
                ("delay_s", settings.delay_s),
            ];
            (followed::<Spasticity<f64>>(&settings, &path), truth)
        }
        Symptom::ClaspKnife => {
            let settings = ClaspKnifeSettings {
                onset_deg: between(20.0, 45.0),
                release_deg: between(65.0, 90.0),
                onset_torque_nm: between(0.3, 1.0),
                slope_nm_per_rad: between(1.0, 4.0),
                residual_share: between(0.05, 0.3),
                ..ClaspKnifeSettings::default()
            };
            let truth = vec![
                ("onset_deg", settings.onset_deg),
                ("release_deg", settings.release_deg),
                ("slope_nm_per_rad", settings.slope_nm_per_rad),
                ("residual_share", settings.residual_share),
            ];
            (followed::<ClaspKnife<f64>>(&settings, &path), truth)
        }
        Symptom::Clonus => {
            let settings = ClonusSettings {
                frequency_hz: between(4.5, 7.5),
                amplitude_nm: between(0.7, 3.0),
                hold_deg: between(50.0, 80.0),
                beats: between(6.0, 30.0).round(),
                ..ClonusSettings::default()
            };
            let truth = vec![
                ("frequency_hz", settings.frequency_hz),
                ("amplitude_nm", settings.amplitude_nm),
            ];
            (followed::<Clonus<f64>>(&settings, &path), truth)
        }
        Symptom::RangeLimit => {
            let is_extension = between(0.0, 1.0) < 0.5;
            let stiffness = between(15.0, 60.0);
            let settings = RangeLimitSettings {
                extension_limit_deg: if is_extension {
                    between(15.0, 35.0)
                } else {
                    -10.0
                },
                flexion_limit_deg: if is_extension {
                    160.0
                } else {
                    between(80.0, 98.0)
                },
                extension_stiffness_nm_per_rad: stiffness,
                flexion_stiffness_nm_per_rad: stiffness,
                extension_torque_nm: 6.5,
                flexion_torque_nm: 6.5,
                ..RangeLimitSettings::default()
            };
            let truth = if is_extension {
                vec![("extension_limit_deg", settings.extension_limit_deg)]
            } else {
                vec![("flexion_limit_deg", settings.flexion_limit_deg)]
            };
            (followed::<RangeLimit<f64>>(&settings, &path), truth)
        }
    };
    Patient {
        examination: with_limb(path, &torques, random),
        symptom,
        truth,
    }
}

/// A patient of the model whose flexors catch, which resist extension.
pub(crate) fn of_the_flexors(random: &mut fastrand::Rng) -> Patient {
    let path = Path::usual(random);
    let settings = SpasticitySettings {
        muscles: 1,
        threshold_deg: 40.0,
        velocity_shift_s: 0.2,
        velocity_torque_nms_per_rad: 0.8,
        residual_share: 0.4,
        ..SpasticitySettings::default()
    };
    let torques = followed::<Spasticity<f64>>(&settings, &path);
    Patient {
        examination: with_limb(path, &torques, random),
        symptom: Symptom::Catch,
        truth: vec![
            ("threshold_deg", settings.threshold_deg),
            ("residual_share", settings.residual_share),
        ],
    }
}

/// The torque of a symptom in a limb, with friction and white noise.
fn with_limb(path: Path, torques: &[f64], random: &mut fastrand::Rng) -> Examination {
    let mut between = |low: f64, high: f64| low + (high - low) * random.f64();
    let passive = Passive::for_hip_deg(between(70.0, 100.0));
    let (moment_nm, inertia, damping) = (between(5.0, 9.0), between(0.2, 0.4), between(0.05, 0.2));
    let friction = followed::<LeadPipe<f64>>(
        &LeadPipeSettings {
            torque_nm: between(0.0, 0.1),
            ..LeadPipeSettings::default()
        },
        &path,
    );
    let noise_nm = between(0.02, 0.06);
    let torque_nm = (0..path.angle.len()).map(|i| {
        let (angle, omega) = (path.angle[i], path.omega[i]);
        let limb = moment_nm * angle.cos() - passive.moment_nm(angle)
            + inertia * path.alpha[i]
            + damping * omega;
        limb + torques[i] + friction[i] + noise_nm * normal(random)
    });
    Examination {
        time_s: (0..path.angle.len()).map(|i| i as f64 * STEP_S).collect(),
        torque_nm: torque_nm.collect(),
        angle_rad: path.angle,
        released_kg_m2: None,
    }
}
