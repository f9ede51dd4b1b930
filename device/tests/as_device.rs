//! A scene with a device renders bit-identical torque to the drive on the same
//! counts: both use one pipeline.

mod support;

use crepitus_model::render::Limit;
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_protocol::{Fault, LimitReason, State};
use crepitus_scene::reference::symptoms::NAMES;
use crepitus_scene::scene::Overrides;
use crepitus_scene::trace::EventRecord;
use crepitus_scene::values::values;
use crepitus_scene::{Observer, Scene, run};
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use support::{Bench, Boots, TICKS_PER_MS};

/// Length of each scene, ms.
const LENGTH_MS: u32 = 2_000;

/// The device's columns of a trace row.
#[derive(Clone, Copy)]
struct Row {
    count: i32,
    omega_rad_s: f64,
    /// None without a joint.
    model_nm: Option<f64>,
    shown_nm: f64,
    limit: u8,
}

/// Records rows.
struct RowRecorder {
    places: [usize; 4],
    model: Option<usize>,
    rows: Vec<Row>,
}

impl Observer for RowRecorder {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        let [count, omega_rad_s, shown_nm, limit] = self.places.map(|at| values[at]);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole numbers"
        )]
        self.rows.push(Row {
            count: count as i32,
            omega_rad_s,
            model_nm: self.model.map(|at| values[at]),
            shown_nm,
            limit: limit as u8,
        });
        Ok(())
    }

    fn event(&mut self, _: &EventRecord) -> Result<(), Infallible> {
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Infallible> {
        Ok(())
    }
}

/// A hand that turns back in its slips, with all that a device adds.
const TURNS_BACK: &str = r#"
version = 1
title = "A hand that turns back"
duration_s = 2.0
device = true
[motion]
kind = "sine"
amplitude_deg = 2.0
frequency_hz = 7.0
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.crepitus]
preset = "coarse"
[effects.encoder]
[effects.drivetrain]
[effects.friction-compensation]
[effects.bone-shaping]
[output]
trace_step_s = 5e-5
"#;

/// Six symptoms with choices that are not the first, from a straight knee to 80°
/// and back. (The teeth of a cogwheel in time begin with arming.)
const SYMPTOMS: &str = r#"
version = 1
title = "Six symptoms"
duration_s = 2.0
device = true
[motion]
kind = "sine"
from_deg = 40.0
amplitude_deg = 40.0
frequency_hz = 0.5
phase_deg = -90.0
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.encoder]
[effects.range-limit]
flexion_limit_deg = 70.0
[effects.lead-pipe]
[effects.cogwheel]
mode = "space"
torque_nm = 0.8
[effects.spasticity]
form = "reflex"
muscles = "flexors"
threshold_deg = -10.0
velocity_shift_s = 0.27
[effects.clasp-knife]
trigger = "torque"
[effects.texture]
[output]
trace_step_s = 5e-5
"#;

/// A shipped scene as the drive would run it, or the reason why it cannot.
fn scene(file: &Path) -> Result<Scene, String> {
    let mut overrides = Overrides {
        precision: Some("f32".to_owned()),
        step: Some("5e-5".to_owned()),
        as_device: true,
        ..Overrides::default()
    };
    let duration_s = f64::from(LENGTH_MS) * 1e-3;
    for (path, value) in [
        ("solver.kind", "\"exact-events\"".to_owned()),
        ("duration_s", duration_s.to_string()),
        ("output.trace_step_s", "5e-5".to_owned()),
        ("effects.encoder.lines", "512".to_owned()),
    ] {
        overrides.set.push((path.to_owned(), value));
    }
    let scene = Scene::read(file, &overrides).map_err(|e| e.to_string())?;
    if scene.has("cogwheel") {
        return Err("its teeth follow each other in time, from arming on".to_owned());
    }
    Ok(scene)
}

fn rows(scene: &Scene) -> Vec<Row> {
    let columns = crepitus_scene::run::columns(scene);
    let place = |name| columns.iter().position(|c| c.name == name);
    let mut rows = RowRecorder {
        places: ["encoder_count", "omega_rad_s", "shown_nm", "limit"]
            .map(|name| place(name).expect(name)),
        model: place("torque_nm"),
        rows: Vec::new(),
    };
    run(scene, &mut rows).expect("it runs");
    rows.rows
}

/// Ticks in which the shaft is turned to where a scene begins, and in which its
/// velocity settles there.
const TURNING: u32 = 10_000;
const SETTLING_MS: u32 = 1_000;

fn has_symptoms(scene: &Scene) -> bool {
    NAMES.iter().any(|symptom| scene.has(symptom))
}

fn commit(bench: &mut Bench, scene: &Scene) {
    let base = bench.comms.revision();
    let values = values(scene).expect("a joint of the device");
    let answer = bench.ask(Operation::Commit { base, values });
    assert!(matches!(answer, Ok(Answer::Committed { .. })), "{answer:?}");
}

/// Replays the counts of these rows to a drive that was zeroed at 0 deg, got the
/// effects where they begin, and was armed there long before.
fn drive(scene: &Scene, rows: &[Row]) -> Bench {
    let first = rows[0].count;
    // Who has been turned never rests to the last bit again: where no angle matters,
    // the drive is zeroed where it stands.
    let zero = if has_symptoms(scene) { 0 } else { first };
    let mut boots = Boots::new();
    boots.drive.counter = zero.cast_unsigned();
    let mut bench = Bench::new(&boots);
    bench.motor.turned = Some((0, 0.0));
    bench.settle();
    let mut healthy = scene.clone();
    for effect in scene.effects() {
        healthy = healthy.without(effect).unwrap_or(healthy);
    }
    commit(&mut bench, &healthy);
    bench.ask(Operation::Zero).expect("zeroed");
    let turned = |tick: u32| {
        let share = f64::from(tick) / f64::from(TURNING);
        #[expect(clippy::cast_possible_truncation, reason = "some counts")]
        let count = (f64::from(first - zero) * share * share * (3.0 - 2.0 * share)).round() as i32;
        (count, 0.0)
    };
    bench.script = (1..=TURNING).map(turned).collect();
    bench.run_leased(TURNING / TICKS_PER_MS + SETTLING_MS);
    bench.rendered.clear();
    commit(&mut bench, scene);
    bench.ask(Operation::Arm).expect("armed");
    // Until the slew limit no longer applies.
    bench.run_leased(200);
    assert_eq!(
        bench.drive.state(),
        State::Armed,
        "{:?}",
        bench.drive.fault()
    );
    let moved = rows.iter().map(|r| (r.count - zero, r.omega_rad_s));
    bench.script = moved.collect();
    let ms = u32::try_from(rows.len()).expect("a few") / TICKS_PER_MS + 1;
    bench.run_leased(ms);
    bench
}

#[test]
fn a_scene_shows_what_the_drive_shows_on_the_same_counts_bit_for_bit() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("the scenes")
        .map(|file| file.expect("a file").path())
        .collect();
    files.sort();
    let (mut compared, mut with_stages, mut with_symptoms) = (0, 0, 0);
    for file in files {
        let name = file.file_stem().expect("a name").display().to_string();
        match scene(&file) {
            Ok(scene) => {
                let limits = compare(&name, &scene);
                if limits.is_none() {
                    continue;
                }
                compared += 1;
                let has_stages = scene.has("friction-compensation") || scene.has("bone-shaping");
                with_stages += u32::from(has_stages);
                with_symptoms += u32::from(has_symptoms(&scene));
            }
            Err(why) => println!("{name}: left out, {why}"),
        }
    }
    println!(
        "{compared} scenes, {with_stages} with stages behind the joint, {with_symptoms} with symptoms"
    );
    assert!(compared > 35 && with_stages > 1 && with_symptoms > 15);
    let scene = Scene::parse(
        Path::new("turns-back.toml"),
        TURNS_BACK,
        &Overrides::default(),
    );
    let limits = compare("turns-back", &scene.expect("a scene")).expect("to the end");
    assert!(
        limits[usize::from(Limit::TurnedBack as u8)] > 100,
        "{limits:?}"
    );
}

#[test]
fn symptoms_and_their_phases_are_those_of_the_scene_on_the_same_counts() {
    let path = Path::new("symptoms.toml");
    let scene = Scene::parse(path, SYMPTOMS, &Overrides::default()).expect("a scene");
    let rows = rows(&scene);
    let bench = drive(&scene, &rows);
    assert_eq!(bench.rendered.len(), rows.len());
    let mut seen = std::collections::BTreeSet::new();
    for (n, (row, rendered)) in rows.iter().zip(&bench.rendered).enumerate() {
        assert_eq!(f64::from(rendered.torque_nm), row.shown_nm, "tick {n}");
        seen.extend(
            rendered
                .phases
                .named()
                .map(|(spec, phase)| (spec.name, phase)),
        );
    }
    for phase in [
        ("range-limit", "in-the-wall"),
        ("lead-pipe", "sliding"),
        ("cogwheel", "high"),
        ("spasticity", "reflex"),
        ("clasp-knife", "fallen"),
        ("texture", "sliding"),
    ] {
        assert!(seen.contains(&phase), "{phase:?} of {seen:?}");
    }
}

/// Compares every tick; returns the ticks with each limit, unless the drive disarmed.
fn compare(name: &str, scene: &Scene) -> Option<[u32; 10]> {
    let rows = rows(scene);
    let bench = drive(scene, &rows);
    assert_eq!(bench.rendered.len(), rows.len(), "{name}");
    let mut limits = [0_u32; 10];
    for (n, (row, rendered)) in rows.iter().zip(&bench.rendered).enumerate() {
        // A shaft that jumps to its speed is more than the winding can take.
        if rendered.flags.limit() == LimitReason::NotArmed {
            let fault = bench.drive.fault().expect("a fault");
            println!("{name}: the drive lets go after {n} ticks, {fault:?}");
            assert!(matches!(fault, Fault::Overcurrent | Fault::Overspeed));
            return None;
        }
        let (shown, model) = (rendered.torque_nm, rendered.model_torque_nm);
        assert_eq!(f64::from(shown), row.shown_nm, "{name}, tick {n}");
        // A drive's is the joint's and the symptoms', of which a scene has a column each.
        if !has_symptoms(scene) {
            let model_nm = row.model_nm.unwrap_or(0.0);
            assert_eq!(f64::from(model), model_nm, "{name}, tick {n}");
        }
        let reason = rendered.flags.limit();
        assert_eq!(reason as u8, row.limit, "{name}, tick {n}");
        limits[usize::from(row.limit)] += 1;
    }
    println!("{name}: {} ticks, by limit {limits:?}", rows.len());
    Some(limits)
}

#[test]
fn a_limit_has_the_number_that_it_has_on_the_wire() {
    for (limit, reason) in [
        (Limit::None, LimitReason::None),
        (Limit::Torque, LimitReason::Torque),
        (Limit::Slew, LimitReason::Slew),
        (Limit::TurnedBack, LimitReason::TurnedBack),
        (Limit::Holding, LimitReason::Holding),
        (Limit::NotArmed, LimitReason::NotArmed),
        (Limit::Tank, LimitReason::Tank),
    ] {
        assert_eq!(SampleFlags::default().with_limit(reason).limit(), reason);
        assert_eq!(limit as u8, reason as u8);
    }
}
