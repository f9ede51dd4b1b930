//! `crepitus sweep … --estimate`: what a sweep would cost, measured on some of it.

use super::{no_thread, words};
use crate::failure::{Failure, print, print_json};
use crate::interrupt;
use crate::progress;
use crepitus_studies::sweep::{
    Ended, Format, Parts, Plan, Receiver, Row, Shard, Stop, run_all, table, totals,
};
use serde_json::json;
use std::io;
use std::iter::once;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Most runs that are measured.
const MEASURED: u64 = 1000;

/// Time after which no other run is begun.
const ENOUGH: Duration = Duration::from_secs(5);

/// Most runs before them that are not measured, and the time after which none of these is begun: the first
/// ones warm up the processor.
const WARM_UP: u64 = 20;
const WARM: Duration = Duration::from_millis(500);

/// Points of a sweep in an order in which the first ones are from all over it, each once: multiples of about the
/// golden ratio. Those that a thread takes at once stay together.
struct Spread {
    runs: u64,
    at_once: u64,
    stride: u64,
}

impl Spread {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "below 2^53"
    )]
    fn of(runs: u64, at_once: u64) -> Self {
        let blocks = runs.div_ceil(at_once.max(1)).max(1);
        let golden = (blocks as f64 * 0.618_033_988_749_894_9) as u64;
        let stride = (golden.max(1)..=blocks).find(|&stride| is_coprime(stride, blocks));
        Self {
            runs,
            at_once: at_once.max(1),
            stride: stride.unwrap_or(1),
        }
    }

    fn point(&self, i: u64) -> u64 {
        let blocks = self.runs.div_ceil(self.at_once).max(1);
        let block = u128::from(i / self.at_once) * u128::from(self.stride) % u128::from(blocks);
        let first = u64::try_from(block).unwrap_or(0) * self.at_once;
        // The last block may have fewer.
        (first + i % self.at_once).min(self.runs.saturating_sub(1))
    }
}

fn is_coprime(mut a: u64, mut b: u64) -> bool {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

pub(super) fn run(plan: &Plan, runs: u64, threads: usize, as_json: bool) -> Result<(), Failure> {
    let threads = plan.threads(threads);
    let spread = Spread::of(plan.runs(), threads.at_once);
    let most = MEASURED.min(plan.runs());
    // A run that has begun is ended: leaving out the long ones would make the others look typical.
    let measure = |most: u64, time: Duration| -> Result<_, Failure> {
        let (begun, busy_ns) = (Instant::now(), AtomicU64::new(0));
        let mut rows = Rows::new(most);
        let run = |numbers: Range<u64>, stop: &Stop, give: &mut dyn FnMut(Row)| {
            if numbers.start > 0 && begun.elapsed() >= time {
                return Err(Ended::Stopped);
            }
            let begun = Instant::now();
            totals(plan, numbers.map(|i| spread.point(i)), stop, give)?;
            let ns = u64::try_from(begun.elapsed().as_nanos()).unwrap_or(u64::MAX);
            busy_ns.fetch_add(ns, Ordering::Relaxed);
            Ok(())
        };
        let threads = run_all(once(0..most), threads, &mut rows, run).map_err(failure)?;
        let busy = Duration::from_nanos(busy_ns.into_inner());
        Ok((rows, threads, busy.as_secs_f64()))
    };
    measure(WARM_UP.min(most), WARM)?;
    let (rows, threads, busy_s) = measure(most, ENOUGH)?;
    let count = rows.ended.len() as u64;
    // As long as all threads have work, as in the sweep.
    let wall_s = busy_s / usize_to_f64(threads);

    let failed = rows
        .ended
        .iter()
        .filter(|row| row.failure().is_some())
        .count();
    let bytes = bytes_of_table(plan, rows)?;
    #[expect(clippy::cast_precision_loss, reason = "an estimate")]
    let (scale, measured) = (runs as f64 / count as f64, count as f64);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "an estimate"
    )]
    let all_bytes = (bytes as f64 * scale) as u64;
    let ms_a_run = wall_s * 1e3 / measured;
    if as_json {
        return print_json(&json!({
            "measured_runs": count,
            "measured_wall_s": wall_s,
            "threads": threads,
            "failed": failed,
            "runs": runs,
            "wall_s": wall_s * scale,
            "core_hours": wall_s * scale * usize_to_f64(threads) / 3600.0,
            "bytes": all_bytes,
        }));
    }
    print(&format!(
        "measured: {count} runs from all over the sweep in {} on {threads} threads ({ms_a_run:.2} ms each), {failed} \
         failed\n{runs} runs: {} on this computer, {:.1} core-hours, a table of at most about {}\n",
        words::time(wall_s),
        words::time(wall_s * scale),
        wall_s * scale * usize_to_f64(threads) / 3600.0,
        words::size(all_bytes)
    ))
}

#[expect(clippy::cast_precision_loss, reason = "cores")]
fn usize_to_f64(x: usize) -> f64 {
    x as f64
}

/// The size of a table of these rows.
fn bytes_of_table(plan: &Plan, rows: Rows) -> Result<u64, Failure> {
    let failed = |e: io::Error| Failure::Work(format!("measuring the size of a table: {e}"));
    let home = tempfile::tempdir().map_err(failed)?;
    let mut rows = rows.ended;
    rows.sort_by_key(|row| row.index);
    // Those of a sweep that has no others.
    for (index, row) in (0..).zip(&mut rows) {
        row.index = index;
    }
    let mut identity = plan.identity().clone();
    identity.runs = rows.len() as u64;
    let parts = Parts::of(home.path().to_owned(), &identity, Shard::WHOLE);
    parts.write(&rows).map_err(failed)?;
    let written = table::write(&parts, &identity, Format::DEFAULT, &mut |_| true);
    match written {
        Ok(written) => Ok(written.bytes),
        Err(e) => Err(Failure::Work(e.to_string())),
    }
}

struct Rows {
    ended: Vec<Row>,
    wanted: u64,
    bar: progress::Progress,
}

impl Rows {
    fn new(wanted: u64) -> Self {
        Self {
            ended: Vec::new(),
            wanted,
            bar: progress::Progress::of_sweep(),
        }
    }
}

fn failure(ended: Ended) -> Failure {
    match ended {
        Ended::NoThread(error) => no_thread(&error),
        // No run has a file of its own.
        Ended::Stopped | Ended::Failed(_) => Failure::interrupted(),
    }
}

impl Receiver for Rows {
    type Error = Ended;

    fn row(&mut self, row: Row) -> Result<(), Ended> {
        self.ended.push(row);
        Ok(())
    }

    #[expect(clippy::cast_precision_loss, reason = "a share for people")]
    fn poll(&mut self) -> Result<(), Ended> {
        self.bar
            .reached(self.ended.len() as f64 / self.wanted.max(1) as f64);
        if interrupt::requested() {
            return Err(Ended::Stopped);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Spread;
    use std::collections::BTreeSet;

    #[test]
    fn the_first_points_are_from_all_over_the_sweep_and_each_is_taken_once() {
        for runs in [1, 2, 3, 15, 1000, 1024, 1_000_000_000] {
            let spread = Spread::of(runs, 1);
            let taken: BTreeSet<_> = (0..runs.min(1000)).map(|i| spread.point(i)).collect();
            assert_eq!(taken.len() as u64, runs.min(1000), "{runs}");
            assert!(taken.iter().all(|&point| point < runs));
        }
        let spread = Spread::of(100_000, 1);
        let tenths: BTreeSet<_> = (0..30).map(|i| spread.point(i) / 10_000).collect();
        assert_eq!(tenths.len(), 10);
    }
}
