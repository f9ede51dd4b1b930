//! A scene, run by a subject, and by the reference where that solves it, too.

use super::input::{Input, SceneRun};
use super::observation::Observation;
use super::subject::{Rung, Subject};
use crate::symptoms::event::{SymptomEvent, own};
use crepitus_model::{EventKind, Real};
use crepitus_scene::run::{Observer, columns};
use crepitus_scene::scene::Precision;
use crepitus_scene::trace::{EventRecord, SymptomEvent as SceneEvent};
use crepitus_scene::{Overrides, Scene, run};
use std::convert::Infallible;
use std::path::Path;

/// Rows so close to an event, in steps, are not compared: its time is.
const BESIDE_STEPS: f64 = 1.5;

/// Runs the scene; a scene that is refused, or fails, is an overflow at 0 s.
pub(super) fn observe(
    subject: Subject,
    (input, scene): (&Input, &SceneRun),
    late_s: f64,
) -> Observation {
    let run = |subject| follow(&scene.scene(subject, input.duration_s, input.step_s), scene);
    let Some(kept) = run(subject) else {
        return Observation::refused();
    };
    let mut seen = Observation {
        imbalance: kept.missing_share,
        ..Observation::of_steps(input.step_s)
    };
    for &(time_s, torque_nm) in &kept.rows {
        seen.steps += 1;
        if !torque_nm.is_finite() {
            seen.overflow_s.get_or_insert(time_s);
        }
        if time_s >= late_s {
            seen.late_torque.add(torque_nm);
        }
        match subject.precision {
            Precision::F32 => seen.add_torque::<f32>(torque_nm),
            Precision::F64 => seen.add_torque::<f64>(torque_nm),
        }
    }
    for kind in &kept.joint {
        let count = match kind {
            EventKind::Break => &mut seen.tally.breaks,
            EventKind::Stick => &mut seen.tally.sticks,
            EventKind::Reverse => &mut seen.tally.reverses,
        };
        *count += 1;
    }
    let events = own(kept.symptoms);
    if scene.is_compared && subject.solver != Rung::Reference {
        let reference = Subject {
            solver: Rung::Reference,
            precision: Precision::F64,
            ..subject
        };
        if let Some(exact) = run(reference) {
            let truth = own(exact.symptoms);
            let beside_s = BESIDE_STEPS * input.step_s;
            let near = |time_s: f64| {
                let all = truth.iter().chain(&events);
                all.into_iter()
                    .any(|event| (event.time_s - time_s).abs() < beside_s)
            };
            let pairs = kept.rows.iter().zip(&exact.rows);
            let errors_nm = pairs
                .filter(|((time_s, _), _)| !near(*time_s))
                .map(|((_, nm), (_, exact_nm))| (nm - exact_nm).abs());
            seen.symptoms.torque_error_nm = Some(errors_nm.fold(0.0, Real::at_least));
            seen.symptoms.truth = Some(truth);
        }
    }
    seen.symptoms.events = events;
    seen
}

/// Records of a run.
#[derive(Default)]
struct RunRecords {
    place: usize,
    /// Times, s, and torques, N·m.
    rows: Vec<(f64, f64)>,
    joint: Vec<EventKind>,
    symptoms: Vec<SymptomEvent>,
    missing_share: Option<f64>,
}

fn follow(text: &str, input: &SceneRun) -> Option<RunRecords> {
    let scene = Scene::parse(Path::new("case.toml"), text, &Overrides::default()).ok()?;
    let place = columns(&scene)
        .iter()
        .position(|column| column.name == input.column)?;
    let mut kept = RunRecords {
        place,
        ..RunRecords::default()
    };
    let summary = run(&scene, &mut kept).ok()?;
    let plant = summary.plant_energy;
    kept.missing_share = plant.map(|plant| plant.residual_relative.abs());
    Some(kept)
}

impl Observer for RunRecords {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        let value = |place: usize| values.get(place).copied().unwrap_or(f64::NAN);
        self.rows.push((value(0), value(self.place)));
        Ok(())
    }

    fn event(&mut self, event: &EventRecord) -> Result<(), Infallible> {
        self.joint.push(event.kind);
        Ok(())
    }

    fn symptom(&mut self, event: &SceneEvent) -> Result<(), Infallible> {
        self.symptoms.push(SymptomEvent {
            time_s: event.time_s,
            word: event.word,
            omega_rad_s: event.omega_rad_s,
            before_nm: event.torque_before_nm,
            after_nm: event.torque_after_nm,
        });
        Ok(())
    }
}
