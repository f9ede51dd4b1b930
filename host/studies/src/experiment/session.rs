//! A session: one participant and one protocol, as a state machine.
//!
//! ```text
//!        ┌───────────────────────── answer ──────────────────────────┐
//!        ▼                                                           │
//!  trial k ── shown ──> [realism: describe] ── choice or rating ──> row ──> … ──> over
//! ```
//!
//! **Repeatable.** Random numbers come from one generator, in the order of the trials; with equal protocol,
//! seed and answers every trial is equal. So rows of a table are answered again to take up a session.
//!
//! **Balanced.** Under constant stimuli the comparison is in each interval equally often at each level, but
//! for one trial if `repeats` is odd; catch trials alike, and X in A, B, X. In staircases each place is drawn.

use super::finding::HEALTHY;
use super::order::{SplitMix64, shuffled};
use super::protocol::{Abx, Protocol, Realism, Threshold, values_of};
use super::staircase::{Staircase, Track};
use super::trial::{AbxRow, RealismRow, Response, Row, Stimulus, ThresholdRow, Trial};

/// Most characters of a description.
pub const MOST_DESCRIPTION: usize = 1_000;

/// A session under way.
#[derive(Clone, Debug)]
pub struct Session {
    protocol: Protocol,
    plan: Plan,
    rows: Vec<Row>,
    described: Option<String>,
}

/// The trials, or what they follow from.
#[derive(Clone, Debug)]
enum Plan {
    /// Difference and interval of the comparison, from 1.
    Constant(Vec<(f64, u8)>),
    Staircase(Box<Running>),
    /// The condition that X is.
    Abx(Vec<u8>),
    /// Knees.
    Realism(Vec<String>),
}

/// Staircases under way.
#[derive(Clone, Debug)]
struct Running {
    tracks: Vec<Track>,
    random: SplitMix64,
    /// Track and interval of the comparison of the current trial.
    current: Option<(usize, u8)>,
}

/// Error of an answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    /// Every trial has an answer.
    #[error("the session is over: every trial has an answer")]
    Over,
    /// The answer is of another kind than the protocol.
    #[error("expected {0}")]
    Kind(&'static str),
    /// A number of the answer is out of range.
    #[error("{what} is {number}; expected {least} to {most}")]
    Number {
        /// Name of the number.
        what: &'static str,
        /// The number.
        number: usize,
        /// The least.
        least: usize,
        /// The most.
        most: usize,
    },
}

impl Session {
    /// A session with this seed; the protocol was [checked](Protocol::check).
    pub fn new(protocol: Protocol, seed: u64) -> Self {
        let plan = Plan::of(&protocol, seed);
        Self {
            protocol,
            plan,
            rows: Vec::new(),
            described: None,
        }
    }

    /// The protocol.
    pub const fn protocol(&self) -> &Protocol {
        &self.protocol
    }

    /// Answered trials.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Description of the current knee, which waits for its rating.
    pub fn described(&self) -> Option<&str> {
        self.described.as_deref()
    }

    /// Returns whether every trial has an answer.
    pub fn is_over(&self) -> bool {
        self.rows.len() >= self.most()
            || matches!(&self.plan, Plan::Staircase(running) if running.current.is_none())
    }

    /// Number of all trials; the most of staircases.
    fn most(&self) -> usize {
        match &self.plan {
            Plan::Constant(trials) => trials.len(),
            Plan::Abx(trials) => trials.len(),
            Plan::Realism(trials) => trials.len(),
            Plan::Staircase(_) => {
                let staircase = self.threshold().and_then(|t| t.staircase.as_ref());
                staircase.map_or(0, |plan| plan.trials * plan.interleaved)
            }
        }
    }

    const fn threshold(&self) -> Option<&Threshold> {
        self.protocol.threshold.as_ref()
    }

    /// Difference and interval of the comparison of the current trial of a threshold.
    fn difference(&self) -> Option<(f64, u8)> {
        match &self.plan {
            Plan::Constant(trials) => trials.get(self.rows.len()).copied(),
            Plan::Staircase(running) => {
                let (track, place) = running.current?;
                let level = running.tracks.get(track)?.level;
                Some((level, place))
            }
            _ => None,
        }
    }

    /// The current trial; `None` if the session is over.
    pub fn trial(&self) -> Option<Trial> {
        if self.is_over() {
            return None;
        }
        let at = self.rows.len();
        let intervals = match &self.plan {
            Plan::Constant(_) | Plan::Staircase(_) => {
                let (difference, place) = self.difference()?;
                let threshold = self.threshold()?;
                let reference = threshold.stimulus(0.0);
                let comparison = threshold.stimulus(difference);
                if place == 1 {
                    vec![comparison, reference]
                } else {
                    vec![reference, comparison]
                }
            }
            Plan::Abx(trials) => {
                let abx = self.protocol.abx.as_ref()?;
                let (a, b) = (abx.stimulus(1), abx.stimulus(2));
                vec![a, b, abx.stimulus(*trials.get(at)?)]
            }
            Plan::Realism(knees) => vec![Stimulus::of(knees.get(at)?)],
        };
        Some(Trial {
            number: at + 1,
            of: self.most(),
            intervals,
        })
    }

    /// Takes an answer to the current trial at a time, s since 1970; returns its row. A description has none:
    /// the rating follows.
    ///
    /// # Errors
    /// [`SessionError`]; the trial stays the current one.
    pub fn answer(
        &mut self,
        response: Response,
        unix_s: f64,
    ) -> Result<Option<&Row>, SessionError> {
        let trial = self.trial().ok_or(SessionError::Over)?.number;
        let row = match (&self.plan, response) {
            (Plan::Constant(_) | Plan::Staircase(_), Response::Choice(answer)) => {
                in_range("the interval", answer.into(), 1, 2)?;
                Row::Threshold(self.threshold_row(trial, answer, unix_s)?)
            }
            (Plan::Abx(conditions), Response::Choice(answer)) => {
                in_range("the condition", answer.into(), 1, 2)?;
                Row::Abx(AbxRow {
                    trial,
                    x: conditions.get(trial - 1).copied().unwrap_or_default(),
                    answer,
                    unix_s,
                })
            }
            (Plan::Realism(_), Response::Description(text)) => {
                let text = one_line(&text);
                in_range(
                    "the length of the description",
                    text.chars().count(),
                    1,
                    MOST_DESCRIPTION,
                )?;
                self.described = Some(text);
                return Ok(None);
            }
            (Plan::Realism(knees), Response::Rating(rating)) => {
                let Some(description) = self.described.clone() else {
                    return Err(SessionError::Kind("a description before the rating"));
                };
                let features = self
                    .protocol
                    .realism
                    .as_ref()
                    .map_or(0, |r| r.features.len());
                in_range(
                    "the number of ratings",
                    rating.realism.len(),
                    features + 1,
                    features + 1,
                )?;
                for realism in &rating.realism {
                    in_range("realism", usize::from(*realism), 1, 5)?;
                }
                in_range("severity", rating.severity.into(), 0, 3)?;
                let knee = knees.get(trial - 1).cloned().unwrap_or_default();
                let before = knees.iter().take(trial).filter(|k| **k == knee);
                Row::Realism(RealismRow {
                    trial,
                    presentation: before.count(),
                    knee,
                    description,
                    rating,
                    unix_s,
                })
            }
            (Plan::Realism(_), _) => {
                return Err(SessionError::Kind("a description, then a rating"));
            }
            _ => return Err(SessionError::Kind("the number of an interval")),
        };
        self.described = None;
        self.rows.push(row);
        Ok(self.rows.last())
    }

    fn threshold_row(
        &mut self,
        trial: usize,
        answer: u8,
        unix_s: f64,
    ) -> Result<ThresholdRow, SessionError> {
        let (difference, comparison_in) = self.difference().ok_or(SessionError::Over)?;
        // A comparison below the reference has less: the other interval is right.
        let is_right = (answer == comparison_in) == (difference >= 0.0);
        let plan = self.protocol.threshold.as_ref();
        let plan = plan.and_then(|threshold| threshold.staircase.as_ref());
        let (staircase, has_turned) = match (&mut self.plan, plan) {
            (Plan::Staircase(running), Some(plan)) => running.answer(plan, is_right),
            _ => (0, false),
        };
        Ok(ThresholdRow {
            trial,
            staircase,
            difference,
            comparison_in,
            answer,
            is_right,
            has_turned,
            unix_s,
        })
    }
}

impl Plan {
    fn of(protocol: &Protocol, seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        if let Some(Threshold {
            constant,
            staircase,
            ..
        }) = &protocol.threshold
        {
            if let Some(plan) = staircase {
                return Self::Staircase(Box::new(Running::begin(plan, random)));
            }
            let constant = constant.iter();
            let levels = constant.flat_map(|plan| {
                let each = plan.differences.iter().map(|level| (*level, plan.repeats));
                each.chain([(0.0, plan.catch_trials)])
            });
            let trials = levels.flat_map(|(level, count)| {
                balanced(count, &mut random)
                    .into_iter()
                    .map(move |place| (level, place))
            });
            let mut trials: Vec<_> = trials.collect();
            shuffle(&mut trials, &mut random);
            return Self::Constant(trials);
        }
        if let Some(Abx { trials, .. }) = &protocol.abx {
            let mut conditions = balanced(*trials, &mut random);
            shuffle(&mut conditions, &mut random);
            return Self::Abx(conditions);
        }
        let realism = protocol.realism.as_ref();
        Self::Realism(realism.map_or_else(Vec::new, |plan| plan.knees(seed)))
    }
}

impl Threshold {
    fn stimulus(&self, difference: f64) -> Stimulus {
        Stimulus {
            values: values_of(&self.quantity, self.reference + difference).into(),
            ..Stimulus::of(&self.preset)
        }
    }
}

impl Abx {
    fn stimulus(&self, condition: u8) -> Stimulus {
        let condition = if condition == 1 { &self.a } else { &self.b };
        Stimulus {
            preset: condition.preset.clone(),
            device: condition.device.clone(),
            values: condition.values.clone(),
        }
    }
}

impl Realism {
    /// Knees in the order of the trials; no knee twice in a row where that is possible.
    fn knees(&self, seed: u64) -> Vec<String> {
        let repeated = self
            .presets
            .iter()
            .flat_map(|p| std::iter::repeat_n(p.as_str(), self.repeats));
        let all: Vec<_> = repeated
            .chain(std::iter::repeat_n(HEALTHY, self.healthy))
            .collect();
        let order = shuffled(&all, 1, seed).into_iter();
        order
            .filter_map(|place| all.get(place).map(|knee| (*knee).to_owned()))
            .collect()
    }
}

impl Running {
    fn begin(plan: &Staircase, random: SplitMix64) -> Self {
        let mut running = Self {
            tracks: vec![Track::new(plan); plan.interleaved],
            random,
            current: None,
        };
        running.choose(plan);
        running
    }

    /// Draws track and interval of the next trial.
    fn choose(&mut self, plan: &Staircase) {
        let tracks = self.tracks.iter().enumerate();
        let open: Vec<_> = tracks
            .filter(|(_, track)| !track.is_over(plan))
            .map(|(place, _)| place)
            .collect();
        let drawn = usize::try_from(self.random.below(open.len() as u64)).unwrap_or(0);
        let place = if self.random.below(2) == 0 { 1 } else { 2 };
        self.current = open.get(drawn).map(|track| (*track, place));
    }

    /// Number of the staircase, from 1, and whether it turned.
    fn answer(&mut self, plan: &Staircase, is_right: bool) -> (usize, bool) {
        let Some((place, _)) = self.current else {
            return (0, false);
        };
        let track = self.tracks.get_mut(place);
        let has_turned = track.is_some_and(|track| track.answer(plan, is_right));
        self.choose(plan);
        (place + 1, has_turned)
    }
}

/// Ones and twos, equally many; an odd one is drawn.
fn balanced(count: usize, random: &mut SplitMix64) -> Vec<u8> {
    let mut places: Vec<u8> = (0..count).map(|k| if k % 2 == 0 { 1 } else { 2 }).collect();
    if count % 2 == 1
        && random.below(2) == 1
        && let Some(last) = places.last_mut()
    {
        *last = 2;
    }
    places
}

/// Shuffles as [`order`](super::order) says.
fn shuffle<T>(list: &mut [T], random: &mut SplitMix64) {
    for i in (1..list.len()).rev() {
        let j = usize::try_from(random.below(i as u64 + 1)).unwrap_or(i);
        list.swap(i, j);
    }
}

/// A text as one line, without what a terminal or a spreadsheet would interpret.
fn one_line(text: &str) -> String {
    let words = text.split(|c: char| c.is_whitespace() || c.is_control());
    let words: Vec<_> = words.filter(|word| !word.is_empty()).collect();
    let line = words.join(" ");
    line.trim_start_matches(['=', '+', '-', '@', '\''])
        .trim()
        .to_owned()
}

const fn in_range(
    what: &'static str,
    number: usize,
    least: usize,
    most: usize,
) -> Result<(), SessionError> {
    if number < least || number > most {
        return Err(SessionError::Number {
            what,
            number,
            least,
            most,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests;
