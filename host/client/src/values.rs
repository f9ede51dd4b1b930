//! Parameters as text.

use crepitus_protocol::parameters::{Kind, Parameter};

/// Errors of parsing a value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ParseError {
    /// Not a number.
    #[error("invalid {name}: expected a number {allowed}, got `{text}`")]
    NotANumber {
        /// The parameter.
        name: String,
        /// The text.
        text: String,
        /// The valid values.
        allowed: String,
    },
    /// Not a valid choice.
    #[error("invalid {name}: expected {allowed}, got `{text}`")]
    NotAChoice {
        /// The parameter.
        name: String,
        /// The text.
        text: String,
        /// The valid values.
        allowed: String,
    },
}

/// Parses a value: a plain number in the unit at the end of the parameter's
/// name, or the name of a choice. The device checks the range.
///
/// # Errors
/// [`ParseError`] with the valid values.
pub fn parse_value(parameter: &Parameter, text: &str) -> Result<f64, ParseError> {
    let text = text.trim();
    let (name, allowed) = (full_name(parameter), allowed_text(parameter));
    match parameter.kind {
        Kind::Number(_) => text
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite())
            .ok_or_else(|| ParseError::NotANumber {
                name,
                text: text.to_owned(),
                allowed,
            }),
        Kind::Choice(choice) => (0_u8..)
            .zip(choice.names)
            .find(|(_, name)| **name == text)
            .map(|(place, _)| f64::from(place))
            .ok_or_else(|| ParseError::NotAChoice {
                name,
                text: text.to_owned(),
                allowed,
            }),
    }
}

/// Formats a value; [`parse_value`] returns the same bits.
pub fn show_value(parameter: &Parameter, value: f64) -> String {
    let name = match parameter.kind {
        Kind::Number(_) => None,
        Kind::Choice(choice) => (0_u8..)
            .zip(choice.names)
            .find(|(place, _)| f64::from(*place) == value)
            .map(|(_, name)| (*name).to_owned()),
    };
    name.unwrap_or_else(|| show_number(value))
}

/// The shortest decimal that reads back to the same bits.
pub fn show_number(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) && value.is_finite() {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

/// `group.key`.
pub fn full_name(parameter: &Parameter) -> String {
    format!("{}.{}", parameter.group, parameter.key())
}

/// The valid values: "between 0 and 4.5 N·m", "`off` or `on`".
pub fn allowed_text(parameter: &Parameter) -> String {
    match parameter.kind {
        Kind::Number(spec) => {
            let (min, max) = (show_number(spec.min), show_number(spec.max));
            // The unit of a ratio is 1.
            match spec.unit {
                "1" => format!("between {min} and {max}"),
                unit => format!("between {min} and {max} {unit}"),
            }
        }
        Kind::Choice(choice) => {
            let names: Vec<_> = choice.names.iter().map(|n| format!("`{n}`")).collect();
            names.join(" or ")
        }
    }
}
