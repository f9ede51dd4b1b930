//! Row of a run: the varied values, and every number of its summary.

use crate::sweep::kind::Kind;
use crepitus_scene::Summary;
use crepitus_scene::run::EffectSummary;
use serde_json::{Map, Value};
use std::fmt;

/// Value of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Integer.
    Whole(i64),
    /// Number.
    Number(f64),
    /// Text.
    Text(String),
}

impl Cell {
    /// Returns the kind of the cell.
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Whole(_) => Kind::Whole,
            Self::Number(_) => Kind::Number,
            Self::Text(_) => Kind::Text,
        }
    }
}

/// Formats the cell; a number is read back to the same bits.
impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(whole) => write!(f, "{whole}"),
            Self::Number(number) => f.write_str(ryu::Buffer::new().format(*number)),
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// Row of a run. A column that it does not have is empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number of its point.
    pub index: u64,
    /// Cells, with the names of their columns.
    pub cells: Vec<(String, Cell)>,
}

/// Column with the reason of a failed run; empty for a run that succeeded.
pub const FAILURE: &str = "failure";

/// Entries of a summary that are no result: the same for every run, in another column, or dependent
/// on the computer.
const LEFT_OUT: [&str; 9] = [
    "summary_version",
    "scene_version",
    "scene",
    "scene_as_run",
    "title",
    "data",
    "effects",
    "wall_s",
    "real_time_factor",
];

impl Row {
    /// Returns the reason of a failed run.
    pub fn failure(&self) -> Option<&str> {
        self.cells.iter().find_map(|(name, cell)| match cell {
            Cell::Text(reason) if name == FAILURE => Some(reason.as_str()),
            _ => None,
        })
    }

    /// Creates the row of a point, with the varied values.
    pub(crate) fn of_point(
        index: u64,
        paths: &[&str],
        values: &[String],
        design_seed: Option<u64>,
    ) -> Self {
        let varied = paths.iter().zip(values);
        let mut cells: Vec<_> = varied
            .map(|(path, value)| ((*path).to_owned(), given(value)))
            .collect();
        let version = Cell::Text(env!("CARGO_PKG_VERSION").to_owned());
        cells.push(("crepitus_version".to_owned(), version));
        if let Some(seed) = design_seed {
            cells.push(("design_seed".to_owned(), Cell::Whole(seed.cast_signed())));
        }
        Self { index, cells }
    }

    /// Adds the numbers of the summary, or the reason of the failure.
    pub(crate) fn add(&mut self, outcome: Result<Summary, String>) {
        match outcome {
            Ok(summary) => {
                for (name, cell) in numbers(&summary) {
                    self.put(name, cell);
                }
            }
            Err(reason) => self.put(FAILURE.to_owned(), Cell::Text(reason)),
        }
    }

    /// Adds a cell, unless the column has a varied value.
    fn put(&mut self, name: String, cell: Cell) {
        if !self.cells.iter().any(|(other, _)| *other == name) {
            self.cells.push((name, cell));
        }
    }
}

/// Converts a given value to a cell: a number if it is one.
fn given(value: &str) -> Cell {
    match value.parse::<f64>() {
        Ok(number) => Cell::Number(number),
        Err(_) => Cell::Text(value.trim_matches('"').to_owned()),
    }
}

/// Returns the cells of a summary. Parameters have their path in a scene as name.
fn numbers(summary: &Summary) -> Vec<(String, Cell)> {
    let mut cells = Vec::with_capacity(96);
    for effect in &summary.effects {
        add_effect(effect, &mut cells);
    }
    if let Ok(Value::Object(whole)) = serde_json::to_value(summary) {
        let kept = whole
            .into_iter()
            .filter(|(name, _)| !LEFT_OUT.contains(&name.as_str()));
        flatten("", kept.collect(), &mut cells);
    }
    cells
}

fn add_effect(effect: &EffectSummary, cells: &mut Vec<(String, Cell)>) {
    let path = |key: &str| format!("effects.{}.{key}", effect.name);
    for parameter in &effect.parameters {
        cells.push((path(parameter.key), Cell::Number(parameter.value)));
    }
    for choice in &effect.choices {
        cells.push((path(choice.key), Cell::Text(choice.value.to_owned())));
    }
}

fn flatten(path: &str, table: Map<String, Value>, cells: &mut Vec<(String, Cell)>) {
    for (name, value) in table {
        let name = if path.is_empty() {
            name
        } else {
            format!("{path}.{name}")
        };
        match value {
            Value::Object(inner) => flatten(&name, inner, cells),
            Value::Array(items) => flatten_list(&name, items, cells),
            Value::Number(number) => cells.push((name, of_json(&number))),
            Value::String(text) => cells.push((name, Cell::Text(text))),
            Value::Bool(_) | Value::Null => {}
        }
    }
}

/// Flattens a list: terms of an energy balance are named by their texts, texts are joined.
fn flatten_list(path: &str, items: Vec<Value>, cells: &mut Vec<(String, Cell)>) {
    let mut texts = Vec::new();
    for item in items {
        match item {
            Value::String(text) => texts.push(text),
            Value::Object(term) => {
                let words: Vec<_> = term.values().filter_map(Value::as_str).collect();
                let name = words.join(".").replace(' ', "-");
                for (key, value) in &term {
                    if let Value::Number(number) = value {
                        cells.push((format!("{path}.{name}.{key}"), of_json(number)));
                    }
                }
            }
            _ => {}
        }
    }
    if !texts.is_empty() {
        cells.push((path.to_owned(), Cell::Text(texts.join("; "))));
    }
}

fn of_json(number: &serde_json::Number) -> Cell {
    match number.as_i64() {
        Some(whole) => Cell::Whole(whole),
        None => Cell::Number(number.as_f64().unwrap_or(f64::NAN)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_scene::{Overrides, run, run::Blind, shipped};
    use std::path::Path;

    fn row(scene: &str) -> Row {
        let scene = shipped::scene(Path::new(scene), &Overrides::default()).unwrap();
        let mut row = Row::of_point(
            3,
            &["effects.crepitus.preset", "duration_s"],
            &["\"coarse\"".to_owned(), "2".to_owned()],
            None,
        );
        row.add(Ok(run(&scene, &mut Blind).unwrap()));
        row
    }

    fn cell<'r>(row: &'r Row, name: &str) -> Option<&'r Cell> {
        let mut found = row.cells.iter().filter(|(n, _)| n == name);
        let first = found.next().map(|(_, cell)| cell);
        assert!(found.next().is_none(), "{name} twice");
        first
    }

    #[test]
    fn every_number_of_a_summary_has_one_column() {
        let row = row("everything");
        assert_eq!(
            cell(&row, "effects.crepitus.preset"),
            Some(&Cell::Text("coarse".to_owned()))
        );
        assert_eq!(cell(&row, "duration_s"), Some(&Cell::Number(2.0)));
        assert!(matches!(cell(&row, "events.break"), Some(Cell::Whole(n)) if *n > 0));
        for name in [
            "torque.rms_nm",
            "hand_torque.max_nm",
            "effects.cuff.stiffness_nm_per_rad",
            "effects.crepitus.static_torque_nm",
            "plant_energy.residual_j",
            "impacts.largest_nms",
        ] {
            assert!(matches!(cell(&row, name), Some(Cell::Number(_))), "{name}");
        }
        let terms = row
            .cells
            .iter()
            .filter(|(n, _)| n.starts_with("plant_energy.terms."));
        assert!(terms.count() > 5);
        for (name, _) in &row.cells {
            assert!(cell(&row, name).is_some());
            assert!(!name.contains("wall") && !name.contains(' '), "{name}");
        }
    }
}
