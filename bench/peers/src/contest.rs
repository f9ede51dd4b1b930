//! Contestants, their settings, and the rounds in which all take turns.

use crate::measure::{Score, Summary, repeats, score, summarise, time};
use crate::ours;
use crate::peers::{Peer, Setting};
use crate::work::{Delivery, Runner, Task, Work};
use crepitus_model::Convention;
use crepitus_scene::preset::Joint;
use serde::Serialize;

/// An event is good if it is within this of the closed form, s.
pub const EVENT_LIMIT_S: f64 = 1e-9;

/// A solver with its settings and what was measured of it.
pub struct Contestant {
    /// Library, method and setting.
    pub who: Who,
    runner: Runner,
    /// Results by task, in the order of [`Task::ALL`]; none where the solver has no answer.
    pub results: [Option<TaskResult>; 3],
}

/// Description of a contestant.
#[derive(Clone, Debug, Serialize)]
pub struct Who {
    /// Library and version, or `crepitus`.
    pub library: String,
    /// Method of the library.
    pub method: String,
    /// Setting of the method; none for ours, which have none.
    pub setting: Option<Setting>,
    /// Tasks for which the search found this setting the cheapest good one.
    pub tuned_for: Vec<Task>,
}

impl Who {
    /// Returns whether it is one of our own.
    pub fn is_ours(&self) -> bool {
        self.setting.is_none()
    }
}

/// Result of one task.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TaskResult {
    /// Errors against the closed form.
    pub score: Score,
    /// Times over all rounds.
    pub time: Summary,
}

impl Contestant {
    /// The result of a task.
    pub fn result(&self, task: Task) -> Option<&TaskResult> {
        self.results[Task::ALL.iter().position(|&t| t == task)?].as_ref()
    }
}

/// Ours, then every peer at three tolerances and at the best that the search found for each task.
pub fn line_up(joint: &Joint, out: &mut Delivery) -> Vec<Contestant> {
    let work = Work::new(joint.parameters);
    let mut all = Vec::new();
    for convention in [Convention::Frozen, Convention::Physical] {
        for (method, runner) in [
            ("exact-events", ours::exact_events(convention, joint)),
            ("reference", ours::reference(convention, joint)),
        ] {
            all.push(Contestant {
                who: Who {
                    library: "crepitus".into(),
                    method: format!("{method}, {}", convention.name()),
                    setting: None,
                    tuned_for: Vec::new(),
                },
                runner,
                results: [None; 3],
            });
        }
    }
    for peer in Peer::ALL {
        eprintln!("{}: tuning {} {}", joint.name, peer.library, peer.method);
        let mut settings: Vec<(Setting, Vec<Task>)> = Vec::new();
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let free = Setting {
                tolerance,
                limited: false,
            };
            settings.push((free, Vec::new()));
            // A peer that misses events is also shown with what it takes to find them.
            if attempt(&work, &peer, free, out).is_none_or(|s| s.event_error_s.is_none()) {
                let limited = Setting {
                    limited: true,
                    ..free
                };
                settings.push((limited, Vec::new()));
            }
        }
        for (task, best) in tune(&work, &peer, out) {
            match settings.iter_mut().find(|(s, _)| *s == best) {
                Some((_, tasks)) => tasks.push(task),
                None => settings.push((best, vec![task])),
            }
        }
        for (setting, tuned_for) in settings {
            if let Ok(runner) = peer.build(work, setting) {
                all.push(Contestant {
                    who: Who {
                        library: peer.library.into(),
                        method: peer.method.into(),
                        setting: Some(setting),
                        tuned_for,
                    },
                    runner,
                    results: [None; 3],
                });
            }
        }
    }
    all
}

fn attempt(work: &Work, peer: &Peer, setting: Setting, out: &mut Delivery) -> Option<Score> {
    score(
        work,
        &mut peer.build(*work, setting).ok()?,
        Task::Events,
        out,
    )
    .ok()
}

/// Finds for each task the cheapest setting with every event within [`EVENT_LIMIT_S`]: tolerances from
/// 1e-4 to 1e-13 in half decades, slips limited or not. A setting that finds all events by luck
/// of its steps is as good as any.
fn tune(work: &Work, peer: &Peer, out: &mut Delivery) -> Vec<(Task, Setting)> {
    /// Number of the cheapest settings that are timed again for each task.
    const SHORT_LIST: usize = 5;
    let mut good = Vec::new();
    for limited in [false, true] {
        for half_decade in 8..=26 {
            let setting = Setting {
                tolerance: 10f64.powf(-f64::from(half_decade) / 2.0),
                limited,
            };
            if attempt(work, peer, setting, out).is_some_and(|s| s.reaches(EVENT_LIMIT_S))
                && let Ok(mut runner) = peer.build(*work, setting)
            {
                let events = cost(setting, &mut runner, Task::Events, out);
                good.push((events, setting, runner));
            }
        }
    }
    good.sort_by(|a, b| a.0.total_cmp(&b.0));
    good.truncate(SHORT_LIST);
    Task::ALL
        .into_iter()
        .filter_map(|task| {
            let mut timed: Vec<_> = good
                .iter_mut()
                .map(|(_, setting, runner)| (cost(*setting, runner, task, out), *setting))
                .collect();
            timed.sort_by(|a, b| a.0.total_cmp(&b.0));
            timed.first().map(|&(_, setting)| (task, setting))
        })
        .collect()
}

/// Cost of a setting, s. A limit that changes nothing should not be chosen for noise.
fn cost(setting: Setting, runner: &mut Runner, task: Task, out: &mut Delivery) -> f64 {
    cheapest(runner, task, out) * if setting.limited { 1.02 } else { 1.0 }
}

/// The least of a few times, s.
fn cheapest(runner: &mut Runner, task: Task, out: &mut Delivery) -> f64 {
    (0..5)
        .map(|_| time(runner, task, out, 1).cpu_s)
        .fold(f64::INFINITY, f64::min)
}

/// Scores everyone once, then lets everyone take a turn in each round, there and back.
pub fn hold(joint: &Joint, contestants: &mut [Contestant], rounds: usize, out: &mut Delivery) {
    struct Entry {
        who: usize,
        task: usize,
        score: Score,
        repeats: u32,
        times: Vec<crate::measure::Times>,
    }

    let work = Work::new(joint.parameters);
    let mut entries = Vec::new();
    for (who, contestant) in contestants.iter_mut().enumerate() {
        for (task, &asked) in Task::ALL.iter().enumerate() {
            let runner = &mut contestant.runner;
            match score(&work, runner, asked, out) {
                Ok(score) => entries.push(Entry {
                    who,
                    task,
                    score,
                    repeats: repeats(runner, asked, out),
                    times: Vec::with_capacity(rounds),
                }),
                Err(reason) if !contestant.who.is_ours() => {
                    eprintln!("{:?} gave up: {reason}", contestant.who);
                }
                Err(_) => {}
            }
        }
    }
    for round in 0..rounds {
        eprintln!("{}: round {} of {rounds}", joint.name, round + 1);
        let mut turn = |entry: &mut Entry| {
            let runner = &mut contestants[entry.who].runner;
            let task = Task::ALL[entry.task];
            entry.times.push(time(runner, task, out, entry.repeats));
        };
        if round % 2 == 0 {
            entries.iter_mut().for_each(&mut turn);
        } else {
            entries.iter_mut().rev().for_each(&mut turn);
        }
    }
    for entry in entries {
        contestants[entry.who].results[entry.task] = Some(TaskResult {
            score: entry.score,
            time: summarise(&entry.times),
        });
    }
}
