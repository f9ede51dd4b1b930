//! Figure of the measured and the simulated angle of each swing, with the residual.

use crepitus_identify::brace::{Brace, Trace, TracePoint};
use crepitus_pages::plot::palette::{OBJECT, SHAFT};
use crepitus_pages::plot::{Axis, Chart, Figure, Key, Panel, Point, Sign, stack};

/// Width and heights, CSS pixels.
const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 220.0;
const LOW_HEIGHT: f64 = 170.0;

/// Room for a heading.
const HEAD: f64 = 30.0;

/// Most swings that are drawn.
const MOST: usize = 6;

/// Draws angle and residual of the first swings, one below the other.
pub(super) fn figure(brace: &Brace) -> Figure {
    let traces: Vec<_> = (brace.traces().take(MOST).enumerate())
        .map(|(at, trace)| {
            let heading = format!("Swing {} · recording {}", at + 1, trace.recording + 1);
            (heading, trace)
        })
        .collect();
    let panels = (traces.iter())
        .flat_map(|(heading, trace)| panels(trace, heading))
        .collect();
    let svg = stack(
        WIDTH,
        "Angle of each swing against time, measured and simulated, and the residual",
        panels,
    );
    Figure {
        name: "residual",
        title: "The swings, and what the fit leaves of them",
        legend: vec![
            Key::new(Sign::Line(OBJECT), "measured by the encoder; residual"),
            Key::new(Sign::Line(SHAFT), "simulated with the identified values"),
        ],
        charts: vec![Chart::full(svg)],
        caption: "Angle of the motor's shaft from where the weight hangs. A residual without shape is noise; one that grows \
                  at the turning points is backlash or friction that is otherwise than assumed; one that rings is a \
                  second mass on a spring, such as the bench."
            .to_owned(),
    }
}

/// Angle and residual of a swing.
fn panels<'h>(trace: &Trace, heading: &'h str) -> Vec<Panel<'h>> {
    let points = |of: &dyn Fn(&TracePoint) -> f64| -> Vec<Point> {
        let degrees = (trace.points.iter()).map(|t| Point::new(t.time_s, of(t).to_degrees()));
        degrees.collect()
    };
    let measured = points(&|t| t.measured_rad);
    let simulated = points(&|t| t.measured_rad - t.residual_rad);
    let residual = points(&|t| t.residual_rad);
    let (first, last) = (trace.points.first(), trace.points.last());
    let (from, to) = (
        first.map_or(0.0, |t| t.time_s),
        last.map_or(1.0, |t| t.time_s),
    );
    let x = || Axis::linear(from, to, 8);
    let angles = Axis::covering(measured.iter().map(|p| p.y), 4);
    let rest = Axis::covering(residual.iter().map(|p| p.y), 4);
    vec![
        Panel::new(HEIGHT, x(), ("Angle (°)", angles), move |plot| {
            plot.grid();
            plot.line(&measured, OBJECT, 2.5);
            plot.line(&simulated, SHAFT, 1.25);
        })
        .head(HEAD, Some(heading)),
        Panel::new(LOW_HEIGHT, x(), ("Residual (°)", rest), move |plot| {
            plot.grid();
            plot.line(&residual, OBJECT, 1.0);
        })
        .head(12.0, None)
        .x_title(Some("Time in the recording (s)")),
    ]
}
