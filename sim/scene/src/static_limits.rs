//! Limits of the symptoms' torque by angle, for pictures and tables of what was
//! rendered, and the largest torque that all can ask for together.
//!
//! They follow from the settings alone, in f64. Nothing here is rendered, and no
//! firmware calls it: the laws are in [`crepitus_model::render::effects`], and the tests
//! follow each law and compare. A symptom has a module of its name here, too.
//!
//! Angles are those of the joint, rad; torques N·m, positive against growing angle.

use crepitus_model::Parameters;
use crepitus_model::control::device_limits::{LimitSettings, RangeSettings};
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::play::Limits;
use crepitus_model::render::effects::spasticity::SpasticitySettings;

/// Range in which a leg may be moved, and its largest speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// End in extension, rad.
    pub least_rad: f64,
    /// End in flexion, rad.
    pub most_rad: f64,
    /// Largest speed, rad/s.
    pub speed_rad_s: f64,
}

impl Reach {
    /// The angles at which a device shows its whole torque, and the speed at which it disarms.
    pub fn of(range: &RangeSettings, limits: &LimitSettings) -> Self {
        Self {
            least_rad: (range.least_deg + range.fade_deg).to_radians(),
            most_rad: (range.most_deg - range.fade_deg).to_radians(),
            speed_rad_s: limits.speed_rad_s,
        }
    }

    /// The largest distance from an angle, rad.
    fn furthest_rad(&self, angle_rad: f64) -> f64 {
        let [least, most] = [self.least_rad, self.most_rad].map(|end| (end - angle_rad).abs());
        least.max(most)
    }
}

/// The largest torque that the symptoms and the joint can ask for together within a
/// reach, N·m: [`largest_torque_nm`](EffectSettings::largest_torque_nm) with what grows with
/// the angle. The line of a clasp-knife, which ends at its collapse, is in that already; a
/// reflex stays below its largest torque.
pub fn largest_within_nm(
    effects: &EffectSettings,
    joint: Option<&Parameters>,
    reach: &Reach,
) -> f64 {
    let lead_pipe = effects
        .lead_pipe
        .map(|s| (s.elastic_nm_per_rad, s.neutral_deg));
    let cogwheel = effects
        .cogwheel
        .map(|s| (s.elastic_nm_per_rad, s.neutral_deg));
    let springs = [lead_pipe, cogwheel].into_iter().flatten();
    let springs_nm: f64 = springs
        .map(|(elastic, neutral_deg)| elastic * reach.furthest_rad(neutral_deg.to_radians()))
        .sum();
    let muscle = effects.spasticity.filter(SpasticitySettings::catches);
    let beyond_nm = muscle.map_or(0.0, |s| {
        let caught_nm = spasticity::largest_caught_nm(&s, reach);
        caught_nm - s.torque_nm
    });
    effects.largest_torque_nm(joint) + springs_nm + beyond_nm
}

/// ±`nm` about a spring.
fn about(nm: f64, elastic_nm_per_rad: f64, neutral_deg: f64, angle_rad: f64) -> Limits<f64> {
    let spring_nm = elastic_nm_per_rad * (angle_rad - neutral_deg.to_radians());
    Limits {
        lower_nm: spring_nm - nm,
        upper_nm: spring_nm + nm,
    }
}

/// The sense of φ in which muscles are stretched: extensors in flexion.
fn stretched(muscles: u8) -> f64 {
    if muscles == 0 { 1.0 } else { -1.0 }
}

/// Ends of the range.
pub mod range_limit {
    use crepitus_model::render::effects::play::Limits;
    use crepitus_model::render::effects::range_limit::{EndFeel, RangeLimitSettings};

    /// env(p), N·m, so far beyond the end's place, rad; nothing before it.
    fn envelope_nm(end: &EndFeel, beyond_rad: f64) -> f64 {
        let p = beyond_rad.max(0.0);
        (p * (end.stiffness_nm_per_rad + p * end.stiffening_nm_per_rad2)).min(end.torque_nm)
    }

    /// Limits, N·m, between which the torque of both ends lies at an angle, rad.
    pub fn limits_at(settings: &RangeLimitSettings, angle_rad: f64) -> Limits<f64> {
        let extension_rad = settings.extension_limit_deg.to_radians() - angle_rad;
        let flexion_rad = angle_rad - settings.flexion_limit_deg.to_radians();
        Limits {
            lower_nm: -envelope_nm(&settings.extension(), extension_rad),
            upper_nm: envelope_nm(&settings.flexion(), flexion_rad),
        }
    }
}

/// Rigidity.
pub mod lead_pipe {
    use super::about;
    use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
    use crepitus_model::render::effects::play::Limits;

    /// Limits, N·m, between which the torque lies at an angle, rad; it is on one of them once
    /// the joint has moved by 2δ in one sense.
    pub fn limits_at(settings: &LeadPipeSettings, angle_rad: f64) -> Limits<f64> {
        let (elastic, neutral_deg) = (settings.elastic_nm_per_rad, settings.neutral_deg);
        about(settings.torque_nm, elastic, neutral_deg, angle_rad)
    }
}

/// Rigidity with teeth.
pub mod cogwheel {
    use super::about;
    use crepitus_model::render::effects::cogwheel::CogwheelSettings;
    use crepitus_model::render::effects::play::Limits;

    /// Limits, N·m, between which the torque lies at an angle, rad: at the height of a tooth,
    /// or between two.
    pub fn limits_at(settings: &CogwheelSettings, angle_rad: f64, is_high: bool) -> Limits<f64> {
        let share = if is_high { 1.0 } else { settings.low_share };
        let (elastic, neutral_deg) = (settings.elastic_nm_per_rad, settings.neutral_deg);
        about(share * settings.torque_nm, elastic, neutral_deg, angle_rad)
    }
}

/// A spastic muscle, in both forms.
pub mod spasticity {
    use super::{Reach, stretched};
    use crepitus_model::Real;
    use crepitus_model::render::effects::spasticity::SpasticitySettings;

    /// Sense of the stretch: +1 where flexion stretches the muscles, −1 where extension does.
    pub fn sense(settings: &SpasticitySettings) -> f64 {
        stretched(settings.muscles)
    }

    /// λ − μΩ, where a stretch at this velocity, rad/s, meets the threshold, rad.
    pub fn threshold_rad(settings: &SpasticitySettings, omega_rad_s: f64) -> f64 {
        settings.threshold_deg.to_radians() - settings.velocity_shift_s * omega_rad_s
    }

    /// The slowest stretch that is answered, rad/s.
    pub fn slowest_rad_s(settings: &SpasticitySettings) -> f64 {
        if settings.catches() {
            settings.threshold_velocity_deg_s.to_radians()
        } else {
            0.0
        }
    }

    /// P, the height of a catch at this velocity, rad/s: N·m, as a magnitude.
    pub fn catch_nm(settings: &SpasticitySettings, omega_rad_s: f64) -> f64 {
        let nm = settings.velocity_torque_nms_per_rad * sense(settings) * omega_rad_s;
        nm.clamp(0.0, settings.torque_nm)
    }

    /// Remaining torque, at an angle, rad, of a catch that has released, N·m, signed: it was
    /// caught at `caught_rad` with `caught_rad_s`.
    pub fn left_nm(
        settings: &SpasticitySettings,
        caught_rad: f64,
        caught_rad_s: f64,
        angle_rad: f64,
    ) -> f64 {
        let sense = sense(settings);
        let beyond_rad = (sense * (angle_rad - caught_rad)).max(0.0);
        let released_nm = catch_nm(settings, caught_rad_s) * settings.residual_share;
        sense * (released_nm + settings.stiffness_nm_per_rad * beyond_rad)
    }

    /// The largest torque of a catch within a reach, N·m: that of the fastest stretch, as it
    /// is caught or at the end of the reach. Between them it is less: the decay is convex, and
    /// k grows at most with the largest speed.
    pub fn largest_caught_nm(settings: &SpasticitySettings, reach: &Reach) -> f64 {
        let sense = sense(settings);
        let (first_rad, last_rad) = if sense > 0.0 {
            (reach.least_rad, reach.most_rad)
        } else {
            (reach.most_rad, reach.least_rad)
        };
        let fastest_rad_s = sense * reach.speed_rad_s;
        // Angles along the stretch.
        let caught = (sense * threshold_rad(settings, fastest_rad_s)).max(sense * first_rad);
        let travel_rad = (sense * last_rad - caught).max(0.0);
        let peak_nm = catch_nm(settings, fastest_rad_s);
        let time_s = travel_rad / reach.speed_rad_s;
        let residual = settings.residual_share;
        let left = residual + (1.0 - residual) * Real::exp(-time_s / settings.release_s);
        peak_nm.max(peak_nm * left + settings.stiffness_nm_per_rad * travel_rad)
    }

    /// Torque that the reflex comes to at an angle, rad, in a stretch without end at this
    /// velocity, rad/s, but for its lateness, N·m, signed.
    pub fn reflex_nm(settings: &SpasticitySettings, angle_rad: f64, omega_rad_s: f64) -> f64 {
        let sense = sense(settings);
        let beyond_rad = sense * (angle_rad - threshold_rad(settings, omega_rad_s));
        sense * (settings.gain_nm_per_rad * beyond_rad.max(0.0)).min(settings.torque_nm)
    }
}

/// Resistance that collapses.
pub mod clasp_knife {
    use super::stretched;
    use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;

    /// Sense of the stretch: +1 where flexion stretches the muscle, −1 where extension does.
    pub fn sense(settings: &ClaspKnifeSettings) -> f64 {
        stretched(settings.muscles)
    }

    /// The angle at which it collapses, rad; `None` if its torque decides.
    pub fn release_rad(settings: &ClaspKnifeSettings) -> Option<f64> {
        (settings.trigger == 0).then(|| settings.release_deg.to_radians())
    }

    /// Largest torque of the limit at an angle, rad, while it builds, N·m, signed; nothing
    /// before the onset.
    pub fn building_nm(settings: &ClaspKnifeSettings, angle_rad: f64) -> f64 {
        let sense = sense(settings);
        let beyond_rad = sense * (angle_rad - settings.onset_deg.to_radians());
        if beyond_rad < 0.0 {
            return 0.0;
        }
        sense * (settings.onset_torque_nm + settings.slope_nm_per_rad * beyond_rad)
    }

    /// Remaining torque, at any angle, after the collapse at this one, rad: N·m, signed.
    pub fn left_nm(settings: &ClaspKnifeSettings, released_rad: f64) -> f64 {
        settings.residual_share * building_nm(settings, released_rad)
    }
}

/// Beats of clonus.
pub mod clonus {
    use super::stretched;
    use crepitus_model::render::effects::clonus::ClonusSettings;

    /// Interval from beat n to the next, s; the first beat is 0.
    pub fn interval_s(settings: &ClonusSettings, n: u32) -> f64 {
        let halved = 0.5_f64.powi(i32::try_from(n).unwrap_or(i32::MAX));
        (1.0 + settings.first_stretch * halved) / settings.frequency_hz
    }

    /// The height of a beat, N·m, signed.
    pub fn beat_nm(settings: &ClonusSettings) -> f64 {
        stretched(settings.muscles) * settings.amplitude_nm
    }
}

#[cfg(test)]
mod tests;
