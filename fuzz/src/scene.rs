//! The reader of scene files, for any text, and the run of what it accepts:
//!
//! - neither panics;
//! - an error has a message, and names a line within the text, or an override
//!   as it was given;
//! - an accepted scene has finite times and settings that are valid, and if it
//!   is short it runs: rows are finite and in the order of time, the end is reached. Only an
//!   explicit solver beyond its limit of stability may diverge, and a plant in long steps.
//!
//! A line `#set PATH=VALUE` is a comment to the scene, and an override to this
//! target, as `--set PATH=VALUE` is on the command line.

use crepitus_model::solver::Solver;
use crepitus_scene::error::Origin;
use crepitus_scene::run::{Diverged, RunError, rows};
use crepitus_scene::scene::{MotionKind, SolverChoice};
use crepitus_scene::trace::EventRecord;
use crepitus_scene::{Observer, Overrides, Scene, SceneError, run};
use std::convert::Infallible;
use std::path::Path;

/// The most steps of a scene that is run, and the most swings of its object.
const MOST_STEPS: f64 = 2000.0;

/// Twenty times that of the device, s.
const LONG_STEP_S: f64 = 1e-3;

/// An object that is heavier than a leg, kg·m².
const HEAVY_KG_M2: f64 = 1.0;

/// A fast knee, rad/s.
const SWIFT_RAD_S: f64 = 10.0;

/// A shaft a thousand times as fast as a knee, rad/s.
const RACING_RAD_S: f64 = 1e4;

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let set = text.lines().filter_map(|line| {
        let (path, value) = line.strip_prefix("#set ")?.split_once('=')?;
        Some((path.to_owned(), value.to_owned()))
    });
    let overrides = Overrides {
        set: set.collect(),
        ..Overrides::default()
    };
    match Scene::parse(Path::new("no-such-folder/scene.toml"), text, &overrides) {
        Err(error) => refused(&error, text, &overrides),
        Ok(scene) => accepted(&scene),
    }
}

fn refused(error: &SceneError, text: &str, overrides: &Overrides) {
    assert!(!error.message.trim().is_empty(), "no message: {error:?}");
    let lines = text.matches('\n').count() + 1;
    match &error.origin {
        None => {}
        Some(Origin::Line(line)) => assert!((1..=lines).contains(line), "{error:?}"),
        Some(Origin::Override(flag)) => {
            let flags = overrides.set.iter().map(|(p, v)| format!("--set {p}={v}"));
            // In one line, and a long one in part.
            let mut flags = flags.map(|f| f.replace('\n', "\\n"));
            let part = flag.strip_suffix('…');
            let is_it = |f: &String| f == flag || part.is_some_and(|part| f.starts_with(part));
            assert!(flags.any(|f| is_it(&f)), "{error:?}");
        }
    }
}

fn accepted(scene: &Scene) {
    let time = |s: f64| s.is_finite() && s > 0.0;
    assert!(time(scene.duration_s), "duration {}", scene.duration_s);
    assert!(time(scene.trace_step_s), "rows {}", scene.trace_step_s);
    if let SolverChoice::Ladder { step_s, .. } = scene.solver {
        assert!(time(step_s), "step {step_s}");
    }
    if let Some(crepitus) = &scene.crepitus {
        assert!(crepitus.settings.validate().is_ok());
    }
    if !is_short(scene) {
        return;
    }
    let mut rows_seen = Rows::default();
    match run(scene, &mut rows_seen) {
        Ok(summary) => {
            assert_eq!(rows_seen.count, rows(scene));
            assert!(summary.simulated_s.is_finite());
            if let Some(energy) = &summary.energy
                && scene.solver == SolverChoice::Reference
            {
                // Of nothing rounding is a large share; a heavy object, or a racing shaft, moves far more
                // than is left in the sums, and what rounding of an event's time is worth grows with it.
                let inertia_kg_m2 = scene
                    .crepitus
                    .map_or(0.0, |crepitus| crepitus.settings.parameters.inertia_kg_m2);
                let share = if inertia_kg_m2 > HEAVY_KG_M2 || summary.fastest_rad_s > RACING_RAD_S {
                    1e-7
                } else {
                    1e-9
                };
                // What a jump of the convention gives and the next one takes, up to the object's energy at
                // the shaft's largest speed, may be far more than what is left in the sums.
                let swift_rad_s = summary.fastest_rad_s.max(SWIFT_RAD_S);
                let moved_j = inertia_kg_m2 * swift_rad_s * swift_rad_s;
                let closes = energy.residual_relative.abs() < share
                    || energy.residual_j.abs() < 1e-12 * (1.0 + moved_j);
                assert!(closes, "{energy:?}");
            }
            if let Some(t) = &summary.torque {
                let most_nm = t.max_nm.max(-t.min_nm);
                let rounding_nm = 1e-6 * (1.0 + most_nm);
                let within = t.min_nm - rounding_nm..=t.max_nm + rounding_nm;
                assert!(within.contains(&t.mean_nm), "{t:?}");
                assert!(t.rms_nm <= most_nm + rounding_nm, "{t:?}");
            }
        }
        Err(RunError::Diverged(diverged)) => {
            let may = match diverged {
                Diverged::Object { .. } => has_limit_of_stability(scene),
                // The shaft feels the torque a step later, and swings ever more if that is long.
                Diverged::Shaft { step_s, .. } => {
                    has_limit_of_stability(scene) || step_s > LONG_STEP_S
                }
            };
            assert!(may, "{diverged}, and there is no reason to");
        }
        Err(other) => panic!("a scene that was accepted does not run: {other}"),
    }
}

/// Short enough to be run: few steps, few swings.
fn is_short(scene: &Scene) -> bool {
    let step_s = match scene.solver {
        SolverChoice::Reference => scene.trace_step_s,
        SolverChoice::Ladder { step_s, .. } => step_s,
    };
    let swings = scene.crepitus.map_or(0.0, |c| {
        c.settings.parameters.natural_rad_s() * scene.duration_s
    });
    scene.motion_kind != MotionKind::Recording
        && scene.duration_s / step_s <= MOST_STEPS
        && swings <= MOST_STEPS
}

/// Returns whether the solver is unstable with long steps.
fn has_limit_of_stability(scene: &Scene) -> bool {
    matches!(
        scene.solver,
        SolverChoice::Ladder {
            solver: Solver::Euler
                | Solver::SemiImplicitEuler
                | Solver::Verlet
                | Solver::Rk4
                | Solver::Rk4Events,
            ..
        }
    )
}

/// Watches the rows.
#[derive(Default)]
struct Rows {
    count: u64,
    last_s: f64,
}

impl Observer for Rows {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        let time_s = values.first().copied().unwrap_or(f64::NAN);
        assert!(
            time_s >= self.last_s,
            "a row of {time_s} s after {} s",
            self.last_s
        );
        assert!(values.iter().all(|x| x.is_finite()), "{values:?}");
        self.last_s = time_s;
        self.count += 1;
        Ok(())
    }

    fn event(&mut self, event: &EventRecord) -> Result<(), Infallible> {
        assert!(event.time_s >= self.last_s, "{event:?} after its row");
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Infallible> {
        Ok(())
    }
}
