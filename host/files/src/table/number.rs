//! Numbers as cells have them: with a point or, where no comma separates cells, a decimal comma.

use crate::characters::look_alike;
use std::fmt;

/// Error of a cell that should hold a number.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CellError {
    /// Nothing is in it.
    Empty,
    /// NaN or infinite.
    NotFinite {
        /// The cell, shortened.
        text: String,
    },
    /// Something else.
    NotANumber {
        /// The cell, shortened.
        text: String,
        /// Advice.
        advice: String,
    },
}

impl fmt::Display for CellError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("the cell is empty"),
            Self::NotFinite { text } => write!(f, "\"{text}\" is not a finite number"),
            Self::NotANumber { text, advice } => write!(f, "\"{text}\" is not a number{advice}"),
        }
    }
}

/// Decimal sign of a table, as far as its cells have shown it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Decimals {
    has_point: bool,
    has_comma: bool,
}

impl Decimals {
    /// Returns whether numbers were read with a decimal comma.
    pub(super) const fn has_comma(self) -> bool {
        self.has_comma
    }

    pub(super) fn number(&mut self, text: &str) -> Result<f64, CellError> {
        if text.is_empty() {
            return Err(CellError::Empty);
        }
        let parsed = match text.parse::<f64>() {
            Ok(value) => {
                self.has_point |= text.contains('.');
                Some(value)
            }
            Err(_) if !self.has_point => with_comma(text),
            Err(_) => None,
        };
        match parsed {
            Some(value) if value.is_finite() => {
                if text.contains(',') {
                    self.has_comma = true;
                } else if self.has_comma && text.contains('.') {
                    // 1.234 may be a thousand here.
                    return Err(not_a_number(text));
                }
                Ok(value)
            }
            Some(_) => Err(CellError::NotFinite {
                text: shortened(text),
            }),
            None => Err(not_a_number(text)),
        }
    }
}

/// A number with one decimal comma and no point.
pub(super) fn with_comma(text: &str) -> Option<f64> {
    let (whole, rest) = text.split_once(',')?;
    if text.contains('.') || rest.contains(',') {
        return None;
    }
    format!("{whole}.{rest}").parse().ok()
}

fn not_a_number(text: &str) -> CellError {
    let odd = text.chars().find_map(look_alike);
    let advice = if let Some(odd) = odd {
        format!("; it has {}, write {}", odd.name, odd.write)
    } else if text.contains(',') {
        " (use a point as the decimal sign)".to_owned()
    } else if text.contains('.') && with_comma(&text.replace('.', ",")).is_some() {
        ": other cells have decimal commas; write one decimal sign in all".to_owned()
    } else if text.contains(':') {
        "; if it is a time of day, write time_unit = \"clock\"".to_owned()
    } else {
        "; write a number such as 12.4".to_owned()
    };
    CellError::NotANumber {
        text: shortened(text),
        advice,
    }
}

/// A cell as messages quote it.
pub fn shortened(text: &str) -> String {
    const SHOWN: usize = 24;
    let mut short: String = text.chars().take(SHOWN).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short.escape_debug().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_decimal_sign_is_used_in_a_table() {
        let mut commas = Decimals::default();
        assert_eq!(commas.number("12,5"), Ok(12.5));
        assert_eq!(commas.number("-0,5e1"), Ok(-5.0));
        assert_eq!(commas.number("7"), Ok(7.0));
        assert!(commas.has_comma());
        let error = commas.number("1.234").unwrap_err().to_string();
        assert!(error.contains("decimal commas"), "{error}");
        let mut points = Decimals::default();
        assert_eq!(points.number("1.5"), Ok(1.5));
        let error = points.number("1,5").unwrap_err().to_string();
        assert!(error.contains("use a point"), "{error}");
        for text in ["1.234,5", "1,234,567"] {
            assert!(Decimals::default().number(text).is_err(), "{text}");
        }
    }

    #[test]
    fn characters_that_look_alike_are_named() {
        for (text, name) in [("\u{2212}1.5", "U+2212"), ("1\u{a0}000", "U+00A0")] {
            let error = Decimals::default().number(text).unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
        }
        assert_eq!(Decimals::default().number(""), Err(CellError::Empty));
        assert!(matches!(
            Decimals::default().number("NaN"),
            Err(CellError::NotFinite { .. })
        ));
    }
}
