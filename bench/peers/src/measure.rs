//! Errors against the closed form, and times in turns.
//!
//! The clock is the CPU time of the thread. On a quiet machine it is the wall time; on a busy one
//! the wall time of a long run holds time slices of others and that of a short run does not, which
//! would flatter the fast contestants. Both are kept.

use crate::work::{Delivery, Runner, SAMPLES, Task, Work, sample_s};
use crepitus_scene::cpu_time;
use serde::Serialize;
use std::hint::black_box;
use std::time::Instant;

/// A turn lasts at least this long, s: short work is repeated within it.
const TURN_S: f64 = 1e-3;

/// Accuracy of a delivery.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Score {
    /// Number of events delivered.
    pub events: usize,
    /// Number of events that there are.
    pub events_true: usize,
    /// Worst error of an event's time, s; none if there are too many or too few.
    pub event_error_s: Option<f64>,
    /// Worst error of the torque more than 1 µs from an event, N·m; none if no samples were asked
    /// for or one of them is missing.
    pub torque_error_nm: Option<f64>,
}

impl Score {
    /// Returns whether all events are there, each within `limit_s`.
    pub fn reaches(&self, limit_s: f64) -> bool {
        self.event_error_s.is_some_and(|e| e <= limit_s)
    }
}

/// Does the work once and scores it.
///
/// # Errors
/// The solver's message if it gives up.
pub fn score(
    work: &Work,
    runner: &mut Runner,
    task: Task,
    out: &mut Delivery,
) -> Result<Score, String> {
    out.wipe();
    runner(task, out)?;
    let truth = work.closed_form_events();
    let worst = |errors: &mut dyn Iterator<Item = f64>| errors.fold(0.0, f64::max);
    Ok(Score {
        events: out.events.len(),
        events_true: truth.len(),
        event_error_s: (out.events.len() == truth.len())
            .then(|| worst(&mut out.events.iter().zip(&truth).map(|(a, b)| (a - b).abs()))),
        torque_error_nm: (task != Task::Events && !out.torque.iter().any(|t| t.is_nan())).then(
            || {
                worst(&mut (0..SAMPLES).filter_map(|n| {
                    let truth = work.closed_form_torque(sample_s(n))?;
                    Some((out.torque[n] - truth).abs())
                }))
            },
        ),
    })
}

/// CPU and wall time of `repeats` runs, s a run.
pub fn time(runner: &mut Runner, task: Task, out: &mut Delivery, repeats: u32) -> Times {
    let (cpu, wall) = (cpu_s(), Instant::now());
    for _ in 0..repeats {
        // The runner did not fail when it was scored, and it does the same again.
        let _ = black_box(runner(black_box(task), out));
        black_box(&mut *out);
    }
    Times {
        cpu_s: (cpu_s() - cpu) / f64::from(repeats),
        wall_s: wall.elapsed().as_secs_f64() / f64::from(repeats),
    }
}

/// Number of times that a run is repeated to fill a turn.
pub fn repeats(runner: &mut Runner, task: Task, out: &mut Delivery) -> u32 {
    let mut repeats = 1;
    while time(runner, task, out, repeats).cpu_s * f64::from(repeats) < TURN_S && repeats < 1 << 20
    {
        repeats *= 2;
    }
    repeats
}

/// One measurement, or the median of several.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Times {
    /// CPU time of the thread, s.
    pub cpu_s: f64,
    /// Wall time, s.
    pub wall_s: f64,
}

/// The times of one contestant at one task over all rounds.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Summary {
    /// Medians.
    pub median: Times,
    /// Distance of the quartiles of the CPU time, over the median.
    pub spread: f64,
}

/// Medians and spread.
pub fn summarise(times: &[Times]) -> Summary {
    let sorted = |value: fn(&Times) -> f64| {
        let mut values: Vec<f64> = times.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let (cpu, wall) = (sorted(|t| t.cpu_s), sorted(|t| t.wall_s));
    let at = |values: &[f64], quarters: usize| values[(values.len() - 1) * quarters / 4];
    Summary {
        median: Times {
            cpu_s: at(&cpu, 2),
            wall_s: at(&wall, 2),
        },
        spread: (at(&cpu, 3) - at(&cpu, 1)) / at(&cpu, 2),
    }
}

fn cpu_s() -> f64 {
    cpu_time::now().as_secs_f64()
}
