//! Words of the study: what its verb prints, and the text of its page.

mod build_up;
mod smallest;
mod summary;
mod table;

use crate::effects::effects_table::effects_table;
use crate::effects::{EffectsStudy, report};
use crate::{Outcome, Picture, Section, StudyText, machine};
use crepitus_pages::plot::Paper;
use crepitus_pages::words::footer;
use serde::Serialize;
use summary::{Summary, conclusion};

impl Outcome for EffectsStudy {
    const REST: &'static str = "every variant";

    fn summary(&self) -> impl Serialize {
        Summary::new(self)
    }

    fn page(&self) -> String {
        report::html(self, &text(self))
    }

    fn pictures(&self, paper: Paper) -> Vec<Picture> {
        report::pictures(self, paper)
    }

    fn tables(&self) -> Vec<(&'static str, String)> {
        vec![("effects.csv", effects_table(&self.rows).to_csv())]
    }

    fn answer(&self) -> String {
        conclusion(self)
    }

    fn in_short(&self) -> String {
        match &self.answer {
            Some(answer) => smallest::words(answer),
            None => table::short(self),
        }
    }

    fn in_full(&self) -> String {
        let answer = self.answer.as_ref();
        format!(
            "{}{}\n{}",
            answer.map_or_else(String::new, |answer| smallest::words(answer) + "\n"),
            table::table(self),
            build_up::table(&self.build_up)
        )
    }

    fn warnings(&self) -> Vec<String> {
        let unsteady = summary::unsteady(self);
        self.warnings.iter().cloned().chain(unsteady).collect()
    }
}

fn text(study: &EffectsStudy) -> StudyText {
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
            conclusion(study)
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
                row(
                    "measured on",
                    format!("one core, {}", machine::measured_on()),
                ),
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
    notes.push(table::counted(study));
    notes.extend(summary::unsteady(study));
    notes
}
