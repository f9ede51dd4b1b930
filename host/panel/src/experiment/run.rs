//! A session on a page: what was felt of the current trial, and what may be done next.
//!
//! ```text
//!  trial k ── feel every interval, motor on ──> [describe] ── choose, or rate ──> on the disk ──> trial k + 1
//!     ↑                                            │
//!     └────────────── the motor went off ──────────┘
//! ```

use crepitus_studies::experiment::finding::Finding;
use crepitus_studies::experiment::protocol::{Design, Protocol};
use crepitus_studies::experiment::table::{SEVERITIES, severity};
use crepitus_studies::experiment::{Held, Rating, Response, Stimulus, Trial};
use serde_json::{Value, json};

/// A session on a page.
#[derive(Debug)]
pub(crate) struct Run {
    file: String,
    held: Held,
    /// Intervals of the current trial that were felt.
    felt: Vec<bool>,
    /// The one that the device has, from 1.
    on_device: Option<usize>,
    /// Description of the current knee.
    described: Option<String>,
}

/// Name of a protocol's kind, which decides what a page asks.
pub(super) fn kind(protocol: &Protocol) -> &'static str {
    match (&protocol.threshold, &protocol.abx) {
        (Some(threshold), _) => threshold.design.name(),
        (None, Some(_)) => "abx",
        (None, None) => "realism",
    }
}

impl Run {
    pub(super) fn new(file: &str, held: Held) -> Self {
        let mut run = Self {
            file: file.to_owned(),
            held,
            felt: Vec::new(),
            on_device: None,
            described: None,
        };
        run.begin_trial();
        run
    }

    fn begin_trial(&mut self) {
        let intervals = self.held.trial().map_or(0, |trial| trial.intervals.len());
        self.felt = vec![false; intervals];
        (self.on_device, self.described) = (None, None);
    }

    /// Returns whether every trial has an answer.
    pub(crate) fn is_over(&self) -> bool {
        self.held.session().is_over()
    }

    /// Number of trials that have an answer.
    pub(crate) fn answered(&self) -> usize {
        self.held.session().rows().len()
    }

    /// Folder of its files.
    #[cfg(test)]
    pub(super) fn held_folder(&self) -> &std::path::Path {
        self.held.folder()
    }

    /// The current trial, if this is its number: what was sent late is not for the next one.
    fn trial(&self, number: usize) -> Result<Trial, String> {
        let trial = self.held.trial();
        let trial = trial.ok_or("the session is over: leave it")?;
        if trial.number != number {
            let now = trial.number;
            return Err(format!(
                "this is for trial {number}, but now it is trial {now}: look again"
            ));
        }
        Ok(trial)
    }

    /// The stimulus of an interval, from 1, if it may be felt now.
    ///
    /// # Errors
    /// A text for people.
    pub(crate) fn interval(&self, trial: usize, interval: usize) -> Result<Stimulus, String> {
        let mut intervals = self.trial(trial)?.intervals;
        let count = intervals.len();
        if !(1..=count).contains(&interval) {
            return Err(format!(
                "there is no interval {interval}: expected 1 to {count}"
            ));
        }
        let place = interval - 1;
        let is_felt = |place: usize| self.felt.get(place).copied().unwrap_or_default();
        if kind(self.held.session().protocol()) == Design::TwoIntervals.name() {
            if is_felt(place) {
                return Err("each interval is felt once: feel the other one, or answer".to_owned());
            }
            if (0..place).any(|earlier| !is_felt(earlier)) {
                return Err("feel interval 1 first".to_owned());
            }
        }
        Ok(intervals.swap_remove(place))
    }

    /// Notes that the device has an interval, from 1.
    pub(crate) fn feel(&mut self, interval: usize) {
        if let Some(felt) = interval
            .checked_sub(1)
            .and_then(|place| self.felt.get_mut(place))
        {
            *felt = true;
            self.on_device = Some(interval);
        }
    }

    /// Notes that the motor is off: every interval has to be felt again. Returns whether one was felt before.
    pub(crate) fn interrupt(&mut self) -> bool {
        let was_felt = self.felt.contains(&true);
        self.felt.fill(false);
        self.on_device = None;
        was_felt
    }

    /// Takes a choice.
    ///
    /// # Errors
    /// A text for people; the trial stays the current one.
    pub(crate) fn choose(&mut self, trial: usize, answer: u8, unix_s: f64) -> Result<(), String> {
        self.answer(trial, Response::Choice(answer), unix_s)?;
        self.begin_trial();
        Ok(())
    }

    /// Takes the description of a knee, before its rating.
    ///
    /// # Errors
    /// A text for people.
    pub(crate) fn describe(&mut self, trial: usize, text: &str, unix_s: f64) -> Result<(), String> {
        if self.described.is_some() {
            self.trial(trial)?;
            return Err("this knee is described: rate it".to_owned());
        }
        self.answer(trial, Response::Description(text.to_owned()), unix_s)?;
        self.described = Some(text.trim().to_owned());
        Ok(())
    }

    /// Takes the rating of a knee that was described; severity and type by their names.
    ///
    /// # Errors
    /// A text for people.
    pub(crate) fn rate(
        &mut self,
        trial: usize,
        realism: &[u8],
        [grade, kind]: [&str; 2],
        unix_s: f64,
    ) -> Result<(), String> {
        let severity = severity(grade).ok_or_else(|| {
            let all = SEVERITIES.join(", ");
            format!("unknown severity {grade:?}: expected one of {all}")
        })?;
        let rating = Rating {
            realism: realism.to_vec(),
            severity,
            finding: Finding::try_from(kind.to_owned())?,
        };
        self.answer(trial, Response::Rating(rating), unix_s)?;
        self.begin_trial();
        Ok(())
    }

    /// Hands an answer to the engine, which has it on the disk when this returns.
    fn answer(&mut self, trial: usize, response: Response, unix_s: f64) -> Result<(), String> {
        self.trial(trial)?;
        if self.felt.contains(&false) {
            return Err(
                "no answer before every interval was felt with the motor on: feel it, then answer"
                    .to_owned(),
            );
        }
        let answered = self.held.answer(response, unix_s);
        answered.map(drop).map_err(|error| error.to_string())
    }

    /// View of a page: neither levels nor knees, nor whether an answer was right.
    pub(crate) fn view(&self) -> Value {
        let begun = self.held.begun();
        let protocol = self.held.session().protocol();
        let threshold = protocol.threshold.as_ref();
        let features = protocol.realism.as_ref().map(|realism| &realism.features);
        let trial = self.held.trial().map(|trial| {
            json!({
                "number": trial.number,
                "of": trial.of,
                "felt": self.felt,
                "on_device": self.on_device,
                "described": self.described,
            })
        });
        let folder = self.held.folder();
        let study = folder.ancestors().nth(2).unwrap_or(folder);
        json!({
            "file": self.file,
            "title": protocol.title,
            "question": protocol.question,
            "kind": kind(protocol),
            // Staircases end after their reversals.
            "at_most": threshold.is_some_and(|threshold| threshold.staircase.is_some()),
            "features": features,
            "severities": SEVERITIES,
            "participant": begun.participant,
            "session": begun.session,
            "folder": folder.display().to_string(),
            "study": study.display().to_string(),
            "answered": self.answered(),
            "over": self.is_over(),
            "trial": trial,
        })
    }
}
