//! A figure for each symptom: torque over the knee's angle with its limits, torque
//! over time with its states, and where there are any, its catches and beats.

use crate::plot::number::rounded;
use crate::plot::palette::{Ink, OBJECT, SHAFT, SLIP_NEGATIVE, SLIP_POSITIVE, STICK, TEXT, TORQUE};
use crate::plot::{
    Axis, Chart, CurveStyle, Figure, Key, Mark, Marker, Panel, Paper, Plot, Point, Sign, extent,
    stack,
};
use crate::report::chart_beats;
use crate::report::chart_catches;
use crate::report::chart_motion::degrees;
use crate::report::collector::Figures;
use crate::report::hysteresis::Range;
use crate::report::symptom_chart::WIDTH;
use crate::report::symptoms::limits::{self, Drawn};
use crate::report::symptoms::path::Path;
use crate::report::symptoms::timeline::Timeline;
use crate::report::symptoms::{Symptom, Symptoms, Together};
use crepitus_model::render::effects::EffectSettings;
use crepitus_scene::trace::{SymptomEvent, Word};

const HEIGHT: f64 = 380.0;
const ANGLE_HEIGHT: f64 = 120.0;
const TIME_HEIGHT: f64 = 290.0;
const ANGLE_TITLE: &str = "Knee angle, flexion (°)";
const TORQUE_TITLE: &str = "Resistance (N·m)";

/// Events that have a sign each, and those that have a name besides.
const MOST_SIGNS: usize = 100;
const MOST_NAMES: usize = 10;

/// The states beside that at rest.
const STATES: [Ink; 3] = [SLIP_POSITIVE, SLIP_NEGATIVE, STICK];

/// All of them.
pub(crate) fn figures(figures: &Figures, paper: Paper) -> Vec<Figure> {
    let Some(symptoms) = &figures.symptoms else {
        return Vec::new();
    };
    let Symptoms {
        settings,
        list,
        together,
    } = symptoms;
    let own = list.iter().flat_map(|symptom| {
        let catches = chart_catches::figure(symptom, settings.spasticity.as_ref(), paper);
        let beats = chart_beats::figure(symptom, settings.clonus.as_ref(), paper);
        [figure(figures, symptom, settings, paper), catches, beats]
    });
    let own = own.flatten();
    let all = together
        .iter()
        .filter_map(|together| sum(figures, together, list, settings, paper));
    own.chain(all).collect()
}

fn figure(
    figures: &Figures,
    symptom: &Symptom,
    settings: &EffectSettings,
    paper: Paper,
) -> Option<Figure> {
    let Symptom {
        words,
        path,
        timeline,
        found,
        ..
    } = symptom;
    if timeline.line.is_empty() {
        return None;
    }
    let drawn = limits::of(settings, words.effect(), ends(path), &found.met);
    let charts = vec![
        over_angle(path, &drawn, Some(symptom), paper),
        over_time(figures, symptom, paper),
    ];
    Some(Figure {
        name: words.effect(),
        title: words.title(),
        legend: legend(symptom, &drawn),
        charts,
        caption: caption(symptom, &drawn),
    })
}

/// The angles of a path, deg.
fn ends(path: &Path) -> (f64, f64) {
    let (low, high) = match path.strokes() {
        Some(strokes) => extent(strokes.iter().flat_map(|s| s.points.iter().map(|p| p.x))),
        None => extent(path.ranges().iter().flatten().map(|range| range.angle)),
    };
    (low.to_degrees(), high.to_degrees())
}

fn ink(is_flexing: bool) -> Ink {
    if is_flexing { OBJECT } else { SHAFT }
}

fn over_angle(path: &Path, drawn: &Drawn, symptom: Option<&Symptom>, paper: Paper) -> Chart {
    let in_degrees = |p: &Point| Point::new(p.x.to_degrees(), p.y);
    let strokes: Vec<(Ink, Vec<Point>)> = path
        .strokes()
        .unwrap_or_default()
        .iter()
        .map(|s| (ink(s.is_flexing), s.points.iter().map(in_degrees).collect()))
        .collect();
    let bands = bands(path);
    let shown = strokes.iter().flat_map(|(_, points)| points);
    let shown = shown.chain(
        bands
            .iter()
            .flat_map(|(_, low, high)| low.iter().chain(high)),
    );
    let limits = drawn.lines.iter().flat_map(|line| &line.points);
    let all: Vec<&Point> = shown.chain(limits).collect();
    let marks = drawn.marks.iter().map(|mark| mark.at);
    let also = marks.chain(drawn.also_deg.iter().copied());
    let x = Axis::covering(all.iter().map(|p| p.x).chain(also), 9);
    let y = torque_axis(all.iter().map(|p| p.y));
    let panel = Panel::new(HEIGHT, x, (TORQUE_TITLE, y), |plot| {
        for (ink, low, high) in &bands {
            plot.band(low, high, *ink, 0.25);
        }
        plot.grid();
        for line in &drawn.lines {
            plot.line(&line.points, line.ink, line.width);
        }
        for (ink, low, high) in &bands {
            plot.line(low, *ink, 1.5);
            plot.line(high, *ink, 1.5);
        }
        for (ink, points) in &strokes {
            plot.line(points, *ink, 1.75);
        }
        plot.moments(&drawn.marks);
        if let Some(symptom) = symptom {
            let at = |event: &SymptomEvent| event.angle_rad.to_degrees();
            signs(plot, symptom, at);
        }
    });
    let label = "Resistance against the knee’s angle, with its limits";
    Chart {
        heading: Some("Resistance over the knee’s angle".to_owned()),
        svg: stack(
            paper.width(WIDTH),
            label,
            vec![
                panel
                    .x_title(Some(ANGLE_TITLE))
                    .moments(drawn.marks.clone()),
            ],
        ),
        half: false,
    }
}

/// An axis of torque that includes zero.
fn torque_axis(nm: impl Iterator<Item = f64>) -> Axis {
    Axis::covering(nm.chain([0.0]), 6)
}

/// Returns whether an event begins something: of these a chart over time says the names.
fn begins(word: Word) -> bool {
    !matches!(
        word,
        Word::Rearm | Word::Leave | Word::Uncap | Word::Offset | Word::Beat
    )
}

/// Range of a path with too many strokes, in either direction.
fn bands(path: &Path) -> Vec<(Ink, Vec<Point>, Vec<Point>)> {
    if path.strokes().is_some() {
        return Vec::new();
    }
    let edge = |ranges: &[Range], nm: fn(&Range) -> f64| -> Vec<Point> {
        let points = ranges.iter();
        points
            .map(|range| Point::new(range.angle.to_degrees(), nm(range)))
            .collect()
    };
    let [flexing, extending] = path.ranges();
    [(true, flexing), (false, extending)]
        .into_iter()
        .map(|(is_flexing, r)| (ink(is_flexing), edge(&r, |r| r.low), edge(&r, |r| r.high)))
        .collect()
}

/// The signs of a symptom's events, if they are few enough to be distinguished.
fn signs(plot: &mut Plot, symptom: &Symptom, x: impl Fn(&SymptomEvent) -> f64) {
    let events = &symptom.timeline.events;
    if events.len() > MOST_SIGNS {
        return;
    }
    for event in events {
        let nm = event.torque_after_nm;
        if let Some(marker) = marker(symptom, event.word) {
            plot.mark((x(event), nm), marker, TEXT);
        }
    }
}

fn marker(symptom: &Symptom, word: Word) -> Option<Marker> {
    let named = symptom.words.named();
    let place = named.iter().position(|(of, _)| *of == word)?;
    Marker::ALL.get(place).copied()
}

fn over_time(figures: &Figures, symptom: &Symptom, paper: Paper) -> Chart {
    let Timeline {
        line,
        stays,
        events,
        ..
    } = &symptom.timeline;
    let line = line.points();
    let (from_s, to_s) = extent(line.iter().map(|p| p.x));
    let time = Axis::linear(from_s, to_s, 9);
    let angle = degrees(&figures.angle.points());
    let angle: Vec<Point> = angle
        .into_iter()
        .filter(|p| (from_s..=to_s).contains(&p.x))
        .collect();
    let shade = |plot: &mut Plot| {
        for (state, ink) in (1..).zip(STATES) {
            let of = stays.iter().filter(|stay| stay.state == state);
            plot.shade(of.map(|stay| (stay.from_s, stay.to_s)), ink);
        }
    };
    let angles = Axis::covering(angle.iter().map(|p| p.y), 3);
    let above = Panel::new(ANGLE_HEIGHT, time.clone(), ("Knee (°)", angles), |plot| {
        shade(plot);
        plot.grid();
        plot.line(&angle, OBJECT, 1.75);
        figures.draw_marks(plot);
    });
    let named: Vec<Mark> = events
        .iter()
        .filter(|event| begins(event.word))
        .filter_map(|event| {
            let name = symptom.words.name(event.word)?.to_owned();
            let at = event.time_s;
            Some(Mark { at, name })
        })
        .collect();
    let named = if named.len() > MOST_NAMES {
        Vec::new()
    } else {
        named
    };
    let y = torque_axis(line.iter().map(|p| p.y));
    let below = Panel::new(TIME_HEIGHT, time, (TORQUE_TITLE, y), |plot| {
        shade(plot);
        plot.grid();
        plot.line(&line, TORQUE, 1.5);
        plot.moments(&named);
        signs(plot, symptom, |event| event.time_s);
        figures.draw_marks(plot);
    });
    let heading = match symptom.timeline.until_s() {
        Some(until_s) => format!(
            "Resistance over time: the first {} s, of which everything can be told apart",
            rounded(until_s - from_s)
        ),
        None => "Resistance over time".to_owned(),
    };
    let panels = vec![
        above.moments(figures.marks.clone()),
        below.x_title(Some("Time (s)")).moments(named.clone()),
    ];
    Chart {
        svg: stack(
            paper.width(WIDTH),
            "Knee angle and resistance over time, with states",
            panels,
        ),
        heading: Some(heading),
        half: false,
    }
}

fn legend(symptom: &Symptom, drawn: &Drawn) -> Vec<Key> {
    let mut legend = strokes_legend(&symptom.path);
    let mut names: Vec<&str> = Vec::new();
    for line in &drawn.lines {
        if !names.contains(&line.name) {
            names.push(line.name);
            legend.push(Key::new(Sign::Line(line.ink), line.name));
        }
    }
    let Timeline { stays, events, .. } = &symptom.timeline;
    for ((state, ink), name) in (1..).zip(STATES).zip(symptom.words.states().iter().skip(1)) {
        if stays.iter().any(|stay| stay.state == state) {
            legend.push(Key::new(Sign::Patch(ink), name));
        }
    }
    if events.len() <= MOST_SIGNS {
        for (word, name) in symptom.words.named() {
            if let Some(marker) = marker(symptom, word)
                && events.iter().any(|event| event.word == word)
            {
                let style = CurveStyle {
                    ink: TEXT,
                    dashes: "",
                    marker,
                };
                legend.push(Key::new(Sign::Filled(style), name));
            }
        }
    }
    legend
}

fn strokes_legend(path: &Path) -> Vec<Key> {
    let has = |is_flexing| match path.strokes() {
        Some(strokes) => strokes.iter().any(|s| s.is_flexing == is_flexing),
        None => true,
    };
    [(true, "while bending"), (false, "while straightening")]
        .into_iter()
        .filter(|(is_flexing, _)| has(*is_flexing))
        .map(|(is_flexing, name)| Key::new(Sign::Line(ink(is_flexing)), name))
        .collect()
}

fn caption(symptom: &Symptom, drawn: &Drawn) -> String {
    let mut caption = "Above, what the knee resists with at each angle: above zero against \
                       bending, below zero against straightening."
        .to_owned();
    if !drawn.lines.is_empty() {
        caption += " The wide lines behind are the limits that follow from the settings.";
    } else if symptom.words.has_changes() || symptom.shows_all() {
        caption += " Its settings changed, or are not known: no limits are drawn.";
    }
    if symptom.shares_torque() {
        caption += " The recording has the resistance of everything that was rendered together.";
    }
    if symptom.path.strokes().is_none() {
        caption += " There were too many movements to draw each: the bands span all of them.";
    }
    caption += " Below, the same over time; the background is what the symptom does.";
    let events = symptom.timeline.events.len();
    if events > MOST_SIGNS {
        caption += " Its events are too many for a sign each.";
    }
    caption
}

/// The sum of all symptoms, with the limits of those that limit a range.
fn sum(
    figures: &Figures,
    together: &Together,
    list: &[Symptom],
    settings: &EffectSettings,
    paper: Paper,
) -> Option<Figure> {
    let line = together.line.points();
    if line.len() < 2 {
        return None;
    }
    let ends = ends(&together.path);
    let marks = list
        .iter()
        .flat_map(|s| limits::of(settings, s.words.effect(), ends, &s.found.met).marks);
    let drawn = Drawn {
        marks: marks.collect(),
        ..Drawn::default()
    };
    let y = torque_axis(line.iter().map(|p| p.y));
    let (from_s, to_s) = extent(line.iter().map(|p| p.x));
    let time = Axis::linear(from_s, to_s, 9);
    let panel = Panel::new(TIME_HEIGHT, time, (TORQUE_TITLE, y), |plot| {
        plot.grid();
        plot.line(&line, TORQUE, 1.5);
        figures.draw_marks(plot);
    });
    let label = "Resistance of all symptoms over time";
    let over_time = Chart {
        svg: stack(
            paper.width(WIDTH),
            label,
            vec![
                panel
                    .x_title(Some("Time (s)"))
                    .moments(figures.marks.clone()),
            ],
        ),
        heading: Some("Resistance over time".to_owned()),
        half: false,
    };
    let crepitus = if together.has_crepitus {
        " Crepitus is one of them."
    } else {
        ""
    };
    Some(Figure {
        name: "together",
        title: "All symptoms together",
        legend: strokes_legend(&together.path),
        charts: vec![over_angle(&together.path, &drawn, None, paper), over_time],
        caption: format!(
            "The sum of what the symptoms above ask for, before a device limits it: what a hand \
             feels of them at once.{crepitus}"
        ),
    })
}
