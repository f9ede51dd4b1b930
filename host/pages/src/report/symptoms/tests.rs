//! Symptoms as their scenes run: what is found, what is drawn, how much is kept.

use super::limits;
use super::occurrences::{Met, Occurrences};
use super::path::Path;
use super::timeline::Timeline;
use super::words::Words;
use super::{Symptom, Symptoms};
use crate::plot::Point;
use crate::report::channels::Setup;
use crate::report::collector::{Collector, Figures};
use crate::report::fixture::symptom::{EXAMINED, Item, STEPPED, ran, scene};
use crepitus_model::render::effects::{EffectSettings, SPECS};
use crepitus_scene::static_limits::spasticity;
use crepitus_scene::trace::{Column, ColumnKind, SymptomEvent, Word};

fn collect(effects: &EffectSettings, columns: &[Column], items: &[Item]) -> Figures {
    let mut collector = Collector::new(&Setup {
        columns,
        rows_expected: items.len() as u64,
        row_step_s: 1e-3,
        levels: None,
        effects: *effects,
    });
    for item in items {
        match item {
            Item::Row(values) => collector.row(values),
            Item::Event(event) => collector.symptom(event),
        }
    }
    collector.finish()
}

pub(crate) fn examined(place: usize, solver: &str) -> (EffectSettings, Symptoms) {
    let (effects, speeds, ends) = EXAMINED[place];
    let scene = scene(effects, speeds, ends, solver);
    let settings = scene.effect_settings();
    let (columns, items) = ran(&scene);
    let figures = collect(&settings, &columns, &items);
    (settings, figures.symptoms.expect("symptoms"))
}

fn met(symptoms: &Symptoms) -> &[Met] {
    &symptoms.list[0].found.met
}

fn near(found: f64, expected: f64, within: f64) {
    assert!(
        (found - expected).abs() <= within,
        "{found} instead of {expected}"
    );
}

/// Returns whether a point is on one of these lines, within what can be seen.
fn is_on(lines: &[(Point, Point)], at: Point) -> bool {
    lines.iter().any(|(a, b)| {
        let share = if a.x == b.x {
            (at.y - a.y) / (b.y - a.y)
        } else {
            (at.x - a.x) / (b.x - a.x)
        };
        (0.0..=1.0).contains(&share)
            && (a.x + share * (b.x - a.x) - at.x).abs() < 0.1
            && (a.y + share * (b.y - a.y) - at.y).abs() < 0.02
    })
}

fn lines(points: &[Point]) -> Vec<(Point, Point)> {
    points.windows(2).map(|ends| (ends[0], ends[1])).collect()
}

#[test]
fn every_limit_that_is_drawn_is_met_by_the_torque() {
    for place in 0..8 {
        let (settings, symptoms) = examined(place, STEPPED);
        let symptom = &symptoms.list[0];
        let strokes = symptom.path.strokes().expect("few");
        let in_degrees = |p: &Point| Point::new(p.x.to_degrees(), p.y);
        let strokes = strokes
            .iter()
            .map(|stroke| stroke.points.iter().map(in_degrees));
        let strokes: Vec<Vec<Point>> = strokes.map(Iterator::collect).collect();
        let path: Vec<_> = strokes.iter().flat_map(|stroke| lines(stroke)).collect();
        let ends = crate::plot::extent(strokes.iter().flatten().map(|p| p.x));
        let effect = symptom.words.effect();
        let drawn = limits::of(&settings, effect, ends, &symptom.found.met);
        assert!(!drawn.lines.is_empty(), "{effect}");
        for line in &drawn.lines {
            let has_torque = |point: &&Point| point.y != 0.0;
            let mut points = line.points.iter().filter(has_torque);
            match line.name {
                // The catch releases while it builds up.
                "height of a catch at its speed" => {
                    let height = points.next().expect("a height");
                    let is_below = |at: &Point| {
                        (at.x - height.x).abs() < 1.5 && (at.y / height.y - 0.93).abs() < 0.02
                    };
                    assert!(strokes.iter().flatten().any(is_below), "{height:?}");
                }
                // A reflex is late.
                "at the speed of the stretch, without its delay" | "a very slow stretch" => {
                    let end = line.points.last().expect("an end");
                    let most_nm = symptom.found.most.0;
                    assert!(end.y > 1.0 && end.y < 1.15 * most_nm, "{end:?} {most_nm}");
                }
                name => {
                    let mut seen = strokes.iter().flatten().filter(has_torque);
                    let limit = lines(&line.points);
                    let is_met =
                        points.any(|at| is_on(&path, *at)) || seen.any(|at| is_on(&limit, *at));
                    assert!(is_met, "{effect}: {name}");
                }
            }
        }
    }
}

#[test]
fn a_catch_is_found_where_and_as_strong_as_it_is() {
    for solver in [STEPPED, "kind = \"reference\""] {
        let (settings, symptoms) = examined(3, solver);
        let settings = settings.spasticity.expect("on");
        let caught: Vec<&Met> = symptoms.list[0].found.caught().collect();
        assert_eq!(caught.len(), 2, "none at 30 deg/s");
        for (met, (deg, deg_s, nm)) in caught.iter().zip([(52.5, 90.0, 1.05), (42.5, 130.0, 1.52)])
        {
            let event = &met.event;
            near(event.angle_rad.to_degrees(), deg, 0.01);
            near(event.omega_rad_s.to_degrees(), deg_s, 0.01);
            let catch_nm = spasticity::catch_nm(&settings, event.omega_rad_s);
            near(catch_nm, nm, 5e-3);
            // The catch releases while it builds up.
            near(met.most_nm, 0.93 * nm, 0.02 * nm);
            let threshold_rad = spasticity::threshold_rad(&settings, event.omega_rad_s);
            near(threshold_rad, event.angle_rad, 1e-4);
        }
    }
}

#[test]
fn a_collapse_an_end_and_beats_are_found() {
    let (_, symptoms) = examined(5, STEPPED);
    for collapse in met(&symptoms) {
        near(collapse.event.angle_rad.to_degrees(), 75.0, 0.01);
        near(collapse.event.torque_before_nm, 3.156, 1e-3);
        near(collapse.fifth_s.expect("it fell"), 0.085, 2e-3);
    }
    assert_eq!(met(&symptoms).len(), 2);

    let (_, symptoms) = examined(0, STEPPED);
    let angles: Vec<f64> = met(&symptoms)
        .iter()
        .map(|met| met.event.angle_rad.to_degrees())
        .collect();
    for (angle, expected) in angles.iter().zip([120.0, 10.0, 120.0, 10.0]) {
        near(*angle, expected, 0.01);
    }
    let end = &met(&symptoms)[0];
    near(end.beyond_rad.to_degrees(), 6.0, 0.01);
    near(end.within_rad.to_degrees(), 0.05_f64.to_degrees(), 0.03);
    near(end.most_nm, 4.0, 1e-6);

    let (_, symptoms) = examined(6, STEPPED);
    let Occurrences { beats, bouts, .. } = &symptoms.list[0].found;
    assert_eq!(
        (bouts.len(), bouts[0].beats, bouts[0].end.map(|end| end.0)),
        (1, 8, Some(Word::Done))
    );
    for (pair, ms) in beats.windows(2).zip([216.7, 191.7, 179.2, 172.9]) {
        near(1e3 * (pair[1].time_s - pair[0].time_s), ms, 0.1);
    }
}

#[test]
fn loops_and_rates_are_those_of_the_closed_forms() {
    let (_, symptoms) = examined(1, STEPPED);
    let whole = symptoms.list[0].found.loops.latest().expect("two strokes");
    near(whole.area_j, 2.3876, 2e-3);
    let (_, symptoms) = examined(7, STEPPED);
    let movement = &symptoms.list[0].found.movement;
    let rate = movement.rates[0];
    // 1.5° from snap to snap, both ways.
    assert_eq!((rate.word, rate.count / 2), (Word::Snap, 40));
    let degrees = movement.travel_rad.to_degrees();
    near(degrees, 120.0, 0.5);
}

/// Rows of a device: fourteen ticks from count to count, and teeth that never rest.
#[test]
fn gives_are_counted_while_the_joint_moves_however_fine_the_rows() {
    const TICK_S: f64 = 5e-5;
    const COUNT_RAD: f64 = 35.67e-6;
    const TEETH_HZ: f64 = 6.25;
    let names = [
        "t_s",
        "angle_rad",
        "omega_rad_s",
        "torque_nm",
        "cogwheel_phase",
    ];
    let columns = names.map(|name| Column {
        name,
        kind: ColumnKind::Number,
    });
    let mut collector = Collector::new(&Setup {
        columns: &columns,
        rows_expected: 0,
        row_step_s: TICK_S,
        levels: None,
        effects: EffectSettings::default(),
    });
    let speed = 10.0_f64.to_radians();
    for tick in 0..400_000_u32 {
        let time_s = f64::from(tick) * TICK_S;
        // At rest for two seconds, there and back, at rest.
        let there_s = (time_s - 2.0).clamp(0.0, 8.0);
        let back_s = (time_s - 10.0).clamp(0.0, 8.0);
        let counts = (speed * (there_s - back_s) / COUNT_RAD).floor();
        let is_high = (time_s * TEETH_HZ).fract() < 0.5;
        let phase = f64::from(u8::from(is_high));
        collector.row(&[time_s, counts * COUNT_RAD, 0.0, phase, phase]);
    }
    let symptoms = collector.finish().symptoms.expect("one");
    let movement = &symptoms.list[0].found.movement;
    let rate = movement.rates[0];
    assert_eq!((rate.word, movement.rates.len()), (Word::Give, 1));
    near(rate.count as f64 / movement.moving_s, TEETH_HZ, 0.1);
    let deg_s = (movement.travel_rad / movement.moving_s).to_degrees();
    near(deg_s, 10.0, 0.1);
    near(movement.moving_s, 16.0, 0.1);
}

#[test]
fn the_sum_is_kept_where_there_are_several() {
    let (_, symptoms) = examined(8, STEPPED);
    assert_eq!(symptoms.list.len(), 2);
    let together = symptoms.together.expect("two");
    assert!(!together.has_crepitus);
    let most = together
        .line
        .points()
        .iter()
        .map(|p| p.y)
        .fold(0.0, f64::max);
    // Beyond the end, and the rigidity.
    near(most, 1.2 + 4.0, 1e-3);
    assert!(examined(1, STEPPED).1.together.is_none());
}

#[test]
fn the_torque_of_a_recording_is_the_symptoms_own_where_nothing_else_was_on() {
    let names = [
        "t_s",
        "torque_nm",
        "clonus_phase",
        "lead_pipe_phase",
        "phase",
    ];
    let columns = names.map(|name| Column {
        name,
        kind: ColumnKind::Number,
    });
    let shares = |columns: &[Column]| -> Vec<bool> {
        let symptoms = collect(&EffectSettings::default(), columns, &[]).symptoms;
        let list = symptoms.expect("a phase").list;
        list.iter().map(Symptom::shares_torque).collect()
    };
    assert_eq!(shares(&columns[..3]), [false]);
    assert_eq!(shares(&columns[..4]), [true, true]);
    // With crepitus, also where its levels changed and are not drawn.
    assert_eq!(shares(&[&columns[..3], &columns[4..]].concat()), [true]);
}

/// Columns and items as a recording has them: the torque of all, and a phase.
fn as_recorded(columns: &[Column], items: &[Item], effect: &str) -> (Vec<Column>, Vec<Item>) {
    let spec = SPECS.iter().find(|spec| spec.name == effect).expect("one");
    let phase = spec.phases.expect("phases").column;
    let names = ["t_s", "angle_rad", "omega_rad_s", spec.column, phase];
    let places = names.map(|name| columns.iter().position(|c| c.name == name).expect(name));
    let shown = ["t_s", "angle_rad", "omega_rad_s", "torque_nm", phase];
    let columns = shown.map(|name| Column {
        name,
        kind: ColumnKind::Number,
    });
    let rows = items.iter().filter_map(|item| match item {
        Item::Row(row) => Some(Item::Row(places.map(|at| row[at]).to_vec())),
        Item::Event(_) => None,
    });
    (columns.to_vec(), rows.collect())
}

#[test]
fn phases_of_a_recording_tell_the_events_of_the_run() {
    for place in [0, 2, 3, 4, 5, 6] {
        let (effects, speeds, ends) = EXAMINED[place];
        let scene = scene(effects, speeds, ends, STEPPED);
        let settings = scene.effect_settings();
        let (columns, items) = ran(&scene);
        let run = collect(&settings, &columns, &items).symptoms.expect("one");
        let effect = run.list[0].words.effect();
        let (columns, items) = as_recorded(&columns, &items, effect);
        let recorded = collect(&settings, &columns, &items).symptoms.expect("one");
        assert!(recorded.list[0].shows_all() && recorded.together.is_none());
        let events = |symptoms: &Symptoms| symptoms.list[0].timeline.events.clone();
        // Letting go says nothing where the beats were over already, and a tooth at
        // rest nothing at all.
        let is_quiet = |event: &SymptomEvent| {
            event.word == Word::Stop || (effect == "cogwheel" && event.omega_rad_s == 0.0)
        };
        let told = |symptoms: &Symptoms| -> Vec<SymptomEvent> {
            events(symptoms)
                .into_iter()
                .filter(|e| !is_quiet(e))
                .collect()
        };
        let (found, expected) = (told(&recorded), told(&run));
        let words =
            |events: &[SymptomEvent]| -> Vec<Word> { events.iter().map(|e| e.word).collect() };
        assert_eq!(words(&found), words(&expected), "{effect}");
        for (found, expected) in found.iter().zip(&expected) {
            near(found.time_s, expected.time_s, 1.1e-3);
            near(found.angle_rad, expected.angle_rad, 4e-3);
        }
        let stays = |symptoms: &Symptoms| symptoms.list[0].timeline.stays.clone();
        assert_eq!(stays(&recorded), stays(&run), "{effect}");
    }
}

#[test]
fn while_it_is_not_armed_nothing_is_told() {
    let columns = [
        "t_s",
        "angle_rad",
        "omega_rad_s",
        "torque_nm",
        "range_limit_phase",
    ];
    let columns = columns.map(|name| Column {
        name,
        kind: ColumnKind::Number,
    });
    let row = |t: f64, angle: f64, phase: f64| Item::Row(vec![t, angle, 1.0, 0.0, phase]);
    let items = [
        row(0.0, 2.2, f64::NAN),
        row(1.0, 2.0, 0.0),
        row(2.0, 2.1, f64::NAN),
        row(3.0, 2.2, 1.0),
        row(4.0, 2.3, 1.0),
    ];
    let symptoms = collect(&EffectSettings::default(), &columns, &items).symptoms;
    let symptom = &symptoms.expect("a phase").list[0];
    assert!(symptom.timeline.events.is_empty() && symptom.found.met.is_empty());
    assert_eq!(symptom.timeline.stays.len(), 1);
    let strokes = symptom.path.strokes().expect("few");
    assert_eq!(
        strokes.iter().map(|s| s.points.len()).collect::<Vec<_>>(),
        [1, 2]
    );
}

/// An hour of everything at once, without end.
#[test]
fn memory_does_not_grow_with_the_run() {
    let symptoms: Vec<Words> = Words::all().collect();
    let mut names = vec!["t_s", "angle_rad", "omega_rad_s"];
    for words in &symptoms {
        let spec = words.spec;
        names.extend([spec.column, spec.phases.expect("phases").column]);
    }
    let columns: Vec<Column> = names
        .into_iter()
        .map(|name| Column {
            name,
            kind: ColumnKind::Number,
        })
        .collect();
    let mut collector = Collector::new(&Setup {
        columns: &columns,
        rows_expected: 0,
        row_step_s: 1e-3,
        levels: None,
        effects: EffectSettings::default(),
    });
    let mut random = fastrand::Rng::with_seed(1);
    for i in 0..600_000_u32 {
        let time_s = f64::from(i) * 6e-3;
        let mut row = vec![time_s, time_s.sin(), time_s.cos()];
        for words in &symptoms {
            row.extend([6.5 * random.f64(), f64::from(random.u8(..2))]);
            for (word, _) in words.named() {
                collector.symptom(&SymptomEvent {
                    time_s,
                    effect: words.effect(),
                    word,
                    angle_rad: row[1],
                    omega_rad_s: row[2],
                    torque_before_nm: 0.0,
                    torque_after_nm: 1.0,
                });
            }
        }
        collector.row(&row);
    }
    let found = collector.finish().symptoms.expect("all");
    assert_eq!(found.list.len(), symptoms.len());
    for symptom in &found.list {
        let Timeline {
            line,
            stays,
            events,
            ..
        } = &symptom.timeline;
        assert!(line.stored() <= Timeline::LINE);
        assert!(stays.len() <= Timeline::MOST && events.len() <= Timeline::MOST);
        assert!(symptom.path.stored() <= Path::CAPACITY + 2002);
        let Occurrences {
            met,
            bouts,
            beats,
            movement,
            ..
        } = &symptom.found;
        assert!(met.len() <= Occurrences::MOST && bouts.len() <= Occurrences::MOST);
        assert!(beats.len() <= Occurrences::MOST && movement.rates.len() <= 2);
    }
    let of = |effect| found.list.iter().find(|s| s.words.effect() == effect);
    let clonus = of("clonus").expect("it is there");
    assert_eq!(clonus.found.beats.len(), Occurrences::MOST);
    assert!(clonus.found.left_out > 500_000);
    let together = found.together.expect("seven");
    assert!(together.line.stored() <= Timeline::LINE);
    assert!(together.path.stored() <= Path::CAPACITY + 2002);
}
