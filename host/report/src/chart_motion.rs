//! Angle and speed of the shaft over the whole run.

use crate::ReportError;
use crate::axis::Axis;
use crate::canvas::{Panel, px, svg};
use crate::collector::Figures;
use crate::figure::{Chart, Figure, Key, Sign};
use crate::number::{count, rounded};
use crate::palette::{ENCODER, OBJECT, SHAFT};
use crate::thinned::Point;

const ANGLE_HEIGHT: u32 = 190;
const SPEED_HEIGHT: u32 = 235;

/// From rad to degrees, of y.
pub(crate) fn degrees(points: &[Point]) -> Vec<Point> {
    points
        .iter()
        .map(|point| Point::new(point.x, point.y.to_degrees()))
        .collect()
}

/// The time of all points, with about eight ticks.
pub(crate) fn time_axis(points: &[Point]) -> Axis {
    match (points.first(), points.last()) {
        (Some(first), Some(last)) => Axis::linear(first.x, last.x, 8),
        _ => Axis::linear(0.0, 1.0, 8),
    }
}

pub(crate) fn figure(figures: &Figures) -> Result<Option<Figure>, ReportError> {
    if figures.angle.is_empty() && figures.omega.is_empty() {
        return Ok(None);
    }
    let angle = degrees(&figures.angle.points());
    let speed = degrees(&figures.omega.points());
    let encoder = degrees(&figures.encoder_omega.points());
    let time = time_axis(if angle.is_empty() { &speed } else { &angle });

    let height = ANGLE_HEIGHT + SPEED_HEIGHT;
    let svg = svg(
        (960, height),
        "Shaft angle and shaft speed over the whole run",
        |area| {
            let (above, below) = area.split_vertically(px(ANGLE_HEIGHT));
            let mut plot = Panel {
                x: time.clone(),
                y: Axis::covering(angle.iter().map(|p| p.y), 5),
                x_title: None,
                y_title: "Angle (°)",
                right: 16,
            }
            .on(&above)?;
            plot.grid()?;
            plot.line(&angle, OBJECT, 7)?;
            let mut plot = Panel {
                x: time,
                // With zero: a steady speed should look steady.
                y: Axis::covering(speed.iter().chain(&encoder).map(|p| p.y).chain([0.0]), 5),
                x_title: Some("Time (s)"),
                y_title: "Speed (°/s)",
                right: 16,
            }
            .on(&below)?;
            plot.grid()?;
            // Wider, so that it shows even where it is exact.
            plot.line(&encoder, ENCODER, 12)?;
            plot.line(&speed, SHAFT, 6)
        },
    )?;

    let mut legend = vec![
        Key::new(Sign::Line("object"), "shaft angle φ"),
        Key::new(Sign::Line("shaft"), "shaft speed Ω"),
    ];
    let (low, high) = crate::axis::extent(speed.iter().map(|p| p.y));
    let (low, high) = (rounded(low), rounded(high));
    let speeds = if low == high {
        format!("The speed is {low} °/s throughout.")
    } else {
        format!("The speed ranges from {low} to {high} °/s.")
    };
    let mut caption = format!(
        "The motion of the joint over all {} rows; growing angle is flexion. {speeds}",
        count(figures.rows),
    );
    if !encoder.is_empty() {
        legend.push(Key::new(Sign::Line("encoder"), "speed by the encoder"));
        caption.push_str(
            " The wide line behind the true speed is the encoder's estimate: where it \
             strays, that is quantisation and delay.",
        );
    }
    Ok(Some(Figure {
        name: "motion",
        title: "Motion",
        legend,
        charts: vec![Chart {
            heading: None,
            svg,
            half: false,
        }],
        caption,
    }))
}
