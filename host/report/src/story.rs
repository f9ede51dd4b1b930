//! A story of the stability study as one chart: its panels one above the
//! other, each with a heading, on one width.

use crepitus_model::EventKind;
use crepitus_study::stability::story::{Mark, Panel as Told, Scale, Series, Story};
use plotters::element::Text;
use plotters::style::text_anchor::{HPos, VPos};

use crate::ReportError;
use crate::axis::{Axis, extent};
use crate::canvas::{Area, Drawn, Panel, Plot, px, svg, text_style};
use crate::figure::{Chart, Figure, Key, Sign};
use crate::palette::{CURVES, Ink, LEVEL, TEXT};
use crate::picture::{Picture, document};
use crate::thinned::Point;

/// CSS pixels.
const WIDTH: u32 = 960;
/// Heading of a panel.
const HEAD: u32 = 34;
/// A panel without the numbers of its axis.
const PANEL: u32 = 168;
/// Those numbers, and what they are.
const FOOT: u32 = 46;
/// Room for the names of levels at the right.
const NAMES: u32 = 84;

/// The inks of lines in the order of their first appearance, with their names
/// in the style sheet: far apart in hue and in lightness.
const INKS: [(&str, Ink); 4] = [
    ("blue", CURVES[7]),
    ("vermillion", CURVES[0]),
    ("green", CURVES[2]),
    ("purple", CURVES[3]),
];

/// The story as an SVG document of its own.
///
/// # Errors
/// [`ReportError::Draw`] if the drawing library refuses a chart.
pub fn picture(story: &Story) -> Result<Picture, ReportError> {
    let legend = legend(story);
    Ok(Picture {
        name: story.name.to_owned(),
        svg: document(&chart(story)?, &legend),
    })
}

/// The story for a page.
pub(crate) fn figure(story: &Story) -> Result<Figure, ReportError> {
    Ok(Figure {
        name: story.name,
        title: story.title,
        legend: legend(story),
        charts: vec![Chart {
            heading: None,
            svg: chart(story)?,
            half: false,
        }],
        caption: story.caption.clone(),
    })
}

fn chart(story: &Story) -> Result<String, ReportError> {
    let panels = &story.panels;
    let height = (0..panels.len())
        .map(|i| HEAD + PANEL + foot(panels, i))
        .sum();
    let names = names(story);
    svg((WIDTH, height), story.title, |area| {
        let mut rest = area.clone();
        for (i, panel) in panels.iter().enumerate() {
            let (head, below) = rest.split_vertically(px(HEAD));
            let foot = foot(panels, i);
            let (body, after) = below.split_vertically(px(PANEL + foot));
            let style = text_style(TEXT, HPos::Left, VPos::Bottom);
            // Where the axis of all panels begins.
            head.draw(&Text::new(
                panel.heading.clone(),
                (offset(74), offset(HEAD)),
                style,
            ))?;
            draw(&body, panel, foot > 0, &names)?;
            rest = after;
        }
        Ok(())
    })
}

/// Room below a panel: none if the next one has the same axis to the right.
fn foot(panels: &[Told], i: usize) -> u32 {
    match (panels.get(i), panels.get(i + 1)) {
        (Some(here), Some(next)) if here.x == next.x && here.x.range.is_some() => 0,
        _ => FOOT,
    }
}

fn draw(area: &Area, told: &Told, numbered: bool, names: &[&str]) -> Drawn {
    let values = |pick: fn(&(f64, f64)) -> f64| {
        let points = told.series.iter().flat_map(|series| &series.points);
        points.map(pick)
    };
    let at = |marks: &[Mark]| marks.iter().map(|mark| mark.at).collect::<Vec<_>>();
    let mut plot = Panel {
        x: axis(&told.x, values(|p| p.0).chain(at(&told.bounds)), true),
        y: axis(&told.y, values(|p| p.1).chain(at(&told.levels)), false),
        x_title: numbered.then_some(told.x.label),
        y_title: told.y.label,
        right: NAMES,
    }
    .on(area)?;
    plot.grid()?;
    levels(&mut plot, &told.levels)?;
    bounds(&mut plot, &told.bounds)?;
    for (i, series) in told.series.iter().enumerate() {
        // A line behind others is wider, so that it is seen where they agree.
        let width = if i == 0 && told.series.len() > 1 {
            10
        } else {
            5
        };
        line(&mut plot, series, ink(names, series).1, width)?;
    }
    Ok(())
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

/// Dashed, each with its name at the right edge.
fn levels(plot: &mut Plot, levels: &[Mark]) -> Drawn {
    let style = text_style(TEXT, HPos::Left, VPos::Center);
    for level in levels {
        plot.across(level.at, LEVEL, 5)?;
        let edge = plot.x().high();
        plot.text((edge, level.at), (offset(8), 0), &level.name, &style)?;
    }
    Ok(())
}

/// Dashed, each with its name at its foot.
fn bounds(plot: &mut Plot, bounds: &[Mark]) -> Drawn {
    for bound in bounds {
        let (low, high) = (plot.y().low(), plot.y().high());
        let ends = [Point::new(bound.at, low), Point::new(bound.at, high)];
        plot.line(&ends, LEVEL, 5)?;
        let left = plot.x().place(bound.at) < 0.6;
        let (side, away) = if left {
            (HPos::Left, offset(8))
        } else {
            (HPos::Right, -offset(8))
        };
        let style = text_style(TEXT, side, VPos::Center);
        plot.text(
            (bound.at, f64::midpoint(low, high)),
            (away, 0),
            &bound.name,
            &style,
        )?;
    }
    Ok(())
}

fn line(plot: &mut Plot, series: &Series, ink: Ink, width: u32) -> Drawn {
    let (low, high) = (plot.x().low(), plot.x().high());
    let points: Vec<Point> = series
        .points
        .iter()
        .filter(|(x, y)| (low..=high).contains(x) && y.is_finite())
        .map(|(x, y)| Point::new(*x, *y))
        .collect();
    plot.line(&points, ink, width)?;
    if series.dotted {
        for point in &points {
            plot.mark((point.x, point.y), EventKind::Stick, ink)?;
        }
    }
    Ok(())
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

fn ink(names: &[&str], series: &Series) -> (&'static str, Ink) {
    let place = names.iter().position(|name| *name == series.name);
    INKS[place.unwrap_or(0) % INKS.len()]
}

fn legend(story: &Story) -> Vec<Key> {
    names(story)
        .into_iter()
        .zip(INKS.iter().cycle())
        .map(|(name, (ink, _))| Key::new(Sign::Line(ink), name))
        .collect()
}

fn offset(pixels: u32) -> i32 {
    i32::try_from(px(pixels)).unwrap_or(0)
}
