//! Stories: pictures of one or several panels, one above the other, each with a
//! heading, on one width. Those of effects are here, with a function that makes each of its study's
//! data; those of hard cases are with them.

pub(crate) mod build_up;
pub(crate) mod hand_torque;

use crepitus_pages::plot::palette::{CURVES, Ink, LEVEL, TEXT};
use crepitus_pages::plot::{
    Anchor, Axis, Chart, Figure, Key, Mark, Marker, Panel, Paper, Plot, Point, Sign, Stroke, Svg,
    extent, stack,
};

/// CSS pixels.
const WIDTH: f64 = 960.0;
/// Heading of a panel.
const HEAD: f64 = 34.0;
/// A panel without the numbers of its axis, and those numbers.
const PANEL: f64 = 168.0;
const FOOT: f64 = 46.0;
/// Room for the names of levels at the right.
const NAMES: f64 = 84.0;

/// The inks of lines in the order of their first appearance: far apart in hue
/// and in lightness.
const INKS: [Ink; 4] = [CURVES[7], CURVES[0], CURVES[2], CURVES[3]];

/// A picture of one or several panels, one above the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Story {
    /// Name of its file: `implicit-euler`.
    pub(crate) name: &'static str,
    /// Statement, in a line.
    pub(crate) title: &'static str,
    /// Description of what one sees, with the numbers.
    pub(crate) caption: String,
    /// Panels from top to bottom.
    pub(crate) panels: Vec<PanelData>,
}

/// One pair of axes with its curves.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PanelData {
    /// Curves.
    pub(crate) heading: String,
    /// The axis to the right.
    pub(crate) x: Scale,
    /// The axis upwards.
    pub(crate) y: Scale,
    /// The lines, the first at the back.
    pub(crate) series: Vec<Series>,
    /// Horizontal lines with names: limits of y.
    pub(crate) levels: Vec<Mark>,
    /// Vertical lines with names: limits of x.
    pub(crate) bounds: Vec<Mark>,
}

/// Quantity, scale and range of an axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Scale {
    /// Quantity and unit: `Time (s)`. Panels below each other that share it,
    /// and the range, share the axis.
    pub(crate) label: &'static str,
    /// Whether it is logarithmic.
    pub(crate) logarithmic: bool,
    /// Start and end; `None` covers what is there. What is outside in y
    /// stands at the edge, what is outside in x is left out.
    pub(crate) range: Option<(f64, f64)>,
}

/// One line. Lines of one name look the same in all panels of a story.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Series {
    /// Name for the legend.
    pub(crate) name: &'static str,
    /// Whether each point has a sign of its own: measured one by one.
    pub(crate) dotted: bool,
    /// Points from left to right.
    pub(crate) points: Vec<(f64, f64)>,
}

impl Scale {
    /// A linear axis over the data.
    pub(crate) fn linear(label: &'static str) -> Self {
        Self {
            label,
            ..Self::default()
        }
    }

    /// A logarithmic axis over the data.
    pub(crate) fn logarithmic(label: &'static str) -> Self {
        Self {
            logarithmic: true,
            ..Self::linear(label)
        }
    }

    /// The axis from `low` to `high`.
    #[must_use]
    pub(crate) fn within(self, low: f64, high: f64) -> Self {
        Self {
            range: Some((low, high)),
            ..self
        }
    }
}

impl Series {
    /// A line without signs.
    pub(crate) fn line(name: &'static str, points: Vec<(f64, f64)>) -> Self {
        Self {
            name,
            dotted: false,
            points,
        }
    }
}

pub(crate) fn mark(at: f64, name: &str) -> Mark {
    Mark {
        at,
        name: name.to_owned(),
    }
}

/// The story as a figure of a page, or a file.
pub(crate) fn figure(story: &Story, paper: Paper) -> Figure {
    let names = names(story);
    Figure {
        name: story.name,
        title: story.title,
        charts: vec![Chart::full(chart(story, &names, paper))],
        legend: names
            .into_iter()
            .zip(INKS.into_iter().cycle())
            .map(|(name, ink)| Key::new(Sign::Line(ink), name))
            .collect(),
        caption: story.caption.clone(),
    }
}

fn chart(story: &Story, names: &[&str], paper: Paper) -> Svg {
    let next = story.panels.iter().skip(1).map(Some).chain([None]);
    let panels = story.panels.iter().zip(next).map(|(data, next)| {
        // No numbers above a panel with the same axis.
        let numbered = !next.is_some_and(|next| next.x == data.x && data.x.range.is_some());
        panel(data, numbered, names)
    });
    stack(paper.width(WIDTH), story.title, panels.collect())
}

fn panel<'a>(data: &'a PanelData, numbered: bool, names: &'a [&str]) -> Panel<'a> {
    let values = |pick: fn(&(f64, f64)) -> f64| {
        let points = data.series.iter().flat_map(|series| &series.points);
        points.map(pick)
    };
    let at = |marks: &[Mark]| marks.iter().map(|mark| mark.at).collect::<Vec<_>>();
    let x = axis(&data.x, values(|p| p.0).chain(at(&data.bounds)), true);
    let y = axis(&data.y, values(|p| p.1).chain(at(&data.levels)), false);
    let height = PANEL + if numbered { FOOT } else { 0.0 };
    Panel::new(height, x, (data.y.label, y), |plot| draw(plot, data, names))
        .head(HEAD, Some(&data.heading))
        .x_title(numbered.then_some(data.x.label))
        .names(
            data.levels
                .iter()
                .map(|level| (level.at, level.name.clone()))
                .collect(),
        )
        .right(NAMES)
}

fn draw(plot: &mut Plot, data: &PanelData, names: &[&str]) {
    plot.grid();
    for level in &data.levels {
        plot.across(level.at);
    }
    bounds(plot, &data.bounds);
    for (i, series) in data.series.iter().enumerate() {
        // A line behind others is wider, so that it is seen where they agree.
        let width = if i == 0 && data.series.len() > 1 {
            2.5
        } else {
            1.25
        };
        let place = names.iter().position(|name| *name == series.name);
        line(plot, series, INKS[place.unwrap_or(0) % INKS.len()], width);
    }
}

fn axis(scale: &Scale, values: impl Iterator<Item = f64>, across: bool) -> Axis {
    let ticks = if across { 8 } else { 4 };
    match (scale.logarithmic, scale.range) {
        (true, range) => {
            let (low, high) = range.unwrap_or_else(|| extent(values));
            Axis::decades(low.max(f64::MIN_POSITIVE), high, 6)
        }
        (false, Some((low, high))) => Axis::linear(low, high, ticks),
        (false, None) => Axis::covering(values, ticks),
    }
}

/// Dashed, each with its name at half its height.
fn bounds(plot: &mut Plot, bounds: &[Mark]) {
    for bound in bounds {
        let (low, high) = (plot.y().low(), plot.y().high());
        let ends = [Point::new(bound.at, low), Point::new(bound.at, high)];
        plot.stroke(&ends, Stroke::dashed(LEVEL, 1.25));
        let (side, away) = if plot.x().place(bound.at) < 0.6 {
            (Anchor::Start, 8.0)
        } else {
            (Anchor::End, -8.0)
        };
        let frame = plot.frame();
        let (x, _) = plot.at((bound.at, low));
        let middle = f64::midpoint(frame.top, frame.bottom);
        if !bound.name.is_empty() {
            plot.over.text((x + away, middle), side, TEXT, &bound.name);
        }
    }
}

fn line(plot: &mut Plot, series: &Series, ink: Ink, width: f64) {
    let (low, high) = (plot.x().low(), plot.x().high());
    let points: Vec<Point> = series
        .points
        .iter()
        .filter(|(x, y)| (low..=high).contains(x) && y.is_finite())
        .map(|(x, y)| Point::new(*x, *y))
        .collect();
    plot.line(&points, ink, width);
    if series.dotted {
        for point in &points {
            plot.mark((point.x, point.y), Marker::Circle, ink);
        }
    }
}

/// The names of the lines, in the order of their first appearance.
fn names(story: &Story) -> Vec<&'static str> {
    let mut names = Vec::new();
    for series in story.panels.iter().flat_map(|panel| &panel.series) {
        if !names.contains(&series.name) {
            names.push(series.name);
        }
    }
    names
}
