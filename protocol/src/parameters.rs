//! The parameters of a device: the table behind wire, command line, book and
//! validation. Each is declared in `model`, beside its use, with id, name, unit,
//! range, default and meaning; here they are collected.
//!
//! An id never changes its meaning and is never reused. A removed parameter
//! leaves a gap.

use crepitus_model::Parameters;
use crepitus_model::control::current_loop::CurrentLoopSettings;
use crepitus_model::control::device_limits::{
    JointSensorSettings, LimitSettings, MotorSettings, RangeSettings,
};
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::{Source, Tabled};
use crepitus_model::render::effects;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

pub use crepitus_model::parameters::{Choice, Kind, Parameter, When};

/// The groups of device parameters: of the components, and of every effect in
/// the model's table.
const DECLARED: [&[&[Parameter]]; 2] = [
    &[
        Parameters::DEVICE,
        EncoderSettings::DEVICE,
        CurrentLoopSettings::DEVICE,
        MotorSettings::DEVICE,
        LimitSettings::DEVICE,
        RangeSettings::DEVICE,
        JointSensorSettings::DEVICE,
    ],
    effects::DEVICE,
];

/// Number of device parameters.
pub const PARAMETER_COUNT: usize = count(DECLARED[0]) + count(DECLARED[1]);

/// Every parameter, in the order of the ids.
pub const PARAMETERS: [Parameter; PARAMETER_COUNT] = sorted();

const fn count(mut groups: &[&[Parameter]]) -> usize {
    let mut count = 0;
    while let [group, rest @ ..] = groups {
        count += group.len();
        groups = rest;
    }
    count
}

/// The parameter with the lowest id that is not below `least`.
#[expect(clippy::panic, reason = "at compile time: it ends the build")]
const fn next(least: u8) -> &'static Parameter {
    let mut found: Option<&'static Parameter> = None;
    let mut declared: &[&[&[Parameter]]] = &DECLARED;
    while let [groups, rest @ ..] = declared {
        let mut groups: &[&[Parameter]] = groups;
        while let [parameters, rest @ ..] = groups {
            let mut parameters: &[Parameter] = parameters;
            while let [parameter, rest @ ..] = parameters {
                let is_lower = match found {
                    Some(found) => parameter.id < found.id,
                    None => true,
                };
                if parameter.id >= least && is_lower {
                    found = Some(parameter);
                }
                parameters = rest;
            }
            groups = rest;
        }
        declared = rest;
    }
    match found {
        Some(found) => found,
        None => panic!("there is no such parameter"),
    }
}

#[expect(clippy::indexing_slicing, reason = "at compile time")]
const fn sorted() -> [Parameter; PARAMETER_COUNT] {
    let mut all = [*next(0); PARAMETER_COUNT];
    let mut index = 1;
    while index < all.len() {
        all[index] = *next(all[index - 1].id + 1);
        index += 1;
    }
    all
}

// With a duplicate id, one parameter would be missing.
const _: () = {
    let mut parameters: &[_] = &PARAMETERS;
    while let [first, rest @ ..] = parameters {
        if let [second, ..] = rest {
            assert!(first.id < second.id, "an id was given twice");
        }
        parameters = rest;
    }
};

/// Ids of the parameters that code uses by name.
pub mod id {
    use super::Parameter;
    use crepitus_model::parameters::same;

    /// `crepitus.render`.
    pub const CREPITUS: u8 = named("crepitus", "render");
    /// `crepitus.stiffness_nm_per_rad`.
    pub const STIFFNESS: u8 = named("crepitus", "stiffness_nm_per_rad");
    /// `crepitus.restart`.
    pub const RESTART: u8 = named("crepitus", "restart");
    /// `crepitus.kinetic_torque_nm`.
    pub const KINETIC_TORQUE: u8 = named("crepitus", "kinetic_torque_nm");
    /// `crepitus.static_torque_nm`.
    pub const STATIC_TORQUE: u8 = named("crepitus", "static_torque_nm");
    /// `encoder.lines`.
    pub const LINES: u8 = named("encoder", "lines");
    /// `encoder.gear_ratio`.
    pub const GEAR_RATIO: u8 = named("encoder", "gear_ratio");
    /// `limits.torque_nm`.
    pub const TORQUE_LIMIT: u8 = named("limits", "torque_nm");
    /// `range.least_deg`.
    pub const RANGE_LEAST: u8 = named("range", "least_deg");
    /// `range.most_deg`.
    pub const RANGE_MOST: u8 = named("range", "most_deg");
    /// `range.fade_deg`.
    pub const RANGE_FADE: u8 = named("range", "fade_deg");

    /// `friction-compensation.render`.
    pub const COMPENSATION: u8 = named("friction-compensation", "render");
    /// `motor.supply_v`.
    pub const SUPPLY: u8 = named("motor", "supply_v");
    /// `joint-sensor.fitted`.
    pub const JOINT_SENSOR: u8 = named("joint-sensor", "fitted");

    /// The id of a parameter.
    #[expect(clippy::panic, reason = "at compile time: it ends the build")]
    const fn named(group: &str, key: &str) -> u8 {
        let mut parameters: &[Parameter] = &super::PARAMETERS;
        while let [parameter, rest @ ..] = parameters {
            if same(parameter.group, group) && same(parameter.key(), key) {
                return parameter.id;
            }
            parameters = rest;
        }
        panic!("there is no such parameter")
    }
}

/// A value for each of [`PARAMETERS`]. A choice is the index of its name.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Values(#[serde(with = "crate::array")] pub [f64; PARAMETER_COUNT]);

impl Default for Values {
    fn default() -> Self {
        DEFAULTS
    }
}

/// Every parameter at its default.
pub static DEFAULTS: Values = {
    let mut values = [0.0; PARAMETER_COUNT];
    let mut index = 0;
    #[expect(clippy::indexing_slicing, reason = "at compile time")]
    while index < values.len() {
        values[index] = PARAMETERS[index].default();
        index += 1;
    }
    Values(values)
};

impl Values {
    /// The value of a parameter, if there is one.
    pub fn get(&self, id: u8) -> Option<f64> {
        self.0.get(index(id)?).copied()
    }

    /// The place of the option that is chosen.
    pub fn option(&self, id: u8) -> u8 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a cast from float saturates"
        )]
        let option = self.get(id).unwrap_or_default() as u8;
        option
    }

    /// Sets a parameter; ignores an unknown id.
    pub fn set(&mut self, id: u8, value: f64) {
        if let Some(slot) = index(id).and_then(|index| self.0.get_mut(index)) {
            *slot = value;
        }
    }

    /// Every parameter with its value.
    pub fn iter(&self) -> impl Iterator<Item = (&'static Parameter, f64)> {
        PARAMETERS_BY_ID.iter().zip(self.0)
    }

    /// Copies the values of these ids, if they exist.
    #[inline(never)]
    fn copy_to(&self, ids: &[Option<u8>], values: &mut [f64]) {
        for (value, id) in values.iter_mut().zip(ids) {
            if let Some(set) = id.and_then(|id| self.get(id)) {
                *value = set;
            }
        }
    }

    /// Returns the values with these settings, as far as a device has them.
    #[must_use]
    pub fn with<const N: usize, T: Tabled<N>>(mut self, settings: &T) -> Self {
        for (value, id) in settings.values().into_iter().zip(T::IDS) {
            if let Some(id) = id {
                self.set(id, value);
            }
        }
        for (option, id) in settings.chosen().zip(T::CHOICE_IDS) {
            self.set(*id, f64::from(option));
        }
        self
    }

    /// The first parameter that differs and can only change while disarmed.
    pub fn needs_disarmed(&self, now: &Self) -> Option<u8> {
        self.iter()
            .zip(now.0)
            .find(|((parameter, new), old)| {
                parameter.when == When::Disarmed && new.to_bits() != old.to_bits()
            })
            .map(|((parameter, _), _)| parameter.id)
    }
}

impl Source for Values {
    fn is_on(&self, id: u8) -> bool {
        self.get(id).is_some_and(|choice| choice != 0.0)
    }

    fn read<const N: usize, T: Tabled<N>>(&self) -> T {
        let mut values = T::TABLE.map(|parameter| parameter.default);
        self.copy_to(&T::IDS, &mut values);
        let mut settings = T::of(values);
        for (index, id) in T::CHOICE_IDS.iter().enumerate() {
            settings.choose(index, self.option(*id));
        }
        settings
    }
}

/// [`PARAMETERS`] in memory, once.
static PARAMETERS_BY_ID: [Parameter; PARAMETER_COUNT] = PARAMETERS;

/// Index of a parameter in [`PARAMETERS`] and [`Values`]. Not inlined: copies
/// would fill the controllers' flash.
#[inline(never)]
fn index(id: u8) -> Option<usize> {
    PARAMETERS_BY_ID.iter().position(|p| p.id == id)
}

/// The parameter with this id.
pub fn with_id(id: u8) -> Option<&'static Parameter> {
    PARAMETERS_BY_ID.iter().find(|p| p.id == id)
}

/// The parameter of this name, `group.key`, with its id.
pub fn find(name: &str) -> Option<(u8, &'static Parameter)> {
    let (group, key) = name.split_once('.')?;
    PARAMETERS_BY_ID
        .iter()
        .find(|parameter| parameter.group == group && parameter.key() == key)
        .map(|parameter| (parameter.id, parameter))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_found() {
        for parameter in &PARAMETERS {
            let name = std::format!("{}.{}", parameter.group, parameter.key());
            assert_eq!(find(&name), Some((parameter.id, parameter)), "{name}");
            assert_eq!(with_id(parameter.id), Some(parameter));
            assert!(parameter.allows(parameter.default()), "{name}");
            assert!(!parameter.allows(f64::NAN), "{name}");
        }
        assert_eq!(find("crepitus.nothing"), None);
        assert_eq!(find("crepitus"), None);
        assert_eq!(with_id(u8::MAX), None);
    }

    /// Programs of other versions and records in flash depend on the ids.
    #[test]
    fn ids_stay() {
        for (id, name) in [
            (id::CREPITUS, "crepitus.render"),
            (1, "crepitus.inertia_kg_m2"),
            (id::RESTART, "crepitus.restart"),
            (8, "encoder.velocity_bandwidth_hz"),
            (9, "friction-compensation.render"),
            (19, "bone-shaping.refill_w"),
            (20, "motor.bandwidth_hz"),
            (25, "motor.torque_constant_nm_per_a"),
            (28, "limits.speed_rad_s"),
        ] {
            assert_eq!(find(name).map(|(id, _)| id), Some(id), "{name}");
        }
    }

    #[test]
    fn settings_are_read_and_written_by_id() {
        let encoder = EncoderSettings {
            lines: 1000.0,
            gear_ratio: 50.0,
            velocity_bandwidth_hz: 80.0,
        };
        let values = Values::default().with(&encoder);
        assert_eq!(values.read::<3, EncoderSettings>(), encoder);
        assert_eq!(values.get(id::LINES), Some(1000.0));
        // Settings that no device has keep their defaults.
        let damped = Parameters {
            damping_nms_per_rad: 1.0,
            ..Parameters::default()
        };
        let values = Values::default().with(&damped);
        assert_eq!(values.read::<5, Parameters>(), Parameters::default());
    }
}
