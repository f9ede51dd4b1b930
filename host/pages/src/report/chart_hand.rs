//! Torque at the hand over the whole run: the torque that a force sensor on
//! the leg shows, and its fast part.

use crate::plot::number::rounded;
use crate::plot::palette::RANGE;
use crate::plot::{Axis, Chart, Figure, Key, Panel, Paper, Sign, stack};

use crate::report::chart_motion::time_axis;
use crate::report::collector::Figures;
use crate::report::course::Course;
use crate::report::levels;
use crate::report::phases::{self, shade};
use crate::report::plant::{LEG, Plant};

const HEIGHT: f64 = 220.0;
/// Height of the last panel, with the numbers of the time.
const LAST_HEIGHT: f64 = 260.0;

pub(crate) fn figure(figures: &Figures, paper: Paper) -> Option<Figure> {
    let plant = figures.plant.as_ref().filter(|p| !p.hand.is_empty())?;
    let has_fast = !plant.fast.is_empty() && !plant.fast.is_zero();
    let mut panels = vec![panel(figures, &plant.hand, true, !has_fast, "Torque (N·m)")];
    if has_fast {
        panels.push(panel(figures, &plant.fast, false, true, "Fast part (N·m)"));
    }
    let svg = stack(
        paper.width(960.0),
        "Torque at the hand over the whole run",
        panels,
    );
    let mut legend = vec![Key::new(Sign::Line(LEG), "hand torque")];
    if figures.bins().is_some() {
        legend = vec![
            Key::new(Sign::Patch(RANGE), "range"),
            Key::new(Sign::Line(LEG), "mean"),
        ];
    } else if figures.has_object {
        legend.extend(phases::keys(figures.envelope.phases()));
    }
    Some(Figure {
        name: "hand",
        title: "What the hand feels",
        legend,
        charts: vec![Chart::full(svg)],
        caption: caption(plant, has_fast),
    })
}

fn caption(plant: &Plant, has_fast: bool) -> String {
    let range = |course: &Course| {
        let (low, high) = course.extent();
        // No rounding noise in place of a zero.
        let clean = |x: f64| {
            if x.abs() < 1e-6 * (high - low) {
                0.0
            } else {
                x
            }
        };
        format!(
            "from {} to {} N·m",
            rounded(clean(low)),
            rounded(clean(high))
        )
    };
    let whole = format!(
        "The torque about the knee that a force sensor between hand and leg shows, {}; positive \
         torque opposes flexion. What the scene has of model, motor, gear, cuff and leg is in it.",
        range(&plant.hand)
    );
    let fast = if has_fast {
        format!(
            " Below it the same without its slow part, {}: what a moving mean follows is taken \
             away, (4·mean over {} s − mean over {} s)/3, and with it the weight of a leg that is \
             moved; {} s at either end have no such mean. What vibrates at 10 Hz and more keeps its size to \
             within a fifth.",
            range(&plant.fast),
            rounded(plant.mean_s),
            rounded(2.0 * plant.mean_s),
            rounded(plant.mean_s),
        )
    } else {
        String::new()
    };
    let peaks = plant
        .hand
        .shown()
        .beyond
        .map_or_else(String::new, |beyond| {
            format!(
                " Peaks of up to {} N·m go beyond the axes, and shift the means around them.",
                rounded(beyond)
            )
        });
    whole + &fast + &peaks
}

fn panel<'f>(
    figures: &'f Figures,
    course: &'f Course,
    first: bool,
    last: bool,
    title: &'static str,
) -> Panel<'f> {
    let bins = figures.bins();
    let window = &figures.whole;
    // That of the torque above, so that the two can be compared.
    let time = if bins.is_none() && !window.torque.is_empty() {
        Axis::linear(window.time.low, window.time.high, 8)
    } else {
        time_axis(figures, &course.points())
    };
    let height = if last { LAST_HEIGHT } else { HEIGHT };
    Panel::new(height, time, (title, course.axis(5)), move |plot| {
        if bins.is_none() {
            shade(plot, &window.spans(window.time.low, window.time.high));
            plot.grid();
            course.draw(plot, bins, LEG);
        } else {
            course.draw(plot, bins, LEG);
            plot.grid();
        }
        figures.draw_marks(plot);
    })
    .x_title(last.then_some("Time (s)"))
    .right(levels::ROOM)
    .moments(if first {
        figures.marks.clone()
    } else {
        Vec::new()
    })
}
