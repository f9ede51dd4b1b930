//! Angle and speed of the shaft over the whole run, and of leg and hand where
//! they move on their own.

use crate::plot::number::{count, rounded};
use crate::plot::palette::{ENCODER, LEVEL, OBJECT, SHAFT};
use crate::plot::{Axis, Chart, Figure, Key, Panel, Paper, Plot, Point, Sign, Stroke, stack};

use crate::report::collector::Figures;
use crate::report::plant::{Follower, LEG};

const HEIGHT: f64 = 190.0;
/// Height that the numbers of the time add to a panel.
const FOOT: f64 = 45.0;

/// Converts y from rad to degrees.
pub(crate) fn degrees(points: &[Point]) -> Vec<Point> {
    points
        .iter()
        .map(|point| Point::new(point.x, point.y.to_degrees()))
        .collect()
}

/// The time of all points and of what is missing, with about eight ticks.
pub(crate) fn time_axis(figures: &Figures, points: &[Point]) -> Axis {
    let (mut from, mut to) = match (points.first(), points.last()) {
        (Some(first), Some(last)) => (first.x, last.x),
        _ => (0.0, 1.0),
    };
    for (gap_from, gap_to) in &figures.gaps {
        (from, to) = (from.min(*gap_from), to.max(*gap_to));
    }
    Axis::linear(from, to, 8)
}

/// Lines of a [`Follower`], which moves beside the shaft, in degrees.
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

pub(crate) fn figure(figures: &Figures, paper: Paper) -> Option<Figure> {
    if figures.angle.is_empty() && figures.omega.is_empty() {
        return None;
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
    let label = if beside {
        "Angle and speed of shaft and leg over the whole run"
    } else {
        "Shaft angle and shaft speed over the whole run"
    };
    let svg = stack(paper.width(960.0), label, panels(figures, &lines, beside));
    let (legend, caption) = words(figures, &lines);
    Some(Figure {
        name: "motion",
        title: "Motion",
        legend,
        charts: vec![Chart::full(svg)],
        caption,
    })
}

fn panels<'f>(figures: &'f Figures, lines: &'f Lines, beside: bool) -> Vec<Panel<'f>> {
    let Lines {
        angle,
        speed,
        encoder,
        leg,
        intended,
    } = lines;
    let axis = |lines: &[&[Point]], also: Option<f64>, ticks| {
        let values = lines.iter().flat_map(|line| line.iter().map(|p| p.y));
        Axis::covering(values.chain(also), ticks)
    };
    let time = time_axis(figures, if angle.is_empty() { speed } else { angle });
    let of_hand = |plot: &mut Plot, line: &[Point]| plot.stroke(line, Stroke::dashed(LEVEL, 1.5));
    let angles = axis(&[angle, &leg.angle, &intended.angle], None, 5);
    let angles = Panel::new(HEIGHT, time.clone(), ("Angle (°)", angles), move |plot| {
        plot.grid();
        plot.line(angle, OBJECT, 1.75);
        plot.line(&leg.angle, LEG, 1.5);
        of_hand(plot, &intended.angle);
        figures.draw_marks(plot);
    });
    let mut panels = vec![angles.moments(figures.marks.clone())];
    // With zero: a steady speed should look steady.
    let speeds = axis(&[speed, encoder, &leg.speed, &intended.speed], Some(0.0), 5);
    let height = if beside { HEIGHT } else { HEIGHT + FOOT };
    let speeds = Panel::new(height, time.clone(), ("Speed (°/s)", speeds), move |plot| {
        plot.grid();
        // Wider, so that it shows even where it is exact.
        plot.line(encoder, ENCODER, 3.0);
        plot.line(speed, SHAFT, 1.5);
        plot.line(&leg.speed, LEG, 1.5);
        of_hand(plot, &intended.speed);
        figures.draw_marks(plot);
    });
    panels.push(speeds.x_title((!beside).then_some("Time (s)")));
    if beside {
        let ahead = axis(&[&leg.ahead, &intended.ahead], Some(0.0), 4);
        let ahead = Panel::new(HEIGHT + 10.0, time, ("Ahead (°)", ahead), move |plot| {
            plot.grid();
            plot.line(&leg.ahead, LEG, 1.5);
            of_hand(plot, &intended.ahead);
            figures.draw_marks(plot);
        });
        panels.push(ahead.x_title(Some("Time (s)")));
    }
    panels
}

fn words(figures: &Figures, lines: &Lines) -> (Vec<Key>, String) {
    let mut legend = vec![
        Key::new(Sign::Line(OBJECT), "shaft angle φ"),
        Key::new(Sign::Line(SHAFT), "shaft speed Ω"),
    ];
    let (low, high) = crate::plot::extent(lines.speed.iter().map(|p| p.y));
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
        legend.push(Key::new(Sign::Line(ENCODER), "speed by the encoder"));
        caption.push_str(
            " The wide line behind the true speed is the encoder's estimate: where it \
             strays, that is quantisation and delay.",
        );
    }
    let (leg, intended) = (lines.leg.is_there(), lines.intended.is_there());
    if leg {
        legend.push(Key::new(Sign::Line(LEG), "leg"));
        caption.push_str(
            " The shaft is that of the motor, behind the gear; the leg moves on its own as far \
             as gear and cuff give.",
        );
    }
    if intended {
        legend.push(Key::new(Sign::Dashed(LEVEL), "intended by the hand"));
        caption.push_str(" The dashed line is the motion that the hand drives the leg toward.");
    }
    if leg || intended {
        caption.push_str(" At the bottom: how far each is ahead of the shaft.");
    }
    if !figures.gaps.is_empty() {
        caption.push_str(" Blank between dotted lines: samples are missing there, or the drive restarted; how long \
             that took is not known.");
    }
    if !figures.marks.is_empty() {
        caption.push_str(
            " Dotted lines: from there on other parameters were in force, or the drive had restarted.",
        );
    }
    (legend, caption)
}
