//! The smallest set of effects within a tolerance: what it is, what was
//! dropped, and why the rest stays.

use crate::effects::Answer;
use crate::effects::answer::Dropped;
use crate::limits::Limited;
use maud::{Markup, html};

use super::table::{percent, torque};
use crepitus_pages::plot::number::{count, rounded};

pub(super) fn section(answer: &Answer) -> Markup {
    let chosen = &answer.chosen;
    let limits: Vec<String> = answer
        .tolerance
        .limits()
        .iter()
        .map(|limit| {
            format!(
                "{} ≤ {} {}",
                limit.criterion.meaning(),
                rounded(limit.at_most),
                limit.criterion.unit()
            )
            .trim_end()
            .to_owned()
        })
        .collect();
    html! {
        section.table {
            h2 { "The smallest set within the tolerance" }
            p.conclusion {
                @if chosen.effects.is_empty() { "No effect at all" }
                @else { strong { (chosen.effects.join(", ")) } }
                ": " (count_of(chosen.effects.len())) " of "
                (answer.kept.len() + answer.dropped.len()) " effects, "
                (chosen.states) " of " (answer.scene_states) " states, "
                (rounded(chosen.ns_per_step)) " of " (rounded(answer.scene_ns_per_step))
                " ns a step. Against the whole scene: "
                (torque(chosen.difference.rms_nm)) " RMS, at most "
                (torque(chosen.difference.peak_nm)) ", number of events off by "
                (percent(chosen.difference.events_relative)) "."
            }
            p.caption {
                "Asked for: " (limits.join(", ")) ". Tried "
                (count_of(answer.tried)) " of the " (count_of(answer.sets))
                " sets in which each effect has what it needs, the small ones first"
                @if !answer.others.is_empty() {
                    "; as small and within, but dearer or further off: "
                    @for (i, other) in answer.others.iter().enumerate() {
                        @if i > 0 { "; " }
                        (other.effects.join(", "))
                    }
                }
                "."
            }
            div.tables {
                (list("Dropped, and what each makes alone", &answer.dropped))
                (list("Kept, and what dropping each one too would make", &answer.kept))
            }
        }
    }
}

fn list(title: &str, dropped: &[Dropped]) -> Markup {
    html! {
        @if !dropped.is_empty() {
            div {
                h3 { (title) }
                table {
                    tbody {
                        @for one in dropped {
                            tr { th scope="row" { (name(one)) } td { (what(one)) } }
                        }
                    }
                }
            }
        }
    }
}

fn name(dropped: &Dropped) -> String {
    match dropped.along.as_slice() {
        [] => dropped.effect.to_owned(),
        along => format!("{} (and {})", dropped.effect, along.join(", ")),
    }
}

fn what(dropped: &Dropped) -> String {
    match (&dropped.difference, &dropped.failure) {
        (Some(d), _) => format!(
            "{} RMS, peak {}, events {}",
            torque(d.rms_nm),
            torque(d.peak_nm),
            percent(d.events_relative)
        ),
        (None, Some(why)) => why.clone(),
        (None, None) => "not known".to_owned(),
    }
}

fn count_of(n: usize) -> String {
    count(u64::try_from(n).unwrap_or(u64::MAX))
}
