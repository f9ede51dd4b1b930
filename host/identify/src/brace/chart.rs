//! Measured and simulated angle of each swing, and what is left between them, as a figure.

use crate::brace::Brace;
use crate::brace::fit::RESIDUAL_S;
use crepitus_plot::palette::{OBJECT, SHAFT};
use crepitus_plot::{Axis, Chart, Figure, Key, Panel, Point, Sign, stack};

/// Width and heights, CSS pixels.
const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 220.0;
const LOW_HEIGHT: f64 = 170.0;

/// Swings that are drawn.
const MOST: usize = 6;

/// The figure: a chart for each of the first six swings.
pub fn figure(brace: &Brace) -> Figure {
    let charts = (0..brace.swings.len().min(MOST)).map(|swing| chart(brace, swing));
    Figure {
        name: "residual",
        title: "The swings, and what the fit leaves of them",
        legend: vec![
            Key::new(Sign::Line(OBJECT), "measured by the encoder"),
            Key::new(Sign::Line(SHAFT), "simulated with the identified values"),
        ],
        charts: charts.collect(),
        caption: "Angle of the motor's shaft from where the weight hangs. A residual without shape is noise; one that grows \
                  at the turning points is backlash or friction that is otherwise than assumed; one that rings is a \
                  second mass on a spring, such as the bench."
            .to_owned(),
    }
}

fn chart(brace: &Brace, at: usize) -> Chart {
    let swing = &brace.swings[at];
    let hang = (brace.fit.hangs_rad.get(swing.recording))
        .copied()
        .unwrap_or(0.0);
    let stride = swing
        .angles_rad
        .len()
        .div_ceil(brace.fit.residuals[at].len().max(1))
        .max(1);
    let time_s = |i: usize| swing.begins_s + i as f64 * RESIDUAL_S;
    let measured_rad = swing.angles_rad.iter().step_by(stride);
    let triples: Vec<(f64, f64, f64)> = measured_rad
        .zip(&brace.fit.residuals[at])
        .enumerate()
        .filter(|(_, (_, residual))| !residual.is_nan())
        .map(|(i, (angle, residual))| (time_s(i), angle - hang, *residual))
        .collect();
    let points = |of: &dyn Fn(&(f64, f64, f64)) -> f64| -> Vec<Point> {
        triples
            .iter()
            .map(|t| Point::new(t.0, of(t).to_degrees()))
            .collect()
    };
    let measured = points(&|t| t.1);
    let simulated = points(&|t| t.1 - t.2);
    let residual = points(&|t| t.2);
    let (first, last) = (triples.first(), triples.last());
    let (from, to) = (first.map_or(0.0, |t| t.0), last.map_or(1.0, |t| t.0));
    let x = || Axis::linear(from, to, 8);
    let angles = Axis::covering(measured.iter().map(|p| p.y), 4);
    let rest = Axis::covering(residual.iter().map(|p| p.y), 4);
    let svg = stack(
        WIDTH,
        "Angle of a swing against time, measured and simulated, and the residual",
        vec![
            Panel::new(HEIGHT, x(), ("Angle (°)", angles), move |plot| {
                plot.grid();
                plot.line(&measured, OBJECT, 2.5);
                plot.line(&simulated, SHAFT, 1.25);
            })
            .head(8.0, None),
            Panel::new(LOW_HEIGHT, x(), ("Residual (°)", rest), move |plot| {
                plot.grid();
                plot.line(&residual, OBJECT, 1.0);
            })
            .head(12.0, None)
            .x_title(Some("Time in the recording (s)")),
        ],
    );
    let mut chart = Chart::full(svg);
    chart.heading = Some(format!(
        "Swing {} · recording {}",
        at + 1,
        swing.recording + 1
    ));
    chart
}
