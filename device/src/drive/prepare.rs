//! Conversion of settings to the coefficients of a tick, outside the tick.
//!
//! Users set a list of values; a tick uses f32 coefficients and ramps, which
//! need logarithms in f64 to compute. The idle loop does that; the tick applies
//! a complete [`Prepared`] between two blocks of telemetry.

use crate::board::LARGEST_DUTY;
use crate::drive::commits::Taken;
use crate::drive::overload::OverloadPlan;
use crate::drive::range::RangePlan;
use crate::drive::slow_checks::{JointSensorPlan, SlowPlan};
use crepitus_model::control::current_loop::{CurrentLoop, CurrentLoopSettings};
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::control::energy_observer::MOST_DELAY_TICKS;
use crepitus_model::render::effects::{EffectChanges, Timing};
use crepitus_model::render::position::Sensing;
use crepitus_model::render::ramp::Ramp;
use crepitus_model::{Settings, SettingsError, StepCoefficients, Validated};
use crepitus_protocol::measured::SUPPLY_SHARES;
use crepitus_protocol::{DeviceSettings, Revision, TICK_S, ValueError, Values};

/// The fastest plausible shaft, rad/s: seven times what the motor can do.
/// Faster counts are disturbances.
const FASTEST_RAD_S: f64 = 50.0;

/// Share of the supply that the back-EMF of a floating motor may have: the
/// estimate of its speed lags.
const FLOATS_SHARE: f64 = 0.7;

/// Share of the speed at which the back-EMF is the largest voltage of the bridge, up to which
/// there is torque. Beyond that speed a current flows that nothing holds, and brakes the leg.
const HELD_SHARE: f64 = 0.95;

/// Delay of the torque: half a tick to a tick and a half, and a lag; of no
/// particular encoder.
pub(crate) const TIMING: Timing = Timing {
    step_s: TICK_S,
    delay_ticks: MOST_DELAY_TICKS,
    sensing: Sensing::IDEAL,
};

fn timing(encoder: &EncoderSettings) -> Timing {
    Timing {
        sensing: Sensing::of_encoder(encoder),
        ..TIMING
    }
}

/// An encoder that can be started at any count.
#[derive(Clone, Copy, Debug)]
pub struct Reader {
    pub(crate) at_zero: EncoderReader<f32>,
    pub(crate) most_counts: u32,
    pub(crate) rad_per_count: f32,
}

impl Reader {
    /// Creates a reader from settings.
    ///
    /// # Errors
    /// [`SettingsError`] if one is out of its range.
    pub fn of(settings: &EncoderSettings) -> Result<Self, SettingsError> {
        let rad_per_count = settings.rad_per_count();
        Ok(Self {
            at_zero: EncoderReader::new(settings, TICK_S, 0, 0.0)?,
            most_counts: most_counts(rad_per_count),
            rad_per_count: single(rad_per_count),
        })
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cast from float saturates"
)]
fn most_counts(rad_per_count: f64) -> u32 {
    ((FASTEST_RAD_S * TICK_S / rad_per_count) as u32).saturating_add(2)
}

#[expect(clippy::cast_possible_truncation, reason = "rounded to f32, once")]
fn single(value: f64) -> f32 {
    value as f32
}

/// Change of the joint with a commit.
#[derive(Clone, Copy, Debug)]
pub enum JointPlan {
    /// No joint before or after.
    Absent,
    /// The joint follows this ramp.
    Follow(Ramp<f32>),
    /// A new joint: starts without torque, then follows the ramp.
    Start(StepCoefficients<f32>, Ramp<f32>),
    /// The joint follows this ramp to zero torque and is then removed.
    Remove(Ramp<f32>),
}

/// Coefficients of the motor.
#[derive(Clone, Copy, Debug)]
pub struct MotorPlan {
    /// A loop at rest.
    pub current_loop: CurrentLoop<f32>,
    /// Torque at the joint for one ampere, N·m/A, and V·s/rad.
    pub joint_constant: f32,
    /// Reciprocal of the joint constant, A/N·m and rad/(V·s).
    pub per_joint_constant: f32,
    /// Assumed resistance of the winding, Ω.
    pub resistance_ohm: f32,
    /// Inductance over a tick, Ω: voltage for a change of 1 A per tick.
    pub inductance_per_tick_ohm: f32,
    /// Share of the supply's voltage for a volt, 1/V.
    pub duty_per_volt: f32,
    /// Speed below which no back-EMF makes a floating bridge conduct, rad/s.
    pub floats_below_rad_s: f32,
    /// Largest current setpoint, A.
    pub current_limit_a: f32,
}

/// Bounds of the vibration actuator's coil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoilPlan {
    /// Supply of its bridge, V, and its reciprocal.
    pub supply_v: f32,
    /// Share of the supply for a volt, 1/V.
    pub duty_per_volt: f32,
    /// The largest duty: what the converter allows, or a current that its sensor can tell.
    pub largest_duty: f32,
    /// Reciprocal of its resistance, 1/Ω.
    pub per_ohm: f32,
    /// Largest back-EMF, V: the whole stroke at the resonance.
    pub emf_v: f32,
    /// Mean square of the voltage from which on the current is compared with it, V².
    pub compared_v2: f32,
    /// Least power for a mean square of the voltage, W/V².
    pub least_power: f32,
    /// Mean square of the current that is too hot, A².
    pub most_a2: f32,
    /// Largest amplitude of a chirp, V: twice the stroke, at the resonance.
    pub most_chirp_v: f32,
}

/// New coefficients for `render_torque`.
#[derive(Clone, Copy, Debug)]
pub struct RenderingPlan {
    /// The encoder, if it has changed.
    pub reader: Option<Reader>,
    /// Angle of one count, rad.
    pub rad_per_count: f32,
    /// The joint.
    pub joint: JointPlan,
    /// Changes of the other effects.
    pub effects: EffectChanges<f32>,
    /// Largest torque, N·m.
    pub torque_limit_nm: f32,
    /// Largest growth of the torque in a tick, N·m.
    pub slew_nm: f32,
}

/// New coefficients for `command_motor`.
#[derive(Clone, Copy, Debug)]
pub struct CommandPlan {
    /// Revision of the parameters, for the blocks.
    pub revision: Revision,
    /// Boot counter of the comms that has sent it: each boot counts revisions from the saved one.
    pub comms_start: u16,
    /// The motor, if it has changed.
    pub motor: Option<MotorPlan>,
    /// Angle of one count, rad.
    pub rad_per_count: f32,
    /// Overspeed threshold, rad/s.
    pub speed_limit_rad_s: f32,
    /// Range of motion.
    pub range: RangePlan,
    /// Quantities that change slowly.
    pub slow: SlowPlan,
    /// Overload limits of gear and motor.
    pub overload: OverloadPlan,
    /// The coil of the vibration actuator, if there is one.
    pub coil: Option<CoilPlan>,
}

/// Prepared parameters, for the tasks to apply.
#[derive(Clone, Copy, Debug)]
pub struct Prepared {
    /// Parameters for `render_torque`.
    pub rendering: RenderingPlan,
    /// Parameters for `command_motor`.
    pub command: CommandPlan,
}

/// Prepares values, given the active parameters.
#[derive(Clone, Debug)]
pub struct Preparation {
    active: DeviceSettings,
    values: Values,
    /// Coefficients of the active joint; without torque if there is none.
    coefficients: StepCoefficients<f32>,
}

/// Initial coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The encoder.
    pub reader: Reader,
    /// The motor.
    pub motor: MotorPlan,
    /// The rest.
    pub prepared: Prepared,
}

impl Preparation {
    /// The defaults as active parameters, with [`Revision::NONE`], and the
    /// initial coefficients.
    ///
    /// # Errors
    /// [`ValueError`] if the default values are invalid: a bug in their table,
    /// which a test excludes.
    pub fn new() -> Result<(Self, Start), ValueError> {
        let values = Values::default();
        let active = DeviceSettings::of(&values)?;
        let mut preparation = Self {
            active: DeviceSettings {
                crepitus: None,
                ..active
            },
            values,
            coefficients: silent(&active.crepitus.unwrap_or(fallback()?))?,
        };
        let reader = Reader::of(&active.encoder)?;
        let motor = motor(&active)?;
        let prepared = preparation.prepare((Revision::NONE, 0), &values, false)?;
        Ok((
            preparation,
            Start {
                reader,
                motor,
                prepared,
            },
        ))
    }

    /// The values prepared last.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// Prepares a commit. Call it only when the previous one was applied and has
    /// settled, and apply the result in any case: it counts as active from here
    /// on.
    ///
    /// # Errors
    /// [`ValueError`] if the values are invalid, or need a disarmed device and
    /// it is `armed`.
    pub fn prepare(
        &mut self,
        (revision, comms_start): Taken,
        values: &Values,
        armed: bool,
    ) -> Result<Prepared, ValueError> {
        let next = DeviceSettings::of(values)?;
        if armed && let Some(id) = values.needs_disarmed(&self.values) {
            return Err(ValueError::NeedsDisarmed { id });
        }
        let now = &self.active;
        let slew = next.limits.slew_nm_per_s;
        let encoder_changed = now.encoder != next.encoder;
        let (joint, coefficients) = match (now.crepitus, next.crepitus) {
            (None, None) => (JointPlan::Absent, self.coefficients),
            // The guard depends on the angle of a count: a new joint.
            (Some(_), Some(settings)) if encoder_changed => {
                let from = silent(&settings)?;
                let to = StepCoefficients::new(&settings, TICK_S)?;
                (JointPlan::Start(from, Ramp::new(from, to, slew)), to)
            }
            (Some(_), Some(settings)) => {
                let to = StepCoefficients::new(&settings, TICK_S)?;
                (
                    JointPlan::Follow(Ramp::new(self.coefficients, to, slew)),
                    to,
                )
            }
            (None, Some(settings)) => {
                let from = silent(&settings)?;
                let to = StepCoefficients::new(&settings, TICK_S)?;
                (JointPlan::Start(from, Ramp::new(from, to, slew)), to)
            }
            (Some(settings), None) => {
                let to = silent(&settings)?;
                (
                    JointPlan::Remove(Ramp::new(self.coefficients, to, slew)),
                    to,
                )
            }
        };
        let reader = Reader::of(&next.encoder)?;
        let motor_changed = now.current_loop != next.current_loop
            || now.motor != next.motor
            || now.joint_constant().to_bits() != next.joint_constant().to_bits();
        let prepared = Prepared {
            rendering: RenderingPlan {
                reader: encoder_changed.then_some(reader),
                rad_per_count: reader.rad_per_count,
                joint,
                effects: next.effects.changes(
                    &timing(&next.encoder),
                    (&now.effects, &timing(&now.encoder)),
                )?,
                torque_limit_nm: single(next.limits.torque_nm),
                slew_nm: single(slew * TICK_S),
            },
            command: CommandPlan {
                revision,
                comms_start,
                motor: if motor_changed {
                    Some(motor(&next)?)
                } else {
                    None
                },
                rad_per_count: reader.rad_per_count,
                speed_limit_rad_s: single(next.limits.speed_rad_s),
                range: range(&next),
                slow: slow(&next),
                overload: OverloadPlan::new(next.motor.continuous_a, TICK_S),
                coil: next.effects.vibration_actuator.as_ref().map(CoilPlan::new),
            },
        };
        (self.active, self.values, self.coefficients) = (next, *values, coefficients);
        Ok(prepared)
    }
}

/// The paper's joint.
fn fallback() -> Result<Validated<Settings>, ValueError> {
    Ok(Settings::default().validate()?)
}

/// Coefficients of this joint without torque.
fn silent(settings: &Validated<Settings>) -> Result<StepCoefficients<f32>, SettingsError> {
    let mut silent = **settings;
    silent.parameters.kinetic_torque_nm = 0.0;
    silent.parameters.static_torque_nm = 0.0;
    StepCoefficients::new(&silent.validate()?, TICK_S)
}

/// The speed up to which a volt of the supply holds a current of zero, with a margin,
/// rad/s/V.
pub(crate) fn held_rad_s_per_volt(settings: &DeviceSettings) -> f64 {
    HELD_SHARE * f64::from(LARGEST_DUTY) / settings.joint_constant()
}

fn range(settings: &DeviceSettings) -> RangePlan {
    let (least, most) = settings.range_counts();
    let fade_rad = settings.range.fade_deg.to_radians();
    RangePlan {
        least,
        most,
        share_per_count: single(settings.encoder.rad_per_count() / fade_rad),
    }
}

fn slow(settings: &DeviceSettings) -> SlowPlan {
    let supply_v = settings.current_loop.supply_v;
    SlowPlan {
        supply_v: (
            single(SUPPLY_SHARES.0 * supply_v),
            single(SUPPLY_SHARES.1 * supply_v),
        ),
        nominal_v: single(supply_v),
        held_rad_s_per_volt: single(held_rad_s_per_volt(settings)),
        joint: settings.joint_sensor.map(|sensor| JointSensorPlan {
            turns_per_count: single(settings.encoder.rad_per_count() / core::f64::consts::TAU),
            tolerance: single(sensor.tolerance_deg / 360.0),
        }),
    }
}

fn motor(settings: &DeviceSettings) -> Result<MotorPlan, SettingsError> {
    let CurrentLoopSettings {
        resistance_ohm,
        inductance_h,
        current_limit_a,
        supply_v,
        ..
    } = settings.current_loop;
    let constant = settings.joint_constant();
    Ok(MotorPlan {
        current_loop: CurrentLoop::new(&settings.current_loop, TICK_S)?
            .with_largest_duty(LARGEST_DUTY),
        joint_constant: single(constant),
        per_joint_constant: single(1.0 / constant),
        resistance_ohm: single(resistance_ohm),
        inductance_per_tick_ohm: single(inductance_h / TICK_S),
        duty_per_volt: single(1.0 / supply_v),
        floats_below_rad_s: single(FLOATS_SHARE * supply_v / constant),
        current_limit_a: single(current_limit_a),
    })
}
