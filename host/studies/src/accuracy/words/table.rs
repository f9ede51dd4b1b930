//! The study at the device's tick, as a table for the terminal.

use crate::accuracy::{Input, Point, Study};
use crepitus_pages::table::Table;
use crepitus_pages::table::show::{fixed, microseconds, scientific};
use std::fmt::Write;

/// The device's tick, s.
const TICK_S: f64 = 5e-5;

/// Table, for each convention and input, of every rung at the device's tick, or at the studied step
/// that is nearest to it: the worst of all scenes.
pub(super) fn at_the_tick(study: &Study) -> String {
    let Some(step_s) = step_of_tables(study) else {
        return "no scene is long enough for any of the steps".to_owned();
    };
    let mut text = format!(
        "What accuracy costs at a step of {}\n",
        microseconds(step_s)
    );
    for rows in
        rows(study, step_s).chunk_by(|a, b| (a.convention, a.input) == (b.convention, b.input))
    {
        let (convention, input) = rows
            .first()
            .map_or(("", ""), |row| (row.convention, row.input));
        let behind = behind(input);
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "\n{convention}{behind}, worst of {}:\n{}",
            scenes(study, convention, input),
            table(rows).to_text()
        );
    }
    text.push('\n');
    text.push_str(counted(study));
    text.push_str(&floor(study, step_s));
    for refused in &study.refused {
        let _ = write!(
            text,
            "\nnot under {}: {}",
            refused.convention, refused.solver
        );
    }
    if !study.refused.is_empty() {
        text.push_str("\n(the reasons are in summary.json)");
    }
    text
}

/// The one of these steps that is nearest to the device's tick, s.
pub(crate) fn nearest_to_the_tick(steps_s: impl Iterator<Item = f64>) -> Option<f64> {
    let away = |h: f64| (h / TICK_S).ln().abs();
    steps_s.min_by(|a, b| away(*a).total_cmp(&away(*b)))
}

/// The step of the study's tables, s.
pub(super) fn step_of_tables(study: &Study) -> Option<f64> {
    nearest_to_the_tick(study.points.iter().map(|p| p.step_s))
}

/// Counts of each rung in the study's tables that knows the true motion.
#[cfg(test)]
pub(crate) fn instructions_at_the_tick(study: &Study) -> Vec<f64> {
    let step_s = step_of_tables(study).unwrap_or(f64::NAN);
    let rows = rows(study, step_s).into_iter();
    rows.filter(|row| row.input == Input::Exact.name())
        .map(|row| row.instructions)
        .collect()
}

/// Sentence on the column of instructions.
pub(super) fn counted(study: &Study) -> &'static str {
    if study.is_priced() {
        "Instructions are valgrind's, on the first scene of each convention."
    } else {
        "Instructions were not counted: that needs valgrind."
    }
}

fn table(rows: &[Row]) -> Table<'_, Row> {
    Table::of(rows)
        .people("solver", |row| row.solver)
        .people("precision", |row| row.precision)
        .people("ns/step", |row| row.ns_per_step)
        .rounded(fixed::<1>)
        .people("instructions", |row| row.instructions)
        .rounded(fixed::<0>)
        .people("spread, %", |row| 100.0 * row.time_spread)
        .rounded(fixed::<0>)
        .people("event error, s", |row| row.event_s)
        .rounded(scientific)
        .group("rms torque, N·m")
        .people("held", |row| row.held_nm)
        .rounded(scientific)
        .people("at tick", |row| row.at_tick_nm)
        .rounded(scientific)
        .group("")
        .people("events", |row| match row.unmatched {
            0 => "all matched".to_owned(),
            unmatched => format!("{unmatched} unmatched"),
        })
}

/// The point at which any torque that is held for a step is off most.
pub(super) fn worst_floor(study: &Study, step_s: f64) -> Option<&Point> {
    let points = study.points.iter();
    let known = points.filter(|p| p.step_s == step_s && p.held_floor_nm.is_finite());
    known.max_by(|a, b| a.held_floor_nm.total_cmp(&b.held_floor_nm))
}

fn floor(study: &Study, step_s: f64) -> String {
    worst_floor(study, step_s).map_or_else(String::new, |worst| {
        format!(
            "\nTorque that is held for {} is off by {} N·m RMS at least, whatever the solver ({}, {}).",
            microseconds(step_s),
            scientific(worst.held_floor_nm),
            worst.scene,
            worst.convention
        )
    })
}

/// Note on a scene that was seen by the encoder.
pub(super) fn behind(input: &str) -> &'static str {
    if input == Input::Encoder.name() {
        " behind the encoder"
    } else {
        ""
    }
}

pub(super) fn scenes(study: &Study, convention: &str, input: &str) -> String {
    let count = study
        .scenes
        .iter()
        .filter(|s| (s.convention, s.input) == (convention, input))
        .count();
    if count == 1 {
        "one scene".to_owned()
    } else {
        format!("{count} scenes")
    }
}

/// A rung, the worst of the scenes of a convention.
pub(super) struct Row {
    pub(super) convention: &'static str,
    pub(super) input: &'static str,
    pub(super) solver: &'static str,
    pub(super) precision: &'static str,
    /// Mean over the scenes, ns.
    pub(super) ns_per_step: f64,
    /// Instructions on the scene on which they were counted.
    pub(super) instructions: f64,
    /// Largest distance of the quartiles over the median.
    time_spread: f64,
    pub(super) event_s: f64,
    pub(super) frequency_rel: f64,
    held_nm: f64,
    pub(super) at_tick_nm: f64,
    pub(super) unmatched: u64,
}

/// The rungs at this step, by convention in the order of the scenes; behind the encoder last.
pub(super) fn rows(study: &Study, step_s: f64) -> Vec<Row> {
    let mut rows: Vec<(Row, f64)> = Vec::new();
    for p in study.points.iter().filter(|p| p.step_s == step_s) {
        match rows.iter_mut().find(|(r, _)| r.is_of(p)) {
            Some((row, count)) => {
                *count += 1.0;
                row.ns_per_step += (p.ns_per_step - row.ns_per_step) / *count;
                if row.instructions.is_nan() {
                    row.instructions = p.host_instructions_per_step;
                }
                row.time_spread = worse(row.time_spread, p.time_spread);
                row.event_s = worse(row.event_s, p.max_event_error_s);
                row.frequency_rel = worse(row.frequency_rel, p.frequency_error_rel);
                row.held_nm = worse(row.held_nm, p.rms_held_torque_error_nm);
                row.at_tick_nm = worse(row.at_tick_nm, p.rms_tick_torque_error_nm);
                row.unmatched += p.unmatched;
            }
            None => rows.push((Row::of(p), 1.0)),
        }
    }
    let order = |convention: &str| study.scenes.iter().position(|s| s.convention == convention);
    rows.sort_by_key(|(row, _)| (order(row.convention), row.input != Input::Exact.name()));
    rows.into_iter().map(|(row, _)| row).collect()
}

/// NaN, for not known, is the worst.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

impl Row {
    fn of(p: &Point) -> Self {
        Self {
            convention: p.convention,
            input: p.input,
            solver: p.solver,
            precision: p.precision,
            ns_per_step: p.ns_per_step,
            instructions: p.host_instructions_per_step,
            time_spread: p.time_spread,
            event_s: p.max_event_error_s,
            frequency_rel: p.frequency_error_rel,
            held_nm: p.rms_held_torque_error_nm,
            at_tick_nm: p.rms_tick_torque_error_nm,
            unmatched: p.unmatched,
        }
    }

    fn is_of(&self, p: &Point) -> bool {
        (self.convention, self.input) == (p.convention, p.input)
            && self.solver == p.solver
            && self.precision == p.precision
    }
}
