//! Torque over the whole run, and the phases.
//!
//! A run of few cycles is drawn line by line. In a run of many a line would
//! be a solid block: there the chart shows the range that the torque covers,
//! its mean, and the share of time that each phase takes.

use crate::plot::number::{count, rounded};
use crate::plot::palette::{RANGE, SLIP_NEGATIVE, SLIP_POSITIVE, STICK, TORQUE};
use crate::plot::{Axis, Chart, Figure, Key, Panel, Paper, Plot, Point, Sign, extent, stack};

use crate::report::chart_motion::time_axis;
use crate::report::collector::Figures;
use crate::report::envelope::{Bin, edges};
use crate::report::levels;
use crate::report::phases::{self, shade};

const HEIGHT: f64 = 330.0;
const RANGE_HEIGHT: f64 = 270.0;
const SHARE_HEIGHT: f64 = 120.0;

pub(crate) fn figure(figures: &Figures, paper: Paper) -> Option<Figure> {
    if figures.whole.torque.is_empty() {
        return None;
    }
    let torque = figures.whole.torque.points();
    let (low, high) = extent(torque.iter().map(|p| p.y));
    let object = if figures.has_object {
        format!("; the object {}", breaks(figures.envelope.breaks()))
    } else {
        String::new()
    };
    let numbers = format!(
        "It ranges from {} to {} N·m with a mean of {} N·m{object}.",
        rounded(low),
        rounded(high),
        rounded(figures.envelope.mean()),
    );
    let label = "Torque of the joint over the whole run";
    let (panels, mut legend, caption) = if figures.whole.overflowed() {
        (
            range(figures, &torque),
            vec![
                Key::new(Sign::Patch(RANGE), "range of the torque"),
                Key::new(Sign::Line(TORQUE), "mean torque"),
            ],
            "The torque of the joint; positive torque opposes flexion. There are too \
             many cycles to draw each: the band spans the lowest and the highest torque of \
             each stretch of a few cycles, the line is its mean. The strip below shows how \
             the time of each stretch divides between sticking and slipping.",
        )
    } else {
        (
            vec![line(figures, &torque)],
            vec![Key::new(Sign::Line(TORQUE), "torque")],
            if figures.has_object {
                "The torque of the joint; positive torque opposes flexion. The background \
                 shows the phase of the imaginary object: where it sticks the torque rises with \
                 the angle like that of a spring, where it slips the torque stays at Tk."
            } else {
                "The torque of the joint; positive torque opposes flexion."
            },
        )
    };
    if figures.has_object {
        legend.extend(phases::keys(figures.envelope.phases()));
    }
    Some(Figure {
        name: "torque",
        title: if figures.plant.is_some() {
            "Torque of the model"
        } else {
            "Torque"
        },
        legend,
        charts: vec![Chart::full(stack(paper.width(960.0), label, panels))],
        caption: format!("{caption} {numbers}"),
    })
}

/// Number of times that the object broke loose, in words.
fn breaks(number: u64) -> String {
    match number {
        0 => "never broke loose".to_owned(),
        1 => "broke loose once".to_owned(),
        n => format!("broke loose {} times", count(n)),
    }
}

fn line<'f>(figures: &'f Figures, torque: &'f [Point]) -> Panel<'f> {
    let window = &figures.whole;
    let levels = levels::levels_in(figures.levels, torque);
    let y = levels::torque_axis(torque, &levels);
    let names = levels::names(&y, &levels, HEIGHT);
    let ends = [window.time.low, window.time.high].map(|time| Point::new(time, 0.0));
    let time = time_axis(figures, &ends);
    let panel = Panel::new(HEIGHT, time, ("Torque (N·m)", y), move |plot| {
        shade(plot, &window.spans(window.time.low, window.time.high));
        plot.grid();
        levels::draw(plot, &levels);
        plot.line(torque, TORQUE, 1.5);
        figures.draw_marks(plot);
    });
    panel
        .x_title(Some("Time (s)"))
        .names(names)
        .right(levels::ROOM)
        .moments(figures.marks.clone())
}

fn range<'f>(figures: &'f Figures, torque: &[Point]) -> Vec<Panel<'f>> {
    let bins = figures.envelope.cycle_bins();
    let mean: Vec<Point> = bins
        .iter()
        .map(|bin| Point::new(bin.middle(), bin.mean()))
        .filter(|point| point.y.is_finite())
        .collect();
    let time = time_axis(figures, torque);
    let levels = levels::levels_in(figures.levels, torque);
    let y = levels::torque_axis(torque, &levels);
    let names = levels::names(&y, &levels, RANGE_HEIGHT);
    let [low, high] = edges(&bins);
    let above = Panel::new(
        RANGE_HEIGHT,
        time.clone(),
        ("Torque (N·m)", y),
        move |plot| {
            plot.band(&low, &high, RANGE, 1.0);
            plot.grid();
            levels::draw(plot, &levels);
            plot.line(&mean, TORQUE, 1.5);
            figures.draw_marks(plot);
        },
    );
    let below = Panel::new(
        SHARE_HEIGHT,
        time,
        ("Time (%)", Axis::linear(0.0, 100.0, 2)),
        move |plot| {
            draw_shares(plot, &bins);
            plot.grid();
            figures.draw_marks(plot);
        },
    );
    vec![
        above
            .names(names)
            .right(levels::ROOM)
            .moments(figures.marks.clone()),
        below.x_title(Some("Time (s)")),
    ]
}

/// Stick at the bottom, the slips above it; nothing where there was no object.
fn draw_shares(plot: &mut Plot, bins: &[Bin]) {
    let known = bins.split(|bin| bin.shares().is_none());
    for bins in known.filter(|bins| !bins.is_empty()) {
        draw_known_shares(plot, bins);
    }
}

fn draw_known_shares(plot: &mut Plot, bins: &[Bin]) {
    let mut floor = Vec::new();
    let mut over_stick = Vec::new();
    let mut over_positive = Vec::new();
    let mut ceiling = Vec::new();
    for bin in bins {
        if let Some(shares) = bin.shares() {
            // Steps, as above.
            for time in bin.ends() {
                floor.push(Point::new(time, 0.0));
                over_stick.push(Point::new(time, 100.0 * shares.stick));
                over_positive.push(Point::new(time, 100.0 * (shares.stick + shares.positive)));
                ceiling.push(Point::new(time, 100.0));
            }
        }
    }
    plot.band(&floor, &over_stick, STICK, 1.0);
    plot.band(&over_stick, &over_positive, SLIP_POSITIVE, 1.0);
    plot.band(&over_positive, &ceiling, SLIP_NEGATIVE, 1.0);
}
