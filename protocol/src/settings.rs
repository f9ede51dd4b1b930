//! [`Values`], as numbers on the wire, and [`DeviceSettings`], with types and
//! checked: what people set, before it becomes what a tick uses.

use crate::parameters::{PARAMETER_COUNT, Values, id};
use crepitus_model::current_loop::CurrentLoopSettings;
use crepitus_model::device_limits::LimitSettings;
use crepitus_model::encoder::EncoderSettings;
use crepitus_model::parameters::{DAMPING, Parameters, Tabled};
use crepitus_model::render::bone_shaping::BoneShapingSettings;
use crepitus_model::render::friction_compensation::FrictionCompensationSettings;
use crepitus_model::render::turn_back::most_rad_per_count;
use crepitus_model::{Convention, Restart, Settings, Validated};
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Why values are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
#[non_exhaustive]
pub enum ValueError {
    /// The parameter with this id is outside its range, no number, or not one
    /// of its names.
    OutOfRange {
        /// The parameter.
        id: u8,
    },
    /// The kinetic torque is above the static torque, or so close below it that
    /// the turn-back guard cannot keep the bound of returned energy with this
    /// stiffness and encoder.
    KineticAboveStatic,
    /// The static torque is above the device's largest torque.
    StaticAboveLimit,
    /// The parameter with this id only changes while there is no torque.
    NeedsDisarmed {
        /// The parameter.
        id: u8,
    },
}

/// Everything that people set of a device. An effect that is off is absent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceSettings {
    /// The joint.
    pub crepitus: Option<Validated<Settings>>,
    /// The encoder and its place in the drivetrain.
    pub encoder: EncoderSettings,
    /// Feed-forward against the gear's friction.
    pub friction_compensation: Option<FrictionCompensationSettings>,
    /// The ringing of the bone.
    pub bone_shaping: Option<BoneShapingSettings>,
    /// The motor's current.
    pub current_loop: CurrentLoopSettings,
    /// Torque of the motor for one ampere, N·m/A.
    pub torque_constant_nm_per_a: f64,
    /// What the device never does.
    pub limits: LimitSettings,
}

impl DeviceSettings {
    /// From values.
    ///
    /// # Errors
    /// [`ValueError`] for the first value, or pair of values, that is not
    /// allowed. Values of an effect that is off are held to their rules too.
    pub fn of(values: &Values) -> Result<Self, ValueError> {
        values.check()?;
        let [
            crepitus,
            inertia_kg_m2,
            stiffness_nm_per_rad,
            kinetic_torque_nm,
            static_torque_nm,
            restart,
            lines,
            encoder_gear,
            velocity_bandwidth_hz,
            compensation,
            friction_nm,
            share,
            fade_rad_s,
            shaping,
            frequency_hz,
            damping_ratio,
            gain,
            limit_nm,
            budget_j,
            refill_w,
            bandwidth_hz,
            resistance_ohm,
            inductance_h,
            supply_v,
            current_limit_a,
            torque_constant_nm_per_a,
            torque_nm,
            slew_nm_per_s,
            speed_rad_s,
        ]: [f64; PARAMETER_COUNT] = values.0;
        if kinetic_torque_nm > static_torque_nm {
            return Err(ValueError::KineticAboveStatic);
        }
        if static_torque_nm > torque_nm {
            return Err(ValueError::StaticAboveLimit);
        }
        let is_on = |choice: f64| choice != 0.0;
        let settings = Settings {
            parameters: Parameters {
                inertia_kg_m2,
                stiffness_nm_per_rad,
                damping_nms_per_rad: DAMPING.default,
                kinetic_torque_nm,
                static_torque_nm,
            },
            convention: Convention::Frozen,
            restart: restart_of(restart),
        };
        // All that `validate` refuses has been refused above, by id.
        let settings = settings
            .validate()
            .map_err(|_| ValueError::KineticAboveStatic)?;
        if values.rad_per_count() > values.guarded_rad_per_count() {
            return Err(ValueError::KineticAboveStatic);
        }
        Ok(Self {
            crepitus: is_on(crepitus).then_some(settings),
            encoder: EncoderSettings {
                lines,
                gear_ratio: encoder_gear,
                velocity_bandwidth_hz,
            },
            friction_compensation: is_on(compensation).then_some(FrictionCompensationSettings::of(
                [friction_nm, share, fade_rad_s],
            )),
            bone_shaping: is_on(shaping).then_some(BoneShapingSettings::of([
                frequency_hz,
                damping_ratio,
                gain,
                limit_nm,
                budget_j,
                refill_w,
            ])),
            current_loop: CurrentLoopSettings::of([
                bandwidth_hz,
                resistance_ohm,
                inductance_h,
                supply_v,
                current_limit_a,
            ]),
            torque_constant_nm_per_a,
            limits: LimitSettings::of([torque_nm, slew_nm_per_s, speed_rad_s]),
        })
    }

    /// Torque at the joint for one ampere, N·m/A, and voltage of the back-EMF
    /// for one rad/s of the joint.
    pub fn joint_constant(&self) -> f64 {
        self.torque_constant_nm_per_a * self.encoder.gear_ratio
    }
}

fn restart_of(choice: f64) -> Restart {
    if choice == 0.0 {
        Restart::Elastic
    } else {
        Restart::FromKinetic
    }
}

impl Values {
    /// Angle of one count of the encoder at the joint, rad.
    pub fn rad_per_count(&self) -> f64 {
        let [
            _,
            _,
            _,
            _,
            _,
            _,
            lines,
            gear_ratio,
            velocity_bandwidth_hz,
            ..,
        ] = self.0;
        EncoderSettings {
            lines,
            gear_ratio,
            velocity_bandwidth_hz,
        }
        .rad_per_count()
    }

    /// The largest angle of one count with which the turn-back guard keeps the
    /// bound of returned energy at this joint, rad.
    pub fn guarded_rad_per_count(&self) -> f64 {
        let [
            _,
            inertia_kg_m2,
            stiffness_nm_per_rad,
            kinetic_torque_nm,
            static_torque_nm,
            restart,
            ..,
        ] = self.0;
        most_rad_per_count(&Settings {
            parameters: Parameters {
                inertia_kg_m2,
                stiffness_nm_per_rad,
                damping_nms_per_rad: DAMPING.default,
                kinetic_torque_nm,
                static_torque_nm,
            },
            convention: Convention::Frozen,
            restart: restart_of(restart),
        })
    }

    /// With the joint's numbers: a preset, for example.
    #[must_use]
    pub fn with_crepitus(mut self, parameters: &Parameters) -> Self {
        self.set(id::CREPITUS, 1.0);
        for (place, value) in (id::CREPITUS + 1..).zip([
            parameters.inertia_kg_m2,
            parameters.stiffness_nm_per_rad,
            parameters.kinetic_torque_nm,
            parameters.static_torque_nm,
        ]) {
            self.set(place, value);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{Kind, PARAMETERS};
    use crepitus_model::presets::PRESETS;

    #[test]
    fn defaults_are_the_papers_joint_and_nothing_else() {
        let settings = DeviceSettings::of(&Values::default()).unwrap();
        assert_eq!(*settings.crepitus.unwrap(), Settings::default());
        assert_eq!(settings.encoder, EncoderSettings::default());
        assert_eq!(settings.friction_compensation, None);
        assert_eq!(settings.bone_shaping, None);
        assert_eq!(settings.current_loop, CurrentLoopSettings::default());
        assert_eq!(settings.limits, LimitSettings::default());
    }

    #[test]
    fn every_number_arrives_at_its_place() {
        let mut values = Values::default();
        for (id, parameter) in PARAMETERS.iter().enumerate() {
            let place = f64::from(u8::try_from(id).unwrap());
            values.set(
                id,
                match parameter.kind {
                    Kind::Choice(_) => 1.0,
                    // Another number in each place, all allowed.
                    Kind::Number(spec) => spec.default * (1.0 - 0.001 * place),
                },
            );
        }
        let s = DeviceSettings::of(&values).unwrap();
        let p = s.crepitus.unwrap().parameters;
        let rebuilt = [
            1.0,
            p.inertia_kg_m2,
            p.stiffness_nm_per_rad,
            p.kinetic_torque_nm,
            p.static_torque_nm,
            f64::from(u8::from(
                s.crepitus.unwrap().restart == Restart::FromKinetic,
            )),
        ]
        .into_iter()
        .chain(s.encoder.values())
        .chain([1.0])
        .chain(s.friction_compensation.unwrap().values())
        .chain([1.0])
        .chain(s.bone_shaping.unwrap().values())
        .chain(s.current_loop.values())
        .chain([s.torque_constant_nm_per_a])
        .chain(s.limits.values());
        assert!(rebuilt.eq(values.0));
    }

    #[test]
    fn every_value_is_held_to_its_range_by_its_id() {
        for (id, parameter) in PARAMETERS.iter().enumerate() {
            for bad in [f64::NAN, f64::INFINITY, -1.0, 1e300] {
                let mut values = Values::default();
                values.set(id, bad);
                let refused = DeviceSettings::of(&values);
                let expected = u8::try_from(id).unwrap();
                assert_eq!(
                    refused,
                    Err(ValueError::OutOfRange { id: expected }),
                    "{}",
                    parameter.key()
                );
            }
        }
    }

    #[test]
    fn values_are_held_against_each_other() {
        let mut values = Values::default();
        values.set(id::KINETIC_TORQUE, 0.5);
        assert_eq!(
            DeviceSettings::of(&values),
            Err(ValueError::KineticAboveStatic)
        );
        values.set(id::STATIC_TORQUE, 5.0);
        assert_eq!(
            DeviceSettings::of(&values),
            Err(ValueError::StaticAboveLimit)
        );
        values.set(id::TORQUE_LIMIT, 6.0);
        assert!(DeviceSettings::of(&values).is_ok());
    }

    #[test]
    fn what_the_turn_back_guard_cannot_guard_is_refused() {
        let with = |changes: &[(usize, f64)]| {
            let mut values = Values::default();
            for &(id, value) in changes {
                values.set(id, value);
            }
            DeviceSettings::of(&values).map(|_| ())
        };
        let refused = Err(ValueError::KineticAboveStatic);
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
        // A stick that begins at Tk loses less to a slip.
        let near = (id::KINETIC_TORQUE, at_limit - 1e-3);
        assert_eq!(with(&[near]), Ok(()));
        assert_eq!(with(&[near, (id::RESTART, 1.0)]), refused);
        // Ts = Tk takes nothing; without torque in slip there is no push.
        assert_eq!(with(&[(id::KINETIC_TORQUE, 0.4)]), refused);
        assert_eq!(
            with(&[(id::KINETIC_TORQUE, 0.0), (id::STIFFNESS, 5000.0)]),
            Ok(())
        );
    }

    #[test]
    fn presets_are_values() {
        for preset in &PRESETS {
            let values = Values::default().with_crepitus(&preset.parameters);
            let settings = DeviceSettings::of(&values).unwrap();
            assert_eq!(settings.crepitus.unwrap().parameters, preset.parameters);
        }
    }
}
