//! Laws as signs between two logarithmic axes, with their names at the right.

use crepitus_pages::plot::labels::{LINE, spread};
use crepitus_pages::plot::palette::{LEVEL, TEXT};
use crepitus_pages::plot::{
    Anchor, Axis, CurveStyle, Drawing, Frame, Panel, Paper, Plot, Stroke, Svg, stack,
};

/// CSS pixels.
const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 460.0;
/// Room for the sign before a name, CSS pixels.
const SIGN: f64 = 14.0;

/// A law.
#[derive(Clone, Debug)]
pub(super) struct Spot {
    /// Place among the laws of the study, which gives its style.
    pub(super) place: usize,
    pub(super) name: &'static str,
    pub(super) at: (f64, f64),
    /// Ends of the bar to the right.
    pub(super) wide: (f64, f64),
    /// Ends of the bar upwards.
    pub(super) high: (f64, f64),
    /// Shown under the pointer.
    pub(super) title: String,
}

/// A chart.
pub(super) struct Spots<'a> {
    pub(super) signs: &'a [Spot],
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) x_title: &'a str,
    pub(super) y_title: &'a str,
    pub(super) label: &'a str,
    /// Whether a dashed line shows where both axes have the same number.
    pub(super) has_diagonal: bool,
}

impl Spots<'_> {
    /// The drawing.
    pub(super) fn draw(self, paper: Paper) -> Svg {
        let spots = self.signs;
        let names = spots.iter().map(|spot| Drawing::label_width(spot.name));
        let room = names.fold(0.0, f64::max) + SIGN + 12.0;
        let panel = Panel::new(HEIGHT, self.x, (self.y_title, self.y), |plot| {
            plot.grid();
            if self.has_diagonal {
                diagonal(plot);
            }
            names_of(plot, spots);
            for spot in spots {
                sign(plot, spot);
            }
        })
        .x_title(Some(self.x_title))
        .right(room);
        stack(paper.wide(WIDTH), self.label, vec![panel])
    }
}

fn diagonal(plot: &mut Plot) {
    let low = plot.x().low().max(plot.y().low());
    let high = plot.x().high().min(plot.y().high());
    if low < high {
        let ends = [plot.at((low, low)), plot.at((high, high))];
        plot.over.line(&ends, Stroke::dashed(LEVEL, 1.25));
    }
}

fn sign(plot: &mut Plot, spot: &Spot) {
    let style = CurveStyle::of(spot.place);
    let (x, y) = spot.at;
    let stroke = Stroke::new(style.ink, 1.25);
    for (from, to) in [
        ((spot.wide.0, y), (spot.wide.1, y)),
        ((x, spot.high.0), (x, spot.high.1)),
    ] {
        let ends = [plot.at(from), plot.at(to)];
        if from != to {
            plot.over.line(&ends, stroke);
        }
    }
    let at = plot.at(spot.at);
    plot.over.marker(at, style, true, &spot.title);
}

/// Draws the names in a column at the right, each behind its sign, in the order of the errors.
/// (Lines to the signs would cross where many laws are as bad.)
fn names_of(plot: &mut Plot, spots: &[Spot]) {
    let Frame {
        right, top, bottom, ..
    } = plot.frame();
    let mut ends: Vec<_> = spots.iter().map(|spot| (plot.at(spot.at), spot)).collect();
    ends.sort_by(|((ax, ay), _), ((bx, by), _)| ay.total_cmp(by).then(ax.total_cmp(bx)));
    let wishes: Vec<f64> = ends.iter().map(|((_, y), _)| *y).collect();
    let Some(heights) = spread(&wishes, top, bottom.max(top + LINE)) else {
        return;
    };
    for ((_, spot), height) in ends.iter().zip(&heights) {
        let (sign, name) = (right + 12.0, right + 12.0 + SIGN);
        let style = CurveStyle::of(spot.place);
        plot.over.marker((sign, *height), style, true, "");
        plot.over
            .label((name, *height), Anchor::Start, TEXT, spot.name);
    }
}
