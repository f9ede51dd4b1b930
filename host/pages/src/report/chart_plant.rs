//! A small chart for each column of the plant's effects, over the whole run.

use crate::plot::number::rounded;
use crate::plot::palette::{RANGE, TORQUE};
use crate::plot::{Chart, Figure, Key, Panel, Paper, Sign, stack};

use crate::report::chart_motion::time_axis;
use crate::report::collector::Figures;
use crate::report::course::Course;
use crate::report::plant::Shown;

/// CSS pixels.
const WIDTH: f64 = 470.0;
const HEIGHT: f64 = 230.0;

pub(crate) fn figure(figures: &Figures, paper: Paper) -> Option<Figure> {
    let plant = figures.plant.as_ref()?;
    let mut charts = Vec::new();
    let mut still = Vec::new();
    for (shown, course) in &plant.columns {
        // A symptom has a figure of its own.
        if course.is_empty() || shown.is_symptom() {
            continue;
        }
        if course.is_zero() {
            still.push(shown.title);
        } else {
            charts.push(chart(figures, shown, course, paper));
        }
    }
    if charts.is_empty() && still.is_empty() {
        return None;
    }
    let legend = match figures.bins() {
        Some(_) if !charts.is_empty() => vec![
            Key::new(Sign::Patch(RANGE), "range"),
            Key::new(Sign::Line(TORQUE), "mean"),
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
    let pushed = if figures.pushes.is_empty() {
        ""
    } else {
        " Arming pushes the motor for 16 ms, to and fro, to see that encoder and motor turn the same \
         way: no torque that was rendered, and in no table."
    };
    let caption = format!(
        "What the effects of the plant do over the whole run, at the joint{of_motor}.{still}{pushed}"
    );
    Some(Figure {
        name: "effects",
        title: "Effects",
        legend,
        charts,
        caption,
    })
}

fn chart(figures: &Figures, shown: &Shown, course: &Course, paper: Paper) -> Chart {
    let time = time_axis(figures, &course.points());
    let panel = Panel::new(HEIGHT, time, (shown.axis, course.axis(4)), |plot| {
        if shown.has_pushes {
            figures.shade_pushes(plot);
        }
        course.draw(plot, figures.bins(), TORQUE);
        plot.grid();
        if shown.has_pushes {
            figures.draw_motor_marks(plot);
        } else {
            figures.draw_marks(plot);
        }
    });
    let panel = panel
        .x_title(Some("Time (s)"))
        .moments(if shown.has_pushes {
            figures.motor_marks()
        } else {
            figures.marks.clone()
        });
    let svg = stack(paper.width(WIDTH), shown.title, vec![panel]);
    let heading = match course.shown().beyond {
        Some(beyond) => format!("{}; up to {} beyond the axis", shown.title, rounded(beyond)),
        None => shown.title.to_owned(),
    };
    Chart {
        heading: Some(heading),
        svg,
        half: true,
    }
}
