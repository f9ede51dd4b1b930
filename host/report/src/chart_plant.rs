//! A small chart for each column of the plant's effects, over the whole run.

use crate::ReportError;
use crate::canvas::{Panel, svg};
use crate::chart_motion::time_axis;
use crate::collector::Figures;
use crate::course::Course;
use crate::figure::{Chart, Figure, Key, Sign};
use crate::number::rounded;
use crate::palette::TORQUE;
use crate::plant::Shown;

const HALF: (u32, u32) = (470, 230);

pub(crate) fn figure(figures: &Figures) -> Result<Option<Figure>, ReportError> {
    let Some(plant) = &figures.plant else {
        return Ok(None);
    };
    let mut charts = Vec::new();
    let mut still = Vec::new();
    for (shown, course) in &plant.columns {
        if course.is_empty() {
            continue;
        }
        if course.is_zero() {
            still.push(shown.title);
        } else {
            charts.push(chart(figures, shown, course)?);
        }
    }
    if charts.is_empty() && still.is_empty() {
        return Ok(None);
    }
    let legend = match figures.bins() {
        Some(_) if !charts.is_empty() => vec![
            Key::new(Sign::Patch("range"), "range"),
            Key::new(Sign::Line("torque"), "mean"),
        ],
        _ => Vec::new(),
    };
    let of_motor = if plant.columns.iter().any(|(shown, _)| shown.of_motor) {
        "; current and voltage are the motor’s own"
    } else {
        ""
    };
    let still = if still.is_empty() {
        String::new()
    } else {
        format!(" Zero all the time: {}.", still.join("; "))
    };
    let caption = format!(
        "What the effects of the plant do over the whole run, at the joint{of_motor}.{still}"
    );
    Ok(Some(Figure {
        name: "effects",
        title: "Effects",
        legend,
        charts,
        caption,
    }))
}

fn chart(figures: &Figures, shown: &Shown, course: &Course) -> Result<Chart, ReportError> {
    let svg = svg(HALF, shown.title, |area| {
        let mut plot = Panel {
            x: time_axis(&course.points()),
            y: course.axis(4),
            x_title: Some("Time (s)"),
            y_title: shown.axis,
            right: 16,
        }
        .on(area)?;
        course.draw(&mut plot, figures.bins(), TORQUE)?;
        plot.grid()
    })?;
    let heading = match course.shown().beyond {
        Some(beyond) => format!("{}; up to {} beyond the axis", shown.title, rounded(beyond)),
        None => shown.title.to_owned(),
    };
    Ok(Chart {
        heading: Some(heading),
        svg,
        half: true,
    })
}
