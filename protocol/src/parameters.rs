//! The parameters of a device: the table that wire, command line, book and
//! validation read. Names, units, ranges, defaults and meanings are those of
//! `model`; what is added here is the id, the group, and when a parameter may
//! change.
//!
//! An id is a place in [`PARAMETERS`] and in [`Values`]. It never changes its
//! meaning; new parameters are appended.

use crate::settings::ValueError;
use crepitus_model::current_loop::CurrentLoopSettings;
use crepitus_model::device_limits::{LimitSettings, TORQUE_CONSTANT};
use crepitus_model::encoder::ENCODER_PARAMETERS;
use crepitus_model::parameters::{
    INERTIA, KINETIC_TORQUE, ParameterSpec, STATIC_TORQUE, STIFFNESS, Tabled,
};
use crepitus_model::render::bone_shaping::BoneShapingSettings;
use crepitus_model::render::friction_compensation::FrictionCompensationSettings;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A parameter of the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// The effect or the part that it belongs to, as in scene files.
    pub group: &'static str,
    /// What it is.
    pub kind: Kind,
    /// When it may change.
    pub when: When,
}

/// What a parameter is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number in a range.
    Number(&'static ParameterSpec),
    /// One of some names; its value is the place of the name.
    Choice(&'static Choice),
}

/// A parameter that is one of some names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Name.
    pub key: &'static str,
    /// What can be chosen.
    pub names: &'static [&'static str],
    /// Place of the default.
    pub default: f64,
    /// What it means.
    pub meaning: &'static str,
}

/// When a parameter may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum When {
    /// Always; active values move there within the slew limit.
    Always,
    /// Only while there is no torque.
    Disarmed,
}

const RENDER_CREPITUS: Choice = Choice {
    key: "render",
    names: &["off", "on"],
    default: 1.0,
    meaning: "whether the joint grates; `off` is a healthy joint",
};

const RESTART: Choice = Choice {
    key: "restart",
    names: &["elastic", "from-kinetic"],
    default: 0.0,
    meaning: "torque with which a stick begins: 2Tk − Ts, or Tk",
};

const RENDER_COMPENSATION: Choice = Choice {
    key: "render",
    names: &["off", "on"],
    default: 0.0,
    meaning: "whether a share of the gear's friction is cancelled",
};

const RENDER_SHAPING: Choice = Choice {
    key: "render",
    names: &["off", "on"],
    default: 0.0,
    meaning: "whether the bone rings when the joint clicks",
};

const fn live(group: &'static str, spec: &'static ParameterSpec) -> Parameter {
    Parameter {
        group,
        kind: Kind::Number(spec),
        when: When::Always,
    }
}

const fn at_rest(group: &'static str, spec: &'static ParameterSpec) -> Parameter {
    Parameter {
        group,
        kind: Kind::Number(spec),
        when: When::Disarmed,
    }
}

const fn choice(group: &'static str, choice: &'static Choice) -> Parameter {
    Parameter {
        group,
        kind: Kind::Choice(choice),
        when: When::Always,
    }
}

const CREPITUS: &str = "crepitus";
const ENCODER: &str = "encoder";
const COMPENSATION: &str = "friction-compensation";
const SHAPING: &str = "bone-shaping";
const MOTOR: &str = "motor";
const LIMITS: &str = "limits";

const FRICTION: &[ParameterSpec; 3] = FrictionCompensationSettings::TABLE;
const BONE: &[ParameterSpec; 6] = BoneShapingSettings::TABLE;
const LOOP: &[ParameterSpec; 5] = CurrentLoopSettings::TABLE;
const LIMIT: &[ParameterSpec; 3] = LimitSettings::TABLE;

/// How many parameters there are.
pub const PARAMETER_COUNT: usize = 29;

/// Every parameter, at the place of its id.
pub const PARAMETERS: [Parameter; PARAMETER_COUNT] = [
    choice(CREPITUS, &RENDER_CREPITUS),
    live(CREPITUS, &INERTIA),
    live(CREPITUS, &STIFFNESS),
    live(CREPITUS, &KINETIC_TORQUE),
    live(CREPITUS, &STATIC_TORQUE),
    choice(CREPITUS, &RESTART),
    at_rest(ENCODER, &ENCODER_PARAMETERS[0]),
    at_rest(ENCODER, &ENCODER_PARAMETERS[1]),
    at_rest(ENCODER, &ENCODER_PARAMETERS[2]),
    choice(COMPENSATION, &RENDER_COMPENSATION),
    live(COMPENSATION, &FRICTION[0]),
    live(COMPENSATION, &FRICTION[1]),
    live(COMPENSATION, &FRICTION[2]),
    choice(SHAPING, &RENDER_SHAPING),
    live(SHAPING, &BONE[0]),
    live(SHAPING, &BONE[1]),
    live(SHAPING, &BONE[2]),
    live(SHAPING, &BONE[3]),
    live(SHAPING, &BONE[4]),
    live(SHAPING, &BONE[5]),
    at_rest(MOTOR, &LOOP[0]),
    at_rest(MOTOR, &LOOP[1]),
    at_rest(MOTOR, &LOOP[2]),
    at_rest(MOTOR, &LOOP[3]),
    at_rest(MOTOR, &LOOP[4]),
    at_rest(MOTOR, &TORQUE_CONSTANT),
    live(LIMITS, &LIMIT[0]),
    live(LIMITS, &LIMIT[1]),
    at_rest(LIMITS, &LIMIT[2]),
];

/// The places of the parameters that code asks for by name.
pub mod id {
    /// `crepitus.render`.
    pub const CREPITUS: usize = 0;
    /// `crepitus.stiffness_nm_per_rad`.
    pub const STIFFNESS: usize = 2;
    /// `crepitus.restart`.
    pub const RESTART: usize = 5;
    /// `crepitus.kinetic_torque_nm`.
    pub const KINETIC_TORQUE: usize = 3;
    /// `crepitus.static_torque_nm`.
    pub const STATIC_TORQUE: usize = 4;
    /// `encoder.lines`.
    pub const LINES: usize = 6;
    /// `limits.torque_nm`.
    pub const TORQUE_LIMIT: usize = 26;
}

/// A value for each of [`PARAMETERS`]; what people set. A choice is the place
/// of its name.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Values(pub [f64; PARAMETER_COUNT]);

impl Default for Values {
    fn default() -> Self {
        Self(PARAMETERS.map(|parameter| parameter.default()))
    }
}

impl Values {
    /// The value at the place of an id, if there is one.
    pub fn get(&self, id: usize) -> Option<f64> {
        self.0.get(id).copied()
    }

    /// Sets the value at the place of an id; nothing if there is none.
    pub fn set(&mut self, id: usize, value: f64) {
        if let Some(place) = self.0.get_mut(id) {
            *place = value;
        }
    }

    /// Checks every value by itself.
    ///
    /// # Errors
    /// [`ValueError`] for the first that is outside its range, or no choice.
    pub fn check(&self) -> Result<(), ValueError> {
        for (id, (parameter, value)) in (0..).zip(PARAMETERS.iter().zip(self.0)) {
            if !parameter.allows(value) {
                return Err(ValueError::OutOfRange { id });
            }
        }
        Ok(())
    }

    /// The first parameter that differs and may not change while there is
    /// torque.
    pub fn needs_disarmed(&self, now: &Self) -> Option<u8> {
        (0..)
            .zip(PARAMETERS.iter().zip(self.0.iter().zip(&now.0)))
            .find(|(_, (parameter, (new, old)))| {
                parameter.when == When::Disarmed && new.to_bits() != old.to_bits()
            })
            .map(|(id, _)| id)
    }
}

impl Parameter {
    /// Name within its group; a number's has its unit.
    pub fn key(&self) -> &'static str {
        match self.kind {
            Kind::Number(spec) => spec.key,
            Kind::Choice(choice) => choice.key,
        }
    }

    /// The default.
    pub fn default(&self) -> f64 {
        match self.kind {
            Kind::Number(spec) => spec.default,
            Kind::Choice(choice) => choice.default,
        }
    }

    /// What it means.
    pub fn meaning(&self) -> &'static str {
        match self.kind {
            Kind::Number(spec) => spec.meaning,
            Kind::Choice(choice) => choice.meaning,
        }
    }

    /// Whether it can have this value; no number is none.
    pub fn allows(&self, value: f64) -> bool {
        match self.kind {
            Kind::Number(spec) => value >= spec.min && value <= spec.max,
            Kind::Choice(choice) => (0_u8..)
                .zip(choice.names)
                .any(|(place, _)| f64::from(place) == value),
        }
    }

    /// The parameter of this name, `group.key`, with its id.
    pub fn find(name: &str) -> Option<(usize, &'static Self)> {
        let (group, key) = name.split_once('.')?;
        PARAMETERS
            .iter()
            .enumerate()
            .find(|(_, parameter)| parameter.group == group && parameter.key() == key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for (id, parameter) in PARAMETERS.iter().enumerate() {
            let name = std::format!("{}.{}", parameter.group, parameter.key());
            assert_eq!(Parameter::find(&name), Some((id, parameter)), "{name}");
            assert!(parameter.allows(parameter.default()), "{name}");
            assert!(!parameter.allows(f64::NAN), "{name}");
        }
        assert_eq!(Parameter::find("crepitus.nothing"), None);
        assert_eq!(Parameter::find("crepitus"), None);
    }

    #[test]
    fn ids_are_the_places_that_code_believes() {
        for (id, name) in [
            (id::CREPITUS, "crepitus.render"),
            (id::STIFFNESS, "crepitus.stiffness_nm_per_rad"),
            (id::RESTART, "crepitus.restart"),
            (id::KINETIC_TORQUE, "crepitus.kinetic_torque_nm"),
            (id::STATIC_TORQUE, "crepitus.static_torque_nm"),
            (id::LINES, "encoder.lines"),
            (id::TORQUE_LIMIT, "limits.torque_nm"),
        ] {
            assert_eq!(Parameter::find(name).map(|(place, _)| place), Some(id));
        }
    }

    #[test]
    fn choices_are_places_of_names() {
        let (_, restart) = Parameter::find("crepitus.restart").unwrap();
        assert!(restart.allows(0.0) && restart.allows(1.0));
        assert!(!restart.allows(2.0) && !restart.allows(0.5) && !restart.allows(-1.0));
    }

    #[test]
    fn some_parameters_only_change_without_torque() {
        let now = Values::default();
        assert_eq!(now.needs_disarmed(&now), None);
        let mut next = now;
        next.set(2, 300.0);
        assert_eq!(next.needs_disarmed(&now), None);
        let (lines, _) = Parameter::find("encoder.lines").unwrap();
        next.set(lines, 500.0);
        assert_eq!(next.needs_disarmed(&now).map(usize::from), Some(lines));
    }
}
