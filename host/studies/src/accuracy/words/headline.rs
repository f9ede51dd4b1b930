//! The answer of the study in three sentences, and the solvers at the device's tick in a table that fits on a screen.

use super::numbers::plain;
use super::table::{Row, counted, rows, scenes, step_of_tables, worst_floor};
use crate::accuracy::target::{self, OnTarget, recorded};
use crate::accuracy::{Input, Study};
use crepitus_model::Convention;
use crepitus_model::solver::Solver;
use crepitus_pages::table::Table;
use crepitus_pages::table::show::{UNKNOWN, fixed, microseconds, milli, scientific};
use crepitus_scene::scene::Precision;
use std::borrow::Cow;

/// The cheapest solver and the exact one, on the host and on the controller, and what holding the torque costs whoever
/// solves.
pub(super) fn answer(study: &Study) -> String {
    let Some(step_s) = step_of_tables(study) else {
        return "No scene is long enough for any of the steps.".to_owned();
    };
    let convention = of_device(study);
    let mut rows = single(study, step_s);
    rows.retain(|row| row.convention == convention);
    let exact = rows
        .iter()
        .find(|row| row.solver == Solver::ExactEvents.name());
    let cheapest = rows
        .iter()
        .min_by(|a, b| a.ns_per_step.total_cmp(&b.ns_per_step));
    let (Some(exact), Some(cheapest)) = (exact, cheapest) else {
        return "The exact solver was not studied.".to_owned();
    };
    let setting = format!(
        "At {} ({convention}, {}, worst of {})",
        at_step(step_s),
        Precision::F32.name(),
        scenes(study, convention, Input::Exact.name())
    );
    let costs = if cheapest.solver == exact.solver {
        format!(
            "the exact solver, {}, is also the cheapest: {} ns a step ({}).",
            exact.solver,
            plain(exact.ns_per_step),
            error(exact)
        )
    } else {
        format!(
            "the cheapest solver, {}, takes {} ns a step ({}); exact events take {} ns, {:.2} times as long ({}).",
            cheapest.solver,
            plain(cheapest.ns_per_step),
            error(cheapest),
            plain(exact.ns_per_step),
            exact.ns_per_step / cheapest.ns_per_step,
            error(exact)
        )
    };
    let held = worst_floor(study, step_s).map(|worst| {
        format!(
            "A torque that is held for {} is off by up to {} mN·m RMS, whoever solves: a shorter step mends that, no solver does.",
            microseconds(step_s),
            milli(worst.held_floor_nm)
        )
    });
    let controller = on_the_controller(&cycles(study), cheapest, exact);
    let sentences = [Some(format!("{setting} {costs}")), controller, held];
    sentences
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join("\n")
}

/// The convention that the device renders; of other scenes the first.
fn of_device(study: &Study) -> &'static str {
    let mut conventions = study.scenes.iter().map(|scene| scene.convention);
    let device = Convention::Frozen.name();
    let first = conventions.clone().next().unwrap_or(device);
    conventions.find(|name| *name == device).unwrap_or(first)
}

fn at_step(step_s: f64) -> String {
    let step = microseconds(step_s);
    if (step_s / target::inputs::TICK_S - 1.0).abs() < 1e-6 {
        format!("the device's tick of {step}")
    } else {
        format!("a step of {step}")
    }
}

/// The error of a solver in words.
fn error(row: &Row) -> String {
    if row.unmatched > 0 {
        format!("{} wrong events", row.unmatched)
    } else if row.frequency_rel.is_finite() {
        format!("frequency off by {}", scientific(row.frequency_rel))
    } else {
        format!("events off by {} s", scientific(row.event_s))
    }
}

fn on_the_controller(on: &OnTarget, cheapest: &Row, exact: &Row) -> Option<String> {
    let (cheapest, exact) = (cost(on, cheapest)?, cost(on, exact)?);
    Some(format!(
        "On the controller: {:.0} and {:.0} of a tick's {:.0} cycles, {} and {} at worst ({}).",
        cheapest.mean_cycles,
        exact.mean_cycles,
        on.tick_cycles,
        cheapest.worst_cycles,
        exact.worst_cycles,
        on.label
    ))
}

/// Cycles of this study, or those on record.
fn cycles(study: &Study) -> Cow<'_, OnTarget> {
    match &study.target {
        Some(measured) => Cow::Borrowed(measured),
        None => Cow::Owned(recorded::on_target()),
    }
}

fn cost<'t>(on: &'t OnTarget, row: &Row) -> Option<&'t target::Row> {
    on.rows.iter().find(|cost| {
        cost.is_rung && cost.subject == row.solver && cost.convention == Some(row.convention)
    })
}

/// The rungs in the device's precision, on the true motion.
fn single(study: &Study, step_s: f64) -> Vec<Row> {
    let mut rows = rows(study, step_s);
    rows.retain(|row| row.precision == Precision::F32.name() && row.input == Input::Exact.name());
    rows
}

/// Table of the solvers at the device's tick, of the device's convention and of `physical`.
pub(super) fn table(study: &Study) -> String {
    let Some(step_s) = step_of_tables(study) else {
        return String::new();
    };
    let shown = [of_device(study), Convention::Physical.name()];
    let mut rows = single(study, step_s);
    rows.retain(|row| shown.contains(&row.convention));
    let on = cycles(study);
    let cycles = |of: fn(&target::Row) -> f64| {
        let on = &on;
        move |row: &Row| cost(on, row).map_or(f64::NAN, of)
    };
    let table = Table::of(&rows)
        .people("convention", |row| row.convention)
        .people("solver", |row| row.solver)
        .people("ns/step", |row| row.ns_per_step)
        .rounded(fixed::<1>)
        .people("instructions", |row| row.instructions)
        .rounded(fixed::<0>)
        .people("cycles", cycles(|cost| cost.mean_cycles))
        .rounded(fixed::<0>)
        .people("at worst", cycles(|cost| f64::from(cost.worst_cycles)))
        .rounded(fixed::<0>)
        .people("frequency off by", |row| match row.unmatched {
            0 => scientific(row.frequency_rel),
            unmatched => format!("{unmatched} wrong events"),
        })
        .right()
        .people("torque at tick, mN·m", |row| match row.at_tick_nm {
            nm if nm.is_nan() => UNKNOWN.to_owned(),
            nm => milli(nm),
        })
        .right()
        .to_text();
    format!("{table}{}\n", counted(study))
}
