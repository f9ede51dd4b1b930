//! Angle and speed of the shaft over the whole run, and of leg and hand where
//! they move on their own.

use crate::ReportError;
use crate::axis::Axis;
use crate::canvas::{Area, Drawn, Panel, px, svg};
use crate::collector::Figures;
use crate::figure::{Chart, Figure, Key, Sign};
use crate::number::{count, rounded};
use crate::palette::{ENCODER, LEVEL, OBJECT, SHAFT};
use crate::plant::{Follower, LEG};
use crate::thinned::Point;

const ANGLE_HEIGHT: u32 = 190;
const SPEED_HEIGHT: u32 = 235;
/// Without the numbers of the time.
const SPEED_HEIGHT_ABOVE: u32 = 190;
const AHEAD_HEIGHT: u32 = 200;

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

/// What moves beside the shaft, in degrees.
#[derive(Default)]
struct Beside {
    angle: Vec<Point>,
    speed: Vec<Point>,
    ahead: Vec<Point>,
}

impl Beside {
    fn of(follower: Option<&Follower>) -> Self {
        follower.map_or_else(Self::default, |follower| Self {
            angle: degrees(&follower.angle.points()),
            speed: degrees(&follower.omega.points()),
            ahead: degrees(&follower.ahead.points()),
        })
    }

    fn is_there(&self) -> bool {
        !self.angle.is_empty()
    }
}

/// All lines of the figure, in degrees.
struct Lines {
    angle: Vec<Point>,
    speed: Vec<Point>,
    encoder: Vec<Point>,
    leg: Beside,
    intended: Beside,
}

pub(crate) fn figure(figures: &Figures) -> Result<Option<Figure>, ReportError> {
    if figures.angle.is_empty() && figures.omega.is_empty() {
        return Ok(None);
    }
    let plant = figures.plant.as_ref();
    let lines = Lines {
        angle: degrees(&figures.angle.points()),
        speed: degrees(&figures.omega.points()),
        encoder: degrees(&figures.encoder_omega.points()),
        leg: Beside::of(plant.map(|p| &p.leg)),
        intended: Beside::of(plant.map(|p| &p.intended)),
    };
    let beside = lines.leg.is_there() || lines.intended.is_there();
    let (height, label) = if beside {
        (
            ANGLE_HEIGHT + SPEED_HEIGHT_ABOVE + AHEAD_HEIGHT,
            "Angle and speed of shaft and leg over the whole run",
        )
    } else {
        (
            ANGLE_HEIGHT + SPEED_HEIGHT,
            "Shaft angle and shaft speed over the whole run",
        )
    };
    let svg = svg((960, height), label, |area| draw(area, &lines, beside))?;
    let (legend, caption) = words(figures, &lines);
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

fn draw(area: &Area, lines: &Lines, beside: bool) -> Drawn {
    let Lines {
        angle,
        speed,
        encoder,
        leg,
        intended,
    } = lines;
    let values = |lines: [&[Point]; 3]| -> Vec<f64> {
        lines
            .iter()
            .flat_map(|line| line.iter().map(|p| p.y))
            .collect()
    };
    let time = time_axis(if angle.is_empty() { speed } else { angle });
    let (above, below) = area.split_vertically(px(ANGLE_HEIGHT));
    let mut plot = Panel {
        x: time.clone(),
        y: Axis::covering(values([angle, &leg.angle, &intended.angle]), 5),
        x_title: None,
        y_title: "Angle (°)",
        right: 16,
    }
    .on(&above)?;
    plot.grid()?;
    plot.line(angle, OBJECT, 7)?;
    plot.line(&leg.angle, LEG, 6)?;
    plot.line(&intended.angle, LEVEL, 6)?;

    let (middle, below) = if beside {
        let (middle, below) = below.split_vertically(px(SPEED_HEIGHT_ABOVE));
        (middle, Some(below))
    } else {
        (below, None)
    };
    let mut speeds = values([speed, encoder, &leg.speed]);
    speeds.extend(intended.speed.iter().map(|p| p.y));
    // With zero: a steady speed should look steady.
    speeds.push(0.0);
    let mut plot = Panel {
        x: time.clone(),
        y: Axis::covering(speeds, 5),
        x_title: below.is_none().then_some("Time (s)"),
        y_title: "Speed (°/s)",
        right: 16,
    }
    .on(&middle)?;
    plot.grid()?;
    // Wider, so that it shows even where it is exact.
    plot.line(encoder, ENCODER, 12)?;
    plot.line(speed, SHAFT, 6)?;
    plot.line(&leg.speed, LEG, 6)?;
    plot.line(&intended.speed, LEVEL, 6)?;

    let Some(below) = below else {
        return Ok(());
    };
    let mut plot = Panel {
        x: time,
        y: Axis::covering(
            values([&leg.ahead, &intended.ahead, &[Point::new(0.0, 0.0)]]),
            4,
        ),
        x_title: Some("Time (s)"),
        y_title: "Ahead (°)",
        right: 16,
    }
    .on(&below)?;
    plot.grid()?;
    plot.line(&leg.ahead, LEG, 6)?;
    plot.line(&intended.ahead, LEVEL, 6)
}

fn words(figures: &Figures, lines: &Lines) -> (Vec<Key>, String) {
    let mut legend = vec![
        Key::new(Sign::Line("object"), "shaft angle φ"),
        Key::new(Sign::Line("shaft"), "shaft speed Ω"),
    ];
    let (low, high) = crate::axis::extent(lines.speed.iter().map(|p| p.y));
    let (low, high) = (rounded(low), rounded(high));
    let of_shaft = if figures.plant.is_some() {
        " of the shaft"
    } else {
        ""
    };
    let speeds = if low == high {
        format!("The speed{of_shaft} is {low} °/s throughout.")
    } else {
        format!("The speed{of_shaft} ranges from {low} to {high} °/s.")
    };
    let mut caption = format!(
        "The motion of the joint over all {} rows; growing angle is flexion. {speeds}",
        count(figures.rows),
    );
    if !lines.encoder.is_empty() {
        legend.push(Key::new(Sign::Line("encoder"), "speed by the encoder"));
        caption.push_str(
            " The wide line behind the true speed is the encoder's estimate: where it \
             strays, that is quantisation and delay.",
        );
    }
    let (leg, intended) = (lines.leg.is_there(), lines.intended.is_there());
    if leg {
        legend.push(Key::new(Sign::Line("green"), "leg"));
        caption.push_str(
            " The shaft is that of the motor, behind the gear; the leg moves on its own as far \
             as gear and cuff give.",
        );
    }
    if intended {
        legend.push(Key::new(Sign::Line("level"), "intended by the hand"));
        caption.push_str(" The dashed line is the motion that the hand drives the leg toward.");
    }
    if leg || intended {
        caption.push_str(" At the bottom: how far each is ahead of the shaft.");
    }
    (legend, caption)
}
