//! Results of a study, by protocol: as JSON, as text, as a page, and as judgements of presets.
//!
//! The table of all trials has participant and session before the columns of `trials.csv`; its SHA-256 is that of
//! the judgements, so that a number can be traced to the answers.

mod json;
mod page;
mod words;

pub use page::html;

use super::choices::{Count, Told, counts, mean_of_reversals, told};
use super::finding::{HEALTHY, Knee};
use super::protocol::{Protocol, ProtocolError};
use super::realism::{Clinician, Results};
use super::table::{Held, hash_of, line};
use super::trial::{AbxRow, Row, ThresholdRow};
use crepitus_scene::preset::Judgement;

/// Reversals of each staircase that are left out of the mean.
const SKIPPED_REVERSALS: usize = 2;

/// Results of all sessions with one protocol.
#[derive(Clone, Debug)]
pub struct Findings {
    /// The protocol.
    pub protocol: Protocol,
    /// SHA-256 of its file.
    pub protocol_sha256: String,
    /// Number of sessions.
    pub sessions: usize,
    /// Those that are not over.
    pub unfinished: usize,
    /// All trials, as CSV.
    pub table: String,
    /// SHA-256 of the table.
    pub sha256: String,
    /// Findings by participant or knee.
    pub found: Found,
}

/// Findings of one kind of protocol.
#[derive(Clone, Debug)]
pub enum Found {
    /// Of a threshold, by participant.
    Threshold(Vec<OfThreshold>),
    /// Of A, B and X, by participant; then of all.
    Abx(Vec<(String, Told)>, Option<Told>),
    /// Of a realism session.
    Realism(Box<Results>),
}

/// Answers of one participant.
#[derive(Clone, Debug, PartialEq)]
pub struct OfThreshold {
    /// Pseudonym.
    pub participant: String,
    /// Answers by difference, of all sessions.
    pub counts: Vec<Count>,
    /// Mean difference at the reversals of each session's staircases.
    pub reversals: Vec<f64>,
}

impl Findings {
    /// Results by protocol, in the order in which they first appear; `find` finds a knee by its preset's name.
    ///
    /// # Errors
    /// Of `find`: an own preset that is gone.
    pub fn all(
        sessions: &[Held],
        find: impl Fn(&str) -> Result<Knee, ProtocolError>,
    ) -> Result<Vec<Self>, ProtocolError> {
        let mut hashes: Vec<&str> = Vec::new();
        for held in sessions {
            let hash = held.begun().protocol_sha256.as_str();
            if !hashes.contains(&hash) {
                hashes.push(hash);
            }
        }
        let of = |hash: &&str| {
            let own = sessions
                .iter()
                .filter(|held| held.begun().protocol_sha256 == *hash);
            Self::of(&own.collect::<Vec<_>>(), &find)
        };
        hashes
            .iter()
            .filter_map(|hash| of(hash).transpose())
            .collect()
    }

    /// Results of sessions with one protocol.
    fn of(
        own: &[&Held],
        find: &impl Fn(&str) -> Result<Knee, ProtocolError>,
    ) -> Result<Option<Self>, ProtocolError> {
        let Some(first) = own.first() else {
            return Ok(None);
        };
        let protocol = first.session().protocol().clone();
        let found = if let Some(realism) = &protocol.realism {
            for preset in &realism.presets {
                find(preset)?;
            }
            let sessions = own
                .iter()
                .map(|held| (held.begun().participant.as_str(), held.session()));
            let clinicians = Clinician::all(sessions);
            let truth = |name: &str| find(name).unwrap_or_else(|_| Knee::healthy());
            Found::Realism(Box::new(Results::of(&clinicians, &realism.features, truth)))
        } else if protocol.abx.is_some() {
            let by = by_participant(own, abx_rows);
            let all = told(by.iter().flat_map(|(_, rows)| rows.iter().flatten()));
            let each = by
                .into_iter()
                .filter_map(|(name, rows)| Some((name, told(rows.iter().flatten())?)));
            Found::Abx(each.collect(), all)
        } else {
            let by = by_participant(own, threshold_rows).into_iter();
            Found::Threshold(
                by.map(|(participant, sessions)| OfThreshold {
                    participant,
                    counts: counts(sessions.iter().flatten()),
                    reversals: sessions
                        .iter()
                        .filter_map(|rows| mean_of_reversals(rows, SKIPPED_REVERSALS))
                        .collect(),
                })
                .collect(),
            )
        };
        let table = table(own);
        Ok(Some(Self {
            protocol,
            protocol_sha256: first.begun().protocol_sha256.clone(),
            sessions: own.len(),
            unfinished: own.iter().filter(|held| !held.session().is_over()).count(),
            sha256: hash_of(table.as_bytes()),
            table,
            found,
        }))
    }

    /// Judgements of the presets of a realism session, evaluated on this day (`2026-11-30`).
    pub fn judgements(&self, date: &str) -> Vec<(String, Judgement)> {
        let Found::Realism(results) = &self.found else {
            return Vec::new();
        };
        let knees = results.knees.iter().filter(|knee| knee.preset != HEALTHY);
        let count = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
        knees
            .filter_map(|knee| {
                let realism = knee.realism?;
                let judgement = Judgement {
                    study: self.protocol.title.trim().to_owned(),
                    date: date.to_owned(),
                    clinicians: count(knee.clinicians),
                    ratings: count(knee.ratings),
                    statistic: format!(
                        "realism {} of 5; type right {} of {}",
                        words::estimated(Some(realism), 1),
                        knee.right,
                        knee.ratings
                    ),
                    sha256: self.sha256.clone(),
                };
                Some((knee.preset.clone(), judgement))
            })
            .collect()
    }
}

/// Something of each session, by participant.
fn by_participant<T>(own: &[&Held], of: impl Fn(&Row) -> Option<T>) -> Vec<(String, Vec<Vec<T>>)> {
    let mut all: Vec<(String, Vec<Vec<T>>)> = Vec::new();
    for held in own {
        let name = &held.begun().participant;
        let rows = held.session().rows().iter().filter_map(&of).collect();
        match all.iter_mut().find(|(other, _)| other == name) {
            Some((_, sessions)) => sessions.push(rows),
            None => all.push((name.clone(), vec![rows])),
        }
    }
    all
}

fn threshold_rows(row: &Row) -> Option<ThresholdRow> {
    match row {
        Row::Threshold(row) => Some(row.clone()),
        _ => None,
    }
}

fn abx_rows(row: &Row) -> Option<AbxRow> {
    match row {
        Row::Abx(row) => Some(row.clone()),
        _ => None,
    }
}

/// All trials, with participant and session.
fn table(own: &[&Held]) -> String {
    let mut text = String::new();
    for held in own {
        let session = held.session();
        if text.is_empty() {
            let names = ["participant", "session"].map(str::to_owned);
            text += &line(&[&names[..], &session.header()].concat());
        }
        let begun = held.begun();
        let who = [begun.participant.clone(), begun.session.to_string()];
        for row in session.rows() {
            text += &line(&[&who[..], &row.record()].concat());
        }
    }
    text
}

#[cfg(test)]
mod tests;
