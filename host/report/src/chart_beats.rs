//! The beats of clonus over time: their number, and the time from each to the next.

use crate::chart_symptoms::WIDTH;
use crate::symptoms::Symptom;
use crate::symptoms::found::Beat;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_plot::palette::{CURVES, TEXT};
use crepitus_plot::{Axis, Chart, Marker, Panel, Point, stack};

const HEIGHT: f64 = 190.0;
const FOOT: f64 = 45.0;

/// The chart, if there were beats.
pub(crate) fn chart(symptom: &Symptom, settings: Option<&ClonusSettings>) -> Option<Chart> {
    let beats = &symptom.found.beats;
    let (Some(first), Some(last)) = (beats.first(), beats.last()) else {
        return None;
    };
    let numbers: Vec<Point> = beats
        .iter()
        .map(|beat| Point::new(beat.time_s, f64::from(beat.number + 1)))
        .collect();
    let found = intervals(beats, |from, to| to.time_s - from.time_s);
    let expected = match settings {
        Some(settings) => intervals(beats, |from, _| settings.interval_s(from.number)),
        None => Vec::new(),
    };
    let room_s = 0.03 * (last.time_s - first.time_s) + 0.1;
    let time = Axis::linear(first.time_s - room_s, last.time_s + room_s, 9);
    let number = Axis::covering(numbers.iter().map(|p| p.y).chain([0.0]), 4);
    let interval = Axis::covering(found.iter().chain(&expected).map(|p| p.y), 4);
    let mut panels = vec![Panel::new(HEIGHT, time.clone(), ("Beat", number), |plot| {
        plot.grid();
        for point in &numbers {
            plot.mark((point.x, point.y), Marker::Circle, TEXT);
        }
    })];
    if found.is_empty() {
        panels = panels
            .into_iter()
            .map(|panel| panel.x_title(Some("Time (s)")))
            .collect();
    } else {
        let title = "To the next beat (ms)";
        let below = Panel::new(HEIGHT + FOOT, time, (title, interval), |plot| {
            plot.grid();
            for point in &expected {
                plot.mark((point.x, point.y), Marker::Plus, CURVES[3]);
            }
            for point in &found {
                plot.mark((point.x, point.y), Marker::Circle, TEXT);
            }
        });
        panels.push(below.x_title(Some("Time (s)")));
    }
    let heading = match settings {
        Some(_) if !found.is_empty() => "Beats over time; plus signs: the rhythm of the settings",
        _ => "Beats over time",
    };
    Some(Chart {
        svg: stack(
            WIDTH,
            "Number of each beat, and time to the next, over time",
            panels,
        ),
        heading: Some(heading.to_owned()),
        half: false,
    })
}

/// From each beat to the next of the same stretch: (s, ms).
fn intervals(beats: &[Beat], length_s: impl Fn(&Beat, &Beat) -> f64) -> Vec<Point> {
    let pairs = beats.iter().zip(beats.iter().skip(1));
    pairs
        .filter(|(from, to)| to.number == from.number + 1)
        .map(|(from, to)| Point::new(from.time_s, 1e3 * length_s(from, to)))
        .collect()
}
