//! Result of the comparison: the ratios, and whether they are what is asked for.

use crate::contest::{Contestant, EVENT_LIMIT_S, Who};
use crate::measure::Summary;
use crate::work::Task;
use crepitus_scene::preset::Joint;
use serde::Serialize;

/// Required speed-up with all samples.
const SAMPLES_RATIO: f64 = 5.0;
/// Required speed-up with the events only.
const EVENTS_RATIO: f64 = 500.0;
/// Faster at all.
const AHEAD: f64 = 1.0;
/// Our default convention, of which the most is asked.
const DEFAULT: &str = "frozen";

/// One of ours against the best peer at the same task.
#[derive(Clone, Debug, Serialize)]
pub struct Ratio {
    /// The task.
    pub task: Task,
    /// Ours.
    pub ours: Who,
    /// The fastest peer with every event within 1e-9 s.
    pub peer: Who,
    /// Our time and the peer's.
    pub times: [Summary; 2],
    /// CPU time of the peer over ours.
    pub cpu: f64,
    /// Wall time of the peer over ours.
    pub wall: f64,
    /// Required value of `cpu`, where there is one.
    pub required: Option<f64>,
}

impl Ratio {
    /// Returns whether it is what is asked for.
    pub fn holds(&self) -> bool {
        self.required.is_none_or(|r| self.cpu >= r)
    }
}

/// All ratios. Each of ours is compared with the best peer in the same task.
pub fn ratios(contestants: &[Contestant]) -> Vec<Ratio> {
    let mut ratios = Vec::new();
    for task in Task::ALL {
        let best = contestants
            .iter()
            .filter(|c| !c.who.is_ours())
            .filter_map(|c| Some((c, c.result(task)?)))
            .filter(|(_, r)| r.score.reaches(EVENT_LIMIT_S))
            .min_by(|a, b| a.1.time.median.cpu_s.total_cmp(&b.1.time.median.cpu_s));
        let Some((peer, peer_result)) = best else {
            continue;
        };
        for ours in contestants.iter().filter(|c| c.who.is_ours()) {
            let Some(result) = ours.result(task) else {
                continue;
            };
            let is_default = ours.who.method.ends_with(DEFAULT);
            let (peer_time, time) = (peer_result.time.median, result.time.median);
            ratios.push(Ratio {
                task,
                ours: ours.who.clone(),
                peer: peer.who.clone(),
                times: [result.time, peer_result.time],
                cpu: peer_time.cpu_s / time.cpu_s,
                wall: peer_time.wall_s / time.wall_s,
                required: match task {
                    Task::Samples if is_default => Some(SAMPLES_RATIO),
                    Task::Events if is_default => Some(EVENTS_RATIO),
                    Task::Events => Some(AHEAD),
                    _ => None,
                },
            });
        }
    }
    ratios
}

/// Requirements that do not hold, in words; empty if all do.
pub fn failures(joint: &Joint, contestants: &[Contestant], ratios: &[Ratio]) -> Vec<String> {
    let mut failures = Vec::new();
    let name = joint.name;
    for ours in contestants.iter().filter(|c| c.who.is_ours()) {
        for result in ours.results.iter().flatten() {
            if !result.score.reaches(EVENT_LIMIT_S) {
                failures.push(format!(
                    "{name}, {}: {} of {} events, worst error {:?} s",
                    ours.who.method,
                    result.score.events,
                    result.score.events_true,
                    result.score.event_error_s
                ));
            }
        }
    }
    for required in [Task::Samples, Task::Events] {
        if !ratios.iter().any(|r| r.task == required) {
            failures.push(format!("{name}: no peer is good enough at {required:?}"));
        }
    }
    for r in ratios.iter().filter(|r| !r.holds()) {
        failures.push(format!(
            "{name}, {}: {:.1} times faster at {:?}, not {}",
            r.ours.method,
            r.cpu,
            r.task,
            r.required.unwrap_or_default()
        ));
    }
    failures
}
