//! Validation: [`Values`], the numbers on the wire, to [`DeviceSettings`], the
//! typed settings.

use crate::parameters::{Kind, PARAMETERS, Parameter, Values, id, with_id};
use crepitus_model::Parameters;
use crepitus_model::control::current_loop::CurrentLoopSettings;
use crepitus_model::control::device_limits::{
    JointSensorSettings, LimitSettings, MotorSettings, RangeSettings,
};
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::Source;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::turn_back::most_rad_per_count;
use crepitus_model::{Convention, Restart, Settings, SettingsError, Validated};
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Errors of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
pub enum ValueError {
    /// The parameter with this id is out of range, NaN, or no valid choice.
    OutOfRange {
        /// The parameter.
        id: u8,
    },
    /// The kinetic torque is above the static torque.
    KineticAboveStatic,
    /// The kinetic torque is so close to the static torque that the turn-back
    /// guard cannot bound the returned energy with this stiffness and encoder:
    /// see [`Values::guarded_rad_per_count`].
    Unguarded,
    /// The static torque is above the device's torque limit.
    StaticAboveLimit,
    /// The parameter with this id can only change while disarmed.
    NeedsDisarmed {
        /// The parameter.
        id: u8,
    },
    /// A rule of the effects, by themselves or together: [`DeviceSettings::broken_rule`] says
    /// which.
    Contradiction,
    /// The range of motion is narrower than its two fades.
    NarrowRange,
}

impl ValueError {
    /// The parameters concerned, the one to change first.
    pub fn parameters(&self) -> &'static [u8] {
        match self {
            Self::KineticAboveStatic => &[id::KINETIC_TORQUE, id::STATIC_TORQUE],
            Self::Unguarded => &[
                id::KINETIC_TORQUE,
                id::STATIC_TORQUE,
                id::STIFFNESS,
                id::LINES,
                id::GEAR_RATIO,
                id::RESTART,
            ],
            Self::StaticAboveLimit => &[id::STATIC_TORQUE, id::TORQUE_LIMIT],
            Self::OutOfRange { id } | Self::NeedsDisarmed { id } => {
                with_id(*id).map_or(&[], |parameter| core::slice::from_ref(&parameter.id))
            }
            Self::NarrowRange => &[id::RANGE_MOST, id::RANGE_LEAST, id::RANGE_FADE],
            Self::Contradiction => &[],
        }
    }
}

/// Converts an error of the model.
impl From<SettingsError> for ValueError {
    #[cold]
    #[inline(never)]
    fn from(error: SettingsError) -> Self {
        match error {
            SettingsError::OutOfRange { parameter, .. } => {
                let is_it = |p: &&Parameter| p.kind == Kind::Number(parameter);
                PARAMETERS
                    .iter()
                    .find(is_it)
                    .map_or(Self::Contradiction, |p| Self::OutOfRange { id: p.id })
            }
            SettingsError::KineticAboveStatic { .. } => Self::KineticAboveStatic,
            _ => Self::Contradiction,
        }
    }
}

/// All settings of a device. An effect that is off is `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceSettings {
    /// The joint.
    pub crepitus: Option<Validated<Settings>>,
    /// The encoder and the gear.
    pub encoder: EncoderSettings,
    /// The other effects.
    pub effects: EffectSettings,
    /// The motor's current loop.
    pub current_loop: CurrentLoopSettings,
    /// The motor, and what it bears.
    pub motor: MotorSettings,
    /// Safety limits.
    pub limits: LimitSettings,
    /// Range of motion.
    pub range: RangeSettings,
    /// The sensor of the joint's angle, if there is one.
    pub joint_sensor: Option<JointSensorSettings>,
}

impl DeviceSettings {
    /// Validates values.
    ///
    /// # Errors
    /// [`ValueError`] for the first invalid value or pair of values. Values of
    /// an effect that is off are checked, too.
    pub fn of(values: &Values) -> Result<Self, ValueError> {
        values.check()?;
        let joint = values.joint().validate()?;
        let limits: LimitSettings = values.read();
        if joint.parameters.static_torque_nm > limits.torque_nm {
            return Err(ValueError::StaticAboveLimit);
        }
        if values.rad_per_count() > values.guarded_rad_per_count() {
            return Err(ValueError::Unguarded);
        }
        let range: RangeSettings = values.read();
        if range.most_deg - range.least_deg < 2.0 * range.fade_deg {
            return Err(ValueError::NarrowRange);
        }
        let effects = EffectSettings::read(values);
        let is_on = values.is_on(id::CREPITUS);
        effects.check(is_on.then_some(&joint.parameters))?;
        Ok(Self {
            crepitus: is_on.then_some(joint),
            encoder: values.read(),
            effects,
            current_loop: values.read(),
            motor: values.read(),
            limits,
            range,
            joint_sensor: values.is_on(id::JOINT_SENSOR).then(|| values.read()),
        })
    }

    /// The rule of the effects, by themselves or together, that these values break, in words: on
    /// the wire it is [`ValueError::Contradiction`].
    pub fn broken_rule(values: &Values) -> Option<SettingsError> {
        let joint = values.joint().parameters;
        let is_on = values.is_on(id::CREPITUS);
        let checked = EffectSettings::read(values).check(is_on.then_some(&joint));
        checked.err()
    }

    /// Torque at the joint for one ampere, N·m/A, and voltage of the back-EMF
    /// for one rad/s of the joint.
    pub fn joint_constant(&self) -> f64 {
        self.motor.torque_constant_nm_per_a * self.encoder.gear_ratio
    }

    /// Counts of the two ends of the range of motion, from the angle's zero.
    pub fn range_counts(&self) -> (i32, i32) {
        let counts = |deg: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "a cast from float saturates"
            )]
            let counts = (deg.to_radians() / self.encoder.rad_per_count()) as i32;
            counts
        };
        (counts(self.range.least_deg), counts(self.range.most_deg))
    }
}

impl Values {
    /// Checks the range of every value.
    ///
    /// # Errors
    /// [`ValueError`] for the first value that is out of range or no valid
    /// choice.
    pub fn check(&self) -> Result<(), ValueError> {
        match self.iter().find(|(p, value)| !p.allows(*value)) {
            Some((parameter, _)) => Err(ValueError::OutOfRange { id: parameter.id }),
            None => Ok(()),
        }
    }

    /// The joint's settings, on or off.
    fn joint(&self) -> Settings {
        Settings {
            parameters: self.read(),
            convention: Convention::Frozen,
            restart: if self.is_on(id::RESTART) {
                Restart::FromKinetic
            } else {
                Restart::Elastic
            },
        }
    }

    /// Angle of one count of the encoder at the joint, rad.
    pub fn rad_per_count(&self) -> f64 {
        self.read::<3, EncoderSettings>().rad_per_count()
    }

    /// The largest angle of one count with which the turn-back guard bounds the
    /// returned energy of this joint, rad.
    pub fn guarded_rad_per_count(&self) -> f64 {
        most_rad_per_count(&self.joint())
    }

    /// Returns the values with these joint parameters, a preset for example.
    #[must_use]
    pub fn with_crepitus(self, parameters: &Parameters) -> Self {
        let mut values = self.with(parameters);
        values.set(id::CREPITUS, 1.0);
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::parameters::{Chosen, Tabled};
    use crepitus_model::render::effects;
    use std::vec::Vec;

    #[test]
    fn defaults_are_the_papers_joint_and_nothing_else() {
        let settings = DeviceSettings::of(&Values::default()).unwrap();
        assert_eq!(*settings.crepitus.unwrap(), Settings::default());
        assert_eq!(settings.encoder, EncoderSettings::default());
        assert_eq!(settings.effects, EffectSettings::default());
        assert_eq!(settings.current_loop, CurrentLoopSettings::default());
        assert_eq!(settings.limits, LimitSettings::default());
        assert_eq!(settings.range, RangeSettings::default());
    }

    #[test]
    fn every_number_arrives_at_its_place() {
        let mut values = Values::default();
        for (place, parameter) in (0_u8..).zip(&PARAMETERS) {
            let place = f64::from(place);
            values.set(
                parameter.id,
                match parameter.kind {
                    Kind::Choice(_) => 1.0,
                    // Another number in each place, all allowed.
                    Kind::Number(spec) => spec.default * (1.0 - 0.001 * place),
                },
            );
        }
        // Flexors are stretched towards smaller angles.
        let mut set = |name, value| {
            let (id, _) = crate::parameters::find(name).unwrap();
            values.set(id, value);
        };
        set("clasp-knife.onset_deg", 80.0);
        // Whole numbers.
        set("clonus.beats", 7.0);
        set("texture.seed", 8.0);
        let s = DeviceSettings::of(&values).unwrap();
        let p = s.crepitus.unwrap().parameters;
        let crepitus = [
            1.0,
            p.inertia_kg_m2,
            p.stiffness_nm_per_rad,
            p.kinetic_torque_nm,
            p.static_torque_nm,
            f64::from(u8::from(
                s.crepitus.unwrap().restart == Restart::FromKinetic,
            )),
        ];
        let of = |group: &str| -> Vec<f64> {
            let own = PARAMETERS.iter().zip(values.0);
            own.filter(|(parameter, _)| parameter.group == group)
                .map(|(_, value)| value)
                .collect()
        };
        assert_eq!(of("crepitus"), crepitus);
        assert_eq!(of("encoder"), s.encoder.values());
        assert_eq!(of("limits"), s.limits.values());
        assert_eq!(of("range"), s.range.values());
        // What came later has later ids.
        let (regulator, motor) = (s.current_loop.values(), s.motor.values());
        assert_eq!(
            of("motor"),
            [&regulator[..5], &motor[..], &regulator[5..]].concat()
        );
        for spec in effects::SPECS {
            assert_eq!(of(spec.name).first(), Some(&1.0), "{}", spec.name);
        }
        let given: Vec<_> = (effects::SPECS.iter())
            .map(|spec| {
                // A choice that came later has a later id than the numbers.
                let own = PARAMETERS
                    .iter()
                    .zip(values.0)
                    .skip_while(|(p, _)| p.group != spec.name);
                let own = own.skip(1).filter(|(p, _)| p.group == spec.name);
                let numbers = own.filter(|(p, _)| matches!(p.kind, Kind::Number(_)));
                let numbers: Vec<f64> = numbers.map(|(_, value)| value).collect();
                assert_eq!(numbers.len() + spec.choices.len() + 1, of(spec.name).len());
                (spec.name, std::vec![1_u8; spec.choices.len()], numbers)
            })
            .collect();
        let effects = EffectSettings::given(|name| {
            let (_, options, numbers) = given.iter().find(|(group, ..)| *group == name)?;
            Some(Chosen { numbers, options })
        });
        assert_eq!(s.effects, effects);
    }

    #[test]
    fn values_are_held_against_each_other() {
        let mut values = Values::default();
        values.set(id::KINETIC_TORQUE, 0.5);
        assert_eq!(
            DeviceSettings::of(&values),
            Err(ValueError::KineticAboveStatic)
        );
        values.set(id::STATIC_TORQUE, 3.0);
        values.set(id::TORQUE_LIMIT, 2.9);
        assert_eq!(
            DeviceSettings::of(&values),
            Err(ValueError::StaticAboveLimit)
        );
        // At the limit itself it is allowed.
        for limit_nm in [3.0, 4.5] {
            values.set(id::TORQUE_LIMIT, limit_nm);
            assert!(DeviceSettings::of(&values).is_ok());
        }
    }

    #[test]
    fn a_range_has_room_for_the_fades_at_both_its_ends() {
        for (least_deg, most_deg, has_room) in [
            (-40.0, 20.0, true),
            (-40.0, 19.9, false),
            (20.0, 80.0, true),
            (20.0, 79.9, false),
            (20.0, -40.0, false),
        ] {
            let mut values = Values::default();
            values.set(id::RANGE_LEAST, least_deg);
            values.set(id::RANGE_MOST, most_deg);
            values.set(id::RANGE_FADE, 30.0);
            let expected = if has_room {
                Ok(())
            } else {
                Err(ValueError::NarrowRange)
            };
            let found = DeviceSettings::of(&values).map(|_| ());
            assert_eq!(found, expected, "{least_deg} to {most_deg}");
        }
    }

    #[test]
    fn the_brace_has_its_constants_and_its_range_in_counts() {
        let mut values = Values::default();
        values.set(id::LINES, 1000.0);
        values.set(id::GEAR_RATIO, 9.0);
        values.set(id::RANGE_LEAST, -45.0);
        values.set(id::RANGE_MOST, 90.0);
        let settings = DeviceSettings::of(&values).unwrap();
        // Four counts a line, nine revolutions of the motor for one of the joint.
        assert_eq!(settings.range_counts(), (-4500, 9000));
        let torque_constant = settings.motor.torque_constant_nm_per_a;
        assert_eq!(settings.joint_constant(), 9.0 * torque_constant);
    }

    #[test]
    fn what_the_turn_back_guard_cannot_guard_is_refused() {
        let with = |changes: &[(u8, f64)]| {
            let mut values = Values::default();
            for &(id, value) in changes {
                values.set(id, value);
            }
            DeviceSettings::of(&values).map(|_| ())
        };
        let refused = Err(ValueError::Unguarded);
        // Two counts are 71.3 µrad; the drop over the stiffness of the default
        // is 500 µrad. Near Ts the other condition counts: with x = Ts − Tk and
        // restart at Ts − 2x it is 12·x² ≥ 8·kr·Δ·(Ts − x).
        let two_counts = 2.0 * EncoderSettings::default().rad_per_count();
        let count_nm = 400.0 * two_counts / 2.0;
        let drop = (count_nm * count_nm / 9.0 + 0.4 * count_nm * 2.0 / 3.0).sqrt() - count_nm / 3.0;
        let at_limit = 0.4 - drop;
        assert_eq!(with(&[(id::KINETIC_TORQUE, at_limit - 1e-9)]), Ok(()));
        assert_eq!(with(&[(id::KINETIC_TORQUE, at_limit + 1e-9)]), refused);
        assert_eq!(with(&[(id::STIFFNESS, 0.2 / two_counts - 1e-3)]), Ok(()));
        assert_eq!(with(&[(id::STIFFNESS, 0.2 / two_counts + 1e-3)]), refused);
        // A coarser encoder of the same joint.
        assert_eq!(with(&[(id::LINES, 73.1)]), Ok(()));
        assert_eq!(with(&[(id::LINES, 73.0)]), refused);
        // The same while crepitus is off.
        let off = (id::CREPITUS, 0.0);
        assert_eq!(with(&[off, (id::KINETIC_TORQUE, 0.4)]), refused);
        assert_eq!(with(&[off, (id::LINES, 73.1)]), Ok(()));
        assert_eq!(with(&[off, (id::LINES, 73.0)]), refused);
        // A stick that begins at Tk loses less to a slip.
        let near = (id::KINETIC_TORQUE, at_limit - 1e-3);
        assert_eq!(with(&[near]), Ok(()));
        assert_eq!(with(&[near, (id::RESTART, 1.0)]), refused);
        // Ts = Tk dissipates nothing; without torque in slip there is no push.
        assert_eq!(with(&[(id::KINETIC_TORQUE, 0.4)]), refused);
        assert_eq!(
            with(&[(id::KINETIC_TORQUE, 0.0), (id::STIFFNESS, 5000.0)]),
            Ok(())
        );
    }

    #[test]
    fn what_the_model_refuses_keeps_its_name() {
        let refused = |change: fn(&mut Settings)| {
            let mut settings = Settings::default();
            change(&mut settings);
            ValueError::from(settings.validate().unwrap_err())
        };
        let stiff = refused(|s| s.parameters.stiffness_nm_per_rad = -1.0);
        assert_eq!(stiff, ValueError::OutOfRange { id: id::STIFFNESS });
        let kinetic = refused(|s| s.parameters.kinetic_torque_nm = 0.5);
        assert_eq!(kinetic, ValueError::KineticAboveStatic);
        // No device has damping.
        let damped = refused(|s| s.parameters.damping_nms_per_rad = -1.0);
        assert_eq!(damped, ValueError::Contradiction);
        for error in [
            stiff,
            kinetic,
            ValueError::Unguarded,
            ValueError::StaticAboveLimit,
            ValueError::NeedsDisarmed { id: id::LINES },
        ] {
            let ids = error.parameters();
            assert!(!ids.is_empty() && ids.iter().all(|id| with_id(*id).is_some()));
        }
        assert!(ValueError::Contradiction.parameters().is_empty());
    }

    #[test]
    fn names_of_choices_are_those_of_the_model() {
        let (_, restart) = crate::parameters::find("crepitus.restart").unwrap();
        let Kind::Choice(choice) = restart.kind else {
            panic!("a choice");
        };
        assert!(Restart::ALL.map(Restart::name).iter().eq(choice.names));
    }

    #[test]
    fn a_joint_is_values() {
        let parameters = Parameters {
            inertia_kg_m2: 8e-4,
            stiffness_nm_per_rad: 320.0,
            damping_nms_per_rad: 0.0,
            kinetic_torque_nm: 0.08,
            static_torque_nm: 0.14,
        };
        let mut off = Values::default();
        off.set(id::CREPITUS, 0.0);
        let settings = DeviceSettings::of(&off.with_crepitus(&parameters)).unwrap();
        assert_eq!(settings.crepitus.unwrap().parameters, parameters);
    }
}
