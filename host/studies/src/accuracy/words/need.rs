//! The answer to a need, in sentences.

mod on_target;

use super::numbers::{plain, with_unit};
use super::target;
use crate::accuracy::answer::{Answer, Candidate, Mark};
use crate::accuracy::target::STEP_SHARE;
use crate::accuracy::{Need, Question, Study};
use crate::limits::Limited;
use crepitus_pages::table::show::{microseconds, scientific};
use crepitus_scene::cpu_time::CLOCK;
use std::fmt::Write;

/// The need, what to use, what that costs, and why nothing cheaper will do.
pub fn in_words(need: &Need, question: &Question<'_>, study: &Study, answer: &Answer) -> String {
    let mut text = asked(need, question, study);
    if let Some(target) = question.target {
        text.push_str(&target::chooses_by(target));
    }
    // Writing to a String cannot fail.
    let _ = match (&answer.chosen, &answer.nearest) {
        (Some(chosen), _) => match &chosen.cycles {
            Some(cycles) => write!(text, "{}", on_target::recommended(chosen, cycles, answer)),
            None => write!(text, "{}", recommended(chosen, answer)),
        },
        (None, Some(nearest)) => writeln!(
            text,
            "Nothing studied meets it. The nearest is {}: {}.",
            at_step(nearest),
            why_not(nearest)
        ),
        (None, None) => writeln!(
            text,
            "No scene is long enough for the step: nothing was studied."
        ),
    };
    if let Some(why) = &answer.unreachable {
        let _ = writeln!(
            text,
            "No solver could: any torque that is held for {} is off by {} N·m RMS at least on {}. Ask for a higher \
             --rate, for more torque, or for torque-at-tick.",
            microseconds(why.step_s),
            scientific(why.floor_nm),
            why.scene
        );
    }
    if !answer.longest.is_empty() && answer.chosen.is_some() {
        text.push_str("The longest studied step at which each meets it:\n");
        for longest in &answer.longest {
            let _ = match &longest.candidate {
                Some(c) => write!(
                    text,
                    "  {:20} {:>9}  {:>6} ns a step, {:>8} µs per simulated second",
                    c.solver,
                    microseconds(c.step_s),
                    plain(c.ns_per_step),
                    plain(c.us_per_simulated_s)
                ),
                None => write!(text, "  {:20}     never", longest.solver),
            };
            if !longest.fails_below_s.is_empty() {
                let steps: Vec<_> = longest
                    .fails_below_s
                    .iter()
                    .map(|h| microseconds(*h))
                    .collect();
                let _ = write!(text, ", but not at {}", steps.join(", "));
            }
            text.push('\n');
        }
    }
    if question.target.is_some() {
        on_target::failed(&mut text, &answer.failed);
    } else if !answer.cheaper.is_empty() {
        text.push_str("Why not a cheaper one:\n");
        for c in &answer.cheaper {
            let _ = writeln!(
                text,
                "  {}, {} µs per simulated second: {}",
                at_step(c),
                plain(c.us_per_simulated_s),
                why_not(c)
            );
        }
    }
    text
}

fn asked(need: &Need, question: &Question<'_>, study: &Study) -> String {
    let limits: Vec<_> = need
        .limits()
        .iter()
        .map(|l| {
            let unit = l.criterion.unit();
            let space = if unit.is_empty() { "" } else { " " };
            format!(
                "{} at most {:e}{space}{unit}",
                l.criterion.meaning(),
                l.at_most
            )
        })
        .collect();
    let scenes: Vec<_> = study
        .scenes
        .iter()
        .filter(|s| s.convention == question.convention)
        .map(|s| s.name.as_str())
        .collect();
    format!(
        "Need: {}; {}, {}, on {}.\n",
        limits.join(", "),
        question.convention,
        question.precision,
        scenes.join(", ")
    )
}

fn recommended(chosen: &Candidate, answer: &Answer) -> String {
    let mut text = format!(
        "Use {} ({} Hz). It costs {} ns a step, {} µs per simulated second: {} % of one core ({CLOCK}).\n",
        at_step(chosen),
        plain(1.0 / chosen.step_s),
        plain(chosen.ns_per_step),
        plain(chosen.us_per_simulated_s),
        plain(chosen.core_share() * 100.0),
    );
    tightest(&mut text, chosen);
    if !answer.equals.is_empty() {
        let names: Vec<_> = answer.equals.iter().map(at_step).collect();
        let _ = writeln!(
            text,
            "At the same cost within the spread of the timings, and not more exact: {}.",
            names.join("; ")
        );
    }
    let _ = match (&answer.better, chosen.tightest()) {
        (Some(better), Some(mark)) => writeln!(
            text,
            "The next better one is {}: {} ns a step, {} µs per simulated second, {} times as much; \
             its {} is {}.",
            at_step(better),
            plain(better.ns_per_step),
            plain(better.us_per_simulated_s),
            plain(better.us_per_simulated_s / chosen.us_per_simulated_s),
            mark.limit.criterion.meaning(),
            better
                .mark(mark.limit.criterion)
                .map_or_else(|| "not known".to_owned(), value)
        ),
        _ => writeln!(
            text,
            "No costlier solver does better on the limiting metric."
        ),
    };
    text
}

fn tightest(text: &mut String, chosen: &Candidate) {
    if let Some(mark) = chosen.tightest() {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "Its limiting metric is the {}: {}, {} % of the limit.",
            mark.limit.criterion.meaning(),
            value(mark),
            plain(mark.ratio() * 100.0)
        );
    }
}

/// `exact-break with a step of 50 µs`.
fn at_step(c: &Candidate) -> String {
    format!("{} with a step of {}", c.solver, microseconds(c.step_s))
}

/// Error and scene.
fn value(mark: &Mark) -> String {
    format!(
        "{} on {}",
        with_unit(mark.error, mark.limit.criterion.unit()),
        mark.scene
    )
}

/// Failures of a candidate, each with its size and place.
fn why_not(c: &Candidate) -> String {
    let mut reasons = Vec::new();
    if let Some(lost) = &c.unmatched {
        reasons.push(format!(
            "{} unmatched events on {}, which has {}",
            lost.events, lost.scene, lost.events_true
        ));
    }
    for mark in c.marks.iter().filter(|m| m.ratio() > 1.0) {
        if mark.error.is_infinite() {
            reasons.push(format!("the object flies off on {}", mark.scene));
            continue;
        }
        reasons.push(format!(
            "{} {}, {} times the limit",
            mark.limit.criterion.meaning(),
            value(mark),
            plain(mark.ratio())
        ));
    }
    if let Some(cycles) = c.cycles.as_ref().filter(|cycles| !cycles.fits()) {
        reasons.push(format!(
            "its worst step, {} cycles on {}, takes {:.1} % of a tick, and {:.0} % is allowed",
            cycles.worst,
            cycles.worst_on,
            100.0 * cycles.worst_share(),
            100.0 * STEP_SHARE
        ));
    }
    reasons.join("; ")
}
