//! Checks of a recording: completeness, and counts that a shaft can make.

use crate::brace::recording::{Recording, Sample};
use crate::brace::refusal::Refusal;

/// Most missing samples, as a share, and in a row.
const MISSING_SHARE: f64 = 0.02;
const MISSING_IN_A_ROW: u64 = 400;

/// Velocity between neighbouring counts from which they are a jump, rad/s.
const FASTEST_RAD_S: f64 = 40.0;

/// Rejects a recording that is too short or incomplete, or whose counts jump or freeze.
pub(crate) fn whole(recording: &Recording, first: &Sample, last: &Sample) -> Result<(), Refusal> {
    /// Shortest recording, s: a release, two turning points and a rest take longer.
    const SHORTEST_S: f64 = 1.5;
    let samples = &recording.samples;
    let mut missing = 0;
    let mut longest = 0;
    let most = FASTEST_RAD_S * recording.tick_s / recording.rad_per_count;
    for pair in samples.windows(2) {
        let (before, after) = (&pair[0], &pair[1]);
        if after.tick <= before.tick {
            return Err(Refusal::NotInOrder { tick: after.tick });
        }
        let ticks = after.tick - before.tick;
        missing += ticks - 1 + u64::from(after.is_lost);
        longest = longest.max(ticks - 1);
        let moved = f64::from(after.count.wrapping_sub(before.count)).abs();
        if moved > most * ticks as f64 {
            return Err(Refusal::Jump {
                time_s: (after.tick - first.tick) as f64 * recording.tick_s,
                degrees: (moved * recording.rad_per_count).to_degrees(),
            });
        }
    }
    frozen(recording)?;
    let all = last.tick - first.tick + 1;
    let duration_s = all as f64 * recording.tick_s;
    if duration_s < SHORTEST_S {
        return Err(Refusal::Short { duration_s });
    }
    let share = missing as f64 / all as f64;
    if share > MISSING_SHARE || longest > MISSING_IN_A_ROW {
        return Err(Refusal::Missing {
            share: 100.0 * share,
            longest_ms: 1e3 * longest as f64 * recording.tick_s,
            limit: 100.0 * MISSING_SHARE,
            limit_ms: 1e3 * MISSING_IN_A_ROW as f64 * recording.tick_s,
        });
    }
    Ok(())
}

/// Rejects counts that stop in mid-motion: friction takes longer to stop a rotor.
fn frozen(recording: &Recording) -> Result<(), Refusal> {
    /// Length of the motion before, and of the standstill after, ticks.
    const TICKS: usize = 200;
    /// Smallest velocity of a motion that froze, rad/s; slower is a turning point.
    const SLOWEST_RAD_S: f64 = 0.6;
    let samples = &recording.samples;
    let window_s = TICKS as f64 * recording.tick_s;
    let least = SLOWEST_RAD_S * window_s / recording.rad_per_count;
    let mut at = TICKS;
    while at + TICKS < samples.len() {
        // The longest stretch of one count from here on.
        let stands = samples[at..]
            .iter()
            .take_while(|s| s.count == samples[at].count)
            .count();
        let moved = f64::from(samples[at].count.wrapping_sub(samples[at - TICKS].count)).abs();
        // At an even speed half of the way lies in each half of the time.
        let late = f64::from(
            samples[at]
                .count
                .wrapping_sub(samples[at - TICKS / 2].count),
        )
        .abs();
        if stands > TICKS && moved > least && late > 0.4 * moved {
            let since = samples[at].tick.saturating_sub(samples[0].tick);
            return Err(Refusal::Frozen {
                time_s: since as f64 * recording.tick_s,
                speed_deg_s: (moved * recording.rad_per_count / window_s).to_degrees(),
            });
        }
        at += stands.max(1);
    }
    Ok(())
}
