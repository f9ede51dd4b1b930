//! Results as text, in sections that the page has, too.

use super::{Findings, Found, OfThreshold};
use crate::experiment::bootstrap::Estimate;
use crate::experiment::choices::Told;
use crate::experiment::realism::Results;
use crepitus_pages::table::Table;
use std::fmt::Write;

/// Fewest clinicians whose resampled interval is more than rough.
const ENOUGH: usize = 10;

/// A heading, and a table below it.
pub(super) struct Section {
    pub(super) heading: &'static str,
    columns: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

impl Section {
    /// The table; numbers begin in the second column.
    pub(super) fn table(&self) -> Table<'_, Vec<String>> {
        let columns = self.columns.iter().enumerate();
        columns.fold(Table::of(&self.rows), |table, (place, name)| {
            let cell = move |row: &Vec<String>| row.get(place).cloned().unwrap_or_default();
            table.column(name, cell).headed(*name)
        })
    }
}

/// A number with its interval, to so many decimals.
pub(super) fn estimated(estimate: Option<Estimate>, decimals: usize) -> String {
    match estimate {
        None => "–".to_owned(),
        Some(Estimate {
            value,
            interval: None,
            ..
        }) => format!("{value:.decimals$}"),
        Some(Estimate {
            value,
            interval: Some([low, high]),
            ..
        }) => {
            format!("{value:.decimals$} (95 % {low:.decimals$} to {high:.decimals$})")
        }
    }
}

impl Findings {
    /// Results for a terminal.
    pub fn to_text(&self) -> String {
        let mut text = format!("{}\n{}\n", self.protocol.title, self.facts());
        for section in self.sections() {
            // Writing to a String cannot fail.
            let _ = write!(text, "\n{}\n{}", section.heading, section.table().to_text());
        }
        for remark in self.remarks() {
            let _ = write!(text, "\n{remark}");
        }
        text.trim_end().to_owned() + "\n"
    }

    /// Numbers of sessions, and the hash of the table.
    pub(super) fn facts(&self) -> String {
        let left = match self.unfinished {
            0 => String::new(),
            count => format!(", {count} not over"),
        };
        format!(
            "{} sessions{left}; SHA-256 of all trials {}",
            self.sessions, self.sha256
        )
    }

    /// Tables of what was found.
    pub(super) fn sections(&self) -> Vec<Section> {
        match &self.found {
            Found::Threshold(all) => vec![threshold(all)],
            Found::Abx(each, all) => vec![abx(each, all.as_ref())],
            Found::Realism(results) => realism(results),
        }
    }

    /// Limits of what was found.
    pub(super) fn remarks(&self) -> Vec<String> {
        match &self.found {
            Found::Threshold(_) => vec![
                "Thresholds with intervals: crepitus.experiments.fit_threshold in Python.".to_owned(),
            ],
            Found::Abx(..) => vec![
                "p is the probability of as many or more right answers by chance; that of all participants together \
                 takes their trials for one person's."
                    .to_owned(),
            ],
            Found::Realism(results) => {
                let [alarms, of_healthy] = results.false_alarms;
                let [missed, of_others] = results.missed;
                let mut remarks = vec![format!(
                    "Healthy knees that were named a disorder: {alarms} of {of_healthy}; knees that were named healthy: \
                     {missed} of {of_others}."
                )];
                if results.clinicians < ENOUGH {
                    remarks.push(format!(
                        "Intervals of {} clinicians are too narrow: fewer than {ENOUGH} were resampled.",
                        results.clinicians
                    ));
                }
                remarks
            }
        }
    }
}

fn threshold(all: &[OfThreshold]) -> Section {
    let rows = all.iter().flat_map(|of| {
        let reversals: Vec<_> = of.reversals.iter().map(|x| format!("{x:.4}")).collect();
        of.counts.iter().enumerate().map(move |(place, count)| {
            let first = |text: String| if place == 0 { text } else { String::new() };
            vec![
                first(of.participant.clone()),
                count.difference.to_string(),
                count.trials.to_string(),
                count.right.to_string(),
                first(reversals.join(", ")),
            ]
        })
    });
    Section {
        heading: "Answers by difference (0: catch trials, choices of the first interval)",
        columns: vec![
            "participant",
            "difference",
            "trials",
            "right",
            "mean of reversals",
        ],
        rows: rows.collect(),
    }
}

fn abx(each: &[(String, Told)], all: Option<&Told>) -> Section {
    let row = |name: &str, told: &Told| {
        let [low, high] = told.interval.map(|share| share * 100.0);
        vec![
            name.to_owned(),
            format!("{} of {}", told.right, told.trials),
            format!("{low:.0} to {high:.0} %"),
            format!("{:.4}", told.p),
        ]
    };
    let rows = each.iter().map(|(name, told)| row(name, told));
    Section {
        heading: "Is X A or B?",
        columns: vec!["participant", "right", "95 % interval", "p"],
        rows: rows.chain(all.map(|told| row("all", told))).collect(),
    }
}

fn realism(results: &Results) -> Vec<Section> {
    let knees = results.knees.iter().map(|knee| {
        vec![
            knee.preset.clone(),
            knee.clinicians.to_string(),
            knee.ratings.to_string(),
            estimated(knee.realism, 1),
            format!("{} of {}", knee.right, knee.ratings),
        ]
    });
    let features = results.features.iter().map(|of| {
        let name = if of.feature.is_empty() {
            "the whole"
        } else {
            &of.feature
        };
        vec![
            name.to_owned(),
            estimated(of.mean, 1),
            estimated(of.agreement, 2),
            estimated(of.consistency, 2),
            estimated(of.again, 2),
        ]
    });
    let kappas = [
        ("severity again, weighted", results.severity_again),
        (
            "severity with the preset's level, weighted",
            results.severity,
        ),
        ("type with the preset's disorder", results.finding),
    ];
    let kappas = kappas.map(|(name, kappa)| vec![name.to_owned(), estimated(kappa, 2)]);
    let said = results.knees.iter().flat_map(|knee| {
        let each = knee.descriptions.iter();
        each.map(|text| vec![knee.preset.clone(), text.clone()])
    });
    vec![
        Section {
            heading: "Each knee",
            columns: vec![
                "knee",
                "clinicians",
                "ratings",
                "realism, 1 to 5",
                "type right",
            ],
            rows: knees.collect(),
        },
        Section {
            heading: "Each feature: realism, and intraclass correlations",
            columns: vec!["feature", "mean", "ICC(2,1)", "ICC(3,1)", "ICC(2,1) again"],
            rows: features.collect(),
        },
        Section {
            heading: "Kappa",
            columns: vec!["agreement", "kappa"],
            rows: kappas.into(),
        },
        Section {
            heading: "What was said",
            columns: vec!["knee", "description"],
            rows: said.collect(),
        },
    ]
}
