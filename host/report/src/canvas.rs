//! Drawing on one chart: what plotters offers, in the page's inks, fonts and
//! scale.
//!
//! Plotters works on whole numbers. A chart is drawn on a grid four times as
//! fine as its nominal size in CSS pixels, so that curves are smooth.

use std::io;

use crepitus_model::EventKind;
use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::element::{EmptyElement, PathElement, Polygon, Rectangle, Text};
use plotters::prelude::{ChartBuilder, DrawingArea, IntoDrawingArea, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, ShapeStyle, TextStyle};

use crate::ReportError;
use crate::axis::Axis;
use crate::escape::escaped;
use crate::palette::{AXIS, GRID, Ink, PAPER, TEXT};
use crate::simplify::simplify;
use crate::thinned::Point;

/// Grid lines per CSS pixel.
const SCALE: u32 = 4;
/// Size of the text, CSS pixels.
const TEXT_SIZE: u32 = 15;

pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(crate) type Fault = DrawingAreaErrorKind<io::Error>;
pub(crate) type Drawn = Result<(), Fault>;

/// CSS pixels as grid lines.
pub(crate) fn px(pixels: u32) -> u32 {
    pixels * SCALE
}

/// Draws an SVG element of this nominal size; `label` is read out to those
/// who cannot see it.
pub(crate) fn svg(
    (width, height): (u32, u32),
    label: &str,
    draw: impl FnOnce(&Area) -> Drawn,
) -> Result<String, ReportError> {
    svg_with((width, height), label, |area| {
        draw(area).map(|()| String::new())
    })
}

/// As [`svg`], with elements over the drawing that the drawing library has no
/// word for. They are in grid lines and end as they are.
pub(crate) fn svg_with(
    (width, height): (u32, u32),
    label: &str,
    draw: impl FnOnce(&Area) -> Result<String, Fault>,
) -> Result<String, ReportError> {
    let mut raw = String::new();
    let over;
    {
        let area = SVGBackend::with_string(&mut raw, (px(width), px(height))).into_drawing_area();
        over = draw(&area)
            .and_then(|over| area.present().map(|()| over))
            .map_err(|fault| ReportError::Draw {
                chart: label.to_owned(),
                reason: fault.to_string(),
            })?;
    }
    // The opening tag is replaced: the page sets the size, and an element
    // inside HTML needs no namespace. Then what every element repeats goes.
    let body = raw.split_once('>').map_or("", |(_, body)| body);
    let body = body
        .replace(" opacity=\"1\"", "")
        .replace(" stroke=\"none\"", "")
        .replace(" font-family=\"sans-serif\"", "")
        .replace(" \"/>", "\"/>");
    let body = body.trim_end().strip_suffix("</svg>").unwrap_or(&body);
    Ok(format!(
        "<svg role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {} {}\" \
         style=\"--nominal:{width}px\">{body}{over}</svg>\n",
        escaped(label),
        px(width),
        px(height),
    ))
}

pub(crate) fn text_style(ink: Ink, horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    // Plotters writes font sizes divided by 1.24.
    let size = f64::from(px(TEXT_SIZE)) * 1.24;
    TextStyle {
        font: ("sans-serif", size).into(),
        color: ink.marker().to_backend_color(),
        pos: Pos::new(horizontal, vertical),
    }
}

/// One pair of axes.
pub(crate) struct Panel<'t> {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// `None`: a panel below has the same axis, and its numbers.
    pub(crate) x_title: Option<&'t str>,
    pub(crate) y_title: &'t str,
    /// Room at the right, CSS pixels.
    pub(crate) right: u32,
}

pub(crate) struct Plot<'p, 'a> {
    chart: ChartContext<'p, SVGBackend<'a>, Cartesian2d<Axis, Axis>>,
    x_title: Option<String>,
    y_title: String,
}

impl Panel<'_> {
    pub(crate) fn on<'p, 'a>(self, area: &'p Area<'a>) -> Result<Plot<'p, 'a>, Fault> {
        let foot = if self.x_title.is_some() { 48 } else { 6 };
        let chart = ChartBuilder::on(area)
            .margin_top(px(10))
            .margin_right(px(self.right))
            .x_label_area_size(px(foot))
            .y_label_area_size(px(74))
            .build_cartesian_2d(self.x, self.y)?;
        Ok(Plot {
            chart,
            x_title: self.x_title.map(str::to_owned),
            y_title: self.y_title.to_owned(),
        })
    }
}

impl Plot<'_, '_> {
    /// Axes, ticks, grid. After the shading, before the lines.
    pub(crate) fn grid(&mut self) -> Drawn {
        let text = text_style(TEXT, HPos::Center, VPos::Center);
        let unlabelled = |_: &f64| String::new();
        let mut mesh = self.chart.configure_mesh();
        mesh.label_style(text.clone())
            .axis_desc_style(text)
            .axis_style(AXIS.marker().stroke_width(px(1)))
            .bold_line_style(GRID.marker().stroke_width(px(1)))
            .set_all_tick_mark_size(px(4))
            .y_desc(self.y_title.clone());
        if let Some(title) = &self.x_title {
            mesh.x_desc(title.clone());
        } else {
            mesh.x_label_formatter(&unlabelled);
        }
        mesh.draw()
    }

    /// Where a point stands, in grid lines of the whole drawing.
    pub(crate) fn at(&self, point: (f64, f64)) -> (i32, i32) {
        self.chart.backend_coord(&point)
    }

    pub(crate) fn x(&self) -> &Axis {
        self.chart.as_coord_spec().x_spec()
    }

    pub(crate) fn y(&self) -> &Axis {
        self.chart.as_coord_spec().y_spec()
    }

    /// A filled rectangle between two corners.
    pub(crate) fn fill(&mut self, from: (f64, f64), to: (f64, f64), ink: Ink) -> Drawn {
        let rectangle = Rectangle::new([from, to], ink.marker().filled());
        self.chart.draw_series([rectangle]).map(|_| ())
    }

    /// A filled stretch of x over the full height.
    pub(crate) fn shade(&mut self, from: f64, to: f64, ink: Ink) -> Drawn {
        let (low, high) = (self.y().low(), self.y().high());
        self.fill((from, low), (to, high), ink)
    }

    /// A line through the points, `width` in quarters of a CSS pixel.
    pub(crate) fn line(&mut self, points: &[Point], ink: Ink, width: u32) -> Drawn {
        let path = self.visible(points);
        if path.len() < 2 {
            return Ok(());
        }
        self.chart
            .draw_series([PathElement::new(path, stroke(ink, width))])
            .map(|_| ())
    }

    /// A filled band between a lower and an upper line.
    pub(crate) fn band(&mut self, lower: &[Point], upper: &[Point], ink: Ink) -> Drawn {
        self.polygon(lower, upper, ink.marker().filled())
    }

    /// A band that lets others show through.
    pub(crate) fn veil(&mut self, lower: &[Point], upper: &[Point], ink: Ink) -> Drawn {
        self.polygon(lower, upper, ink.marker().mix(0.25).filled())
    }

    fn polygon(&mut self, lower: &[Point], upper: &[Point], style: ShapeStyle) -> Drawn {
        let mut outline = self.visible(lower);
        outline.extend(self.visible(upper).into_iter().rev());
        if outline.len() < 3 {
            return Ok(());
        }
        self.chart
            .draw_series([Polygon::new(outline, style)])
            .map(|_| ())
    }

    /// The points that can be seen to matter.
    fn visible(&self, points: &[Point]) -> Vec<(f64, f64)> {
        let grid: Vec<(i32, i32)> = points
            .iter()
            .map(|point| self.chart.backend_coord(&(point.x, point.y)))
            .collect();
        let mut kept = simplify(&grid, 0.15 * f64::from(SCALE))
            .into_iter()
            .peekable();
        let mut path = Vec::new();
        for (point, at) in points.iter().zip(grid) {
            if kept.next_if_eq(&at).is_some() {
                path.push((point.x, point.y));
            }
        }
        path
    }

    /// A line across the panel; the style sheet dashes the ink of levels.
    pub(crate) fn across(&mut self, y: f64, ink: Ink, width: u32) -> Drawn {
        let ends = vec![(self.x().low(), y), (self.x().high(), y)];
        self.chart
            .draw_series([PathElement::new(ends, stroke(ink, width))])
            .map(|_| ())
    }

    pub(crate) fn text(
        &mut self,
        at: (f64, f64),
        offset: (i32, i32),
        text: &str,
        style: &TextStyle<'static>,
    ) -> Drawn {
        let text = Text::new(text.to_owned(), offset, style.clone());
        self.chart
            .draw_series([EmptyElement::at(at) + text])
            .map(|_| ())
    }

    /// A sign for an event: a triangle for a break, a disc for a stick, a
    /// diamond for a reversal, rimmed so that they stand out from the line.
    pub(crate) fn mark(&mut self, at: (f64, f64), kind: EventKind, ink: Ink) -> Drawn {
        for (size, ink) in [(27, PAPER), (20, ink)] {
            let sign = Polygon::new(outline(kind, size), ink.marker().filled());
            self.chart.draw_series([EmptyElement::at(at) + sign])?;
        }
        Ok(())
    }
}

fn stroke(ink: Ink, width: u32) -> ShapeStyle {
    ink.marker().stroke_width(width)
}

fn outline(kind: EventKind, size: i32) -> Vec<(i32, i32)> {
    match kind {
        EventKind::Break => vec![(0, -size), (size, size * 3 / 4), (-size, size * 3 / 4)],
        EventKind::Reverse => vec![(0, -size), (size, 0), (0, size), (-size, 0)],
        EventKind::Stick => {
            // A regular figure of many corners: elements must be of one kind.
            let (near, far) = (size * 4 / 10, size * 9 / 10);
            vec![
                (near, far),
                (far, near),
                (far, -near),
                (near, -far),
                (-near, -far),
                (-far, -near),
                (-far, near),
                (-near, far),
            ]
        }
    }
}
