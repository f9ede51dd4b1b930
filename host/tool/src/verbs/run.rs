//! `crepitus run SCENE`: simulate, write the four files, say what happened.

mod plant;
mod tables;
mod watch;

use crate::cli::RunArguments;
use crate::failure::{Failure, print, print_json, warn};
use crate::interrupt;
use crate::pictures::{self};
use crate::shipped;
use crepitus_model::Restart;
use crepitus_report::{Setup, Text, TorqueLevels};
use crepitus_scene::output::Folder;
use crepitus_scene::{Overrides, RunError, Scene, Summary, run as runner};
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};
use watch::{Watch, WatchError};

/// Runs a scene.
pub(crate) fn run(arguments: &RunArguments, as_json: bool) -> Result<(), Failure> {
    let scene = read(arguments)?;
    let out = out_folder(arguments, &scene);
    let (summary, files) = simulate(&scene, &out, arguments)?;
    files
        .commit()
        .map_err(|e| Failure::at(&out, "moving the results into place", &e))?;
    if as_json {
        return print_json(&json!({ "out": out, "summary": summary }));
    }
    for warning in &summary.warnings {
        warn(warning);
    }
    print(&format!(
        "{}\n{}\nreport: {}\n",
        summary.title,
        tables::in_brief(&summary),
        out.join("report.html").display()
    ))
}

/// The scene that the arguments name, with what they change.
fn read(arguments: &RunArguments) -> Result<Scene, Failure> {
    let overrides = Overrides {
        solver: arguments.solver.clone(),
        step: arguments.step.clone(),
        precision: arguments.precision.clone(),
        as_device: arguments.as_device,
        set: arguments.set.clone(),
    };
    shipped::scene(&arguments.scene, &overrides)
}

/// `--out`, or `out/<scene>`.
fn out_folder(arguments: &RunArguments, scene: &Scene) -> PathBuf {
    arguments.out.clone().unwrap_or_else(|| {
        let name = scene.file.file_stem().unwrap_or_default();
        Path::new("out").join(name)
    })
}

/// Runs the scene into a folder that still has to be committed.
fn simulate(
    scene: &Scene,
    out: &Path,
    arguments: &RunArguments,
) -> Result<(Summary, Folder), Failure> {
    let failed = |doing: &str, e: &std::io::Error| Failure::at(out, doing, e);
    let folder = Folder::create(out).map_err(|e| failed("cannot be written", &e))?;
    interrupt::listen();
    let setup = Setup {
        columns: &runner::columns(scene),
        rows_expected: runner::rows(scene),
        row_step_s: scene.trace_step_s,
        levels: levels(scene),
    };
    let mut watch = Watch::new(&folder, &setup, scene.duration_s, arguments.trace_every)
        .map_err(|e| failed("writing the results", &e))?;
    let mut summary = crepitus_scene::run(scene, &mut watch).map_err(|e| match e {
        RunError::Observer(WatchError::Write(e)) => failed("writing the results", &e),
        RunError::Observer(WatchError::Interrupted) => {
            Failure::Work("interrupted: nothing was written".to_owned())
        }
        RunError::Settings(e) => Failure::Input(format!("{}: {e}", scene.file.display())),
        RunError::Diverged(e) => Failure::Work(format!("{}: {e}", scene.file.display())),
        // A kind of error that did not exist when this was written.
        _ => Failure::Work(format!("{}: the run failed", scene.file.display())),
    })?;
    runner::measure_costs(scene, &mut summary);
    let mut figures = watch
        .finish()
        .map_err(|e| failed("writing the results", &e))?;
    if let Some(balance) = plant::balance(&summary) {
        figures.set_balance(balance);
    }
    let specs: Vec<_> = scene.effects().iter().map(|e| e.parameters).collect();
    let text = Text {
        title: scene.title.clone(),
        description: scene.description.clone(),
        warnings: summary.warnings.clone(),
        sections: tables::sections(&summary, &specs),
        footer: format!(
            "crepitus {} · research and education prototype, not a medical device",
            summary.crepitus_version
        ),
    };
    let page = crepitus_report::html(&text, &figures);
    let json = serde_json::to_string_pretty(&summary)
        .map_err(|e| Failure::Work(format!("the summary cannot be written: {e}")))?;
    let mut texts = vec![
        ("report.html".to_owned(), page.into()),
        ("summary.json".to_owned(), (json + "\n").into()),
    ];
    texts.extend(pictures::files(arguments.pictures, || {
        crepitus_report::pictures(&figures)
    })?);
    for (name, content) in texts {
        folder
            .file(&name)
            .and_then(|mut file| {
                file.write_all(&content)?;
                Folder::finish(file)
            })
            .map_err(|e| failed("writing the results", &e))?;
    }
    Ok((summary, folder))
}

/// The torque levels that the report marks.
fn levels(scene: &Scene) -> Option<TorqueLevels> {
    let settings = scene.crepitus?.settings;
    let p = &settings.parameters;
    let elastic = TorqueLevels::elastic(p.kinetic_torque_nm, p.static_torque_nm);
    Some(match settings.restart {
        Restart::Elastic => elastic,
        Restart::FromKinetic => TorqueLevels {
            restart_nm: elastic.kinetic_nm,
            ..elastic
        },
    })
}
