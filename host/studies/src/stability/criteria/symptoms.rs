//! Criteria of a symptom's torque and of its own events.

use super::{between, number, other_events, span, whole};
use crate::stability::criterion::{Basis, Criterion, Limits};
use crate::stability::text::{Plain, Time};
use crate::stability::verdict::Verdict;
use crate::symptoms::event::matched;
use crepitus_model::render::effects::symptom::Word;

/// The symptom's own events are those of its reference, each within a tolerance.
pub(in crate::stability) fn symptom_events(within_s: impl Into<Limits>) -> Criterion {
    let limits = within_s.into();
    let within = limits.in_unit("s");
    let text = format!("same events as the symptom's reference, each within {within}");
    Criterion::new(text, move |e| {
        let found = &e.seen.symptoms.events;
        let Some(truth) = &e.seen.symptoms.truth else {
            return Verdict::broken("no reference");
        };
        let matching = matched(truth, found, e.seen.step_s, e.seen.duration_s());
        if matching.unmatched > 0 {
            return other_events(whole(found.len()), whole(truth.len()));
        }
        let errors_s = matching.pairs.iter().filter_map(|&(i, j)| {
            let (truth, found) = (truth.get(i)?, found.get(j)?);
            Some((found.time_s - truth.time_s).abs())
        });
        Verdict::of(errors_s.fold(0.0, f64::max), limits.of(e), "s")
    })
    .on(Basis::Truth)
}

/// The symptom's torque at the end of each step is that of its reference.
pub(in crate::stability) fn symptom_torques(within_nm: impl Into<Limits>) -> Criterion {
    let limits = within_nm.into();
    let within = limits.in_unit("N·m");
    let text =
        format!("torque at the ends of steps that of the symptom's reference within {within}");
    Criterion::new(text, move |e| match e.seen.symptoms.torque_error_nm {
        Some(error_nm) => Verdict::of(error_nm, limits.of(e), "N·m"),
        None => Verdict::broken("no reference"),
    })
    .on(Basis::Truth)
}

/// The symptoms' own events are these, in this order.
pub(in crate::stability) fn words(words: &'static [Word]) -> Criterion {
    let names: Vec<_> = words.iter().map(|word| word.name()).collect();
    let text = match names.as_slice() {
        [] => "no event".to_owned(),
        names => format!("events in their order: {}", names.join(", ")),
    };
    Criterion::new(text, move |e| {
        let events = &e.seen.symptoms.events;
        let found = events.iter().map(|event| event.word);
        if found.eq(words.iter().copied()) {
            return Verdict::MET;
        }
        other_events(whole(events.len()), whole(words.len()))
    })
}

/// Time of the symptoms' first event of one kind.
pub(in crate::stability) fn first_word(
    word: Word,
    at_s: f64,
    within_s: impl Into<Limits>,
) -> Criterion {
    let limits = within_s.into();
    let (name, at, within) = (word.name(), Time(at_s), limits.in_unit("s"));
    let text = format!("the first {name} at {at} within {within}");
    Criterion::new(text, move |e| {
        let mut events = e.seen.symptoms.events.iter();
        match events.find(|event| event.word == word) {
            Some(first) => Verdict::of((first.time_s - at_s).abs(), limits.of(e), "s"),
            None => Verdict::broken("it does not happen"),
        }
    })
}

/// Number of the symptoms' events of one kind.
pub(in crate::stability) fn word_count(word: Word, least: u64, most: u64) -> Criterion {
    let text = format!("{} happens {} times", word.name(), span(least, most));
    Criterion::new(text, move |e| {
        let events = e.seen.symptoms.events.iter();
        let found = events.filter(|event| event.word == word).count();
        between(whole(found), least, most)
    })
}

/// Energy that the hand gets back over any time from springs, beyond that of sampling, as a share
/// of T²/2σ.
pub(in crate::stability) fn springs_return(most: f64) -> Criterion {
    let text = format!("the hand gets back at most {most:.4} T²/2σ + (½ + d) σ h ∫Ω² dt");
    number(text, most, "", |seen| seen.symptoms.returned)
}

pub(in crate::stability) fn net_returned(most_j: f64) -> Criterion {
    let text = format!("the hand gets back at most {} J in any 2 s", Plain(most_j));
    number(text, most_j, "J", |seen| seen.symptoms.net_returned_j)
}
