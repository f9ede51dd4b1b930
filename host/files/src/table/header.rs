//! The header of an OpenSim file: motion (`.mot`) and storage (`.sto`).
//!
//! ```text
//! Coordinates              free lines, and lines of key=value (older files: key value)
//! nRows=158
//! nColumns=36
//! inDegrees=yes
//! endheader
//! time  pelvis_tilt  …     names, separated by tabs or spaces
//! 0.00  12.2         …     rows
//! ```
//! Source: OpenSim documentation, "Motion (.mot) files" and "Storage (.sto) files"; the older keys
//! `datarows` and `datacolumns` are those of SIMM.

use super::layout::Line;

/// Declarations of the header, each with its line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Header {
    /// The title: the name of the table that a program wrote, such as `Coordinates`.
    pub title: Option<(u64, String)>,
    /// Number of rows.
    pub rows: Option<(u64, u64)>,
    /// Number of columns.
    pub columns: Option<(u64, u64)>,
    /// The value of `inDegrees`: as written, and its meaning.
    pub in_degrees: Option<(u64, String, bool)>,
}

impl Header {
    pub(super) fn of(lines: &[Line]) -> Self {
        let mut header = Self::default();
        for (line, text) in lines {
            // A spreadsheet pads lines and puts them in quotes.
            let padding = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '"');
            let text = text.trim_matches(padding);
            if text.is_empty() {
                continue;
            }
            let pair = text
                .split_once('=')
                .or_else(|| text.split_once(char::is_whitespace))
                .map(|(key, value)| (key.trim().to_ascii_lowercase(), value.trim()));
            let (key, value) = pair.unwrap_or_else(|| (String::new(), text));
            match key.as_str() {
                "nrows" | "datarows" => header.rows = value.parse().ok().map(|n| (*line, n)),
                "ncolumns" | "datacolumns" => {
                    header.columns = value.parse().ok().map(|n| (*line, n));
                }
                "indegrees" => {
                    let is_deg = match value.to_ascii_lowercase().as_str() {
                        "yes" | "y" | "true" | "1" => true,
                        "no" | "n" | "false" | "0" => false,
                        _ => continue,
                    };
                    header.in_degrees = Some((*line, format!("inDegrees={value}"), is_deg));
                }
                "name" => header.title = Some((*line, value.to_owned())),
                _ if header.title.is_none() && !text.contains('=') => {
                    header.title = Some((*line, text.to_owned()));
                }
                _ => {}
            }
        }
        header
    }
}
