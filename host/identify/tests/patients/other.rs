//! Patients that share nothing with the fit: every law is written here.

use super::{Path, Patient, STEP_S, normal};
use crepitus_identify::knee::{Examination, Symptom};
use std::collections::VecDeque;

/// Dahl's friction, by its travel, rad.
struct Dahl {
    travel: f64,
    share: f64,
}

impl Dahl {
    fn new(travel_deg: f64) -> Self {
        Self {
            travel: travel_deg.to_radians(),
            share: 0.0,
        }
    }

    /// Share of the friction after a motion.
    fn after(&mut self, delta: f64) -> f64 {
        self.share += delta / self.travel * (1.0 - self.share * delta.signum());
        self.share
    }
}

/// A muscle that is loaded only as long as it is stretched: what is left after a return from its furthest point.
#[derive(Default)]
struct Loaded {
    furthest: f64,
}

impl Loaded {
    fn share(&mut self, angle: f64, yields_deg: f64) -> f64 {
        self.furthest = self.furthest.max(angle);
        (1.0 - (self.furthest - angle) / yields_deg.to_radians()).max(0.0)
    }
}

/// A patient of another model.
pub(crate) fn patient(symptom: Symptom, random: &mut fastrand::Rng) -> Patient {
    let path = Path::usual(random);
    let count = path.angle.len();
    let (torques, truth) = answered(symptom, &path, random);
    let mut between = |low: f64, high: f64| low + (high - low) * random.f64();
    let (weight, offset) = (between(4.0, 8.0), between(-0.1, 0.1));
    let (inertia, damping, turbulent) =
        (between(0.2, 0.45), between(0.02, 0.15), between(0.0, 0.03));
    let (near, near_deg) = (between(2.0, 8.0), between(6.0, 10.0));
    let (far, far_deg) = (between(0.5, 2.0), between(15.0, 25.0));
    let (dry, mut dahl) = (between(0.03, 0.15), Dahl::new(between(2.0, 6.0)));
    let (noise, breath, drift) = (between(0.02, 0.06), between(0.0, 0.06), between(0.0, 0.1));
    let step_nm = 0.02;
    let (mut slow, mut wander) = (0.0, 0.0);
    let mut torque_nm = Vec::with_capacity(count);
    for (i, answer) in torques.iter().enumerate() {
        let (angle, omega) = (path.angle[i], path.omega[i]);
        let deg = angle.to_degrees();
        let delta = if i > 0 {
            angle - path.angle[i - 1]
        } else {
            0.0
        };
        // Noise with a memory of 80 ms, a walk, and breath.
        slow += -slow * STEP_S / 0.08 + noise * (2.0 * STEP_S / 0.08_f64).sqrt() * normal(random);
        wander += drift * (STEP_S / 30.0_f64).sqrt() * normal(random);
        let breathed = breath * (std::f64::consts::TAU * 0.3 * i as f64 * STEP_S).sin();
        let passive = -near * (-deg / near_deg).exp() + far * ((deg - 110.0) / far_deg).exp();
        let limb = offset
            + weight * (angle - 0.1).cos()
            + passive
            + inertia * path.alpha[i]
            + damping * omega
            + turbulent * omega * omega.abs()
            + dry * dahl.after(delta);
        let torque = limb + answer + slow + wander + breathed;
        torque_nm.push((torque / step_nm).round() * step_nm);
    }
    let angle_rad = path
        .angle
        .iter()
        .map(|angle| angle + 2e-4 * normal(random))
        .collect();
    Patient {
        examination: Examination {
            time_s: (0..count).map(|i| i as f64 * STEP_S).collect(),
            angle_rad,
            torque_nm,
            released_kg_m2: None,
        },
        symptom,
        truth,
    }
}

type Answer = (Vec<f64>, Vec<(&'static str, f64)>);

#[allow(clippy::too_many_lines, reason = "a paragraph for each symptom")]
fn answered(symptom: Symptom, path: &Path, random: &mut fastrand::Rng) -> Answer {
    let count = path.angle.len();
    let rad = f64::to_radians;
    match symptom {
        Symptom::Healthy => (vec![0.0; count], Vec::new()),
        Symptom::LeadPipe | Symptom::Cogwheel => {
            let torque = 0.7 + 3.3 * random.f64();
            let frequency = 5.0 + 3.0 * random.f64();
            let low = if symptom == Symptom::Cogwheel {
                0.2 + 0.4 * random.f64()
            } else {
                1.0
            };
            let torque = if symptom == Symptom::Cogwheel {
                torque.max(1.2)
            } else {
                torque
            };
            let mut dahl = Dahl::new(0.6 + 0.8 * random.f64());
            let (mut phase, mut period, mut level) = (0.0, 1.0, 1.0);
            let torques = (0..count).map(|i| {
                let delta = if i > 0 {
                    path.angle[i] - path.angle[i - 1]
                } else {
                    0.0
                };
                phase += STEP_S * frequency / period;
                if phase >= 1.0 {
                    phase -= 1.0;
                    period = 1.0 + 0.03 * normal(random);
                }
                let target = if phase < 0.5 { 1.0 } else { low };
                level += (target - level) * STEP_S / 0.008;
                torque * level * dahl.after(delta)
            });
            let torques = torques.collect();
            let mut truth = vec![("torque_nm", torque)];
            if symptom == Symptom::Cogwheel {
                truth.push(("frequency_hz", frequency));
            }
            (torques, truth)
        }
        Symptom::Catch => {
            let (threshold, shift) = (60.0 + 35.0 * random.f64(), 0.15 + 0.15 * random.f64());
            let (per_speed, left) = (0.4 + 0.8 * random.f64(), 0.1 + 0.7 * random.f64());
            let (stiffness, release) = (1.0 * random.f64(), 0.05 + 0.05 * random.f64());
            let mut caught: Option<(f64, f64, f64, Loaded)> = None;
            let torques = (0..count).map(|i| {
                let (angle, omega) = (path.angle[i], path.omega[i]);
                let now = i as f64 * STEP_S;
                if caught.is_none() && omega > rad(40.0) && angle + shift * omega > rad(threshold) {
                    caught = Some((now, angle, per_speed * omega, Loaded::default()));
                }
                if caught
                    .as_ref()
                    .is_some_and(|(_, at, ..)| angle < at - rad(10.0))
                {
                    caught = None;
                }
                let Some((since, at, peak, loaded)) = &mut caught else {
                    return 0.0;
                };
                let t = now - *since;
                let decayed = left + (1.0 - left) * (-t / release).exp();
                let built = 1.0 - (-t / 0.008).exp();
                let torque = *peak * built * decayed + stiffness * (angle - *at).max(0.0);
                torque * loaded.share(angle, 1.5)
            });
            let torques = torques.collect();
            let truth = vec![
                ("threshold_deg", threshold),
                ("velocity_shift_s", shift),
                ("velocity_torque_nms_per_rad", per_speed),
                ("residual_share", left),
            ];
            (torques, truth)
        }
        Symptom::Reflex => {
            let (threshold, shift) = (60.0 + 35.0 * random.f64(), 0.2 + 0.15 * random.f64());
            let gain = 0.8 + 3.0 * random.f64();
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "ticks"
            )]
            let ticks = ((0.03 + 0.03 * random.f64()) / STEP_S) as usize;
            let mut on_its_way: VecDeque<f64> = std::iter::repeat_n(0.0, ticks).collect();
            let (mut first, mut second) = (0.0, 0.0);
            let torques = (0..count).map(|i| {
                let beyond = path.angle[i] + shift * path.omega[i] - rad(threshold);
                on_its_way.push_back(gain * beyond.max(0.0));
                let arrived = on_its_way.pop_front().unwrap_or(0.0);
                // Activation of the second order.
                first += (arrived - first) * STEP_S / 0.008;
                second += (first - second) * STEP_S / 0.008;
                second
            });
            let torques = torques.collect();
            let truth = vec![
                ("threshold_deg", threshold),
                ("velocity_shift_s", shift),
                ("gain_nm_per_rad", gain),
            ];
            (torques, truth)
        }
        Symptom::ClaspKnife => {
            let (onset, release) = (20.0 + 25.0 * random.f64(), 65.0 + 25.0 * random.f64());
            let (first, slope) = (0.3 + 0.5 * random.f64(), 1.2 + 3.0 * random.f64());
            let (left, collapse) = (0.05 + 0.25 * random.f64(), 0.02 + 0.04 * random.f64());
            let mut stage = 0;
            let (mut since, mut loaded) = (0.0, Loaded::default());
            let torques = (0..count).map(|i| {
                let (angle, now) = (path.angle[i], i as f64 * STEP_S);
                match stage {
                    0 if angle > rad(onset) => (stage, loaded) = (1, Loaded::default()),
                    1 if angle > rad(release) => (stage, since) = (2, now),
                    1 if angle < rad(onset) => stage = 0,
                    2 if angle < rad(onset - 10.0) => stage = 0,
                    _ => {}
                }
                let built = |at: f64| {
                    (first + slope * (at - rad(onset)))
                        * (1.0 - (-(at - rad(onset)) / rad(1.0)).exp())
                };
                match stage {
                    1 => built(angle) * loaded.share(angle, 3.0),
                    2 => {
                        let decayed = left + (1.0 - left) * (-(now - since) / collapse).exp();
                        built(rad(release)) * decayed * loaded.share(angle, 3.0)
                    }
                    _ => 0.0,
                }
            });
            let torques = torques.collect();
            let truth = vec![
                ("onset_deg", onset),
                ("release_deg", release),
                ("slope_nm_per_rad", slope),
                ("residual_share", left),
            ];
            (torques, truth)
        }
        Symptom::Clonus => {
            let (frequency, amplitude) = (4.5 + 3.0 * random.f64(), 0.8 + 2.0 * random.f64());
            let (hold, beats) = (50.0 + 30.0 * random.f64(), 6.0 + 20.0 * random.f64());
            let mut state: Option<(f64, f64, f64, f64)> = None;
            let mut is_ready = true;
            let torques = (0..count).map(|i| {
                let (angle, omega) = (path.angle[i], path.omega[i]);
                if angle < rad(hold - 5.0) {
                    (state, is_ready) = (None, true);
                }
                if is_ready && angle > rad(hold) {
                    is_ready = false;
                    // Time to the next beat, number, its size and its period.
                    state = (omega > rad(100.0)).then_some((-0.05, 0.0, 1.0, 1.25));
                }
                let Some((phase, number, size, period)) = &mut state else {
                    return 0.0;
                };
                *phase += STEP_S;
                let lasts = *period / frequency;
                if *phase > lasts {
                    *phase -= lasts;
                    *number += 1.0;
                    *size = 1.0 + 0.08 * normal(random);
                    *period = 1.0 + 0.25 * 0.5_f64.powf(*number) + 0.02 * normal(random);
                }
                let x = *phase / (0.45 * lasts);
                let is_pushing = *number < beats && (0.0..1.0).contains(&x);
                if is_pushing {
                    amplitude * *size * (std::f64::consts::PI * x).sin().powf(1.2)
                } else {
                    0.0
                }
            });
            let torques = torques.collect();
            (
                torques,
                vec![("frequency_hz", frequency), ("amplitude_nm", amplitude)],
            )
        }
        Symptom::RangeLimit => {
            let is_extension = random.bool();
            let at = if is_extension {
                15.0 + 20.0 * random.f64()
            } else {
                80.0 + 18.0 * random.f64()
            };
            let (stiffness, bend) = (10.0 + 25.0 * random.f64(), 60.0 * random.f64());
            let loss = 0.3 * random.f64();
            let sense = if is_extension { -1.0 } else { 1.0 };
            let torques = (0..count).map(|i| {
                // A corner of one degree.
                let x = sense * (path.angle[i] - rad(at));
                let deep = rad(1.0) * (x / rad(1.0)).min(40.0).exp().ln_1p();
                let deep = if x > rad(30.0) { x } else { deep };
                let out = if sense * path.omega[i] < 0.0 {
                    1.0 - loss
                } else {
                    1.0
                };
                sense * out * (stiffness * deep + bend * deep * deep)
            });
            let torques = torques.collect();
            let key = if is_extension {
                "extension_limit_deg"
            } else {
                "flexion_limit_deg"
            };
            (torques, vec![(key, at)])
        }
    }
}
