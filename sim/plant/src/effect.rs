//! Description of an effect: a name, its numbers, and how it joins a plant.

use crate::actuator::Commanded;
use crate::boundary::Boundary;
use crate::chain::{Body, Chain};
use crepitus_model::SettingsError;
use crepitus_model::parameters::{Choice, ParameterSpec};
use crepitus_model::render::effects::EffectSpec;

pub use crepitus_model::render::effects::Need;

/// An effect that a scene can call for.
#[derive(Clone, Copy, Debug)]
pub struct Effect {
    /// Name in scene files: the table `[effects.NAME]`.
    pub name: &'static str,
    /// Description.
    pub adds: &'static str,
    /// State variables of the effect.
    pub states: &'static [&'static str],
    /// Numbers of the effect.
    pub parameters: &'static [ParameterSpec],
    /// Choices of the effect by name.
    pub choices: &'static [Choice],
    /// Effects without which it has no meaning.
    pub needs: &'static [Need],
    /// Place at which it joins.
    pub part: Part,
}

/// Numbers of an effect, a row each: key, symbol, unit, range, default, meaning.
macro_rules! parameters {
    ($($key:ident $symbol:literal $unit:literal, $min:literal..=$max:literal, $default:literal, $meaning:literal;)*) => {
        &[$(crepitus_model::parameters::ParameterSpec {
            key: stringify!($key),
            symbol: $symbol,
            unit: $unit,
            min: $min,
            max: $max,
            default: $default,
            meaning: $meaning,
        }),*]
    };
}

pub(crate) use parameters;

impl Effect {
    /// An effect of the device, from the model's table.
    pub const fn of_device(spec: &'static EffectSpec) -> Self {
        Self {
            name: spec.name,
            adds: spec.adds,
            states: spec.states,
            parameters: spec.parameters,
            choices: spec.choices,
            needs: spec.needs,
            part: Part::Stage(spec),
        }
    }
}

/// Parameters of an effect from a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// A number for each of its parameters.
    pub numbers: Vec<f64>,
    /// Place of the chosen name for each of its choices.
    pub choices: Vec<u8>,
}

impl Given {
    /// An effect's defaults.
    pub fn defaults(effect: &Effect) -> Self {
        Self {
            numbers: effect.parameters.iter().map(|p| p.default).collect(),
            choices: effect.choices.iter().map(|c| c.default).collect(),
        }
    }
}

/// Common inputs of all parts when they are built.
#[derive(Clone, Copy, Debug)]
pub struct Context {
    /// Tick of the device, s.
    pub tick_s: f64,
    /// The device computes in f32.
    pub single: bool,
    /// Angle and velocity at which the motion begins.
    pub start: Body,
    /// Angle to add to φ so that weight on the leg is a cosine, rad: of the posture of
    /// a `limb`. Without one nothing has weight.
    pub gravity_rad: Option<f64>,
}

/// Makes an actuator.
pub type MakeActuator = fn(&Given, &Context) -> Result<Box<dyn Commanded>, SettingsError>;
/// Lengthens the chain.
pub type MakeLink = fn(&Given, &Context, Box<dyn Chain>) -> Box<dyn Chain>;
/// Carrier of an actuator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mounted {
    /// The shell; without one the right end of the chain.
    Shell,
    /// The brace, left of the cuff.
    Brace,
}

/// Puts something on a chain.
pub type OnChain<'a> = &'a dyn Fn(Box<dyn Chain>) -> Box<dyn Chain>;
/// Lengthens the chain by a shell that carries something.
pub type MakeShell = fn(&Given, &Context, Box<dyn Chain>, OnChain<'_>) -> Box<dyn Chain>;
/// Makes what holds the chain's right end.
pub type MakeBoundary = fn(&Given, &Context, &dyn Chain) -> Box<dyn Boundary>;

/// Place at which an effect joins.
#[derive(Clone, Copy, Debug)]
pub enum Part {
    /// The stick-slip object, which the scene's solver renders.
    Joint,
    /// The shaft as the device measures it.
    Sensor,
    /// A stage of the device after the joint, which its
    /// [pipeline](crepitus_model::render) renders.
    Stage(&'static EffectSpec),
    /// The actuator, which turns the command into torque.
    Actuator(MakeActuator),
    /// A part of the chain, right of those before it in the table.
    Link(MakeLink),
    /// The shell, right of all links.
    Shell(MakeShell),
    /// An actuator that sits on a part of the chain.
    Mount(fn(&Given) -> Mounted, MakeLink),
    /// The boundary, which holds the right end.
    Boundary(MakeBoundary),
}

/// The numbers of an effect whose table has `N`.
///
/// # Panics
/// If it has not: a mistake in the effect's own file.
pub fn numbers<const N: usize>(given: &Given) -> [f64; N] {
    given
        .numbers
        .as_slice()
        .try_into()
        .expect("as many numbers as the effect's table has")
}
