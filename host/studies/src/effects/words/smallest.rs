//! The smallest set of effects within a tolerance, in sentences.

use super::table::torque;
use crate::effects::Answer;
use crate::effects::answer::{Dropped, Subset};
use crate::effects::influence::Difference;
use crate::limits::Limited;
use crepitus_pages::table::Table;
use std::fmt::Write;

/// The smallest set, what was dropped, and why the rest is kept.
pub(super) fn words(answer: &Answer) -> String {
    let chosen = &answer.chosen;
    let limits: Vec<String> = answer
        .tolerance
        .limits()
        .iter()
        .map(|l| {
            format!(
                "{} at most {} {}",
                l.criterion.meaning(),
                l.at_most,
                l.criterion.unit()
            )
            .trim_end()
            .to_owned()
        })
        .collect();
    let mut text = format!(
        "Tolerance: {}.\nThe smallest set that stays within it: {}\n  {} of {} effects, {} of {} states, {:.0} of {:.0} ns a \
         step; {}\n",
        limits.join(", "),
        names(chosen),
        chosen.effects.len(),
        answer.kept.len() + answer.dropped.len(),
        chosen.states,
        answer.scene_states,
        chosen.ns_per_step,
        answer.scene_ns_per_step,
        difference(&chosen.difference),
    );
    list(&mut text, "Dropped; each alone makes:", &answer.dropped);
    list(&mut text, "Kept; dropping it too would make:", &answer.kept);
    if !answer.others.is_empty() {
        text.push_str("As small and within the tolerance, but costlier or further off:\n");
        for other in &answer.others {
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "  {}: {:.0} ns a step, {}",
                names(other),
                other.ns_per_step,
                difference(&other.difference)
            );
        }
    }
    let _ = writeln!(
        text,
        "Tried {} of the {} sets in which each effect has what it needs, the small ones first.",
        answer.tried, answer.sets
    );
    text
}

fn names(set: &Subset) -> String {
    if set.effects.is_empty() {
        "no effect at all".to_owned()
    } else {
        set.effects.join(", ")
    }
}

fn list(text: &mut String, title: &str, dropped: &[Dropped]) {
    if dropped.is_empty() {
        return;
    }
    let name = |d: &Dropped| match d.along.as_slice() {
        [] => format!("  {}", d.effect),
        along => format!("  {} (and {})", d.effect, along.join(", ")),
    };
    let what = |d: &Dropped| match (&d.difference, &d.failure) {
        (Some(d), _) => difference(d),
        (None, Some(why)) => why.clone(),
        (None, None) => "not known".to_owned(),
    };
    let table = Table::of(dropped).people("", name).people("", what);
    // Writing to a String cannot fail.
    let _ = write!(text, "{title}\n{}", table.to_text());
}

fn difference(d: &Difference) -> String {
    let events = if d.events_relative.is_finite() {
        format!("{:.1} %", 100.0 * d.events_relative)
    } else {
        "∞".to_owned()
    };
    format!(
        "{} RMS, peak {}, events off by {events}",
        torque(d.rms_nm),
        torque(d.peak_nm)
    )
}
