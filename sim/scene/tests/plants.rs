//! Scenes with a plant: what an effect leaves alone, balances, time steps.

use crepitus_plant::effects::EFFECTS;
use crepitus_scene::run::columns;
use crepitus_scene::trace::EventRecord;
use crepitus_scene::{Observer, Overrides, Scene, Summary, run};
use std::convert::Infallible;
use std::path::Path;

/// Keeps the bits of everything.
#[derive(Default, PartialEq)]
struct Keep {
    rows: Vec<Vec<u64>>,
    events: Vec<EventRecord>,
}

impl Observer for Keep {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        self.rows.push(values.iter().map(|x| x.to_bits()).collect());
        Ok(())
    }

    fn event(&mut self, event: &EventRecord) -> Result<(), Infallible> {
        self.events.push(*event);
        Ok(())
    }
}

const STROKES: &str =
    "kind = \"strokes\"\nfrom_deg = 20\nto_deg = 60\npeak_speed_deg_s = 80\npause_s = 0.1";
const KNOTS: &str = "kind = \"velocity-knots\"\nknots = [{ t_s = 0.0, omega_rad_s = 1.0 }, \
     { t_s = 0.3, omega_left_rad_s = 0.5, omega_right_rad_s = -0.7 }, { t_s = 0.6, omega_rad_s = 0.0 }]";

fn scene(duration_s: f64, motion: &str, solver: &str, effects: &[&str]) -> Scene {
    use std::fmt::Write;
    let mut text = format!(
        "version = 1\ntitle = \"test\"\nduration_s = {duration_s:?}\n[motion]\n{motion}\n\
         [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n{solver}\n"
    );
    for effect in effects {
        let _ = writeln!(text, "[effects.{effect}]");
    }
    Scene::parse(Path::new("test.toml"), &text, &Overrides::default()).unwrap()
}

fn simulate(scene: &Scene) -> (Keep, Summary) {
    let mut keep = Keep::default();
    let summary = run(scene, &mut keep).unwrap();
    (keep, summary)
}

/// The column of this name.
fn column(scene: &Scene, kept: &Keep, name: &str) -> Vec<f64> {
    let place = columns(scene).iter().position(|c| c.name == name).unwrap();
    kept.rows
        .iter()
        .map(|row| f64::from_bits(row[place]))
        .collect()
}

fn rms(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a few thousand")]
    let n = values.len() as f64;
    (values.map(|x| x * x).sum::<f64>() / n).sqrt()
}

/// All effects in the order of the table.
fn all() -> Vec<&'static str> {
    EFFECTS.iter().map(|e| e.name).collect()
}

/// The motor neither moves a prescribed shaft nor is seen by the model: what
/// the joint does is, bit for bit, what it does in a program without plants.
#[test]
fn a_plant_that_does_not_move_the_shaft_leaves_the_joint_alone() {
    for motion in [STROKES, KNOTS] {
        for precision in ["precision = \"f32\"", "precision = \"f64\""] {
            for sensor in [&["crepitus"][..], &["crepitus", "encoder"]] {
                let alone = scene(1.0, motion, precision, sensor);
                let plant = [
                    "motor",
                    "drivetrain",
                    "friction-compensation",
                    "bone-shaping",
                ];
                let with = scene(1.0, motion, precision, &[sensor, &plant].concat());
                let ((alone_kept, _), (with_kept, _)) = (simulate(&alone), simulate(&with));
                assert!(alone_kept.events == with_kept.events);
                let names = columns(&alone);
                for (i, (a, b)) in alone_kept.rows.iter().zip(&with_kept.rows).enumerate() {
                    assert_eq!(a, &b[..names.len()], "row {i} of {names:?}");
                }
            }
        }
    }
}

/// A scene file that never lists an effect, and a scene that it was taken
/// from, are one.
#[test]
fn an_effect_taken_out_leaves_no_trace() {
    let whole = scene(0.4, STROKES, "", &all());
    for effect in EFFECTS {
        let without = whole.without(effect).unwrap();
        let names: Vec<_> = without.effects().iter().map(|e| e.name).collect();
        assert!(!names.contains(&effect.name));
        let written = scene(0.4, STROKES, "", &names);
        assert_eq!(columns(&without), columns(&written));
        assert!(
            simulate(&without).0 == simulate(&written).0,
            "{}",
            effect.name
        );
    }
}

/// All scenes that ship: every balance closes.
#[test]
fn every_scene_runs_and_its_balances_close() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let scene = Scene::read(&path, &Overrides::default()).unwrap();
        let summary = run(&scene, &mut crepitus_scene::run::Blind).unwrap();
        let name = path.display();
        if let Some(energy) = summary.energy {
            // The object's energy is computed in the scene's precision.
            let most = if summary.precision == "f32" {
                1e-5
            } else {
                1e-6
            };
            assert!(energy.residual_relative.abs() < most, "{name} {energy:?}");
        }
        if let Some(plant) = &summary.plant_energy {
            println!("{:24} {:9.1e}", scene.title, plant.residual_relative);
            assert!(plant.residual_relative.abs() < 1e-6, "{name} {plant:?}");
            let r = &plant.rendering;
            let parts = r.model_j + r.sampling_j + r.actuator_j;
            let stages: f64 = r.stages.iter().map(|s| s.joule).sum();
            assert!((parts + stages - r.absorbed_j).abs() < 1e-12, "{name}");
        }
        seen += 1;
    }
    assert!(seen >= 27, "{seen}");
}

/// The plant stepped once a tick against a hundred times, which is 2 MHz: the
/// hand could not tell.
#[test]
fn a_step_a_tick_is_enough() {
    let felt = |substeps: u32, effects: &[&str]| {
        let scene = scene(1.0, STROKES, &format!("substeps = {substeps}"), effects);
        let (kept, summary) = simulate(&scene);
        (column(&scene, &kept, "hand_torque_nm"), summary.events)
    };
    let prescribed: Vec<_> = all().into_iter().filter(|e| *e != "hand").collect();
    // A mass meets its stops at the end of a step: it is compared below.
    let on_shell = ["shell", "reaction-mass", "vibration-actuator"];
    let without = |effects: Vec<&'static str>| -> Vec<&'static str> {
        let kept = effects.into_iter().filter(|e| !on_shell.contains(e));
        kept.collect()
    };
    let off_with = |effects: &[&str]| {
        let (one, hundred) = (felt(1, effects).0, felt(100, effects).0);
        rms(one.iter().zip(&hundred).map(|(a, b)| a - b))
    };
    assert!(off_with(&all()) < 0.04 && off_with(&prescribed) < 0.04);
    for effects in [without(all()), without(prescribed)] {
        let ((one, events), (hundred, same_events)) = (felt(1, &effects), felt(100, &effects));
        let off = rms(one.iter().zip(&hundred).map(|(a, b)| a - b));
        println!("{off:.1e} N·m of {:.2} N·m", rms(one.iter().copied()));
        assert!(off < 1e-3, "{off}");
        assert_eq!(events, same_events);
    }
}

/// A ripple of 0.4 N·m at the shaft is a tenth of it behind the cuff.
#[test]
fn a_cuff_swallows_the_vibration() {
    const STEADY: &str = "kind = \"constant\"\nvelocity_rad_s = 1.0";
    let ripple = |effects: &[&str]| {
        let scene = scene(2.0, STEADY, "", effects);
        let felt = column(&scene, &simulate(&scene).0, "hand_torque_nm");
        let late = &felt[20_000..];
        let most = late.iter().fold(f64::MIN, |a, &b| a.max(b));
        most - late.iter().fold(f64::MAX, |a, &b| a.min(b))
    };
    let bare = ripple(&["crepitus", "motor"]);
    let worn = ripple(&["crepitus", "motor", "drivetrain", "cuff"]);
    assert!(bare > 0.25 && worn < 0.1 * bare, "{bare} {worn}");
}

#[test]
fn what_nobody_holds_has_no_hand_torque() {
    let released = "kind = \"released\"\nfrom_deg = 30";
    let scene = scene(0.5, released, "", &["limb"]);
    let (kept, summary) = simulate(&scene);
    assert!(summary.hand_torque.is_none() && summary.torque.is_none());
    let names: Vec<_> = columns(&scene).iter().map(|c| c.name).collect();
    assert_eq!(names, ["t_s", "angle_rad", "omega_rad_s", "limb_torque_nm"]);
    let angle = column(&scene, &kept, "angle_rad");
    assert!(angle.last().unwrap() > &angle[0]);
}
