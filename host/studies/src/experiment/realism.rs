//! Judgements of knees by clinicians, and their consistency.
//!
//! A clinician is one pseudonym. Each knee comes in several presentations, in an order of its own for each
//! clinician, with healthy knees between.
//!
//! | question | measure | resampled |
//! |---|---|---|
//! | how real is this knee? | mean of the whole, each clinician's mean counting once | clinicians |
//! | do clinicians agree? | ICC(2,1), ICC(3,1) of each clinician's mean for each knee | knees |
//! | does one clinician say the same again? | ICC(2,1) of first and second presentation; weighted kappa of the severity | knees |
//! | is the severity the one that is meant? | weighted kappa with the preset's level | knees |
//! | is the type the one that is meant? | kappa with the preset's disorder; shares of healthy knees and others | knees |
//!
//! Weights are linear. Clinicians whose session is not over are left out where a table has to be complete; a knee
//! without a level is left out of the severity. The healthy knee is one knee among the others.

use super::agreement::{Table, Weights};
use super::bootstrap::{Estimate, estimate};
use super::correlation::correlation;
use super::finding::{Finding, HEALTHY, Knee};
use super::session::Session;
use super::trial::{RealismRow, Row};
use crepitus_scene::preset::{Disorder, Level};
use std::collections::BTreeMap;

/// Findings: healthy and every disorder.
const FINDINGS: usize = 1 + Disorder::ALL.len();

/// Grades of severity.
const GRADES: usize = 1 + Level::ALL.len();

/// Ratings of one clinician.
#[derive(Clone, Debug)]
pub struct Clinician {
    /// Pseudonym.
    pub name: String,
    /// Rows of all sessions.
    rows: Vec<RealismRow>,
    /// Whether every session is over.
    is_over: bool,
}

/// Results of all clinicians.
#[derive(Clone, Debug)]
pub struct Results {
    /// Number of clinicians.
    pub clinicians: usize,
    /// Those whose sessions are over.
    pub finished: usize,
    /// Number of ratings.
    pub ratings: usize,
    /// Each knee, by name.
    pub knees: Vec<OfKnee>,
    /// The whole, then each feature.
    pub features: Vec<OfFeature>,
    /// Severity of the second presentation with the first.
    pub severity_again: Option<Estimate>,
    /// Severity with the preset's level.
    pub severity: Option<Estimate>,
    /// Type with the preset's disorder.
    pub finding: Option<Estimate>,
    /// Healthy knees that were named a disorder, of all ratings of them.
    pub false_alarms: [usize; 2],
    /// Knees with a disorder that were named healthy, of all ratings of them.
    pub missed: [usize; 2],
}

/// Results of one knee.
#[derive(Clone, Debug, PartialEq)]
pub struct OfKnee {
    /// Preset, or "healthy".
    pub preset: String,
    /// Clinicians who judged it.
    pub clinicians: usize,
    /// Ratings.
    pub ratings: usize,
    /// Realism of the whole, 1 to 5.
    pub realism: Option<Estimate>,
    /// Ratings with the preset's disorder.
    pub right: usize,
    /// Descriptions, in the order of clinicians and trials.
    pub descriptions: Vec<String>,
}

/// Consistency of the ratings of a feature.
#[derive(Clone, Debug, PartialEq)]
pub struct OfFeature {
    /// Name; empty for the whole.
    pub feature: String,
    /// Mean over clinicians.
    pub mean: Option<Estimate>,
    /// ICC(2,1) between clinicians.
    pub agreement: Option<Estimate>,
    /// ICC(3,1) between clinicians.
    pub consistency: Option<Estimate>,
    /// ICC(2,1) of the first two presentations.
    pub again: Option<Estimate>,
}

/// Ratings of one knee, by clinician.
struct Rated<'a> {
    truth: Knee,
    by: Vec<Vec<&'a RealismRow>>,
}

impl Clinician {
    /// Sessions by pseudonym; those of other protocols are left out.
    pub fn all<'a>(sessions: impl IntoIterator<Item = (&'a str, &'a Session)>) -> Vec<Self> {
        let mut all: BTreeMap<&str, Self> = BTreeMap::new();
        for (name, session) in sessions {
            if session.protocol().realism.is_none() {
                continue;
            }
            let clinician = all.entry(name).or_insert_with(|| Self {
                name: name.to_owned(),
                rows: Vec::new(),
                is_over: true,
            });
            clinician.is_over &= session.is_over();
            let rows = session.rows().iter();
            clinician.rows.extend(rows.filter_map(|row| match row {
                Row::Realism(row) => Some(row.clone()),
                _ => None,
            }));
        }
        all.into_values().filter(|c| !c.rows.is_empty()).collect()
    }
}

impl Results {
    /// Results of these clinicians; `truth` is what a preset is meant to be.
    pub fn of(clinicians: &[Clinician], features: &[String], truth: impl Fn(&str) -> Knee) -> Self {
        let mut names: Vec<&str> = Vec::new();
        for row in clinicians.iter().flat_map(|c| &c.rows) {
            if !names.contains(&row.knee.as_str()) {
                names.push(&row.knee);
            }
        }
        names.sort_unstable_by_key(|name| (*name == HEALTHY, *name));
        let knees: Vec<_> = names
            .iter()
            .map(|name| Rated::of(truth(name), name, clinicians.iter()))
            .collect();
        let finished = || clinicians.iter().filter(|c| c.is_over);
        let complete: Vec<_> = names
            .iter()
            .map(|name| Rated::of(truth(name), name, finished()))
            .collect();
        let of_feature = |(place, feature): (usize, &String)| OfFeature {
            feature: feature.clone(),
            mean: estimate(clinicians, |drawn| {
                mean(
                    drawn
                        .iter()
                        .filter_map(|c| mean(c.rows.iter().map(|row| realism(row, place)))),
                )
            }),
            agreement: estimate(&complete, |drawn| Some(between(drawn, place)?.agreement)),
            consistency: estimate(&complete, |drawn| Some(between(drawn, place)?.consistency)),
            again: estimate(&knees, |drawn| {
                let pairs: Vec<_> = pairs(drawn)
                    .map(|(first, second)| [realism(first, place), realism(second, place)])
                    .collect();
                Some(correlation(&pairs)?.agreement)
            }),
        };
        let names = std::iter::once(String::new()).chain(features.iter().cloned());
        let names: Vec<_> = names.collect();
        let is_healthy = |knee: &Rated<'_>| knee.truth.disorder == Some(Finding::Healthy);
        let named = |is_healthy_one: bool, wrong: fn(&RealismRow) -> bool| {
            let of = knees.iter().filter(|k| is_healthy(k) == is_healthy_one);
            let rows: Vec<_> = of.flat_map(Rated::rows).collect();
            [rows.iter().filter(|row| wrong(row)).count(), rows.len()]
        };
        Self {
            clinicians: clinicians.len(),
            finished: finished().count(),
            ratings: clinicians.iter().map(|c| c.rows.len()).sum(),
            knees: knees.iter().map(OfKnee::of).collect(),
            features: names.iter().enumerate().map(of_feature).collect(),
            severity_again: estimate(&knees, |drawn| {
                let mut table = Table::<GRADES>::default();
                for (first, second) in pairs(drawn) {
                    table.count(first.rating.severity.into(), second.rating.severity.into());
                }
                Some(table.kappa(Weights::Linear)?.value)
            }),
            severity: estimate(&knees, |drawn| {
                let mut table = Table::<GRADES>::default();
                for knee in drawn {
                    let Some(grade) = grade(&knee.truth) else {
                        continue;
                    };
                    knee.rows()
                        .for_each(|row| table.count(grade, row.rating.severity.into()));
                }
                several(&table)?
                    .kappa(Weights::Linear)
                    .map(|kappa| kappa.value)
            }),
            finding: estimate(&knees, |drawn| {
                let mut table = Table::<FINDINGS>::default();
                for knee in drawn {
                    let Some(truth) = knee.truth.disorder else {
                        continue;
                    };
                    knee.rows()
                        .for_each(|row| table.count(place(truth), place(row.rating.finding)));
                }
                several(&table)?
                    .kappa(Weights::Nominal)
                    .map(|kappa| kappa.value)
            }),
            false_alarms: named(true, |row| row.rating.finding != Finding::Healthy),
            missed: named(false, |row| row.rating.finding == Finding::Healthy),
        }
    }
}

/// A table whose truths differ: kappa is 0 for every answer where they do not.
fn several<const K: usize>(table: &Table<K>) -> Option<&Table<K>> {
    (table.truths() > 1).then_some(table)
}

impl OfKnee {
    fn of(knee: &Rated<'_>) -> Self {
        let own: Vec<_> = knee.by.iter().filter(|rows| !rows.is_empty()).collect();
        let right = knee
            .rows()
            .filter(|row| knee.truth.disorder == Some(row.rating.finding));
        Self {
            preset: knee.truth.preset.clone(),
            clinicians: own.len(),
            ratings: knee.rows().count(),
            realism: estimate(&own, |drawn| {
                mean(
                    drawn
                        .iter()
                        .filter_map(|rows| mean(rows.iter().map(|row| realism(row, 0)))),
                )
            }),
            right: right.count(),
            descriptions: knee.rows().map(|row| row.description.clone()).collect(),
        }
    }
}

impl<'a> Rated<'a> {
    fn of(truth: Knee, name: &str, clinicians: impl Iterator<Item = &'a Clinician>) -> Self {
        let own = |clinician: &'a Clinician| {
            let rows = clinician.rows.iter();
            rows.filter(|row| row.knee == name).collect()
        };
        Self {
            truth,
            by: clinicians.map(own).collect(),
        }
    }

    fn rows(&self) -> impl Iterator<Item = &'a RealismRow> {
        self.by.iter().flatten().copied()
    }
}

/// First and second presentation of every knee, by clinician.
fn pairs<'a>(knees: &[&Rated<'a>]) -> impl Iterator<Item = (&'a RealismRow, &'a RealismRow)> {
    let by = knees.iter().flat_map(|knee| &knee.by);
    by.filter_map(|rows| Some((*rows.first()?, *rows.get(1)?)))
}

/// Correlation between clinicians, of their mean for each knee.
fn between(knees: &[&Rated<'_>], feature: usize) -> Option<super::correlation::Correlation> {
    let row = |knee: &&Rated<'_>| -> Option<Vec<f64>> {
        let means = knee
            .by
            .iter()
            .map(|rows| mean(rows.iter().map(|row| realism(row, feature))));
        means.collect()
    };
    let rows: Option<Vec<_>> = knees.iter().map(row).collect();
    correlation(&rows?)
}

fn realism(row: &RealismRow, feature: usize) -> f64 {
    row.rating
        .realism
        .get(feature)
        .copied()
        .map_or(f64::NAN, f64::from)
}

fn mean(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = numbers.fold((0_usize, 0.0), |(count, sum), x| (count + 1, sum + x));
    (count > 0).then(|| sum / count as f64)
}

/// Place of a finding in a table.
fn place(finding: Finding) -> usize {
    Finding::all()
        .position(|other| other == finding)
        .unwrap_or(FINDINGS)
}

/// Place of the level that a knee is meant to have; `None` if it is unknown.
fn grade(knee: &Knee) -> Option<usize> {
    if knee.disorder == Some(Finding::Healthy) {
        return Some(0);
    }
    let level = knee.level?;
    let found = Level::ALL.into_iter().position(|other| other == level);
    found.map(|place| place + 1)
}

#[cfg(test)]
mod tests;
