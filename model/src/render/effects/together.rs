//! Rules between the symptoms that a device renders at once.

use super::EffectSettings;
use crate::joint::{MOST_STIFFNESS_NM_PER_RAD, Parameters, SettingsError};
use crate::parameters::Tabled;

/// The share of the gear's friction that may be cancelled in front of a wall.
pub const MOST_SHARE_AT_A_WALL: f64 = 0.8;

impl EffectSettings {
    /// Checks every effect, and what holds between them and the joint.
    ///
    /// # Errors
    /// The first rule that is broken.
    pub fn check(&self, joint: Option<&Parameters>) -> Result<(), SettingsError> {
        self.check_knee(joint)?;
        let rings_there = self.bone_shaping.is_some_and(|bone| bone.output != 0);
        if rings_there && self.vibration_actuator.is_none() {
            return Err(SettingsError::Contradiction {
                reason: "bone-shaping: an output to the actuator needs vibration-actuator",
            });
        }
        Ok(())
    }

    /// Checks a knee on any brace: what the brace has besides its motor is not known.
    ///
    /// # Errors
    /// The first rule that is broken.
    pub fn check_knee(&self, joint: Option<&Parameters>) -> Result<(), SettingsError> {
        self.check_symptoms()?;
        if let Some(settings) = &self.vibration_actuator {
            settings.check()?;
        }
        if let Some(settings) = &self.bone_shaping {
            settings.validate()?;
        }
        if let Some(settings) = &self.friction_compensation {
            settings.validate()?;
            let has_wall = self.bounds().any(|most| most.is_wall);
            if has_wall && settings.share > MOST_SHARE_AT_A_WALL {
                return Err(SettingsError::Contradiction {
                    reason: "friction-compensation: a share above 0.8 leaves too little friction to keep the \
                             wall of range-limit quiet",
                });
            }
        }
        let sum_nm_per_rad = self.stiffness_nm_per_rad(joint);
        // The stick-slip joint alone is held to what its turn-back guard can do.
        let is_alone = self.stiffness_nm_per_rad(None) == 0.0;
        if sum_nm_per_rad > MOST_STIFFNESS_NM_PER_RAD && !is_alone {
            return Err(SettingsError::TooStiff { sum_nm_per_rad });
        }
        Ok(())
    }

    /// The sum of the stiffness of all that can be elastic at once, N·m/rad.
    pub fn stiffness_nm_per_rad(&self, joint: Option<&Parameters>) -> f64 {
        let joint = joint.map(|joint| joint.stiffness_nm_per_rad);
        let symptoms = self.bounds().map(|most| most.stiffness_nm_per_rad);
        joint.into_iter().chain(symptoms).sum()
    }

    /// The largest torque that the symptoms and the joint can ask for together, N·m, but for
    /// what grows with the angle: `crepitus_scene::static_limits` adds that.
    pub fn largest_torque_nm(&self, joint: Option<&Parameters>) -> f64 {
        let joint = joint.map(|joint| joint.static_torque_nm);
        let symptoms = self.bounds().map(|most| most.torque_nm);
        joint.into_iter().chain(symptoms).sum()
    }

    /// A torque that symptoms and joint never exceed together while the leg is within
    /// half a turn, N·m: with what grows with the angle.
    pub fn torque_bound_nm(&self, joint: Option<&Parameters>) -> f64 {
        let slope: f64 = self.bounds().map(|most| most.slope_nm_per_rad).sum();
        self.largest_torque_nm(joint) + slope * core::f64::consts::PI
    }

    /// The largest torque that the motor gets besides that of symptoms and joint, N·m.
    pub fn added_bound_nm(&self) -> f64 {
        let friction = self.friction_compensation.as_ref();
        let friction_nm = friction.map_or(0.0, |gear| gear.share * gear.friction_nm);
        let bone = self.bone_shaping.as_ref();
        // Ringing on the actuator is no torque of the motor.
        let bone_nm = bone
            .filter(|bone| bone.output == 0)
            .map_or(0.0, |bone| bone.limit_nm);
        friction_nm + bone_nm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::effects::SPECS;
    use crate::render::effects::bone_shaping::BoneShapingSettings;
    use crate::render::effects::clasp_knife::ClaspKnifeSettings;
    use crate::render::effects::clonus::ClonusSettings;
    use crate::render::effects::cogwheel::CogwheelSettings;
    use crate::render::effects::friction_compensation::FrictionCompensationSettings;
    use crate::render::effects::lead_pipe::LeadPipeSettings;
    use crate::render::effects::range_limit::RangeLimitSettings;
    use crate::render::effects::spasticity::SpasticitySettings;
    use crate::render::effects::texture::TextureSettings;
    use crate::render::effects::vibration_actuator::VibrationActuatorSettings;

    /// The stiffest that the presets ask for at once: 400 + 400 + 200 + 76.
    fn stiff() -> EffectSettings {
        EffectSettings {
            range_limit: Some(RangeLimitSettings {
                flexion_stiffness_nm_per_rad: 300.0,
                flexion_stiffening_nm_per_rad2: 0.0,
                flexion_loss: 0.25,
                ..RangeLimitSettings::default()
            }),
            lead_pipe: Some(LeadPipeSettings {
                torque_nm: 2.0,
                ..LeadPipeSettings::default()
            }),
            texture: Some(TextureSettings::default()),
            ..EffectSettings::default()
        }
    }

    #[test]
    fn an_effect_alone_is_that_at_its_place() {
        let settings = stiff();
        let alone = |name| {
            let place = SPECS.iter().position(|spec| spec.name == name).unwrap();
            settings.only(place)
        };
        assert_eq!(alone("texture").texture, settings.texture);
        assert_eq!(alone("texture").lead_pipe, None);
        assert_eq!(alone("lead-pipe").lead_pipe, settings.lead_pipe);
        assert_eq!(alone("cogwheel"), EffectSettings::default());
        assert_eq!(settings.only(SPECS.len()), EffectSettings::default());
    }

    #[test]
    fn all_that_is_elastic_at_once_has_a_limit() {
        let joint = Parameters::default();
        let settings = stiff();
        let sum = settings.stiffness_nm_per_rad(Some(&joint));
        assert!(
            (sum - (400.0 + 400.0 + 200.0 + 76.394)).abs() < 1e-3,
            "{sum}"
        );
        assert_eq!(settings.check(Some(&joint)), Ok(()));
        let stiffer = Parameters {
            stiffness_nm_per_rad: 1530.0,
            ..joint
        };
        let refused = settings.check(Some(&stiffer));
        assert!(
            matches!(refused, Err(SettingsError::TooStiff { sum_nm_per_rad }) if sum_nm_per_rad > 1200.0)
        );
        assert_eq!(settings.check(None), Ok(()));
        assert_eq!(EffectSettings::default().check(Some(&stiffer)), Ok(()));
        let nm = settings.largest_torque_nm(Some(&joint));
        assert!((nm - (0.4 + 4.0 + 2.0 + 0.4)).abs() < 1e-12, "{nm}");
        // The limit itself is allowed: a wall of 1000 N·m/rad, and a texture of 200.
        let most = EffectSettings {
            range_limit: Some(RangeLimitSettings {
                flexion_stiffness_nm_per_rad: 500.0,
                flexion_stiffening_nm_per_rad2: 0.0,
                flexion_loss: 0.5,
                ..RangeLimitSettings::default()
            }),
            texture: Some(TextureSettings::default()),
            ..EffectSettings::default()
        };
        assert_eq!(most.stiffness_nm_per_rad(None), MOST_STIFFNESS_NM_PER_RAD);
        assert_eq!(most.check(None), Ok(()));
    }

    #[test]
    fn ringing_of_an_actuator_needs_one() {
        let bone = |output, vibration_actuator| {
            let settings = EffectSettings {
                bone_shaping: Some(BoneShapingSettings {
                    output,
                    ..BoneShapingSettings::default()
                }),
                vibration_actuator,
                ..EffectSettings::default()
            };
            // A knee is one on any brace.
            assert_eq!(settings.check_knee(None), Ok(()));
            settings.check(None).is_ok()
        };
        let actuator = Some(VibrationActuatorSettings::default());
        assert!(bone(0, None) && bone(0, actuator) && bone(1, actuator));
        assert!(!bone(1, None));
    }

    #[test]
    fn what_is_added_has_a_bound() {
        let friction = Some(FrictionCompensationSettings::default());
        let bone = |output| {
            Some(BoneShapingSettings {
                output,
                ..BoneShapingSettings::default()
            })
        };
        for (friction_compensation, bone_shaping, expected_nm) in [
            (None, None, 0.0),
            (friction, None, 0.4),
            (friction, bone(0), 1.0),
            (None, bone(1), 0.0),
        ] {
            let added = EffectSettings {
                friction_compensation,
                bone_shaping,
                ..stiff()
            };
            let bound_nm = added.added_bound_nm();
            assert!((bound_nm - expected_nm).abs() < 1e-12, "{bound_nm}");
        }
    }

    #[test]
    fn the_torques_of_all_symptoms_have_a_sum_and_a_bound() {
        let all = EffectSettings {
            range_limit: Some(RangeLimitSettings::default()),
            lead_pipe: Some(LeadPipeSettings {
                elastic_nm_per_rad: 2.0,
                ..LeadPipeSettings::default()
            }),
            cogwheel: Some(CogwheelSettings {
                elastic_nm_per_rad: 5.0,
                ..CogwheelSettings::default()
            }),
            spasticity: Some(SpasticitySettings::default()),
            clasp_knife: Some(ClaspKnifeSettings::default()),
            clonus: Some(ClonusSettings::default()),
            texture: Some(TextureSettings::default()),
            ..EffectSettings::default()
        };
        let clasp_nm = 0.8 + 3.0 * core::f64::consts::FRAC_PI_4;
        let sum_nm = 0.4 + 4.0 + 1.2 + 2.0 + 4.5 + clasp_nm + 1.5 + 0.4;
        let joint = Parameters::default();
        let nm = all.largest_torque_nm(Some(&joint));
        assert!((nm - sum_nm).abs() < 1e-12, "{nm}");
        let bound_nm = all.torque_bound_nm(Some(&joint));
        let slopes = 2.0 + 5.0 + 1.0 + 3.0;
        assert!((bound_nm - sum_nm - slopes * core::f64::consts::PI).abs() < 1e-12);
        // A stiff blade that falls by its torque has no more, wherever it falls.
        let by_torque = EffectSettings {
            clasp_knife: Some(ClaspKnifeSettings {
                trigger: 1,
                release_torque_nm: 2.5,
                slope_nm_per_rad: 20.0,
                ..ClaspKnifeSettings::default()
            }),
            ..EffectSettings::default()
        };
        assert_eq!(by_torque.largest_torque_nm(None), 2.5);
        // One that is soft collapses before it has come to its limit, and rises on to that.
        let soft = EffectSettings {
            clasp_knife: by_torque.clasp_knife.map(|blade| ClaspKnifeSettings {
                onset_torque_nm: 1.0,
                catch_stiffness_nm_per_rad: 10.0,
                ..blade
            }),
            ..by_torque
        };
        assert_eq!(soft.largest_torque_nm(None), 1.0 + 20.0 * 0.25);
    }

    #[test]
    fn a_wall_needs_friction() {
        let share = |share| FrictionCompensationSettings {
            share,
            ..FrictionCompensationSettings::default()
        };
        let with = |friction| EffectSettings {
            friction_compensation: Some(friction),
            ..stiff()
        };
        assert_eq!(with(share(0.8)).check(None), Ok(()));
        assert!(with(share(0.81)).check(None).is_err());
        let without_wall = EffectSettings {
            range_limit: None,
            ..with(share(0.9))
        };
        assert_eq!(without_wall.check(None), Ok(()));
    }

    #[test]
    fn a_wall_that_is_too_stiff_or_too_elastic_is_refused() {
        let wall = |stiffness, loss| EffectSettings {
            range_limit: Some(RangeLimitSettings {
                extension_stiffness_nm_per_rad: stiffness,
                extension_stiffening_nm_per_rad2: 0.0,
                extension_loss: loss,
                ..RangeLimitSettings::default()
            }),
            ..EffectSettings::default()
        };
        assert_eq!(wall(400.0, 0.0).check(None), Ok(()));
        assert!(wall(401.0, 0.0).check(None).is_err());
        assert_eq!(wall(600.0, 0.1).check(None), Ok(()));
        assert_eq!(wall(600.0, 0.39).check(None), Ok(()));
        assert_eq!(wall(500.0, 0.5).check(None), Ok(()));
        assert!(wall(600.0, 0.41).check(None).is_err());
    }
}
