//! Values of cells.

use crate::table::show::Show;
use serde::{Serialize, Serializer};
use std::fmt::Write;

/// The content of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Empty: not applicable to this row.
    Missing,
    /// Yes or no.
    Flag(bool),
    /// A whole number.
    Count(i64),
    /// A number; NaN if it is not known.
    Number(f64),
    /// Words.
    Text(String),
    /// Several names.
    List(Vec<String>),
    /// A cell that people see as this text.
    Shown(Box<Cell>, String),
}

impl Cell {
    /// The cell, shown to people as `text`.
    #[must_use]
    pub fn shown_as(self, text: impl Into<String>) -> Self {
        Self::Shown(Box::new(self), text.into())
    }

    pub(crate) fn is_number(&self) -> bool {
        match self {
            Self::Count(_) | Self::Number(_) => true,
            Self::Shown(cell, _) => cell.is_number(),
            _ => false,
        }
    }

    pub(crate) fn push_csv(&self, text: &mut String) {
        match self {
            Self::Missing => {}
            // Writing to a String cannot fail.
            Self::Flag(flag) => drop(write!(text, "{flag}")),
            Self::Count(n) => drop(write!(text, "{n}")),
            Self::Number(x) => push_number(text, *x),
            Self::Text(words) => push_quoted(text, words),
            Self::List(names) => push_quoted(text, &names.join(" ")),
            Self::Shown(cell, _) => cell.push_csv(text),
        }
    }

    /// Returns the text for people.
    pub(crate) fn to_text(&self, show: Option<Show>) -> String {
        #[expect(clippy::cast_precision_loss, reason = "rounded for people")]
        match (self, show) {
            (Self::Count(n), Some(show)) => show(*n as f64),
            (Self::Number(x), Some(show)) => show(*x),
            (Self::Number(x), None) => x.to_string(),
            (Self::List(names), _) => names.join(", "),
            (Self::Shown(_, text) | Self::Text(text), _) => text.clone(),
            (other, _) => {
                let mut text = String::new();
                other.push_csv(&mut text);
                text
            }
        }
    }
}

impl Serialize for Cell {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Missing => serializer.serialize_none(),
            Self::Flag(flag) => flag.serialize(serializer),
            Self::Count(n) => n.serialize(serializer),
            Self::Number(x) => x.serialize(serializer),
            Self::Text(words) => words.serialize(serializer),
            Self::List(names) => names.serialize(serializer),
            Self::Shown(cell, _) => cell.serialize(serializer),
        }
    }
}

/// Appends a number, with as many digits as read back to the same bits.
fn push_number(text: &mut String, x: f64) {
    if x.is_finite() {
        text.push_str(ryu::Buffer::new().format_finite(x));
    } else if x.is_nan() {
        text.push_str("nan");
    } else {
        text.push_str(if x > 0.0 { "inf" } else { "-inf" });
    }
}

/// Appends words, in quotes if they need them.
fn push_quoted(text: &mut String, words: &str) {
    if words.contains([',', '"', '\n', '\r']) {
        text.push('"');
        text.push_str(&words.replace('"', "\"\""));
        text.push('"');
    } else {
        text.push_str(words);
    }
}

macro_rules! cell_from {
    ($($from:ty => |$x:ident| $cell:expr),* $(,)?) => {
        $(impl From<$from> for Cell {
            fn from($x: $from) -> Self {
                $cell
            }
        })*
    };
}

cell_from! {
    bool => |flag| Self::Flag(flag),
    i64 => |n| Self::Count(n),
    u32 => |n| Self::Count(n.into()),
    u64 => |n| Self::Count(i64::try_from(n).unwrap_or(i64::MAX)),
    usize => |n| Self::Count(i64::try_from(n).unwrap_or(i64::MAX)),
    f64 => |x| Self::Number(x),
    &str => |words| Self::Text(words.to_owned()),
    String => |words| Self::Text(words),
    &[&str] => |names| Self::List(names.iter().map(|&name| name.to_owned()).collect()),
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(cell: Option<T>) -> Self {
        cell.map_or(Self::Missing, Into::into)
    }
}
