//! Parameters as text.

use crepitus_protocol::parameters::{Kind, Parameter};

/// Why a text is no value of a parameter.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ParseError {
    /// The parameter is a number, and this is none.
    #[error("{name} is a number: `{text}` is none; it is {allowed}")]
    NotANumber {
        /// The parameter.
        name: String,
        /// The text.
        text: String,
        /// What is allowed.
        allowed: String,
    },
    /// The parameter is one of some names, and this is none of them.
    #[error("{name} cannot be `{text}`: it is {allowed}")]
    NotAChoice {
        /// The parameter.
        name: String,
        /// The text.
        text: String,
        /// What is allowed.
        allowed: String,
    },
}

/// A value from what a person writes: a plain number in the unit that the
/// parameter's name ends with, or one of a choice's names. Whether a number is
/// in its range is for the device to say.
///
/// # Errors
/// [`ParseError`] with what is allowed.
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

/// A value as [`parse_value`] reads it: the same bits come back.
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

/// What is allowed: "between 0 and 6.5 N·m", "`off` or `on`".
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
