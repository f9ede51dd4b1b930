//! Settings to the numbers of a tick, outside the tick.
//!
//! What people set is a list of values; what a tick uses are plain numbers in
//! f32, ramps among them, whose making takes logarithms in f64. That is work
//! for the idle loop: the tick finds a [`Prepared`] and takes it over whole,
//! between two blocks of telemetry.

use crepitus_model::control::current_loop::{CurrentLoop, CurrentLoopSettings};
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::control::energy_observer::MOST_DELAY_TICKS;
use crepitus_model::render::effects::{EffectChanges, Timing};
use crepitus_model::render::ramp::Ramp;
use crepitus_model::{Settings, SettingsError, StepCoefficients, Validated};
use crepitus_protocol::{DeviceSettings, Revision, TICK_S, ValueError, Values};

/// The fastest shaft that is believed, rad/s: seven times what the motor can
/// do. Beyond it a count is a disturbance.
const FASTEST_RAD_S: f64 = 50.0;

/// Torque acts half a tick to a tick and a half late, and lags.
const TIMING: Timing = Timing {
    step_s: TICK_S,
    delay_ticks: MOST_DELAY_TICKS,
};

/// An encoder that can be started at any count.
#[derive(Clone, Copy, Debug)]
pub struct Reader {
    pub(crate) at_zero: EncoderReader<f32>,
    pub(crate) most_counts: u32,
    pub(crate) rad_per_count: f32,
}

impl Reader {
    /// From settings.
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

/// What becomes of the joint.
#[derive(Clone, Copy, Debug)]
pub enum JointPlan {
    /// There is none, and will be none.
    Absent,
    /// There is one: it goes on along this ramp.
    Follow(Ramp<f32>),
    /// There will be one: it begins without torque, and goes on along the ramp.
    Begin(StepCoefficients<f32>, Ramp<f32>),
    /// It goes along this ramp until it has no torque, then there is none.
    Leave(Ramp<f32>),
}

/// What a tick of the motor uses.
#[derive(Clone, Copy, Debug)]
pub struct MotorPlan {
    /// A loop at rest.
    pub current_loop: CurrentLoop<f32>,
    /// Torque at the joint for one ampere, N·m/A, and V·s/rad.
    pub joint_constant: f32,
    /// 1/`joint_constant`.
    pub amperes_per_nm: f32,
    /// Resistance that the winding is believed to have, Ω.
    pub resistance_ohm: f32,
    /// Inductance over a tick, Ω: voltage for a change of 1 A in a tick.
    pub inductance_per_tick_ohm: f32,
    /// Largest current that is asked for, A.
    pub current_limit_a: f32,
}

/// What `render_torque` takes over.
#[derive(Clone, Copy, Debug)]
pub struct RenderingPlan {
    /// Angle of one count, rad.
    pub rad_per_count: f32,
    /// The joint.
    pub joint: JointPlan,
    /// The effects besides the joint, where they are others.
    pub effects: EffectChanges<f32>,
    /// Largest torque, N·m.
    pub torque_limit_nm: f32,
    /// How much torque grows in a tick, N·m.
    pub slew_nm: f32,
}

/// What `command_motor` takes over.
#[derive(Clone, Copy, Debug)]
pub struct CommandPlan {
    /// The revision that blocks have from now on.
    pub revision: Revision,
    /// The motor, where it is another.
    pub motor: Option<MotorPlan>,
    /// Speed beyond which the device lets go, rad/s.
    pub speed_limit_rad_s: f32,
}

/// Parameters, ready for the tasks to take over.
#[derive(Clone, Copy, Debug)]
pub struct Prepared {
    /// The encoder, where it is another.
    pub reader: Option<Reader>,
    /// For `render_torque`.
    pub rendering: RenderingPlan,
    /// For `command_motor`.
    pub command: CommandPlan,
}

/// Makes [`Prepared`] from values, knowing what is in force.
#[derive(Clone, Debug)]
pub struct Preparation {
    in_force: DeviceSettings,
    values: Values,
    /// Numbers of the joint in force; without torque if there is none.
    coefficients: StepCoefficients<f32>,
}

/// What everything starts from.
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
    /// The defaults in force, as [`Revision::NONE`], and what starts from them.
    ///
    /// # Errors
    /// [`ValueError`] if the defaults are not allowed: a mistake in their
    /// table, which a test would have found.
    pub fn new() -> Result<(Self, Start), ValueError> {
        let values = Values::default();
        let in_force = DeviceSettings::of(&values)?;
        let mut preparation = Self {
            in_force: DeviceSettings {
                crepitus: None,
                ..in_force
            },
            values,
            coefficients: silent(&in_force.crepitus.unwrap_or(fallback()?))?,
        };
        let reader = Reader::of(&in_force.encoder)?;
        let motor = motor(&in_force)?;
        let prepared = preparation.prepare(Revision::NONE, &values, false)?;
        Ok((
            preparation,
            Start {
                reader,
                motor,
                prepared,
            },
        ))
    }

    /// What was prepared last.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// Prepares a commit. Called only when the one before has been taken over
    /// and has settled, and then taken over in any case: it becomes what is in
    /// force.
    ///
    /// # Errors
    /// [`ValueError`] if the values are not allowed, or not while `armed`.
    pub fn prepare(
        &mut self,
        revision: Revision,
        values: &Values,
        armed: bool,
    ) -> Result<Prepared, ValueError> {
        let next = DeviceSettings::of(values)?;
        if armed && let Some(id) = values.needs_disarmed(&self.values) {
            return Err(ValueError::NeedsDisarmed { id });
        }
        let now = &self.in_force;
        let slew = next.limits.slew_nm_per_s;
        let is_other_encoder = now.encoder != next.encoder;
        let (joint, coefficients) = match (now.crepitus, next.crepitus) {
            (None, None) => (JointPlan::Absent, self.coefficients),
            // The guard knows the encoder's count: a new joint for a new one.
            (Some(_), Some(settings)) if is_other_encoder => {
                let from = silent(&settings)?;
                let to = StepCoefficients::new(&settings, TICK_S)?;
                (JointPlan::Begin(from, Ramp::new(from, to, slew)), to)
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
                (JointPlan::Begin(from, Ramp::new(from, to, slew)), to)
            }
            (Some(settings), None) => {
                let to = silent(&settings)?;
                (JointPlan::Leave(Ramp::new(self.coefficients, to, slew)), to)
            }
        };
        let reader = Reader::of(&next.encoder)?;
        let is_other_motor = now.current_loop != next.current_loop
            || now.joint_constant().to_bits() != next.joint_constant().to_bits();
        let prepared = Prepared {
            reader: is_other_encoder.then_some(reader),
            rendering: RenderingPlan {
                rad_per_count: reader.rad_per_count,
                joint,
                effects: next.effects.changes(&now.effects, &TIMING)?,
                torque_limit_nm: single(next.limits.torque_nm),
                slew_nm: single(slew * TICK_S),
            },
            command: CommandPlan {
                revision,
                motor: if is_other_motor {
                    Some(motor(&next)?)
                } else {
                    None
                },
                speed_limit_rad_s: single(next.limits.speed_rad_s),
            },
        };
        (self.in_force, self.values, self.coefficients) = (next, *values, coefficients);
        Ok(prepared)
    }
}

/// The paper's joint.
fn fallback() -> Result<Validated<Settings>, ValueError> {
    Ok(Settings::default().validate()?)
}

/// The same joint without torque.
fn silent(settings: &Validated<Settings>) -> Result<StepCoefficients<f32>, SettingsError> {
    let mut silent = **settings;
    silent.parameters.kinetic_torque_nm = 0.0;
    silent.parameters.static_torque_nm = 0.0;
    StepCoefficients::new(&silent.validate()?, TICK_S)
}

fn motor(settings: &DeviceSettings) -> Result<MotorPlan, SettingsError> {
    let CurrentLoopSettings {
        resistance_ohm,
        inductance_h,
        current_limit_a,
        ..
    } = settings.current_loop;
    let constant = settings.joint_constant();
    Ok(MotorPlan {
        current_loop: CurrentLoop::new(&settings.current_loop, TICK_S)?,
        joint_constant: single(constant),
        amperes_per_nm: single(1.0 / constant),
        resistance_ohm: single(resistance_ohm),
        inductance_per_tick_ohm: single(inductance_h / TICK_S),
        current_limit_a: single(current_limit_a),
    })
}
