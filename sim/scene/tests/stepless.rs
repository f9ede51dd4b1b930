//! A run without a trace goes from event to event where it can: on random joints, motions and
//! conventions its events and totals are those of its steps.

use crepitus_scene::cpu_time;
use crepitus_scene::run::{Observer, is_stepless};
use crepitus_scene::shipped::Source;
use crepitus_scene::trace::EventRecord;
use crepitus_scene::{Overrides, Scene, Summary, run};
use fastrand::Rng;
use serde_json::Value;
use std::convert::Infallible;
use std::fmt::Write;
use std::path::Path;

/// Largest difference of an event's time, s.
const EVENT_LIMIT_S: f64 = 1e-9;
/// Rows of 4 s of `low-speed` for each second of CPU time, in a release build: what is asked for, and
/// the least.
const ROWS: [f64; 2] = [2500.0, 1500.0];
/// The least ratio of the CPU times of a run of it with its steps and without.
const LEAST_RATIO: f64 = 8.0;

/// Largest difference of a total, as a share of the largest of its kind. On a curved motion an event of the steps is
/// up to [`EVENT_LIMIT_S`] from the true one, and what swings with it differs by that in radians of the swing.
const SUM_LIMIT: f64 = 1e-9;

/// Sees events only; makes every step if `STEPS`.
#[derive(Default)]
struct Seen<const STEPS: bool>(Vec<EventRecord>);

impl<const STEPS: bool> Observer for Seen<STEPS> {
    type Error = Infallible;
    const WANTS_ROWS: bool = false;
    const NEEDS_STEPS: bool = STEPS;

    fn event(&mut self, event: &EventRecord) -> Result<(), Infallible> {
        self.0.push(*event);
        Ok(())
    }
}

fn runs(scene: &Scene) -> [(Vec<EventRecord>, Summary); 2] {
    let (mut steps, mut events) = (Seen::<true>::default(), Seen::<false>::default());
    let summary = run(scene, &mut steps).unwrap();
    let stepless = run(scene, &mut events).unwrap();
    [(steps.0, summary), (events.0, stepless)]
}

fn parse(text: &str) -> Scene {
    Scene::parse(Path::new("random.toml"), text, &Overrides::default())
        .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// A number between two, evenly in its logarithm.
fn log(random: &mut Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(random.f64())
}

/// A joint on a shaft that a hand moves.
fn scene_text(random: &mut Rng) -> String {
    let step_s = [5e-5, 1e-4, 3.1e-5, 1e-3][random.usize(..4)];
    // Some end within a step.
    let duration_s = 0.3 + 1.2 * random.f64();
    let mut text = format!(
        "version = 1\ntitle = \"random\"\nduration_s = {duration_s:?}\n\
         [solver]\nkind = \"exact-events\"\nstep_s = {step_s:?}\n[motion]\n"
    );
    let speed = log(random, 0.02, 6.0) * if random.bool() { 1.0 } else { -1.0 };
    let kind = random.f64();
    if kind < 0.15 {
        let _ = writeln!(
            text,
            "kind = \"sine\"\namplitude_deg = {:?}\nfrequency_hz = {:?}\nphase_deg = {:?}",
            log(random, 3.0, 60.0),
            log(random, 0.1, 2.0),
            360.0 * random.f64()
        );
    } else if kind < 0.3 {
        let _ = writeln!(
            text,
            "kind = \"strokes\"\nfrom_deg = {:?}\nto_deg = {:?}\npeak_speed_deg_s = {:?}\n\
             pause_s = {:?}",
            40.0 * random.f64(),
            60.0 + 60.0 * random.f64(),
            log(random, 30.0, 300.0),
            0.2 * random.f64()
        );
    } else if kind < 0.5 {
        let _ = writeln!(text, "kind = \"constant\"\nvelocity_rad_s = {speed:?}");
    } else {
        let _ = writeln!(text, "kind = \"velocity-knots\"");
        let (mut time_s, mut right) = (0.0, speed);
        let mut left = right;
        loop {
            let _ = writeln!(
                text,
                "[[motion.knots]]\nt_s = {time_s:?}\nomega_left_rad_s = {left:?}\n\
                 omega_right_rad_s = {right:?}"
            );
            if time_s > duration_s {
                break;
            }
            time_s += log(random, 0.02, 0.6);
            if random.f64() < 0.4 {
                time_s = (time_s / step_s).round() * step_s;
            }
            left = match random.usize(..4) {
                0 => right,
                1 => 0.0,
                _ => speed * (2.0 * random.f64() - 1.0),
            };
            right = if random.f64() < 0.4 {
                speed * (2.0 * random.f64() - 1.0)
            } else {
                left
            };
        }
    }
    let static_nm = log(random, 0.05, 2.0);
    let kinetic_nm = static_nm * (0.3 + 0.6 * random.f64());
    let stiffness = log(random, 50.0, 2000.0);
    let inertia = log(random, 3e-4, 0.05);
    // On a curved motion the steps of `physical` are not that close.
    let convention = ["frozen", "physical"][random.usize(..2) * usize::from(kind >= 0.3)];
    let damping = if convention == "frozen" || random.bool() {
        0.0
    } else {
        2.0 * (stiffness * inertia).sqrt() * log(random, 1e-3, 0.6)
    };
    let restart = if convention == "frozen" && random.bool() {
        "from-kinetic"
    } else {
        "elastic"
    };
    let _ = write!(
        text,
        "[effects.crepitus]\nconvention = \"{convention}\"\nrestart = \"{restart}\"\n\
         static_torque_nm = {static_nm:?}\nkinetic_torque_nm = {kinetic_nm:?}\n\
         stiffness_nm_per_rad = {stiffness:?}\ninertia_kg_m2 = {inertia:?}\n\
         damping_nms_per_rad = {damping:?}\n"
    );
    text
}

/// Totals of a summary by their paths, without those that depend on the computer.
fn numbers(summary: &Summary) -> Vec<(String, f64)> {
    fn flatten(path: &str, value: &Value, to: &mut Vec<(String, f64)>) {
        match value {
            Value::Object(inner) => {
                for (name, value) in inner {
                    flatten(&format!("{path}/{name}"), value, to);
                }
            }
            Value::Number(number) => to.push((path.to_owned(), number.as_f64().unwrap())),
            _ => {}
        }
    }
    let whole = serde_json::to_value(summary).unwrap();
    let mut to = Vec::new();
    for key in [
        "simulated_s",
        "steps",
        "fastest_rad_s",
        "events",
        "cycles",
        "torque",
        "energy",
        "lead",
    ] {
        flatten(key, &whole[key], &mut to);
    }
    to
}

/// The largest difference of a total, as a share of the largest of its kind, and its name.
fn worst_sum(scene: &Scene, steps: &Summary, events: &Summary) -> (f64, String) {
    let (steps, events) = (numbers(steps), numbers(events));
    assert_eq!(steps.len(), events.len());
    let group = |name: &str| name.split('/').next().unwrap().to_owned();
    let of = |name: &str| steps.iter().find(|(n, _)| n == name).map_or(0.0, |x| x.1);
    let largest = |name: &str| {
        let of_group = steps.iter().filter(|(n, _)| group(n) == group(name));
        of_group.map(|(_, x)| x.abs()).fold(0.0, f64::max)
    };
    // The lead is a small difference of two velocities.
    let p = &scene.crepitus.as_ref().unwrap().settings.parameters;
    let velocity =
        of("fastest_rad_s") + p.natural_rad_s() * p.static_torque_nm / p.stiffness_nm_per_rad;
    let mut worst = (0.0, String::new());
    for ((name, a), (other, b)) in steps.iter().zip(&events) {
        assert_eq!(name, other);
        let scale = match name.as_str() {
            "lead/worst_behind_rad_s" => velocity,
            "lead/behind_j" => p.kinetic_torque_nm * velocity * of("lead/behind_s"),
            // Residuals are rounding.
            name if group(name) == "lead" || group(name) == "cycles" => a.abs().max(b.abs()),
            name => largest(name),
        };
        let share = if a == b { 0.0 } else { (a - b).abs() / scale };
        if !name.ends_with("residual_relative") && share > worst.0 {
            worst = (share, format!("{name}: {a:e} in steps, {b:e}"));
        }
    }
    worst
}

#[test]
fn events_and_totals_are_those_of_the_steps() {
    let (mut scenes, mut events_in_all) = (0, 0);
    let (mut worst_event_s, mut worst_total) = (0.0_f64, [0.0_f64; 2]);
    for seed in 0..400 {
        let text = scene_text(&mut Rng::with_seed(seed));
        let scene = parse(&text);
        assert!(is_stepless(&scene), "{text}");
        let [(stepped, summary), (events, totals)] = runs(&scene);
        let kinds = |events: &[EventRecord]| -> Vec<_> {
            events.iter().map(|e| (e.kind, e.from, e.to)).collect()
        };
        assert!(
            kinds(&stepped) == kinds(&events),
            "{seed}: {} and {} events\n{text}",
            stepped.len(),
            events.len()
        );
        for (a, b) in stepped.iter().zip(&events) {
            let apart_s = (a.time_s - b.time_s).abs();
            assert!(
                apart_s <= EVENT_LIMIT_S,
                "{seed}, {} s: {apart_s:e} s\n{text}",
                a.time_s
            );
            let torques = |e: &EventRecord| [e.torque_before_nm, e.torque_after_nm];
            let static_nm = scene
                .crepitus
                .as_ref()
                .unwrap()
                .settings
                .parameters
                .static_torque_nm;
            for (a_nm, b_nm) in torques(a).into_iter().zip(torques(b)) {
                let apart_nm = (a_nm - b_nm).abs();
                assert!(apart_nm <= 1e-6 * static_nm, "{seed}: {a:?} {b:?}\n{text}");
            }
            worst_event_s = worst_event_s.max(apart_s);
        }
        let (share, name) = worst_sum(&scene, &summary, &totals);
        let is_curved = !scene.motion.is_parabolic();
        let swung = EVENT_LIMIT_S
            * scene
                .crepitus
                .as_ref()
                .unwrap()
                .settings
                .parameters
                .natural_rad_s();
        let limit = SUM_LIMIT + if is_curved { swung } else { 0.0 };
        assert!(share <= limit, "{seed}: {share:e}, {name}\n{text}");
        worst_total[usize::from(is_curved)] = worst_total[usize::from(is_curved)].max(share);
        scenes += 1;
        events_in_all += events.len();
    }
    println!(
        "{scenes} scenes, {events_in_all} events: {worst_event_s:.1e} s apart at most, totals {:.1e}, on curved \
         motions {:.1e}",
        worst_total[0], worst_total[1]
    );
    assert!(events_in_all > 10_000);
}

#[test]
fn a_crowded_step_is_walked() {
    // A swing of 20 µs: every step has more events than a step reports.
    let text = "version = 1\ntitle = \"crowded\"\nduration_s = 0.02\n\
                [solver]\nkind = \"exact-events\"\nstep_s = 1e-3\n\
                [motion]\nkind = \"constant\"\nvelocity_rad_s = 20.0\n\
                [effects.crepitus]\nstiffness_nm_per_rad = 1000.0\ninertia_kg_m2 = 1e-8\n\
                static_torque_nm = 0.2\nkinetic_torque_nm = 0.1\ndamping_nms_per_rad = 0.0\n";
    let scene = parse(text);
    assert!(is_stepless(&scene));
    let [(stepped, summary), (events, totals)] = runs(&scene);
    assert!(stepped.len() > 100 && summary.warnings == totals.warnings);
    assert!(!totals.warnings.is_empty());
    for (a, b) in stepped.iter().zip(&events) {
        assert!((a.time_s - b.time_s).abs() <= EVENT_LIMIT_S);
    }
    assert_eq!(stepped.len(), events.len());
    assert_eq!(numbers(&summary), numbers(&totals));
}

#[test]
fn what_depends_on_steps_is_stepped() {
    let with = |old: &str, new: &str| {
        let text = "version = 1\ntitle = \"t\"\nduration_s = 1.0\n[solver]\nkind = \"exact-events\"\n\
                    step_s = 5e-5\n[motion]\nkind = \"constant\"\nvelocity_rad_s = 0.5\n\
                    [effects.crepitus]\n";
        let changed = text.replace(old, new);
        assert!(old.is_empty() || changed != text, "{old}");
        is_stepless(&parse(&changed))
    };
    assert!(with("", ""));
    for (old, new) in [
        ("exact-events", "exact"),
        ("step_s = 5e-5", "step_s = 5e-5\nprecision = \"f32\""),
        (
            "kind = \"constant\"\nvelocity_rad_s = 0.5\n[effects.crepitus]",
            "kind = \"sine\"\namplitude_deg = 30\nfrequency_hz = 1.0\n[effects.crepitus]\nconvention = \"physical\"",
        ),
        (
            "[effects.crepitus]",
            "[effects.crepitus]\nconvention = \"paper\"",
        ),
        (
            "[effects.crepitus]",
            "[effects.crepitus]\n[effects.encoder]",
        ),
        ("[effects.crepitus]", "[effects.crepitus]\n[effects.motor]"),
        (
            "[effects.crepitus]",
            "[effects.crepitus]\n[effects.lead-pipe]",
        ),
        (
            "[effects.crepitus]",
            "[effects.crepitus]\nstatic_torque_nm = 20.0",
        ),
    ] {
        assert!(!with(old, new), "{new}");
    }
}

/// Cost of a row of a sweep but for its cells: `cargo test --release -p crepitus-scene --test stepless -- \
/// --nocapture` prints it.
#[test]
fn a_row_of_a_sweep_costs_little_more_than_its_scene() {
    let source = Source::find(Path::new("low-speed")).unwrap();
    let scene_of = |n: u32| {
        let values = [
            ("duration_s", 4.0),
            (
                "effects.crepitus.static_torque_nm",
                0.4 + 1e-5 * f64::from(n),
            ),
        ];
        let set = values.map(|(path, value)| (path.to_owned(), format!("{value:?}")));
        let overrides = Overrides {
            set: set.to_vec(),
            ..Overrides::default()
        };
        source.scene(&overrides).unwrap()
    };
    let timed = |work: &mut dyn FnMut()| {
        let begun = cpu_time::now();
        work();
        cpu_time::now().saturating_sub(begun).as_secs_f64()
    };
    let (mut ratios, mut rows) = (Vec::new(), Vec::new());
    for round in 0..9 {
        let scenes: Vec<_> = (0..20).map(|n| scene_of(20 * round + n)).collect();
        let steps_s = timed(&mut || {
            for scene in scenes.iter().take(4) {
                run(scene, &mut Seen::<true>::default()).unwrap();
            }
        });
        let events_s = timed(&mut || {
            for scene in &scenes {
                run(scene, &mut Seen::<false>::default()).unwrap();
            }
        });
        let rows_s = timed(&mut || {
            for n in 0..20 {
                let scene = scene_of(20 * round + n);
                let summary = run(&scene, &mut Seen::<false>::default()).unwrap();
                std::hint::black_box(serde_json::to_value(&summary).unwrap());
            }
        });
        ratios.push(5.0 * steps_s / events_s);
        rows.push(20.0 / rows_s);
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let (ratio, rows) = (median(&mut ratios), median(&mut rows));
    println!("a run of 4 s of low-speed: {ratio:.1} times quicker without its steps");
    println!("{rows:.0} rows for each second of CPU time, with scene and summary");
    assert!(ratio >= LEAST_RATIO, "{ratio}");
    if !cfg!(debug_assertions) {
        let [aim, least] = ROWS;
        println!("asked for {aim}, at least {least}");
        assert!(rows >= least, "{rows}");
    }
}
