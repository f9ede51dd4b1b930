//! `crepitus sweep … --estimate`: what a sweep would cost, measured on some of it.

use super::{no_thread, words};
use crate::failure::{Failure, print, print_json};
use crate::interrupt;
use crate::progress;
use crepitus_studies::sweep::{
    Ended, Format, Parts, Plan, Receiver, Row, Shard, run_all, table, totals,
};
use serde_json::json;
use std::io;
use std::iter::once;
use std::ops::Range;
use std::time::Instant;

/// Runs that are measured.
const MEASURED: u64 = 1000;

/// Runs before them that are not: the first ones warm up the processor.
const WARM_UP: u64 = 20;

pub(super) fn run(plan: &Plan, runs: u64, threads: usize, as_json: bool) -> Result<(), Failure> {
    let count = MEASURED.min(plan.runs());
    let point = |i: u64| {
        let place = u128::from(i) * u128::from(plan.runs()) / u128::from(count);
        u64::try_from(place).unwrap_or(0)
    };
    let mut warm = Rows::new(WARM_UP);
    let run = |numbers: Range<u64>, stop: &_, give: &mut dyn FnMut(Row)| {
        totals(plan, numbers.map(point), stop, give)
    };
    let threads = plan.threads(threads);
    let warm_up = WARM_UP.min(count);
    run_all(once(0..warm_up), threads, &mut warm, run).map_err(failure)?;
    let mut rows = Rows::new(count);
    let begun = Instant::now();
    let threads = run_all(once(0..count), threads, &mut rows, run).map_err(failure)?;
    let wall_s = begun.elapsed().as_secs_f64();

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
