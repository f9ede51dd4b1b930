//! `crepitus accuracy`: what accuracy costs in time, and the cheapest solver
//! that is accurate enough, on the host or on the target.

mod answer;
mod orders_table;
mod page;
mod plan;
mod summary;
mod table;
mod target;
mod words;

use crate::cli::AccuracyArguments;
use crate::failure::{Failure, print, print_json};
use crate::pictures::{Files, PictureFormat};
use crate::studying::{self, Watch};
use crepitus_scene::output::Folder;
use crepitus_study::accuracy::{Need, Study, convergence, points_csv, study};
use serde_json::json;
use std::path::PathBuf;
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
    // So is an image that cannot be built.
    let ladder = arguments.target.then(target::ladder).transpose()?;
    let mut study = study::run(&studied.plan, &mut Watch::new()).map_err(studying::failed)?;
    if let Some(mut ladder) = ladder {
        let scenes = &studied.plan.scenes;
        target::add(&mut study, scenes, arguments.quick, &mut ladder)?;
    }
    let by_motion = if arguments.scene.is_none() && need.is_none() {
        convergence::motions().and_then(|motions| convergence::orders_on(&motions))
    } else {
        Ok(Vec::new())
    };
    let by_motion =
        by_motion.map_err(|e| Failure::Work(format!("the orders cannot be measured: {e}")))?;
    study.orders.extend_from_slice(&by_motion);
    let summary = Summary::new(arguments.quick, &studied, &study);
    if let (Some(folder), Some(out)) = (folder, &out) {
        studying::write(folder, out, files(&study, &summary, arguments.pictures)?)?;
    }
    match &need {
        Some(need) => answer::tell(need, &studied, &study, out.as_deref(), as_json),
        None if as_json => print_json(&json!({ "out": out, "summary": summary })),
        None => {
            let report = out.unwrap_or_default().join("report.html");
            let target = study.target.as_ref().map(target::table);
            print(&format!(
                "{}\n{}{}\nreport: {}\n",
                table::at_the_tick(&study),
                orders_table::by_motion(&by_motion),
                target.map_or_else(String::new, |table| format!("\n{table}")),
                report.display()
            ))
        }
    }
}

/// The report, the points and the summary, and the pictures if asked for.
fn files(
    study: &Study,
    summary: &Summary<'_>,
    pictures: Option<PictureFormat>,
) -> Result<Files, Failure> {
    let json = serde_json::to_string_pretty(summary)
        .map_err(|e| Failure::Work(format!("the summary cannot be written: {e}")))?;
    let mut files = page::files(study, summary, pictures)?;
    files.push((
        "points.csv".to_owned(),
        points_csv::points_csv(&study.points).into(),
    ));
    files.push(("summary.json".to_owned(), (json + "\n").into()));
    Ok(files)
}
