//! `crepitus accuracy`: what accuracy costs in time, and the cheapest solver
//! that is accurate enough.

mod answer;
mod page;
mod plan;
mod summary;
mod table;
mod words;

use crate::cli::AccuracyArguments;
use crate::failure::{Failure, print, print_json};
use crate::interrupt;
use crate::progress::Progress;
use crepitus_scene::output::Folder;
use crepitus_study::accuracy::{Need, Study, points_csv, study};
use crepitus_study::{StudyError, Watcher};
use plan::Studied;
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};
use summary::Summary;

/// Studies, and writes the files or answers the need.
pub(crate) fn accuracy(arguments: &AccuracyArguments, as_json: bool) -> Result<(), Failure> {
    let need = arguments
        .need
        .as_deref()
        .map(str::parse::<Need>)
        .transpose()
        .map_err(|e| Failure::Input(format!("--need: {e}")))?;
    let studied = plan::plan(arguments)?;
    let out = match (&arguments.out, &need) {
        (Some(out), _) => Some(out.clone()),
        (None, None) => Some(PathBuf::from("out/accuracy")),
        (None, Some(_)) => None,
    };
    // A folder that cannot be written is better known before the work.
    let folder = out
        .as_deref()
        .map(|out| Folder::create(out).map_err(|e| Failure::at(out, "cannot be written", &e)))
        .transpose()?;
    interrupt::listen();
    let study = carry_out(&studied)?;
    let summary = Summary::new(arguments.quick, &studied, &study);
    if let (Some(folder), Some(out)) = (folder, &out) {
        write(folder, out, arguments.pictures, &study, &summary)?;
    }
    match &need {
        Some(need) => answer::tell(need, &studied, &study, out.as_deref(), as_json),
        None if as_json => print_json(&json!({ "out": out, "summary": summary })),
        None => {
            let report = out.unwrap_or_default().join("report.html");
            print(&format!(
                "{}\nreport: {}\n",
                table::at_the_tick(&study),
                report.display()
            ))
        }
    }
}

fn carry_out(studied: &Studied) -> Result<Study, Failure> {
    let mut watch = Watch(Progress::of_study());
    study::run(&studied.plan, &mut watch).map_err(|e| match e {
        StudyError::Watcher(Interrupted) => {
            Failure::Work("interrupted: nothing was written".to_owned())
        }
        other => Failure::Work(format!("the study failed: {other}")),
    })
}

/// Moves the progress bar, and stops when asked.
struct Watch(Progress);

/// Ctrl-C.
#[derive(Debug)]
struct Interrupted;

impl Watcher for Watch {
    type Error = Interrupted;

    fn progress(&mut self, fraction: f64) -> Result<(), Interrupted> {
        self.0.reached(fraction);
        if interrupt::asked() {
            return Err(Interrupted);
        }
        Ok(())
    }
}

/// Writes the files, whole or not at all.
fn write(
    folder: Folder,
    out: &Path,
    pictures: bool,
    study: &Study,
    summary: &Summary<'_>,
) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(summary)
        .map_err(|e| Failure::Work(format!("the summary cannot be written: {e}")))?;
    let mut files = page::files(study, summary, pictures)?;
    files.push((
        "points.csv".to_owned(),
        points_csv::points_csv(&study.points),
    ));
    files.push(("summary.json".to_owned(), json + "\n"));
    for (name, content) in files {
        folder
            .file(&name)
            .and_then(|mut file| {
                file.write_all(content.as_bytes())?;
                Folder::finish(file)
            })
            .map_err(|e| Failure::at(out, "writing the results", &e))?;
    }
    folder
        .commit()
        .map_err(|e| Failure::at(out, "moving the results into place", &e))
}
