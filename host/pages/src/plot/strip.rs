//! The strip above a pair of axes with the names of moments, so that none lies on a curve.

use crate::plot::axis::Axis;
use crate::plot::drawing::{Anchor, Drawing};
use crate::plot::frame::Frame;
use crate::plot::palette::TEXT;
use crate::plot::plot::Mark;
use crate::plot::stroke::Stroke;
use crate::plot::text::LINE;

/// Rows of a strip; names that find no room in them are left out.
const MOST_ROWS: usize = 6;
/// Least distance of a name from a line or another name, CSS pixels.
const GAP: f64 = 5.0;

/// Names in rows, the first at the top.
#[derive(Debug, Default)]
pub(crate) struct Strip {
    rows: usize,
    names: Vec<Name>,
}

/// A name; x counts from the left of the axes, CSS pixels.
#[derive(Debug)]
struct Name {
    line: f64,
    start: f64,
    row: usize,
    text: String,
}

impl Strip {
    /// The names of the moments within an axis of this width, CSS pixels.
    pub(crate) fn of(marks: &[Mark], x: &Axis, width: f64) -> Self {
        let mut inside: Vec<&Mark> = marks
            .iter()
            .filter(|mark| !mark.name.is_empty() && (x.low()..=x.high()).contains(&mark.at))
            .collect();
        inside.sort_by(|a, b| a.at.total_cmp(&b.at));
        // Where the last name of each row ends.
        let mut ends: Vec<f64> = Vec::new();
        let mut names: Vec<Name> = Vec::new();
        for mark in inside {
            let line = width * x.place(mark.at);
            let long = Drawing::label_width(&mark.name);
            if long > width {
                continue;
            }
            // Right of its line; at the edge left of it, unless it would cover the line before.
            let (right, left) = (line + GAP, line - GAP - long);
            let before = names.last().map_or(0.0, |name| name.line + GAP);
            let start = if right + long > width && left >= before {
                left
            } else {
                right.min(width - long)
            };
            // The line of the name must not cross a name in a row below.
            let is_free = |row: &usize| ends[*row..].iter().all(|end| *end < start.min(line) - GAP);
            let row = (0..ends.len()).find(is_free).unwrap_or(ends.len());
            if row >= MOST_ROWS {
                continue;
            }
            ends.resize(ends.len().max(row + 1), 0.0);
            ends[row] = start + long;
            names.push(Name {
                line,
                start,
                row,
                text: mark.name.clone(),
            });
        }
        Self {
            rows: ends.len(),
            names,
        }
    }

    /// Room that it takes above the axes, CSS pixels.
    pub(crate) fn height(&self) -> f64 {
        LINE * self.rows as f64
    }

    /// Draws the names, and the line of each from its name down to the axes.
    pub(crate) fn draw(&self, frame: Frame, drawing: &mut Drawing) {
        let y = |row: usize| frame.top - LINE * (self.rows as f64 - row as f64 - 0.5);
        for name in &self.names {
            let x = frame.left + name.line;
            let ends = [(x, y(name.row) - 0.5 * LINE), (x, frame.top)];
            drawing.line(&ends, Stroke::MOMENT);
        }
        // After all lines: a name at the right edge may cover the line of an earlier one.
        for name in &self.names {
            let at = (frame.left + name.start, y(name.row));
            drawing.label(at, Anchor::Start, TEXT, &name.text);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: f64 = 800.0;

    fn strip(marks: &[(f64, &str)]) -> Strip {
        let marks: Vec<Mark> = marks
            .iter()
            .map(|(at, name)| Mark {
                at: *at,
                name: (*name).to_owned(),
            })
            .collect();
        Strip::of(&marks, &Axis::linear(0.0, 10.0, 5), WIDTH)
    }

    fn rows(strip: &Strip) -> Vec<(&str, usize)> {
        let names = strip.names.iter();
        names.map(|name| (name.text.as_str(), name.row)).collect()
    }

    #[test]
    fn names_are_staggered_and_stay_inside() {
        let strip = strip(&[
            (5.1, "second"),
            (5.0, "first"),
            (9.9, "third"),
            (99.0, "outside"),
            (7.0, ""),
        ]);
        assert_eq!(rows(&strip), [("first", 0), ("second", 1), ("third", 0)]);
        assert_eq!(strip.names[0].start, 405.0);
        // Left of its line at the edge, over it where an earlier line is in the way.
        let end = |name: &Name| name.start + Drawing::label_width(&name.text);
        let third = &strip.names[2];
        assert!((end(third) - (third.line - GAP)).abs() < 1e-9);
        let near = self::strip(&[(9.7, "one"), (9.9, "beside")]);
        assert!((end(&near.names[1]) - WIDTH).abs() < 1e-9);
        assert_eq!(strip.height(), 2.0 * LINE);
        assert_eq!(self::strip(&[]).height(), 0.0);
    }

    #[test]
    fn no_line_crosses_a_name_in_a_row_below() {
        let long = "a name that is much longer than the one before";
        let strip = strip(&[(1.0, "short"), (1.1, long), (3.0, "over the long one")]);
        assert_eq!(
            rows(&strip),
            [("short", 0), (long, 1), ("over the long one", 2)]
        );
    }

    #[test]
    fn a_name_longer_than_the_axes_and_one_without_a_row_are_left_out() {
        let wide = "too long for any chart".repeat(9);
        assert!(rows(&strip(&[(1.0, &wide)])).is_empty());
        assert_eq!(
            rows(&strip(&[(5.0, "crowded"); MOST_ROWS + 3])).len(),
            MOST_ROWS
        );
    }

    #[test]
    fn a_strip_is_above_the_axes_and_its_lines_meet_them() {
        let frame = Frame {
            left: 100.0,
            top: 50.0,
            right: 900.0,
            bottom: 210.0,
        };
        let mut drawing = Drawing::default();
        strip(&[(5.0, "first"), (5.1, "second")]).draw(frame, &mut drawing);
        let out = drawing.finish();
        assert!(out.contains("d=\"M500 14l0 36\""), "{out}");
        assert!(out.contains("d=\"M508 32l0 18\""), "{out}");
        // The baseline, a third of the letters' size below the middle of the row.
        assert!(out.contains("x=\"505\" y=\"27.55\""), "{out}");
    }
}
