//! Cost of effects in instructions, counted by valgrind: an effect that a
//! scene leaves out executes nothing, the costs of those that it lists add
//! up to that of the scene, and standard scenes cost what they did.
//!
//! Counts are those of this build's profile; only their ratios mean something. The table of the
//! standard scenes is that of the gate's build, and made again with
//! `CARGO_INCREMENTAL=0 CREPITUS_BLESS=1 cargo test -p crepitus-scene --test instructions`.
//! Without valgrind nothing is counted and the test reports it, unless
//! `CREPITUS_NEEDS_VALGRIND` is set.

use crepitus_plant::effect::Effect;
use crepitus_plant::effects::EFFECTS;
use crepitus_scene::run::Blind;
use crepitus_scene::{Overrides, Scene, instructions, run};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

/// Set for the process that is counted: the scene's file.
const SCENE_VARIABLE: &str = "CREPITUS_COUNTED_SCENE";
/// Set where a machine without valgrind is an error.
const NEEDED_VARIABLE: &str = "CREPITUS_NEEDS_VALGRIND";

/// A tenth of a second, or a fifth.
const STEPS: u32 = 2_000;

fn scene_text(effects: &[&Effect], steps: u32) -> String {
    use std::fmt::Write;
    let mut text = format!(
        "version = 1\ntitle = \"counted\"\nduration_s = {}\n\
         [motion]\nkind = \"sine\"\namplitude_deg = 30\nfrequency_hz = 1.0\n\
         [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\nprecision = \"f32\"\n",
        f64::from(steps) * 5e-5
    );
    for effect in effects {
        let _ = writeln!(text, "[effects.{}]", effect.name);
    }
    text
}

/// Change of a count from which on it is another, as a share: the next compiler's is.
const TOLERANCE: f64 = 0.03;

#[test]
fn standard_scenes_cost_what_they_did() {
    if !valgrind() {
        return;
    }
    if cfg!(not(debug_assertions)) || option_env!("CARGO_INCREMENTAL") != Some("0") {
        eprintln!("left out: the table is of the gate's build, with CARGO_INCREMENTAL=0");
        return;
    }
    let scenes = instructions::standard().unwrap();
    let counts = instructions::per_step(
        &std::env::current_exe().unwrap(),
        ["--exact", "counted_process", "--test-threads=1"],
        (scenes.len(), STEPS),
    )
    .unwrap();
    let rows = scenes.iter().zip(&counts);
    let mut table = String::from("scene,instructions_per_step\n");
    table.extend(rows.map(|((name, _), count)| format!("{name},{count:.0}\n")));
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/instructions.csv");
    if std::env::var_os("CREPITUS_BLESS").is_some() {
        std::fs::write(&file, &table).unwrap();
        return;
    }
    let known = std::fs::read_to_string(&file).unwrap();
    let changes = changes(&known, &table);
    assert!(
        changes.is_empty(),
        "{changes:#?}: if that is meant, make the table again"
    );
}

/// Rows of `table` that are not those of the `known` one within the tolerance.
fn changes(known: &str, table: &str) -> Vec<String> {
    assert_eq!(known.lines().count(), table.lines().count());
    let number = |line: &str| -> f64 { line.rsplit(',').next().unwrap().parse().unwrap() };
    let rows = known.lines().zip(table.lines()).skip(1);
    let change = |(was, is): (&str, &str)| {
        let change = number(is) / number(was) - 1.0;
        (change.abs() > TOLERANCE).then(|| format!("{is}, which was {was}: {:+.1} %", 1e2 * change))
    };
    rows.filter_map(change).collect()
}

#[test]
fn a_twentieth_more_or_less_is_a_change_and_a_hundredth_is_none() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/instructions.csv");
    let known = std::fs::read_to_string(file).unwrap();
    assert_eq!(known.lines().count(), 11);
    let times = |factor: f64| -> String {
        let cost = |line: &str| {
            let (name, count) = line.rsplit_once(',').unwrap();
            match count.parse::<f64>() {
                Ok(count) => format!("{name},{:.0}\n", count * factor),
                Err(_) => format!("{line}\n"),
            }
        };
        known.lines().map(cost).collect()
    };
    assert_eq!(changes(&known, &times(1.05)).len(), 10);
    assert_eq!(changes(&known, &times(0.95)).len(), 10);
    assert_eq!(changes(&known, &times(1.01)), [""; 0]);
}

/// The measured process: does nothing unless it is given a scene, or counted.
#[test]
fn counted_process() {
    if instructions::is_counted() {
        let standard = instructions::standard().unwrap();
        let scenes: Vec<_> = standard.into_iter().map(|(_, scene)| scene).collect();
        instructions::run_counted(&scenes, STEPS);
        return;
    }
    let Some(file) = std::env::var_os(SCENE_VARIABLE) else {
        return;
    };
    let scene = Scene::read(Path::new(&file), &Overrides::default()).unwrap();
    run(&scene, &mut Blind).unwrap();
}

/// Instructions by function.
type Profile = BTreeMap<String, u64>;

/// Counts a run of this many steps.
fn count(folder: &Path, effects: &[&Effect], steps: u32) -> Profile {
    let scene = folder.join(format!("{steps}.toml"));
    let out = folder.join(format!("{steps}.out"));
    std::fs::write(&scene, scene_text(effects, steps)).unwrap();
    let ran = Command::new("valgrind")
        .args([
            "--tool=callgrind",
            "--compress-strings=no",
            "--compress-pos=no",
        ])
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "counted_process", "--test-threads=1"])
        .env(SCENE_VARIABLE, &scene)
        .output()
        .unwrap();
    assert!(
        ran.status.success(),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    parse(&std::fs::read_to_string(&out).unwrap())
}

/// Own instructions of each function in a callgrind file: lines "fn=NAME",
/// then "line count"; the line after a "calls=" is that of the callee.
fn parse(text: &str) -> Profile {
    let mut profile = Profile::new();
    let (mut function, mut called) = (String::new(), false);
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("fn=") {
            name.clone_into(&mut function);
        } else if line.starts_with("calls=") {
            called = true;
        } else if let Some((_, count)) = line.split_once(' ')
            && line.starts_with(|c: char| c.is_ascii_digit() || "+-*".contains(c))
            && let Ok(count) = count.parse::<u64>()
        {
            if !called {
                *profile.entry(function.clone()).or_default() += count;
            }
            called = false;
        }
    }
    profile
}

/// Instructions for each step: what twice the steps need more.
fn per_step(folder: &Path, effects: &[&Effect]) -> f64 {
    let total = |steps| count(folder, effects, steps).values().sum::<u64>();
    let (once, twice) = thread::scope(|scope| {
        let once = scope.spawn(|| total(STEPS));
        let twice = total(2 * STEPS);
        (once.join().unwrap(), twice)
    });
    #[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
    let more = (twice - once) as f64;
    more / f64::from(STEPS)
}

fn valgrind() -> bool {
    let there = Command::new("valgrind").arg("--version").output().is_ok();
    let needed = std::env::var_os(NEEDED_VARIABLE).is_some();
    assert!(
        there || !needed,
        "{NEEDED_VARIABLE} is set, and there is no valgrind"
    );
    if !there {
        eprintln!("left out: there is no valgrind, so nothing was counted");
    }
    there
}

/// All effects but one and those that need it, directly or not.
fn without(name: &str, effects: &[&'static Effect]) -> Vec<&'static Effect> {
    let mut left: Vec<_> = effects.iter().copied().filter(|e| e.name != name).collect();
    while let Some(place) = left.iter().position(|e| {
        e.needs
            .iter()
            .any(|n| !left.iter().any(|o| o.name == n.effect))
    }) {
        left.remove(place);
    }
    left
}

fn folder(name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::Builder::new().prefix(name).tempdir().unwrap();
    let path = folder.path().to_owned();
    (folder, path)
}

/// The functions of an effect's own file, or of the model's that it runs.
fn is_of(effect: &Effect, function: &str) -> bool {
    let file = effect.name.replace('-', "_");
    let model = match effect.name {
        "crepitus" => "crepitus_model::solver::frozen".to_owned(),
        "encoder" => "crepitus_model::control::encoder".to_owned(),
        "motor" => "crepitus_model::control::current_loop".to_owned(),
        // The settings of `vibration-actuator` describe the plant's actuator, too.
        "vibration-actuator" => {
            "crepitus_model::render::effects::vibration_actuator::VibrationActuator<".to_owned()
        }
        // The seat of a shell is one, too.
        "cuff" => "crepitus_plant::compliance::".to_owned(),
        _ => format!("crepitus_model::render::effects::{file}::"),
    };
    let winding =
        effect.name == "motor" && function.contains("crepitus_plant::effects::motor::winding");
    winding
        || function.contains(&format!("crepitus_plant::effects::{file}::"))
        || function.contains(&model)
}

#[test]
fn an_absent_effect_executes_nothing() {
    if !valgrind() {
        return;
    }
    let (_keep, folder) = folder("absent");
    let whole = count(&folder, &EFFECTS, STEPS);
    for effect in EFFECTS {
        let own = |profile: &Profile| -> u64 {
            profile
                .iter()
                .filter(|(function, _)| is_of(effect, function))
                .map(|(_, count)| count)
                .sum()
        };
        if effect.name != "encoder" {
            assert!(
                own(&whole) > u64::from(STEPS),
                "{} is not seen: if all of it is inlined, `follow` needs the attributes of lead_pipe.rs",
                effect.name
            );
        }
        let mut rest = without(effect.name, &EFFECTS);
        if effect.name == "cuff" {
            rest = without("shell", &rest);
        }
        let absent = count(&folder, &rest, STEPS);
        assert_eq!(own(&absent), 0, "{}", effect.name);
    }
}

#[test]
fn a_scene_without_a_plant_executes_none_of_it() {
    if !valgrind() {
        return;
    }
    let (_keep, folder) = folder("bare");
    let joint: Vec<_> = EFFECTS.iter().copied().take(2).collect();
    for (function, count) in count(&folder, &joint, STEPS) {
        for of_plants in [
            "crepitus_plant::chain",
            "crepitus_plant::plant",
            "run::coupled",
        ] {
            // Once, when the scene is checked, is not a step.
            let each_step = count >= u64::from(STEPS);
            assert!(
                !(each_step && function.contains(of_plants)),
                "{function} {count}"
            );
        }
    }
}

#[test]
fn costs_add_up() {
    if !valgrind() {
        return;
    }
    let (_keep, folder) = folder("sum");
    let whole = per_step(&folder, &EFFECTS);
    // The loop itself, with the least plant.
    let base = per_step(&folder, &[]);
    println!("{:24} {whole:8.1} instructions a step", "all effects");
    println!("{:24} {base:8.1}", "none");
    let mut sum = base;
    for effect in EFFECTS {
        let rest = without(effect.name, &EFFECTS);
        let with_it: Vec<_> = EFFECTS
            .iter()
            .copied()
            .filter(|e| e.name == effect.name || rest.iter().any(|o| o.name == e.name))
            .collect();
        // No other needs it: these are all.
        let with_it = if with_it.len() == EFFECTS.len() {
            whole
        } else {
            per_step(&folder, &with_it)
        };
        let cost = with_it - per_step(&folder, &rest);
        println!("{:24} {cost:8.1}", effect.name);
        sum += cost;
    }
    println!(
        "{:24} {sum:8.1}, {:.1} % of the whole",
        "sum",
        100.0 * sum / whole
    );
    // A step that changes its modes is folded again, each time by all parts: an effect that changes
    // them costs that of the others, too.
    assert!((sum / whole - 1.0).abs() <= 0.2);
}
