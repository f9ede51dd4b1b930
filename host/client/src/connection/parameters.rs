//! Parameters by name, and as JSON.

use crate::values::{full_name, show_value};
use crepitus_protocol::parameters::{self, Kind, PARAMETERS, Parameter, When};
use serde_json::{Value, json};

/// Error of an unknown parameter name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "unknown parameter {name:?}: {}`crepitus params list` lists all",
    like.as_ref().map(|like| format!("did you mean {like:?}? ")).unwrap_or_default()
)]
pub struct UnknownParameter {
    /// Name that was given.
    pub name: String,
    /// Name of the most similar parameter, if there is a similar one.
    pub like: Option<String>,
}

/// Finds a parameter by its full name; returns its id, too.
///
/// # Errors
/// [`UnknownParameter`] suggests a similar one.
pub fn find(name: &str) -> Result<(u8, &'static Parameter), UnknownParameter> {
    parameters::find(name).ok_or_else(|| UnknownParameter {
        name: name.to_owned(),
        like: PARAMETERS
            .iter()
            // Of equals the last is taken.
            .rev()
            .map(|parameter| (likeness(parameter, name), full_name(parameter)))
            .filter(|(likeness, _)| *likeness > ALIKE)
            .max_by(|(a, _), (b, _)| a.total_cmp(b))
            .map(|(_, like)| like),
    })
}

/// Likeness of names that are probably meant for each other, from 0 to 1.
const ALIKE: f64 = 0.85;

/// Likeness of a parameter's name, with or without that of its group, to a given one.
fn likeness(parameter: &Parameter, given: &str) -> f64 {
    let full = strsim::jaro_winkler(&full_name(parameter), given);
    let short = strsim::jaro_winkler(parameter.key(), given);
    full.max(short)
}

/// Returns name, unit, range or choices, default and meaning of a parameter as JSON.
pub fn described(parameter: &Parameter) -> Value {
    let (unit, min, max, choices) = match parameter.kind {
        Kind::Number(spec) => (Some(spec.unit), Some(spec.min), Some(spec.max), None),
        Kind::Choice(choice) => (None, None, None, Some(choice.names)),
    };
    json!({
        "id": parameter.id,
        "name": full_name(parameter),
        "unit": unit,
        "min": min,
        "max": max,
        "choices": choices,
        "default": named(parameter, parameter.default()),
        "only_disarmed": parameter.when == When::Disarmed,
        "meaning": parameter.meaning(),
    })
}

/// Returns a value as JSON: a number, or the name of a choice.
pub fn named(parameter: &Parameter, value: f64) -> Value {
    match parameter.kind {
        Kind::Number(_) => json!(value),
        Kind::Choice(_) => json!(show_value(parameter, value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_found_and_a_misspelt_one_is_corrected() {
        for parameter in &PARAMETERS {
            let (id, found) = find(&full_name(parameter)).unwrap();
            assert_eq!((id, found.id), (parameter.id, parameter.id));
            assert_eq!(described(parameter)["id"], parameter.id);
        }
        let error = find("crepitus.static_torqe_nm").unwrap_err();
        assert_eq!(error.like.as_deref(), Some("crepitus.static_torque_nm"));
        let error = find("static_torque_nm").unwrap_err();
        assert_eq!(error.like.as_deref(), Some("crepitus.static_torque_nm"));
        let error = find("stiffness_nm_per_rad").unwrap_err().to_string();
        assert_eq!(
            error,
            "unknown parameter \"stiffness_nm_per_rad\": did you mean \"crepitus.stiffness_nm_per_rad\"? \
             `crepitus params list` lists all"
        );
        let error = find("nosuch").unwrap_err().to_string();
        assert!(!error.contains("did you mean"), "{error}");
    }
}
