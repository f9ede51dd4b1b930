//! The answer to a need where the target chooses.

use super::{at_step, tightest, value, why_not};
use crate::accuracy::answer::{Answer, Candidate, Cycles};
use crate::accuracy::words::numbers::plain;
use crate::limits::Limited;
use std::fmt::Write;

/// Recommendation for the target, and what else would do.
pub(super) fn recommended(chosen: &Candidate, cost: &Cycles, answer: &Answer) -> String {
    let mut text = format!(
        "Use {} ({} Hz). It costs {} (on {}): {:.1} % of a tick.\n",
        at_step(chosen),
        plain(1.0 / chosen.step_s),
        cycles(cost),
        cost.worst_on,
        100.0 * cost.worst_share()
    );
    tightest(&mut text, chosen);
    let _ = match answer
        .runner_up
        .as_ref()
        .and_then(|r| Some((r, r.cycles.as_ref()?)))
    {
        Some((runner_up, cost)) => {
            text.push_str("The runner-up is ");
            let _ = write!(text, "{}: {}", runner_up.solver, cycles(cost));
            match runner_up.tightest() {
                Some(mark) => writeln!(
                    text,
                    "; its {} is {}.",
                    mark.limit.criterion.meaning(),
                    value(mark)
                ),
                None => writeln!(text, "."),
            }
        }
        None => writeln!(text, "No other rung meets it."),
    };
    text
}

/// Appends what fails on the target, and why.
pub(super) fn failed(text: &mut String, failed: &[Candidate]) {
    if failed.is_empty() {
        text.push_str("No rung fails.\n");
        return;
    }
    text.push_str("These fail:\n");
    for c in failed {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "  {}, {}: {}",
            c.solver,
            c.cycles.as_ref().map_or_else(String::new, cycles),
            why_not(c)
        );
    }
}

/// `93 cycles in the mean, 359 at worst`.
fn cycles(c: &Cycles) -> String {
    format!("{:.0} cycles in the mean, {} at worst", c.mean, c.worst)
}
