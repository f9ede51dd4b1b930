//! Contestants on a moving hand: the search for settings, and the timed rounds.

use super::{Peer, Setting, settings};
use crate::measure::{Summary, Times, repeats, summarise, time};
use crate::motion::Hand;
use crate::ours;
use crate::summary::Line;
use crate::work::{Delivery, Runner, Task};
use crepitus_model::Convention;
use serde::Serialize;

/// Least ratio to every peer.
const AHEAD: f64 = 1.0;

/// A motion under a convention, with all who do it.
pub struct Case {
    /// The motion.
    pub hand: Hand,
    /// The convention.
    pub convention: Convention,
    /// The events that `reference` finds, s.
    pub truth: Vec<f64>,
    /// Ours.
    pub ours: Entrant,
    /// The best of each peer.
    pub peers: Vec<Entrant>,
}

/// A solver with its setting and what was measured of it.
#[derive(Serialize)]
pub struct Entrant {
    /// Library and method.
    pub name: String,
    /// Setting of the method; none for ours, and for a peer that finishes with none.
    pub setting: Option<Setting>,
    /// Events that it found.
    pub events: usize,
    /// Worst difference of an event to `reference`, s; none if there are too many or too few.
    pub event_error_s: Option<f64>,
    /// The limit that it is within, s; none if it is within none.
    pub within_s: Option<f64>,
    /// CPU time of the work.
    pub time: Option<Summary>,
    #[serde(skip)]
    runner: Option<Runner>,
}

impl Case {
    /// Ours, and each peer at the cheapest setting that is good enough.
    pub fn new(hand: &Hand, convention: Convention, quick: bool, out: &mut Delivery) -> Self {
        let mut runner = ours::reference_events(convention, hand);
        // `reference` cannot fail.
        let _ = runner(Task::Events, out);
        let truth = out.events.clone();
        let ours = Entrant {
            name: "crepitus reference".into(),
            setting: None,
            events: truth.len(),
            event_error_s: Some(0.0),
            within_s: Some(0.0),
            time: None,
            runner: Some(runner),
        };
        let mut case = Self {
            hand: hand.clone(),
            convention,
            truth,
            ours,
            peers: Vec::new(),
        };
        case.peers = Peer::ALL
            .iter()
            .map(|peer| {
                eprintln!("tuning {} on {}", peer.name, case.name());
                case.best(peer, quick, out)
            })
            .collect();
        case
    }

    /// Motion and convention.
    pub fn name(&self) -> String {
        format!("{}, {}", self.hand.name(), self.convention.name())
    }

    /// The cheapest setting within the tightest limit that the peer reaches; else the one that
    /// comes nearest.
    fn best(&self, peer: &Peer, quick: bool, out: &mut Delivery) -> Entrant {
        /// Number of the cheapest settings that are timed again.
        const SHORT_LIST: usize = 5;
        let mut tried: Vec<(Entrant, f64)> = settings(self.convention, &self.hand, quick)
            .into_iter()
            .filter_map(|setting| self.attempt(peer, setting, out))
            .collect();
        let reached = self.hand.event_limits_s.iter().find(|&&limit_s| {
            let within = |e: &Entrant| e.event_error_s.is_some_and(|error_s| error_s <= limit_s);
            tried.iter().any(|(e, _)| within(e))
        });
        if let Some(&limit_s) = reached {
            tried.retain(|(e, _)| e.event_error_s.is_some_and(|error_s| error_s <= limit_s));
            tried.sort_by(|a, b| a.1.total_cmp(&b.1));
            tried.truncate(SHORT_LIST);
            for (entrant, cost_s) in &mut tried {
                entrant.within_s = Some(limit_s);
                if let Some(runner) = &mut entrant.runner {
                    *cost_s = (0..5)
                        .map(|_| time(runner, Task::Events, out, 1).cpu_s)
                        .fold(f64::INFINITY, f64::min);
                }
            }
            tried.sort_by(|a, b| a.1.total_cmp(&b.1));
        } else {
            let far = |e: &Entrant| (self.truth.len().abs_diff(e.events), e.event_error_s);
            tried.sort_by(|(a, _), (b, _)| {
                let ((a_missed, a_error), (b_missed, b_error)) = (far(a), far(b));
                let error = |e: Option<f64>| e.unwrap_or(f64::INFINITY);
                a_missed
                    .cmp(&b_missed)
                    .then(error(a_error).total_cmp(&error(b_error)))
            });
        }
        let gave_up = || Entrant {
            name: peer.name.into(),
            setting: None,
            events: 0,
            event_error_s: None,
            within_s: None,
            time: None,
            runner: None,
        };
        tried
            .into_iter()
            .next()
            .map_or_else(gave_up, |(entrant, _)| entrant)
    }

    /// A setting with its events and the CPU time of one run, s; none if it gives up.
    fn attempt(&self, peer: &Peer, setting: Setting, out: &mut Delivery) -> Option<(Entrant, f64)> {
        let mut runner = peer.build(&self.hand, self.convention, setting).ok()?;
        runner(Task::Events, out).ok()?;
        let differences = out.events.iter().zip(&self.truth);
        let worst_s = differences.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let (events, complete) = (out.events.len(), out.events.len() == self.truth.len());
        let cost_s = if complete {
            time(&mut runner, Task::Events, out, 1).cpu_s
        } else {
            f64::INFINITY
        };
        let entrant = Entrant {
            name: peer.name.into(),
            setting: Some(setting),
            events,
            event_error_s: complete.then_some(worst_s),
            within_s: None,
            time: None,
            runner: Some(runner),
        };
        Some((entrant, cost_s))
    }

    /// Times faster than each peer that found every event within a limit, by CPU time.
    pub fn ratios(&self) -> impl Iterator<Item = (&Entrant, f64)> {
        let ours = self.ours.time.map_or(f64::NAN, |t| t.median.cpu_s);
        self.peers.iter().filter_map(move |peer| {
            let time = peer.time.filter(|_| peer.within_s.is_some())?;
            Some((peer, time.median.cpu_s / ours))
        })
    }

    /// Ours beside the fastest peer that found every event.
    pub fn line(&self) -> Option<Line> {
        let best = self.ratios().min_by(|a, b| a.1.total_cmp(&b.1));
        Some(Line {
            joint: self.hand.joint.name,
            work: format!("{}, {} events", self.hand.name, self.truth.len()),
            ours: format!("reference, {}", self.convention.name()),
            ours_time: self.ours.time?,
            peer: best.and_then(|(peer, _)| Some((peer.name.clone(), peer.time?))),
            required: Some(AHEAD),
        })
    }

    /// Relative spread of a ratio: half the distances of the quartiles of both times.
    fn spread(&self, peer: &Entrant) -> f64 {
        let of = |time: Option<Summary>| time.map_or(f64::NAN, |t| t.spread);
        (of(self.ours.time) + of(peer.time)) / 2.0
    }

    /// Messages of the checks that fail: ours is to be ahead of every peer beyond the spread of the
    /// runs.
    pub fn failures(&self) -> Vec<String> {
        let mut failures: Vec<String> = self
            .ratios()
            .map(|(peer, ratio)| (peer, ratio, self.spread(peer)))
            // A ratio that is no number does not hold either.
            .filter(|(_, ratio, spread)| !(ratio * (1.0 - spread)).gt(&AHEAD))
            .map(|(peer, ratio, spread)| {
                format!(
                    "{}: {} is {ratio:.2} times as slow ±{:.0} %",
                    self.name(),
                    peer.name,
                    100.0 * spread
                )
            })
            .collect();
        let libraries = |name: &str| {
            self.peers
                .iter()
                .any(|p| p.within_s.is_some() && p.name.starts_with(name))
        };
        let confirmed = ["differential-equations", "diffsol", "ivp"]
            .iter()
            .filter(|name| libraries(name))
            .count();
        if self.truth.is_empty() || confirmed < 2 {
            failures.push(format!(
                "{}: {} events, which {confirmed} libraries find, not 2 or more",
                self.name(),
                self.truth.len()
            ));
        }
        failures
    }
}

/// Lets everyone take a turn in each round, there and back.
pub fn hold(cases: &mut [Case], rounds: usize, out: &mut Delivery) {
    let mut entries: Vec<(&mut Entrant, u32, Vec<Times>)> = Vec::new();
    for case in cases {
        for entrant in std::iter::once(&mut case.ours).chain(&mut case.peers) {
            let Some(runner) = &mut entrant.runner else {
                continue;
            };
            let repeats = repeats(runner, Task::Events, out);
            entries.push((entrant, repeats, Vec::with_capacity(rounds)));
        }
    }
    for round in 0..rounds {
        let turn = |(entrant, repeats, times): &mut (&mut Entrant, u32, Vec<Times>)| {
            if let Some(runner) = &mut entrant.runner {
                times.push(time(runner, Task::Events, out, *repeats));
            }
        };
        if round % 2 == 0 {
            entries.iter_mut().for_each(turn);
        } else {
            entries.iter_mut().rev().for_each(turn);
        }
    }
    for (entrant, _, times) in entries {
        entrant.time = Some(summarise(&times));
    }
}
