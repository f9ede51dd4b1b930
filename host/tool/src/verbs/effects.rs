//! `crepitus effects`: what effects there are; what each effect of a scene
//! does to the torque at the hand and what it costs; the fewest that will do.

mod build_up;
mod list;
mod page;
mod smallest;
mod summary;
mod table;

use crate::cli::EffectsArguments;
use crate::failure::{Failure, print, print_json, warn};
use crate::shipped;
use crate::studying::{self, Interrupted, Watch};
use crepitus_scene::output::Folder;
use crepitus_scene::{Overrides, Scene, SceneError};
use crepitus_study::effects::{EffectsError, Plan, Refusal, Tolerance, refusal, run};
use serde_json::json;
use std::path::{Path, PathBuf};
use summary::Summary;

/// Lists the effects, or studies those of a scene.
pub(crate) fn effects(arguments: &EffectsArguments, as_json: bool) -> Result<(), Failure> {
    let Some(path) = &arguments.scene else {
        return if as_json {
            print_json(&list::values())
        } else {
            print(&list::text())
        };
    };
    let plan = plan(arguments, path)?;
    let out = arguments.out.clone().unwrap_or_else(|| out(&plan.scene));
    // A folder that cannot be written is better known before the work.
    let folder = Folder::create(&out).map_err(|e| Failure::at(&out, "cannot be written", &e))?;
    let study = run(&plan, &mut Watch::new()).map_err(|e| failed(&plan.scene, e))?;
    let summary = Summary::new(&study);
    studying::write(
        folder,
        &out,
        page::files(&study, &summary, arguments.pictures)?,
    )?;
    if as_json {
        return print_json(&json!({ "out": out, "summary": summary }));
    }
    for warning in study.warnings.iter().chain(&summary::unsteady(&study)) {
        warn(warning);
    }
    let answer = study.answer.as_ref().map_or_else(String::new, |answer| {
        format!("\n{}", smallest::words(answer))
    });
    print(&format!(
        "{}\n{}{}\n{answer}report: {}\n",
        table::table(&study),
        build_up::table(&study.build_up),
        summary.conclusion,
        out.join("report.html").display()
    ))
}

fn plan(arguments: &EffectsArguments, path: &Path) -> Result<Plan, Failure> {
    let tolerance = arguments
        .tolerance
        .as_deref()
        .map(str::parse::<Tolerance>)
        .transpose()
        .map_err(|e| Failure::Input(format!("--tolerance: {e}")))?;
    let overrides = Overrides {
        set: arguments.set.clone(),
        ..Overrides::default()
    };
    let scene = shipped::scene(path, &overrides)?;
    match refusal(&scene) {
        Some(refused) => Err(refuse(&scene, refused)),
        None => Ok(Plan { scene, tolerance }),
    }
}

/// `out/<scene>-effects`.
fn out(scene: &Scene) -> PathBuf {
    let mut name = scene.file.file_stem().unwrap_or_default().to_owned();
    name.push("-effects");
    Path::new("out").join(name)
}

/// A refusal as a scene's own errors are told.
fn refuse(scene: &Scene, refusal: Refusal) -> Failure {
    Failure::input(SceneError {
        file: scene.file.clone(),
        origin: None,
        key: refusal.key().to_owned(),
        message: refusal.to_string(),
    })
}

fn failed(scene: &Scene, error: EffectsError<Interrupted>) -> Failure {
    match error {
        EffectsError::Watcher(Interrupted) => {
            Failure::Work("interrupted: nothing was written".to_owned())
        }
        EffectsError::Refused(refusal) => refuse(scene, refusal),
        other => Failure::Work(format!("{}: {other}", scene.file.display())),
    }
}
