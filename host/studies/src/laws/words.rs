//! Words of the study: what its verb prints, and the text of its page.

pub(crate) mod fits;
mod headline;
mod list;
pub(crate) mod numbers;
pub(crate) mod rows_table;
pub(crate) mod scores_table;
mod summary;

use crate::accuracy::target::LABEL;
use crate::laws::law_tables::{costs_table, leaderboard_table};
use crate::laws::ranking::{Answer, answers};
use crate::laws::report;
use crate::laws::task::Extent;
use crate::laws::{LawStudy, Row};
use crate::{Outcome, Picture, Section, StudyText, machine};
use crepitus_pages::plot::Paper;
use crepitus_pages::words::{WIDTH, footer, wrapped};
use crepitus_scene::cpu_time::CLOCK;
pub use list::{text as list, value};
use numbers::{is_on_controller, percent};
use serde::Serialize;
use summary::Summary;

/// The rule of the ranking.
pub const RULE: &str = "The score of a law for a use is the mean of its relative errors at 20 kHz in f32, over all numbers of the \
     use and all joints; an error beyond 1, and a number that the law cannot do, count as 1. Laws within a tenth of the \
     smallest score, or within 0.005 of it, are as good as the best. Of those the answer is the one whose step costs least: in \
     cycles of the controller, or in time on this computer if it was not run there.";

/// A study with its answers.
#[derive(Clone, Debug)]
pub struct LawsOutcome<'a> {
    /// The study.
    pub study: &'a LawStudy,
    /// The law to take for each use.
    pub answers: Vec<Answer>,
}

impl<'a> LawsOutcome<'a> {
    /// The outcome of a study.
    pub fn new(study: &'a LawStudy) -> Self {
        Self {
            study,
            answers: answers(study),
        }
    }
}

impl Outcome for LawsOutcome<'_> {
    const REST: &'static str = "every number";

    fn summary(&self) -> impl Serialize {
        Summary::new(self)
    }

    fn page(&self) -> String {
        report::html(self.study, &self.answers, &text(self))
    }

    fn pictures(&self, paper: Paper) -> Vec<Picture> {
        report::pictures(self.study, &self.answers, paper)
    }

    fn tables(&self) -> Vec<(&'static str, String)> {
        vec![
            (
                "leaderboard.csv",
                leaderboard_table(&self.study.rows).to_csv(),
            ),
            ("costs.csv", costs_table(&self.study.costs).to_csv()),
        ]
    }

    fn answer(&self) -> String {
        headline::answer(self.study, &self.answers)
    }

    fn in_short(&self) -> String {
        let laws = scores_table::in_order(self.study, &self.answers);
        scores_table::table(self.study, &self.answers, &laws).to_text()
    }

    fn in_full(&self) -> String {
        let study = self.study;
        let fits = fits::fits(study);
        let about = |text: &str| wrapped(text, WIDTH).join("\n");
        format!(
            "{}\n{}\n{}\n{}\n\n{}",
            self.in_short(),
            about(RULE),
            rows_table::text(study),
            about(fits::RULE),
            fits::table(&fits).to_text()
        )
    }

    fn warnings(&self) -> Vec<String> {
        let debug = self.study.machine.debug_assertions && !is_on_controller(self.study);
        let debug = debug
            .then(|| "this is a debug build: the times mean little, and they choose".to_owned());
        debug.into_iter().collect()
    }
}

fn text(of: &LawsOutcome<'_>) -> StudyText {
    let study = of.study;
    StudyText {
        title: "Which friction law should a device render?".to_owned(),
        intro: headline::answer(study, &of.answers),
        notes: notes(study),
        tables: vec![studied(study), machine_record(study)],
        footer: footer(),
    }
}

fn studied(study: &LawStudy) -> Section {
    let row = |name: &str, value: String| (name.to_owned(), value);
    let rows = &study.rows;
    let failed = rows.iter().filter(|row| row.failed.is_some()).count();
    let settled = |row: &&Row| row.is_settled || row.converged.is_none();
    Section {
        title: "The study".to_owned(),
        rows: vec![
            row("laws", study.laws.len().to_string()),
            row("joints", study.joints.join(", ")),
            row("numbers", rows.len().to_string()),
            row("numbers that a law cannot do", failed.to_string()),
            row(
                "numbers whose model error moves by more than 1 % with a finer step",
                (rows.len() - rows.iter().filter(settled).count()).to_string(),
            ),
            row(
                "extent",
                match study.extent {
                    Extent::Quick => "quick: one joint, short tasks",
                    Extent::Full => "full",
                    Extent::Long => "long, with a day in f32",
                }
                .to_owned(),
            ),
            row("the study took", format!("{:.1} s", study.wall_s)),
        ],
    }
}

fn machine_record(study: &LawStudy) -> Section {
    let machine = &study.machine;
    let row = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    Section {
        title: "Where it was measured".to_owned(),
        rows: vec![
            row("processor", &machine.cpu),
            row(
                "system",
                &format!("{}, {} cores", machine.system, machine.cores),
            ),
            row("compiler", machine.compiler),
            row("target", machine.target),
            row("optimisation level of the laws", machine.opt_level),
            row("features of the target", machine.target_features),
            row(
                "debug assertions",
                if machine.debug_assertions {
                    "yes: times mean little"
                } else {
                    "no"
                },
            ),
            row("clock", machine.clock),
            row(
                "controller",
                if is_on_controller(study) {
                    LABEL
                } else {
                    "not run: --target runs the laws there"
                },
            ),
        ],
    }
}

fn notes(study: &LawStudy) -> Vec<String> {
    let mut notes = vec![
        RULE.to_owned(),
        "Two errors are kept apart. The model error is that of the law converged (f64, ever finer steps) against what the \
         task demands: no step makes it smaller. The numerical error is that of the law at 20 kHz in f32 against itself \
         converged. Both are drawn as shares of the scale of the number, at which an error is as large as the effect."
            .to_owned(),
        "What is demanded is the joint of the paper under the convention frozen, which is ours. A law that makes another \
         joint well has a model error here."
            .to_owned(),
        fits::RULE.to_owned(),
    ];
    if let Some(repeats) = study.costs.first().map(|costs| costs.repeats)
        && repeats > 0
    {
        let spreads = study.costs.iter().filter_map(|costs| costs.grating);
        let worst = spreads.map(|time| time.spread).fold(0.0, f64::max);
        notes.push(format!(
            "Time is {CLOCK} of a step: the median of {repeats} repeats in which the laws take turns. The quartiles are at most \
             {} % of it apart. {}.",
            percent(worst),
            machine::measured_on()
        ));
    }
    notes
}

#[cfg(test)]
pub(in crate::laws) mod tests;
