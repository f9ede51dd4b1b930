//! Limits of the symptoms' torque by angle, for pictures and tables of what was
//! rendered.
//!
//! They follow from the settings alone, in f64. Nothing here is rendered, and no
//! firmware calls it: the laws are in the files of their names, and the tests below
//! follow each law and compare.
//!
//! Angles are those of the joint, rad; torques N·m, positive against growing angle.

use super::EffectSettings;
use super::clasp_knife::ClaspKnifeSettings;
use super::clonus::ClonusSettings;
use super::cogwheel::CogwheelSettings;
use super::lead_pipe::LeadPipeSettings;
use super::play::Limits;
use super::range_limit::{EndFeel, RangeLimitSettings};
use super::spasticity::SpasticitySettings;
use super::symptom::sense;
use super::texture::TextureSettings;
use crate::control::device_limits::{LimitSettings, RangeSettings};
use crate::joint::Parameters;

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

impl EffectSettings {
    /// The largest torque that the symptoms and the joint can ask for together within a
    /// reach, N·m: [`largest_torque_nm`](Self::largest_torque_nm) with what grows with the
    /// angle. The line of a clasp-knife, which ends at its collapse, is in that already; a
    /// reflex stays below its largest torque.
    pub fn largest_within_nm(&self, joint: Option<&Parameters>, reach: &Reach) -> f64 {
        let lead_pipe = self
            .lead_pipe
            .map(|s| (s.elastic_nm_per_rad, s.neutral_deg));
        let cogwheel = self.cogwheel.map(|s| (s.elastic_nm_per_rad, s.neutral_deg));
        let springs = [lead_pipe, cogwheel].into_iter().flatten();
        let springs_nm: f64 = springs
            .map(|(nm_per_rad, neutral_deg)| {
                nm_per_rad * reach.furthest_rad(neutral_deg.to_radians())
            })
            .sum();
        let muscle = self.spasticity.filter(SpasticitySettings::catches);
        let beyond_nm = muscle.map_or(0.0, |s| s.largest_caught_nm(reach) - s.torque_nm);
        self.largest_torque_nm(joint) + springs_nm + beyond_nm
    }
}

impl EndFeel {
    /// env(p), N·m, so far beyond the end's place; nothing before it.
    fn envelope_nm(&self, beyond_rad: f64) -> f64 {
        let p = beyond_rad.max(0.0);
        (p * (self.stiffness_nm_per_rad + p * self.stiffening_nm_per_rad2)).min(self.torque_nm)
    }
}

impl RangeLimitSettings {
    /// Limits between which the torque of both ends lies at an angle.
    pub fn limits_at(&self, angle_rad: f64) -> Limits<f64> {
        let (extension, flexion) = (self.extension(), self.flexion());
        let extension_rad = self.extension_limit_deg.to_radians() - angle_rad;
        let flexion_rad = angle_rad - self.flexion_limit_deg.to_radians();
        Limits {
            lower_nm: -extension.envelope_nm(extension_rad),
            upper_nm: flexion.envelope_nm(flexion_rad),
        }
    }
}

/// ±`nm` about a spring.
fn about(nm: f64, elastic_nm_per_rad: f64, neutral_deg: f64, angle_rad: f64) -> Limits<f64> {
    let spring_nm = elastic_nm_per_rad * (angle_rad - neutral_deg.to_radians());
    Limits {
        lower_nm: spring_nm - nm,
        upper_nm: spring_nm + nm,
    }
}

impl LeadPipeSettings {
    /// Limits between which its torque lies at an angle; on one of them once the joint has moved
    /// by 2δ in one sense.
    pub fn limits_at(&self, angle_rad: f64) -> Limits<f64> {
        let (elastic, neutral_deg) = (self.elastic_nm_per_rad, self.neutral_deg);
        about(self.torque_nm, elastic, neutral_deg, angle_rad)
    }
}

impl CogwheelSettings {
    /// Limits between which its torque lies at an angle: at the height of a tooth, or between
    /// two.
    pub fn limits_at(&self, angle_rad: f64, is_high: bool) -> Limits<f64> {
        let share = if is_high { 1.0 } else { self.low_share };
        let (elastic, neutral_deg) = (self.elastic_nm_per_rad, self.neutral_deg);
        about(share * self.torque_nm, elastic, neutral_deg, angle_rad)
    }
}

impl SpasticitySettings {
    /// +1 where flexion stretches the muscles, −1 where extension does.
    pub fn sense(&self) -> f64 {
        sense(self.muscles)
    }

    /// Returns whether it has the form `catch`; otherwise `reflex`.
    pub fn catches(&self) -> bool {
        self.form == 0
    }

    /// λ − μΩ, where a stretch at this velocity meets the threshold, rad.
    pub fn threshold_rad(&self, omega_rad_s: f64) -> f64 {
        self.threshold_deg.to_radians() - self.velocity_shift_s * omega_rad_s
    }

    /// The slowest stretch that is answered, rad/s.
    pub fn slowest_rad_s(&self) -> f64 {
        if self.catches() {
            self.threshold_velocity_deg_s.to_radians()
        } else {
            0.0
        }
    }

    /// P, the height of a catch at this velocity, N·m, as a magnitude.
    pub fn catch_nm(&self, omega_rad_s: f64) -> f64 {
        (self.velocity_torque_nms_per_rad * self.sense() * omega_rad_s).clamp(0.0, self.torque_nm)
    }

    /// Remaining torque, at an angle, of a catch that has released, N·m, signed.
    pub fn left_nm(&self, caught_rad: f64, caught_rad_s: f64, angle_rad: f64) -> f64 {
        let beyond_rad = (self.sense() * (angle_rad - caught_rad)).max(0.0);
        self.sense()
            * (self.catch_nm(caught_rad_s) * self.residual_share
                + self.stiffness_nm_per_rad * beyond_rad)
    }

    /// The largest torque of a catch within a reach, N·m: that of the fastest stretch, as it
    /// is caught or at the end of the reach. Between them it is less: the decay is convex, and
    /// k grows at most with the largest speed.
    pub fn largest_caught_nm(&self, reach: &Reach) -> f64 {
        let sense = self.sense();
        let (first_rad, last_rad) = if sense > 0.0 {
            (reach.least_rad, reach.most_rad)
        } else {
            (reach.most_rad, reach.least_rad)
        };
        let fastest_rad_s = sense * reach.speed_rad_s;
        // Angles along the stretch.
        let caught = (sense * self.threshold_rad(fastest_rad_s)).max(sense * first_rad);
        let travel_rad = (sense * last_rad - caught).max(0.0);
        let peak_nm = self.catch_nm(fastest_rad_s);
        let time_s = travel_rad / reach.speed_rad_s;
        let left =
            self.residual_share + (1.0 - self.residual_share) * libm::exp(-time_s / self.release_s);
        peak_nm.max(peak_nm * left + self.stiffness_nm_per_rad * travel_rad)
    }

    /// Torque that the reflex comes to at an angle in a stretch without end at this velocity,
    /// but for its lateness, N·m, signed.
    pub fn reflex_nm(&self, angle_rad: f64, omega_rad_s: f64) -> f64 {
        let beyond_rad = self.sense() * (angle_rad - self.threshold_rad(omega_rad_s));
        self.sense() * (self.gain_nm_per_rad * beyond_rad.max(0.0)).min(self.torque_nm)
    }
}

impl ClaspKnifeSettings {
    /// +1 where flexion stretches the muscle, −1 where extension does.
    pub fn sense(&self) -> f64 {
        sense(self.muscles)
    }

    /// The angle at which it collapses, rad; `None` if its torque decides.
    pub fn release_rad(&self) -> Option<f64> {
        (self.trigger == 0).then(|| self.release_deg.to_radians())
    }

    /// Largest torque of the limit at an angle while it builds, N·m, signed; nothing before
    /// the onset.
    pub fn building_nm(&self, angle_rad: f64) -> f64 {
        let beyond_rad = self.sense() * (angle_rad - self.onset_deg.to_radians());
        if beyond_rad < 0.0 {
            return 0.0;
        }
        self.sense() * (self.onset_torque_nm + self.slope_nm_per_rad * beyond_rad)
    }

    /// Remaining torque, at any angle, after the collapse at this one, N·m, signed.
    pub fn left_nm(&self, released_rad: f64) -> f64 {
        self.residual_share * self.building_nm(released_rad)
    }
}

impl ClonusSettings {
    /// Interval from beat n to the next, s; the first beat is 0.
    pub fn interval_s(&self, n: u32) -> f64 {
        (1.0 + self.first_stretch * libm::exp2(-f64::from(n))) / self.frequency_hz
    }

    /// The height of a beat, N·m, signed.
    pub fn beat_nm(&self) -> f64 {
        sense::<f64>(self.muscles) * self.amplitude_nm
    }
}

impl TextureSettings {
    /// Mean resistance of a long movement at one speed, N·m, where asperities are even.
    pub fn mean_nm(&self) -> f64 {
        let (all, there) = self.patches();
        let share = f64::from(there) / f64::from(all);
        self.base_nm + 0.5 * share * self.width_share * (self.peak_nm - self.base_nm)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Effects;
    use super::super::tests::TIMING;
    use super::*;
    use crate::render::input_check::{InputCheck, InputLimits};
    use crate::render::{Addition, Check, ShaftEstimate, Shown};
    use crate::{Sample, ShaftStep, Tabled};
    use std::vec::Vec;

    const STEP_S: f64 = 5e-5;

    /// Angle, velocity and torque at the ticks of a movement over these angles, deg, at
    /// this speed, deg/s.
    fn follow(settings: &EffectSettings, degrees: &[f64], deg_s: f64) -> Vec<(f64, f64, f64)> {
        let mut effects: Effects<f64> = settings.laws(&TIMING).unwrap();
        let mut check = InputCheck::new(&InputLimits::device(STEP_S), STEP_S, 0.0);
        effects.rest(&TIMING.sensing.position(degrees[0].to_radians()));
        let mut rows = Vec::new();
        for ends in degrees.windows(2) {
            let (from, to) = (ends[0].to_radians(), ends[1].to_radians());
            let omega_rad_s = deg_s.to_radians().copysign(to - from);
            let ticks = ((to - from) / omega_rad_s / STEP_S).round();
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            for n in 1..=ticks as u32 {
                let angle_rad = from + f64::from(n) * STEP_S * omega_rad_s;
                let sample = Sample::Taken(ShaftStep {
                    delta_phi_rad: STEP_S * omega_rad_s,
                    omega_start_rad_s: omega_rad_s,
                    omega_end_rad_s: omega_rad_s,
                });
                let seen = ShaftEstimate {
                    sample,
                    omega_rad_s,
                    place: TIMING.sensing.position(angle_rad),
                    is_driven: true,
                };
                let mut shown = Shown::nothing();
                effects.tick(&seen, &check.check(&sample), &mut shown, &mut ());
                rows.push((angle_rad, omega_rad_s, shown.torque_nm));
            }
        }
        rows
    }

    /// The torque never leaves the limits, and is on both of them for a part of the
    /// movement.
    fn assert_between(rows: &[(f64, f64, f64)], limits: impl Fn(f64) -> Limits<f64>) {
        let (mut at_upper, mut at_lower) = (0, 0);
        for (angle_rad, _, nm) in rows {
            let Limits { lower_nm, upper_nm } = limits(*angle_rad);
            assert!(
                (lower_nm - 1e-9..=upper_nm + 1e-9).contains(nm),
                "{nm} at {angle_rad}: {lower_nm} to {upper_nm}"
            );
            at_upper += u32::from(upper_nm > 0.0 && (nm - upper_nm).abs() < 1e-9);
            at_lower += u32::from(lower_nm < 0.0 && (nm - lower_nm).abs() < 1e-9);
        }
        assert!(at_upper > 200 && at_lower > 200, "{at_upper}, {at_lower}");
    }

    #[test]
    fn both_ends_of_the_range_push_inwards() {
        let settings = RangeLimitSettings {
            extension_torque_nm: 3.0,
            ..RangeLimitSettings::defaults()
        };
        let of = EffectSettings {
            range_limit: Some(settings),
            ..EffectSettings::default()
        };
        let rows = follow(&of, &[60.0, 125.0, 5.0, 60.0], 60.0);
        assert_between(&rows, |angle_rad| settings.limits_at(angle_rad));
        assert_eq!(settings.limits_at(1.0), Limits::both(0.0));
        assert_eq!(settings.limits_at(140_f64.to_radians()).upper_nm, 4.0);
        assert_eq!(settings.limits_at(0.0).lower_nm, -3.0);
    }

    #[test]
    fn closed_forms_of_ends_catches_and_blades() {
        let settings = RangeLimitSettings {
            flexion_limit_deg: 0.0,
            flexion_stiffness_nm_per_rad: 40.0,
            flexion_stiffening_nm_per_rad2: 1000.0,
            flexion_torque_nm: 6.0,
            extension_limit_deg: -10.0,
            ..RangeLimitSettings::defaults()
        };
        for (beyond_rad, nm) in [(-0.01, 0.0), (0.01, 0.5), (0.05, 4.5), (0.1, 6.0)] {
            let upper_nm = settings.limits_at(beyond_rad).upper_nm;
            assert!((upper_nm - nm).abs() < 1e-12, "{upper_nm} for {nm}");
        }
        for (muscles, sign) in [(0, 1.0), (1, -1.0)] {
            let muscle = SpasticitySettings {
                muscles,
                velocity_torque_nms_per_rad: 0.5,
                torque_nm: 2.0,
                ..SpasticitySettings::defaults()
            };
            for (rad_s, nm) in [(3.0, 1.5), (9.0, 2.0), (-3.0, 0.0)] {
                assert_eq!(muscle.catch_nm(sign * rad_s), nm);
            }
            let blade = ClaspKnifeSettings {
                muscles,
                onset_deg: 60.0,
                onset_torque_nm: 1.5,
                slope_nm_per_rad: 2.0,
                ..ClaspKnifeSettings::defaults()
            };
            let onset_rad = 60_f64.to_radians();
            for (beyond_rad, nm) in [(-0.1, 0.0), (0.0, 1.5), (0.25, 2.0)] {
                let found_nm = blade.building_nm(onset_rad + sign * beyond_rad);
                assert!((found_nm - sign * nm).abs() < 1e-12, "{found_nm} {nm}");
            }
        }
    }

    #[test]
    fn rigidity_is_a_band_about_its_spring() {
        let settings = LeadPipeSettings {
            elastic_nm_per_rad: 2.0,
            ..LeadPipeSettings::defaults()
        };
        let of = EffectSettings {
            lead_pipe: Some(settings),
            ..EffectSettings::default()
        };
        let rows = follow(&of, &[45.0, 80.0, 20.0, 45.0], 60.0);
        assert_between(&rows, |angle_rad| settings.limits_at(angle_rad));
    }

    #[test]
    fn a_cogwheel_is_on_the_limits_of_its_teeth() {
        let settings = CogwheelSettings::defaults();
        let of = EffectSettings {
            cogwheel: Some(settings),
            ..EffectSettings::default()
        };
        let rows = follow(&of, &[45.0, 80.0, 20.0, 45.0], 60.0);
        assert_between(&rows, |angle_rad| settings.limits_at(angle_rad, true));
        let low = settings.limits_at(0.0, false);
        let at_low = rows.iter().filter(|(.., nm)| *nm == low.upper_nm).count();
        assert!(low.upper_nm == 0.8 && at_low > 200, "{at_low}");
    }

    #[test]
    fn a_catch_is_where_it_should_be_and_leaves_what_it_should() {
        for muscles in [0, 1] {
            let settings = SpasticitySettings {
                muscles,
                ..SpasticitySettings::defaults()
            };
            let of = EffectSettings {
                spasticity: Some(settings),
                ..EffectSettings::default()
            };
            let degrees = if muscles == 0 {
                [20.0, 110.0]
            } else {
                [130.0, 40.0]
            };
            let rows = follow(&of, &degrees, 90.0);
            let omega_rad_s = settings.sense() * 90_f64.to_radians();
            let caught_rad = settings.threshold_rad(omega_rad_s);
            let (first, ..) = rows.iter().find(|(.., nm)| *nm != 0.0).unwrap();
            assert!((first - caught_rad).abs() < 2e-4, "{first} {caught_rad}");
            let (end_rad, _, end_nm) = rows.last().unwrap();
            let left_nm = settings.left_nm(caught_rad, omega_rad_s, *end_rad);
            assert!((end_nm - left_nm).abs() < 1e-3, "{end_nm} {left_nm}");
            assert!((settings.catch_nm(omega_rad_s) - 1.0524).abs() < 1e-4);
            // Slower than any that is caught.
            assert!(settings.slowest_rad_s() > 30_f64.to_radians());
            let slow = follow(&of, &degrees, 30.0);
            assert!(slow.iter().all(|(.., nm)| *nm == 0.0));
        }
    }

    #[test]
    fn a_reflex_comes_to_its_line_late() {
        let settings = SpasticitySettings {
            form: 1,
            velocity_shift_s: 0.27,
            ..SpasticitySettings::defaults()
        };
        let of = EffectSettings {
            spasticity: Some(settings),
            ..EffectSettings::default()
        };
        let late_s = settings.delay_s + settings.activation_s;
        let rows = follow(&of, &[30.0, 110.0], 60.0);
        let (angle_rad, omega_rad_s, nm) = *rows.last().unwrap();
        let expected_nm = settings.reflex_nm(angle_rad - omega_rad_s * late_s, omega_rad_s);
        assert!((nm - expected_nm).abs() < 1e-3, "{nm} {expected_nm}");
        assert!(nm > 1.0 && !settings.catches() && settings.slowest_rad_s() == 0.0);
    }

    /// A reach of a device at its defaults: 0° to 120°.
    fn reach() -> Reach {
        Reach::of(&RangeSettings::defaults(), &LimitSettings::defaults())
    }

    #[test]
    fn springs_count_as_far_from_their_neutral_angle_as_the_leg_can_be() {
        let of = |neutral_deg| EffectSettings {
            lead_pipe: Some(LeadPipeSettings {
                torque_nm: 1.2,
                elastic_nm_per_rad: 2.0,
                neutral_deg,
                ..LeadPipeSettings::defaults()
            }),
            ..EffectSettings::default()
        };
        let joint = Parameters::default();
        for (neutral_deg, furthest_deg) in [(45.0, 75.0), (100.0, 100.0), (140.0, 140.0)] {
            let nm = of(neutral_deg).largest_within_nm(Some(&joint), &reach());
            let expected_nm = 0.4 + 1.2 + 2.0 * f64::to_radians(furthest_deg);
            assert!((nm - expected_nm).abs() < 1e-12, "{nm} {expected_nm}");
        }
        let both = EffectSettings {
            cogwheel: Some(CogwheelSettings {
                elastic_nm_per_rad: 1.0,
                neutral_deg: 0.0,
                ..CogwheelSettings::defaults()
            }),
            ..of(45.0)
        };
        let more_nm =
            both.largest_within_nm(None, &reach()) - of(45.0).largest_within_nm(None, &reach());
        assert!(
            (more_nm - 2.0 - 120_f64.to_radians()).abs() < 1e-12,
            "{more_nm}"
        );
    }

    /// Catches of both muscles, at the speed at which a device disarms and at slower ones.
    #[test]
    fn no_catch_exceeds_its_largest_torque_and_the_fastest_comes_close() {
        for (muscles, threshold_deg, degrees) in [(0, 50.0, [0.0, 120.0]), (1, 70.0, [120.0, 0.0])]
        {
            for release_s in [0.06, 1.0] {
                let settings = SpasticitySettings {
                    muscles,
                    threshold_deg,
                    velocity_torque_nms_per_rad: 0.956,
                    residual_share: 0.7,
                    stiffness_nm_per_rad: 2.0,
                    release_s,
                    ..SpasticitySettings::defaults()
                };
                let of = EffectSettings {
                    spasticity: Some(settings),
                    ..EffectSettings::default()
                };
                let bound_nm = of.largest_within_nm(None, &reach());
                let highest_nm = |deg_s| {
                    let rows = follow(&of, &degrees, deg_s);
                    rows.iter().fold(0.0_f64, |most, row| most.max(row.2.abs()))
                };
                // The last tick may end beyond the reach, by less than a tick.
                let highest_allowed_nm = bound_nm + 1e-3;
                for deg_s in [60.0, 150.0, 300.0] {
                    assert!(highest_nm(deg_s) <= highest_allowed_nm, "{deg_s} deg/s");
                }
                let fastest_nm = highest_nm(reach().speed_rad_s.to_degrees());
                let close = 0.99 * bound_nm..=highest_allowed_nm;
                assert!(close.contains(&fastest_nm), "{fastest_nm} {bound_nm}");
                assert!(bound_nm > 4.5 + 2.0, "{bound_nm}");
            }
        }
        // A reflex has its largest torque, and no more.
        let reflex = EffectSettings {
            spasticity: Some(SpasticitySettings {
                form: 1,
                stiffness_nm_per_rad: 10.0,
                ..SpasticitySettings::defaults()
            }),
            ..EffectSettings::default()
        };
        assert_eq!(reflex.largest_within_nm(None, &reach()), 4.5);
    }

    #[test]
    fn a_clasp_knife_builds_along_its_line() {
        for muscles in [0, 1] {
            let settings = ClaspKnifeSettings {
                muscles,
                onset_deg: if muscles == 0 { 30.0 } else { 75.0 },
                release_deg: if muscles == 0 { 75.0 } else { 30.0 },
                ..ClaspKnifeSettings::defaults()
            };
            let of = EffectSettings {
                clasp_knife: Some(settings),
                ..EffectSettings::default()
            };
            let (from, to) = if muscles == 0 {
                (20.0, 110.0)
            } else {
                (85.0, -5.0)
            };
            let rows = follow(&of, &[from, to], 60.0);
            let most_nm = |(angle_rad, ..): &(f64, f64, f64)| settings.building_nm(*angle_rad);
            let on_it = rows
                .iter()
                .filter(|row| (row.2 - most_nm(row)).abs() < 1e-9);
            assert!(on_it.filter(|row| row.2 != 0.0).count() > 10_000);
            let released_rad = settings.release_rad().unwrap();
            assert!((settings.building_nm(released_rad).abs() - 3.156).abs() < 1e-3);
            let (.., end_nm) = rows.last().unwrap();
            assert!((end_nm - settings.left_nm(released_rad)).abs() < 1e-6);
        }
    }

    #[test]
    fn clonus_and_texture_have_their_closed_forms() {
        let clonus = ClonusSettings::defaults();
        for (n, ms) in [(0, 216.7), (1, 191.7), (2, 179.2), (3, 172.9)] {
            assert!((1e3 * clonus.interval_s(n) - ms).abs() < 0.05);
        }
        assert_eq!(clonus.beat_nm(), 1.5);
        assert!((TextureSettings::defaults().mean_nm() - 0.19).abs() < 1e-12);
    }
}
