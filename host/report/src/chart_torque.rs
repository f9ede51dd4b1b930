//! Torque over the whole run, and the phases.
//!
//! A run of few cycles is drawn line by line. In a run of many a line would
//! be a solid block: there the chart shows the range that the torque covers,
//! its mean, and the share of time that each phase takes.

use crepitus_model::{Phase, Sense};

use crate::ReportError;
use crate::axis::{Axis, extent};
use crate::canvas::{Area, Drawn, Panel, Plot, px, svg};
use crate::chart_motion::time_axis;
use crate::collector::Figures;
use crate::envelope::Bin;
use crate::figure::{Chart, Figure, Key, Sign, phase_keys};
use crate::levels;
use crate::number::{count, rounded};
use crate::palette::{Ink, RANGE, SLIP_NEGATIVE, SLIP_POSITIVE, STICK, TORQUE};
use crate::thinned::Point;
use crate::window::Span;

const HEIGHT: u32 = 330;
const RANGE_HEIGHT: u32 = 270;
const SHARE_HEIGHT: u32 = 120;

pub(crate) fn phase_ink(phase: Phase) -> Ink {
    match phase {
        Phase::Stick => STICK,
        Phase::Slip(Sense::Positive) => SLIP_POSITIVE,
        Phase::Slip(Sense::Negative) => SLIP_NEGATIVE,
    }
}

/// Shades the phases over the full height of a panel.
pub(crate) fn shade(plot: &mut Plot, spans: &[Span]) -> Drawn {
    for span in spans {
        plot.shade(span.from, span.to, phase_ink(span.phase))?;
    }
    Ok(())
}

pub(crate) fn figure(figures: &Figures) -> Result<Option<Figure>, ReportError> {
    if figures.whole.torque.is_empty() {
        return Ok(None);
    }
    let torque = figures.whole.torque.points();
    let (low, high) = extent(torque.iter().map(|p| p.y));
    let breaks = figures.envelope.breaks();
    let numbers = format!(
        "It ranges from {} to {} N·m with a mean of {} N·m; the object {}.",
        rounded(low),
        rounded(high),
        rounded(figures.envelope.mean()),
        match breaks {
            0 => "never broke loose".to_owned(),
            1 => "broke loose once".to_owned(),
            n => format!("broke loose {} times", count(n)),
        }
    );
    let label = "Torque of the joint over the whole run";
    let (svg, mut legend, caption) = if figures.whole.overflowed() {
        (
            svg((960, RANGE_HEIGHT + SHARE_HEIGHT), label, |area| {
                draw_range(area, figures, &torque)
            })?,
            vec![
                Key::new(Sign::Patch("range"), "range of the torque"),
                Key::new(Sign::Line("torque"), "mean torque"),
            ],
            "The torque of the joint; positive torque opposes flexion. There are too \
             many cycles to draw each: the band spans the lowest and the highest torque of \
             each stretch of a few cycles, the line is its mean. The strip below shows how \
             the time of each stretch divides between sticking and slipping.",
        )
    } else {
        (
            svg((960, HEIGHT), label, |area| {
                draw_line(area, figures, &torque)
            })?,
            vec![Key::new(Sign::Line("torque"), "torque")],
            "The torque of the joint; positive torque opposes flexion. The background \
             shows the phase of the imaginary object: where it sticks the torque rises with \
             the angle like that of a spring, where it slips the torque stays at Tk.",
        )
    };
    if figures.has_object {
        legend.extend(phase_keys(figures.envelope.phases()));
    }
    Ok(Some(Figure {
        name: "torque",
        title: if figures.plant.is_some() {
            "Torque of the model"
        } else {
            "Torque"
        },
        legend,
        charts: vec![Chart {
            heading: None,
            svg,
            half: false,
        }],
        caption: format!("{caption} {numbers}"),
    }))
}

fn draw_line(area: &Area, figures: &Figures, torque: &[Point]) -> Drawn {
    let window = &figures.whole;
    let levels = levels::levels_in(figures.levels, torque);
    let mut plot = Panel {
        x: Axis::linear(window.start, window.end, 8),
        y: levels::torque_axis(torque, &levels),
        x_title: Some("Time (s)"),
        y_title: "Torque (N·m)",
        right: levels::ROOM,
    }
    .on(area)?;
    shade(&mut plot, &window.spans(window.start, window.end))?;
    plot.grid()?;
    levels::draw(&mut plot, &levels, HEIGHT)?;
    plot.line(torque, TORQUE, 6)
}

fn draw_range(area: &Area, figures: &Figures, torque: &[Point]) -> Drawn {
    let bins = figures.envelope.cycle_bins();
    // Two points a bin: steps, since extremes belong to the whole bin.
    let edge = |pick: fn(&Bin) -> f64| -> Vec<Point> {
        bins.iter()
            .filter(|bin| bin.low <= bin.high)
            .flat_map(|bin| [bin.start, bin.end].map(|time| Point::new(time, pick(bin))))
            .collect()
    };
    let mean: Vec<Point> = bins
        .iter()
        .map(|bin| Point::new(bin.middle(), bin.mean()))
        .filter(|point| point.y.is_finite())
        .collect();
    let time = time_axis(torque);
    let levels = levels::levels_in(figures.levels, torque);
    let (above, below) = area.split_vertically(px(RANGE_HEIGHT));
    let mut plot = Panel {
        x: time.clone(),
        y: levels::torque_axis(torque, &levels),
        x_title: None,
        y_title: "Torque (N·m)",
        right: levels::ROOM,
    }
    .on(&above)?;
    plot.band(&edge(|bin| bin.low), &edge(|bin| bin.high), RANGE)?;
    plot.grid()?;
    levels::draw(&mut plot, &levels, RANGE_HEIGHT)?;
    plot.line(&mean, TORQUE, 6)?;

    let mut plot = Panel {
        x: time,
        y: Axis::linear(0.0, 100.0, 2),
        x_title: Some("Time (s)"),
        y_title: "Time (%)",
        right: levels::ROOM,
    }
    .on(&below)?;
    draw_shares(&mut plot, &bins)?;
    plot.grid()
}

/// Stick at the bottom, the slips above it.
fn draw_shares(plot: &mut Plot, bins: &[Bin]) -> Drawn {
    let mut floor = Vec::new();
    let mut over_stick = Vec::new();
    let mut over_positive = Vec::new();
    let mut ceiling = Vec::new();
    for bin in bins {
        if let Some(shares) = bin.shares() {
            // Steps, as above.
            for time in [bin.start, bin.end] {
                floor.push(Point::new(time, 0.0));
                over_stick.push(Point::new(time, 100.0 * shares.stick));
                over_positive.push(Point::new(time, 100.0 * (shares.stick + shares.positive)));
                ceiling.push(Point::new(time, 100.0));
            }
        }
    }
    plot.band(&floor, &over_stick, STICK)?;
    plot.band(&over_stick, &over_positive, SLIP_POSITIVE)?;
    plot.band(&over_positive, &ceiling, SLIP_NEGATIVE)
}
