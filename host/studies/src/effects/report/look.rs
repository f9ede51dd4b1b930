//! Look of a variant, and its name where there is little room.

use crate::effects::Row;
use crate::effects::variant::Change;

use crepitus_pages::plot::palette::{CURVES, TEXT};
use crepitus_pages::plot::{CurveStyle, Key, Marker, Sign};

/// Look of a variant, by what was done to the scene.
pub(super) fn of(change: Change) -> CurveStyle {
    let (ink, marker) = match change {
        Change::Scene => (TEXT, Marker::Square),
        Change::Without => (CURVES[2], Marker::Circle),
        Change::With => (CURVES[3], Marker::Diamond),
    };
    CurveStyle {
        ink,
        dashes: "",
        marker,
    }
}

/// Legend of the signs of these rows.
pub(super) fn legend<'a>(rows: impl Iterator<Item = &'a Row>) -> Vec<Key> {
    let changes: Vec<Change> = rows.map(|row| row.change).collect();
    [
        (Change::Scene, "the scene"),
        (Change::Without, "an effect of the scene, left out"),
        (Change::With, "an absent effect, added"),
    ]
    .into_iter()
    .filter(|(change, _)| changes.contains(change))
    .map(|(change, text)| Key::new(Sign::Filled(of(change)), text))
    .collect()
}

/// The effect, and how many came or left with it: `drivetrain +2`.
pub(super) fn short(row: &Row) -> String {
    match row.along.len() {
        0 => row.effect.to_owned(),
        n => format!("{} +{n}", row.effect),
    }
}
