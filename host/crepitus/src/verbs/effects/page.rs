//! The files of a study, and the words of its report.

use super::summary::Summary;
use crate::failure::Failure;
use crate::pictures::Pictures;
use crate::results::{Files, footer, report_files};
use crepitus_studies::effects::EffectsStudy;
use crepitus_studies::effects::effects_table::effects_table;
use crepitus_studies::effects::report;
use crepitus_studies::{Section, StudyText};

/// Names and contents of the files; each figure as an SVG of its own if asked
/// for.
pub(super) fn files(
    study: &EffectsStudy,
    summary: &Summary<'_>,
    pictures: &Pictures,
) -> Result<Files, Failure> {
    let page = report::html(study, &text(study, summary));
    let pictures = pictures.files(|paper| report::pictures(study, paper))?;
    let mut files = report_files(page, summary, pictures)?;
    files.push((
        "effects.csv".to_owned(),
        effects_table(&study.rows).to_csv().into(),
    ));
    Ok(files)
}

fn text(study: &EffectsStudy, summary: &Summary<'_>) -> StudyText {
    let row = |name: &str, value: String| (name.to_owned(), value);
    let effects = if study.effects.is_empty() {
        "none".to_owned()
    } else {
        study.effects.join(", ")
    };
    StudyText {
        title: format!("What each effect does and costs: {}", study.title),
        intro: format!(
            "{}\nEach effect of the scene is left out in turn, and each absent one added.",
            summary.conclusion
        ),
        notes: notes(study),
        tables: vec![Section {
            title: "What was studied".to_owned(),
            rows: vec![
                row("scene", study.scene.clone()),
                row("its effects", effects),
                row(
                    "ticks",
                    format!("{} of {:.6} µs", study.ticks, study.tick_s * 1e6)
                        .replace(".000000", ""),
                ),
                row("measured on", summary.measured_on()),
                row("the study took", format!("{:.1} s", study.wall_s)),
            ],
        }],
        footer: footer(),
    }
}

fn notes(study: &EffectsStudy) -> Vec<String> {
    let mut notes: Vec<String> = [
        "The torque at the hand is what a force sensor between leg and hand would show, as the mean of each tick. \
         Without any effect of the plant the hand holds the joint itself, and feels the torque that the model has at \
         the end of the tick; with a plant, a tick passes between what the model says and what the motor does.",
        "A difference is taken tick by tick. Two gratings that run a hair apart in time differ as much as if one \
         were missing: where an effect shifts the events, the bands and the number of events tell whether the \
         grating itself is another.",
        "An added effect has its default numbers.",
        "Influences do not add up: two effects may hide, or undo, each other.",
    ]
    .map(str::to_owned)
    .to_vec();
    notes.extend(super::summary::unsteady(study));
    notes
}
