//! What the hand feels over the whole run: the torque that a force sensor on
//! the leg shows, and its fast part.

use crate::ReportError;
use crate::axis::Axis;
use crate::canvas::{Area, Drawn, Panel, px, svg};
use crate::chart_motion::time_axis;
use crate::chart_torque::shade;
use crate::collector::Figures;
use crate::course::Course;
use crate::figure::{Chart, Figure, Key, Sign, phase_keys};
use crate::levels;
use crate::number::rounded;
use crate::plant::{LEG, Plant};

const HEIGHT: u32 = 220;
/// With the numbers of the time.
const LAST_HEIGHT: u32 = 260;

pub(crate) fn figure(figures: &Figures) -> Result<Option<Figure>, ReportError> {
    let Some(plant) = figures.plant.as_ref().filter(|p| !p.hand.is_empty()) else {
        return Ok(None);
    };
    let has_fast = !plant.fast.is_empty() && !plant.fast.is_zero();
    let height = LAST_HEIGHT + if has_fast { HEIGHT } else { 0 };
    let svg = svg(
        (960, height),
        "Torque at the hand over the whole run",
        |area| {
            if has_fast {
                let (above, below) = area.split_vertically(px(HEIGHT));
                draw(&above, figures, &plant.hand, false, "Torque (N·m)")?;
                draw(&below, figures, &plant.fast, true, "Fast part (N·m)")
            } else {
                draw(area, figures, &plant.hand, true, "Torque (N·m)")
            }
        },
    )?;
    let mut legend = vec![Key::new(Sign::Line("green"), "hand torque")];
    if figures.bins().is_some() {
        legend = vec![
            Key::new(Sign::Patch("range"), "range"),
            Key::new(Sign::Line("green"), "mean"),
        ];
    } else if figures.has_object {
        legend.extend(phase_keys(figures.envelope.phases()));
    }
    Ok(Some(Figure {
        name: "hand",
        title: "What the hand feels",
        legend,
        charts: vec![Chart {
            heading: None,
            svg,
            half: false,
        }],
        caption: caption(plant, has_fast),
    }))
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
             moved. What vibrates at 10 Hz and more keeps its size to within a fifth.",
            range(&plant.fast),
            rounded(plant.mean_s),
            rounded(2.0 * plant.mean_s),
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

fn draw(area: &Area, figures: &Figures, course: &Course, last: bool, title: &str) -> Drawn {
    let points = course.points();
    let bins = figures.bins();
    // That of the torque above, so that the two can be compared.
    let time = if bins.is_none() && !figures.whole.torque.is_empty() {
        Axis::linear(figures.whole.start, figures.whole.end, 8)
    } else {
        time_axis(&points)
    };
    let mut plot = Panel {
        x: time,
        y: course.axis(5),
        x_title: last.then_some("Time (s)"),
        y_title: title,
        right: levels::ROOM,
    }
    .on(area)?;
    if bins.is_none() {
        let window = &figures.whole;
        shade(&mut plot, &window.spans(window.start, window.end))?;
        plot.grid()?;
        course.draw(&mut plot, bins, LEG)
    } else {
        course.draw(&mut plot, bins, LEG)?;
        plot.grid()
    }
}
