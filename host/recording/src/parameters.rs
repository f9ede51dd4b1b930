//! Parameters over a recording: by name, and each time only what has changed.

use crepitus_model::parameters::Source;
use crepitus_model::{Convention, Parameters, Restart, Settings};
use crepitus_protocol::Values;
use crepitus_protocol::parameters::{self, Kind, Parameter, id};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// Values by name; a choice by the name of what was chosen.
pub type Named = Map<String, Value>;

/// Parameters that were in force from a row on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterSet {
    /// Their revision.
    pub revision: u32,
    /// Number of rows before them.
    pub first_row: u64,
    /// Tick of that row.
    pub first_tick: u64,
    /// All in the first set, in a later one those that have changed; none if
    /// they are unknown.
    pub values: Option<Named>,
}

/// The sets of a recording, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct History(pub Vec<ParameterSet>);

impl History {
    /// Returns for each set the row where it took effect, and in a few words what has
    /// changed.
    pub fn changes(&self) -> impl Iterator<Item = (u64, String)> {
        self.0.iter().map(|set| {
            let changed: Vec<_> = set.values.iter().flatten().collect();
            let what = match (&set.values, changed.as_slice()) {
                (None, _) => ": unknown".to_owned(),
                (_, [(name, value)]) => {
                    let short = name.split_once('.').map_or(name.as_str(), |(_, key)| key);
                    format!(": {short} = {value}")
                }
                (_, []) => String::new(),
                (_, several) => format!(": {} parameters", several.len()),
            };
            (set.first_row, format!("revision {}{what}", set.revision))
        })
    }

    /// Follows the rows from the first one.
    pub fn in_force(&self) -> InForce<'_> {
        InForce {
            due: &self.0,
            known: Named::new(),
            is_known: false,
        }
    }
}

/// The parameters of one row after the other.
#[derive(Clone, Debug)]
pub struct InForce<'h> {
    due: &'h [ParameterSet],
    known: Named,
    is_known: bool,
}

impl InForce<'_> {
    /// Goes on to a row; true if its parameters are others than before.
    pub fn at(&mut self, row: u64) -> bool {
        let mut is_other = false;
        while let [set, rest @ ..] = self.due
            && set.first_row <= row
        {
            self.due = rest;
            is_other = true;
            self.is_known = set.values.is_some();
            for (name, value) in set.values.iter().flatten() {
                self.known.insert(name.clone(), value.clone());
            }
        }
        is_other
    }

    /// A value, if it is known.
    pub fn value(&self, name: &str) -> Option<&Value> {
        self.known.get(name).filter(|_| self.is_known)
    }

    /// The value of a number, if it is known.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.value(name).and_then(Value::as_f64)
    }

    /// All values, if they are known.
    pub fn values(&self) -> Option<Values> {
        self.is_known.then(|| values_of(&self.known))
    }

    /// All values as they were known last; defaults for those that never were.
    pub(crate) fn last_values(&self) -> Values {
        values_of(&self.known)
    }

    /// The settings of the stick-slip joint, if they are known and it is on.
    pub fn joint_settings(&self) -> Option<Settings> {
        if !self.values()?.is_on(id::CREPITUS) {
            return None;
        }
        Some(Settings {
            parameters: Parameters {
                inertia_kg_m2: self.number("crepitus.inertia_kg_m2")?,
                stiffness_nm_per_rad: self.number("crepitus.stiffness_nm_per_rad")?,
                kinetic_torque_nm: self.number("crepitus.kinetic_torque_nm")?,
                static_torque_nm: self.number("crepitus.static_torque_nm")?,
                // No device has damping.
                ..Parameters::default()
            },
            // The only convention that a device renders.
            convention: Convention::Frozen,
            restart: self
                .value("crepitus.restart")
                .and_then(|value| Restart::ALL.into_iter().find(|r| value == r.name()))
                .unwrap_or_default(),
        })
    }
}

/// Values by name; choices by the name of what was chosen.
pub fn named_values(values: &Values) -> Named {
    values
        .iter()
        .map(|(parameter, value)| (name_of(parameter), named(parameter, value)))
        .collect()
}

fn name_of(parameter: &Parameter) -> String {
    format!("{}.{}", parameter.group, parameter.key())
}

fn named(parameter: &Parameter, value: f64) -> Value {
    match parameter.kind {
        Kind::Number(_) => json!(value),
        Kind::Choice(choice) => choice
            .names
            .iter()
            .zip(0_u8..)
            .find(|(_, place)| f64::from(*place) == value)
            .map_or(Value::Null, |(name, _)| json!(name)),
    }
}

/// The values of these names; defaults for what is not named.
pub(crate) fn values_of(known: &Named) -> Values {
    let mut values = Values::default();
    for (name, value) in known {
        let Some((id, parameter)) = parameters::find(name) else {
            continue;
        };
        let number = match (parameter.kind, value) {
            (Kind::Choice(choice), Value::String(chosen)) => (choice.names.iter().zip(0_u8..))
                .find(|(name, _)| *name == chosen)
                .map(|(_, place)| f64::from(place)),
            _ => value.as_f64(),
        };
        if let Some(number) = number {
            values.set(id, number);
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(revision: u32, first_row: u64, values: &Value) -> ParameterSet {
        ParameterSet {
            revision,
            first_row,
            first_tick: first_row + 320,
            values: values.as_object().cloned(),
        }
    }

    fn history() -> History {
        History(vec![
            set(
                2,
                0,
                &json!({ "crepitus.kinetic_torque_nm": 0.2, "crepitus.stiffness_nm_per_rad": 400.0 }),
            ),
            set(3, 80_000, &json!({ "crepitus.kinetic_torque_nm": 0.25 })),
            set(
                4,
                160_000,
                &json!({ "crepitus.kinetic_torque_nm": 0.2, "crepitus.stiffness_nm_per_rad": 900.0 }),
            ),
            set(5, 200_000, &Value::Null),
        ])
    }

    #[test]
    fn changes_of_parameters_have_a_row_and_a_name() {
        let named = |row, name: &str| (row, name.to_owned());
        assert_eq!(
            history().changes().collect::<Vec<_>>(),
            [
                named(0, "revision 2: 2 parameters"),
                named(80_000, "revision 3: kinetic_torque_nm = 0.25"),
                named(160_000, "revision 4: 2 parameters"),
                named(200_000, "revision 5: unknown")
            ]
        );
    }

    #[test]
    fn each_row_has_the_values_of_all_sets_before_it() {
        let history = history();
        let mut in_force = history.in_force();
        let mut at = |row| {
            let is_other = in_force.at(row);
            let number = |name| in_force.number(name);
            (
                is_other,
                number("crepitus.kinetic_torque_nm"),
                number("crepitus.stiffness_nm_per_rad"),
            )
        };
        assert_eq!(at(0), (true, Some(0.2), Some(400.0)));
        assert_eq!(at(79_999), (false, Some(0.2), Some(400.0)));
        assert_eq!(at(80_000), (true, Some(0.25), Some(400.0)));
        assert_eq!(at(170_000), (true, Some(0.2), Some(900.0)));
        assert_eq!(at(200_000), (true, None, None));
    }

    #[test]
    fn a_joint_that_is_off_has_no_settings() {
        let all = Value::Object(named_values(&Values::default()));
        let history = History(vec![
            set(1, 0, &all),
            set(2, 10, &json!({ "crepitus.render": "off" })),
            set(3, 20, &json!({ "crepitus.render": "on" })),
            set(4, 30, &Value::Null),
        ]);
        let mut in_force = history.in_force();
        let is_known = |row| {
            in_force.at(row);
            in_force.joint_settings().is_some()
        };
        assert_eq!([0, 10, 20, 30].map(is_known), [true, false, true, false]);
    }

    #[test]
    fn values_read_back_from_their_names() {
        let mut values = Values::default();
        values.set(id::STATIC_TORQUE, 0.1 + 0.2);
        for (parameter, _) in Values::default().iter() {
            if let Kind::Choice(choice) = parameter.kind {
                let last = u8::try_from(choice.names.len() - 1).expect("few names");
                let (id, _) = parameters::find(&name_of(parameter)).expect("a parameter");
                values.set(id, f64::from(last));
            }
        }
        assert_eq!(values_of(&named_values(&values)), values);
    }
}
