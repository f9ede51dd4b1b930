//! The symptoms of random scenes: the laws stepped at 20 kHz in f64 against the
//! event-driven reference.
//!
//! Compared are the events of a symptom itself in their order, their times, and the
//! torque at the ticks. Left out: what the play under it does; and what rounding
//! decides, which is whether two events within two ticks are two, and on which side of
//! one a tick's torque is.

mod random_scene;

use crepitus_model::render::effects::symptom::Word;
use crepitus_scene::run::columns;
use crepitus_scene::trace::SymptomEvent;
use crepitus_scene::{Observer, Overrides, Scene, run};
use random_scene::{Random, TICK_S, Tolerance, effects, motion};
use std::convert::Infallible;
use std::path::Path;

/// Scenes of each of the ten forms of a symptom, numbered from zero: the number is the seed.
const SCENES: u64 = 60;

/// Scenes of each form in the long mode.
const LONG_SCENES: u64 = 550;

/// Length of a scene, s.
const END_S: f64 = 1.5;

/// Events closer than this may merge or change places.
const CLOSE_S: f64 = 2.0 * TICK_S;

#[derive(Default)]
struct Keep {
    rows: Vec<Vec<f64>>,
    events: Vec<SymptomEvent>,
}

impl Observer for Keep {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        self.rows.push(values.to_vec());
        Ok(())
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Infallible> {
        self.events.push(*event);
        Ok(())
    }
}

/// The rows of a scene as (s, N·m of the symptom), and its events.
fn render(text: &str, solver: &str) -> (Vec<(f64, f64)>, Vec<SymptomEvent>) {
    let text = format!("{text}\n[solver]\n{solver}\n");
    let scene = Scene::parse(Path::new("random.toml"), &text, &Overrides::default())
        .unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mut keep = Keep::default();
    let Ok(_) = run(&scene, &mut keep) else {
        panic!("it did not run:\n{text}");
    };
    let names = columns(&scene);
    let place = |is: &dyn Fn(&str) -> bool| names.iter().position(|c| is(c.name));
    let time = place(&|name| name == "t_s").unwrap();
    let nm = place(&|name| name.ends_with("_nm") && !SUMS.contains(&name)).unwrap();
    let rows = keep.rows.iter().map(|row| (row[time], row[nm])).collect();
    (rows, keep.events)
}

/// Columns that are of no symptom.
const SUMS: [&str; 3] = ["hand_torque_nm", "torque_nm", "model_torque_nm"];

/// Returns the events without those whose order, or existence, rounding decides.
fn apart(events: &[SymptomEvent], others: &[SymptomEvent]) -> Vec<SymptomEvent> {
    let is_close = |e: &SymptomEvent| {
        [events, others].iter().any(|list| {
            let near = list
                .iter()
                .filter(|o| (o.time_s - e.time_s).abs() < CLOSE_S);
            near.count() > 1
        })
    };
    events.iter().filter(|e| !is_close(e)).copied().collect()
}

#[derive(Default)]
struct Worst {
    late_s: f64,
    nm: f64,
    events: usize,
    rows: usize,
}

/// Fails with the first disagreement, if there is any.
fn compare(text: &str, tolerance: &Tolerance, worst: &mut Worst) -> Result<(), String> {
    let (rows, events) = render(
        text,
        "kind = \"exact-events\"\nstep_s = 5e-5\nprecision = \"f64\"",
    );
    let (exact_rows, exact_events) = render(text, "kind = \"reference\"");
    // A tooth that passes a joint at rest without a change is silent, or not.
    let is_felt = |e: &SymptomEvent| {
        let is_tooth = matches!(e.word, Word::Give | Word::Catch) && e.effect == "cogwheel";
        !is_tooth || e.omega_rad_s != 0.0 || e.torque_before_nm != e.torque_after_nm
    };
    let own = |e: &SymptomEvent| !e.word.is_of_play() && is_felt(e);
    let events: Vec<_> = events.into_iter().filter(own).collect();
    let exact_events: Vec<_> = exact_events.into_iter().filter(own).collect();
    let found = apart(&events, &exact_events);
    let expected = apart(&exact_events, &events);
    let words = |list: &[SymptomEvent]| -> Vec<_> {
        list.iter().map(|e| (e.word.name(), e.time_s)).collect()
    };
    let names = |list: &[SymptomEvent]| -> Vec<_> { list.iter().map(|e| e.word).collect() };
    if names(&found) != names(&expected) {
        let (found, expected) = (words(&found), words(&expected));
        let differ = found.iter().zip(&expected).position(|(a, b)| a.0 != b.0);
        let from = differ.unwrap_or(found.len().min(expected.len()));
        let from = from.saturating_sub(2);
        let show = |list: &[(&'static str, f64)]| {
            format!("{:?}", list.iter().skip(from).take(6).collect::<Vec<_>>())
        };
        return Err(format!(
            "events {}\n   for {}",
            show(&found),
            show(&expected)
        ));
    }
    for (e, exact) in found.iter().zip(&expected) {
        let late_s = (e.time_s - exact.time_s).abs();
        if late_s > tolerance.time_s {
            return Err(format!("{e:?} is {late_s:e} s off {exact:?}"));
        }
        worst.late_s = worst.late_s.max(late_s);
    }
    worst.events += found.len();
    let all: Vec<f64> = events
        .iter()
        .chain(&exact_events)
        .map(|e| e.time_s)
        .collect();
    for (&(time_s, nm), &(exact_s, exact_nm)) in rows.iter().zip(&exact_rows) {
        assert!((time_s - exact_s).abs() < 1e-9, "other rows");
        if all.iter().any(|t| (t - time_s).abs() < CLOSE_S) {
            continue;
        }
        let error_nm = (nm - exact_nm).abs();
        if error_nm > tolerance.torque_nm {
            return Err(format!("at {time_s} s {nm} for {exact_nm} N·m"));
        }
        worst.nm = worst.nm.max(error_nm);
        worst.rows += 1;
    }
    Ok(())
}

fn agree(name: &str, form: &str, tolerance: &Tolerance) {
    let mut worst = Worst::default();
    let mut wrong = Vec::new();
    let is_long = std::env::var_os("CREPITUS_LONG").is_some();
    for seed in 0..if is_long { LONG_SCENES } else { SCENES } {
        let mut random = Random::new(seed, name, form);
        let effect = effects(name, form, &mut random);
        let jumps = if seed % 2 == 1 { 0.3 } else { 0.0 };
        let motion = motion(&mut random, END_S, jumps);
        let text =
            format!("version = 1\ntitle = \"random\"\nduration_s = {END_S:?}\n{effect}\n{motion}");
        if let Err(what) = compare(&text, tolerance, &mut worst) {
            wrong.push(format!("{name} {form} {seed}: {what}\n{text}"));
        }
    }
    println!(
        "{name} {form}: {} events within {:.1e} s, {} torques within {:.1e} N·m",
        worst.events, worst.late_s, worst.rows, worst.nm
    );
    let first = wrong
        .iter()
        .take(3)
        .cloned()
        .collect::<Vec<_>>()
        .join("\n\n");
    assert!(wrong.is_empty(), "{} disagree\n{first}", wrong.len());
    assert!(worst.events > 30 || name == "lead-pipe", "few events");
}

/// An event is located on a parabola, on which a sine is not quite; torques differ most
/// where a play turns and where it meets a bent limit within a tick.
const USUAL: Tolerance = Tolerance {
    time_s: 1e-6,
    torque_nm: 1e-4,
};

/// Tolerance for a release by torque: in its tick the torque is a line between its ends.
const LINE: Tolerance = Tolerance {
    time_s: 1e-5,
    ..USUAL
};

/// Tolerance for a reflex, of 0.04 N·m at most: it may begin within a tick.
const SMALL: Tolerance = Tolerance {
    torque_nm: 1e-6,
    ..USUAL
};

#[test]
fn range_limit() {
    agree("range-limit", "", &USUAL);
}

#[test]
fn lead_pipe() {
    agree("lead-pipe", "", &USUAL);
}

#[test]
fn cogwheel_in_time() {
    agree("cogwheel", "time", &USUAL);
}

#[test]
fn cogwheel_in_space() {
    agree("cogwheel", "space", &USUAL);
}

#[test]
fn catch() {
    agree("spasticity", "catch", &USUAL);
}

#[test]
fn reflex() {
    agree("spasticity", "reflex", &SMALL);
}

#[test]
fn clasp_knife_by_angle() {
    agree("clasp-knife", "angle", &USUAL);
}

#[test]
fn clasp_knife_by_torque() {
    agree("clasp-knife", "torque", &LINE);
}

#[test]
fn clonus() {
    agree("clonus", "", &USUAL);
}

#[test]
fn texture() {
    agree("texture", "", &USUAL);
}
