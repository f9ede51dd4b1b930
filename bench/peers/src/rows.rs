//! Cost of rows of output to the reference: events' cost + rows' cost.
//!
//! A solver that searches again from each row for the next event pays for the rows in events.

use crate::measure::{Times, repeats, summarise, time};
use crate::motion::Hand;
use crate::ours;
use crate::work::{Delivery, Runner, Task};
use crepitus_model::Convention;
use serde::Serialize;
use std::fmt::Write as _;

/// Spacings of the rows, s.
const SPACINGS_S: [f64; 5] = [1.0, 1e-1, 1e-2, 1e-3, 1e-4];
/// Up to this spacing the rows themselves cost next to nothing, s.
const COARSE_S: f64 = 1e-1;
/// Times that the events may take with coarse rows, of their time without.
const COARSE_RATIO: f64 = 1.3;
/// Spacing from which down the rows cost more than the scatter of the events' time, s.
const FINE_S: f64 = 1e-3;
/// Largest allowed ratio between the times of a row.
const ROW_RATIO: f64 = 2.0;

/// The costs on one motion under one convention.
#[derive(Serialize)]
pub struct Rows {
    /// Motion and convention.
    pub name: String,
    /// Time of the events only, s.
    pub events_s: f64,
    /// Each spacing, coarsest first.
    pub spacings: Vec<Spacing>,
    #[serde(skip)]
    runners: Vec<Runner>,
}

/// The cost at a spacing of rows.
#[derive(Clone, Copy, Serialize)]
#[expect(clippy::struct_field_names, reason = "a column of the results")]
pub struct Spacing {
    /// The spacing, s.
    pub spacing_s: f64,
    /// Number of rows.
    pub rows: usize,
    /// Time of the run, s.
    pub total_s: f64,
}

impl Rows {
    /// Sets up a motion under a convention.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most 100,000 rows"
    )]
    pub fn new(hand: &Hand, convention: Convention) -> Self {
        let rows = |spacing_s: f64| (hand.duration_s / spacing_s + 1e-9) as usize;
        let spacings = SPACINGS_S.map(|spacing_s| Spacing {
            spacing_s,
            rows: rows(spacing_s),
            total_s: f64::NAN,
        });
        let mut runners = vec![ours::reference_events(convention, hand)];
        runners.extend(
            spacings
                .iter()
                .map(|s| ours::reference_rows(convention, hand, s.spacing_s, s.rows)),
        );
        Self {
            name: format!("{}, {}", hand.name(), convention.name()),
            events_s: f64::NAN,
            spacings: spacings.into(),
            runners,
        }
    }

    /// Time of a row beyond the events, s.
    #[expect(clippy::cast_precision_loss, reason = "at most 100,000 rows")]
    fn row_s(&self, spacing: &Spacing) -> f64 {
        (spacing.total_s - self.events_s) / spacing.rows as f64
    }

    /// Requirements that do not hold, in words.
    pub fn failures(&self) -> Vec<String> {
        let mut failures = Vec::new();
        for s in self.spacings.iter().filter(|s| s.spacing_s >= COARSE_S) {
            let ratio = s.total_s / self.events_s;
            if !ratio.le(&COARSE_RATIO) {
                failures.push(format!(
                    "{}: with rows {} s apart {ratio:.2} times the time without, not {COARSE_RATIO}",
                    self.name, s.spacing_s
                ));
            }
        }
        let fine = self.spacings.iter().filter(|s| s.spacing_s <= FINE_S);
        let (least, most) = fine
            .map(|s| self.row_s(s))
            .fold((f64::INFINITY, 0.0), |(a, b), x| (x.min(a), x.max(b)));
        if !(least > 0.0 && most / least <= ROW_RATIO) {
            failures.push(format!(
                "{}: a row costs {:.1} to {:.1} ns, not within {ROW_RATIO} times",
                self.name,
                1e9 * least,
                1e9 * most
            ));
        }
        failures
    }
}

/// Lets every spacing take a turn in each round, there and back.
pub fn hold(all: &mut [Rows], rounds: usize, out: &mut Delivery) {
    for rows in all {
        let mut entries: Vec<(&mut Runner, u32, Vec<Times>)> = Vec::new();
        for runner in &mut rows.runners {
            let repeats = repeats(runner, Task::Events, out);
            entries.push((runner, repeats, Vec::with_capacity(rounds)));
        }
        for round in 0..rounds {
            let turn = |(runner, repeats, times): &mut (&mut Runner, u32, Vec<Times>)| {
                times.push(time(runner, Task::Events, out, *repeats));
            };
            if round % 2 == 0 {
                entries.iter_mut().for_each(turn);
            } else {
                entries.iter_mut().rev().for_each(turn);
            }
        }
        let mut medians = entries
            .iter()
            .map(|(_, _, times)| summarise(times).median.cpu_s);
        rows.events_s = medians.next().unwrap_or(f64::NAN);
        for (spacing, median_s) in rows.spacings.iter_mut().zip(medians) {
            spacing.total_s = median_s;
        }
    }
}

/// The table.
pub fn markdown(all: &[Rows]) -> String {
    let mut text = String::from("\n| reference | events only, µs |");
    for spacing_s in SPACINGS_S {
        let _ = write!(text, " rows {spacing_s} s apart, µs (ns a row) |");
    }
    text.push_str("\n|---|---|---|---|---|---|---|\n");
    for rows in all {
        let _ = write!(text, "| {} | {:.1} |", rows.name, 1e6 * rows.events_s);
        for s in &rows.spacings {
            let total_us = 1e6 * s.total_s;
            if s.spacing_s <= FINE_S {
                let _ = write!(text, " {total_us:.1} ({:.1}) |", 1e9 * rows.row_s(s));
            } else {
                let _ = write!(text, " {total_us:.1} |");
            }
        }
        text.push('\n');
    }
    text
}
