//! Pairs of axes above each other on one chart.

use crate::plot::drawing::{Anchor, Drawing, Svg};
use crate::plot::frame::Frame;
use crate::plot::layout::{GAP, TICK, frames, y_title};
use crate::plot::palette::{AXIS, TEXT};
use crate::plot::panel::Panel;
use crate::plot::plot::Plot;
use crate::plot::stroke::Stroke;
use crate::plot::text::{LINE, SIZE, width};

/// Draws panels one above the other, on one width.
pub fn stack(total: f64, label: &str, panels: Vec<Panel>) -> Svg {
    let (frames, height) = frames(total, &panels);
    let mut drawing = Drawing::default();
    for ((frame, strip), panel) in frames.into_iter().zip(panels) {
        let titles = y_title(&panel);
        if let Some(heading) = panel.heading {
            let y = frame.top - strip.height() - 18.0;
            drawing.text((frame.left, y), Anchor::Start, TEXT, heading);
        }
        strip.draw(frame, &mut drawing);
        let x = panel.x.fitting(frame.right - frame.left);
        let mut plot = Plot::new(x, panel.y, frame, drawing);
        (panel.draw)(&mut plot);
        for (value, name) in &panel.names {
            let (x, y) = plot.at((plot.x().high(), *value));
            plot.over.text((x + GAP, y), Anchor::Start, TEXT, name);
        }
        axes(&mut plot, panel.x_title, &titles, (total, height));
        drawing = plot.over;
    }
    drawing.svg((total, height), label)
}

/// Lines, ticks, numbers and titles.
fn axes(plot: &mut Plot, x_title: Option<&str>, y_title: &[&str], (total, height): (f64, f64)) {
    let Frame {
        left,
        top,
        right,
        bottom,
    } = plot.frame();
    let mut lines = vec![
        [(left, top), (left, bottom)],
        [(left, bottom), (right, bottom)],
    ];
    for (value, label) in plot.x().clone().labels() {
        let x = plot.at((value, plot.y().low())).0;
        lines.push([(x, bottom), (x, bottom + TICK)]);
        if x_title.is_some() {
            plot.over
                .text((x, bottom + 14.0), Anchor::Middle, TEXT, &label);
        }
    }
    for (value, label) in plot.y().clone().labels() {
        let y = plot.at((plot.x().low(), value)).1;
        lines.push([(left - TICK, y), (left, y)]);
        plot.over.text((left - GAP, y), Anchor::End, TEXT, &label);
    }
    plot.over.lines(lines, Stroke::new(AXIS, 1.0));
    // A title is in the middle, if it is not too long for that.
    let inside = |middle: f64, title: &str, end: f64| {
        let half = 0.5 * width(title, SIZE).min(end);
        middle.clamp(half, end - half)
    };
    if let Some(title) = x_title {
        let middle = inside(f64::midpoint(left, right), title, total);
        plot.over
            .text((middle, bottom + 36.0), Anchor::Middle, TEXT, title);
    }
    for (i, title) in y_title.iter().enumerate() {
        let middle = inside(f64::midpoint(top, bottom), title, height);
        plot.over.upright((LINE * (i as f64 + 1.0), middle), title);
    }
}
