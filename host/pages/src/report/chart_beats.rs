//! The beats of clonus over time: their number, and the time from each to the next.

use crate::plot::palette::{AXIS, TEXT};
use crate::plot::{
    Axis, Chart, CurveStyle, Figure, Key, Marker, Panel, Paper, Plot, Point, Sign, stack,
};
use crate::report::symptom_chart::{WIDE, WIDTH};
use crate::report::symptoms::Symptom;
use crate::report::symptoms::occurrences::Beat;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_scene::static_limits;

const HEIGHT: f64 = 190.0;
const FOOT: f64 = 45.0;
const TIME: &str = "Time (s)";

/// The figure, if there were beats.
pub(crate) fn figure(
    symptom: &Symptom,
    settings: Option<&ClonusSettings>,
    paper: Paper,
) -> Option<Figure> {
    let beats = &symptom.found.beats;
    let (first, last) = (beats.first()?, beats.last()?);
    let numbers: Vec<Point> = beats
        .iter()
        .map(|beat| Point::new(beat.time_s, f64::from(beat.number + 1)))
        .collect();
    let found = intervals(beats);
    let expected = settings.map_or_else(Vec::new, |settings| rhythm(beats, settings));
    let room_s = 0.03 * (last.time_s - first.time_s) + 0.1;
    let time = Axis::linear(first.time_s - room_s, last.time_s + room_s, 9);
    let number = Axis::covering(numbers.iter().map(|p| p.y).chain([0.0]), 4);
    let above = Panel::new(HEIGHT, time.clone(), ("Beat", number), |plot| {
        plot.grid();
        signs(plot, &numbers);
    });
    let panels = if found.is_empty() {
        vec![above.x_title(Some(TIME))]
    } else {
        let interval = Axis::covering(found.iter().chain(&expected).map(|p| p.y), 4);
        let title = "To the next (ms)";
        let below = Panel::new(HEIGHT + FOOT, time, (title, interval), |plot| {
            plot.grid();
            for stretch in stretches(&expected) {
                plot.line(stretch, AXIS, WIDE);
            }
            signs(plot, &found);
        });
        vec![above, below.x_title(Some(TIME))]
    };
    let mut legend = vec![Key::new(Sign::Filled(CurveStyle::NEUTRAL), "a beat")];
    if !expected.is_empty() {
        legend.push(Key::new(Sign::Line(AXIS), "the rhythm of the settings"));
    }
    let label = "Number of each beat, and time to the next, over time";
    Some(Figure {
        name: "beats",
        title: "Beats of clonus",
        legend,
        charts: vec![Chart::full(stack(paper.width(WIDTH), label, panels))],
        caption: "Each beat over time: its number since the stretch, and how long it was to the \
                  next. The first interval is the longest; from the fourth or fifth beat on the \
                  rhythm is steady."
            .to_owned(),
    })
}

fn signs(plot: &mut Plot, points: &[Point]) {
    for point in points {
        plot.mark((point.x, point.y), Marker::Circle, TEXT);
    }
}

/// Intervals from each beat to the next of the same stretch: (s, ms).
fn intervals(beats: &[Beat]) -> Vec<Point> {
    between(beats, |from, to| to.time_s - from.time_s)
}

/// Intervals that the settings give for these beats: (s, ms).
fn rhythm(beats: &[Beat], settings: &ClonusSettings) -> Vec<Point> {
    between(beats, |from, _| {
        static_limits::clonus::interval_s(settings, from.number)
    })
}

fn between(beats: &[Beat], length_s: impl Fn(&Beat, &Beat) -> f64) -> Vec<Point> {
    let pairs = beats.iter().zip(beats.iter().skip(1));
    pairs
        .filter(|(from, to)| to.number == from.number + 1)
        .map(|(from, to)| Point::new(from.time_s, 1e3 * length_s(from, to)))
        .collect()
}

/// Parts in which intervals become shorter: a longer one begins another stretch.
fn stretches(intervals: &[Point]) -> impl Iterator<Item = &[Point]> {
    intervals.chunk_by(|a, b| b.y <= a.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::symptom::STEPPED;
    use crate::report::symptoms::tests::examined;

    #[test]
    fn beats_are_in_the_rhythm_of_the_settings_in_milliseconds() {
        let (settings, symptoms) = examined(6, STEPPED);
        let beats = &symptoms.list[0].found.beats;
        let found = intervals(beats);
        let expected = rhythm(beats, &settings.clonus.expect("on"));
        assert_eq!((found.len(), expected.len()), (7, 7));
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found.x, expected.x);
            assert!((found.y - expected.y).abs() < 0.1, "{found:?} {expected:?}");
        }
        assert!((found[0].y - 216.7).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn another_stretch_is_another_line() {
        let beat = |time_s, number| Beat { time_s, number };
        let beats = [
            beat(1.0, 0),
            beat(1.3, 1),
            beat(1.5, 2),
            beat(4.0, 0),
            beat(4.3, 1),
        ];
        let found = intervals(&beats);
        assert_eq!(found.len(), 3);
        let lengths: Vec<usize> = stretches(&found).map(<[Point]>::len).collect();
        assert_eq!(lengths, [2, 1]);
    }
}
