//! Figure of the measured and the fitted impedance, with the residual.

use crepitus_identify::actuator::{Actuator, ImpedancePoint};
use crepitus_pages::plot::number::rounded;
use crepitus_pages::plot::palette::{OBJECT, SHAFT};
use crepitus_pages::plot::{Axis, Chart, Figure, Key, Panel, Point, Sign, stack};

/// Width and heights, CSS pixels.
const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 240.0;
const LOW_HEIGHT: f64 = 190.0;

/// Draws magnitude, phase and residual.
pub(super) fn figure(actuator: &Actuator) -> Figure {
    let all: Vec<_> = actuator.impedance_points().collect();
    let points = |of: &dyn Fn(&ImpedancePoint) -> f64| -> Vec<Point> {
        (all.iter()
            .map(|point| Point::new(point.frequency_hz, of(point))))
        .collect()
    };
    let measured_ohm = points(&|point| point.measured_ohm.norm());
    let fitted_ohm = points(&|point| point.fitted_ohm.norm());
    let measured_degrees = points(&|point| point.measured_ohm.arg().to_degrees());
    let fitted_degrees = points(&|point| point.fitted_ohm.arg().to_degrees());
    // Line by line: between means, the curvature of the hump would show.
    let residual: Vec<Point> = (actuator.misfits())
        .map(|(hz, share)| Point::new(hz, 100.0 * share))
        .collect();
    let frequencies = || {
        let (first, last) = (measured_ohm.first(), measured_ohm.last());
        let hz = |point: Option<&Point>, otherwise| point.map_or(otherwise, |point| point.x);
        Axis::one_two_five(hz(first, 8.0), hz(last, 500.0))
    };
    let pair = |measured: &[Point], fitted: &[Point], title: &'static str, height: f64| {
        let all = measured.iter().chain(fitted).map(|point| point.y);
        let y = Axis::covering(all, 4);
        let (measured, fitted) = (measured.to_vec(), fitted.to_vec());
        Panel::new(height, frequencies(), (title, y), move |plot| {
            plot.grid();
            plot.line(&measured, OBJECT, 2.5);
            plot.line(&fitted, SHAFT, 1.25);
        })
    };
    let greatest = residual.iter().map(|point| point.y).fold(0.01, f64::max);
    let svg = stack(
        WIDTH,
        "Impedance of the coil against frequency: magnitude, phase, and what the fit leaves",
        vec![
            pair(&measured_ohm, &fitted_ohm, "|Z| (Ω)", HEIGHT).head(8.0, None),
            pair(&measured_degrees, &fitted_degrees, "Phase (°)", LOW_HEIGHT).head(12.0, None),
            Panel::new(
                LOW_HEIGHT,
                frequencies(),
                ("Residual (%)", Axis::linear(0.0, 1.1 * greatest, 4)),
                |plot| {
                    plot.grid();
                    plot.line(&residual, OBJECT, 1.25);
                },
            )
            .head(12.0, None)
            .x_title(Some("Frequency (Hz)")),
        ],
    );
    Figure {
        name: "impedance",
        title: "Impedance of the coil",
        legend: vec![
            Key::new(Sign::Line(OBJECT), "measured, means of a 24th of an octave"),
            Key::new(Sign::Line(SHAFT), "fitted"),
        ],
        charts: vec![Chart::full(svg)],
        caption: format!(
            "The hump at {} Hz is what the moving mass induces in the coil. A residual without shape is noise; a \
             second hump is a ring that moves; a residual that grows with the amplitude is a mass at its stops.",
            rounded(actuator.resonance_hz.value)
        ),
    }
}
