//! Every criterion is shown an observation that is right and one that is
//! wrong: a criterion that cannot fail is not a criterion.

use super::*;
use crate::stability::criterion::{common, common_bounds};
use crate::stability::input::Shaft;
use crate::stability::subject::{Rung, Subject};
use crate::symptoms::SymptomEvent;
use crate::true_events::TrueEvent;
use crepitus_model::render::effects::symptom::Word;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Sense};
use crepitus_plant::Extremes;
use crepitus_scene::scene::Precision;

const SUBJECT: Subject = Subject {
    solver: Rung::Ladder(Solver::ExactEvents),
    convention: Convention::Physical,
    precision: Precision::F64,
};

fn event(time_s: f64, kind: EventKind) -> TimedEvent {
    TimedEvent {
        time_s,
        kind,
        sense: Sense::Positive,
    }
}

/// Ten cycles of 30 ms in 0.3 s of steps of 1 ms; each sticks after 20 ms.
fn truth() -> Vec<TrueEvent> {
    (0..10_u8)
        .flat_map(|n| {
            let start = 1e-3 + 30e-3 * f64::from(n);
            [
                (event(start, EventKind::Break), 0.2),
                (event(start + 20e-3, EventKind::Stick), 0.0),
            ]
        })
        .map(|(event, torque_after_nm)| TrueEvent {
            event,
            torque_before_nm: 0.4,
            theta_rad: 0.0,
            torque_after_nm,
        })
        .collect()
}

fn symptom_event(time_s: f64, word: Word) -> SymptomEvent {
    SymptomEvent {
        time_s,
        word,
        omega_rad_s: 1.0,
        before_nm: 0.0,
        after_nm: 0.0,
    }
}

/// Observation of a run in which `events` happen.
fn seen(events: &[TrueEvent]) -> Observation {
    let mut seen = Observation {
        steps: 300,
        step_s: 1e-3,
        peak: 1.0,
        ..Observation::default()
    };
    for e in events {
        seen.tally.add(&e.event);
        seen.events.push(e.event);
        seen.torques_after_nm.push(e.torque_after_nm);
    }
    let words = [
        symptom_event(0.05, Word::Contact),
        symptom_event(0.1, Word::Cap),
        symptom_event(0.2, Word::Leave),
    ];
    seen.symptoms.truth = Some(words.to_vec());
    seen.symptoms.events = words.to_vec();
    seen.symptoms.torque_error_nm = Some(1e-6);
    seen.symptoms.returned = 0.9;
    seen.symptoms.net_returned_j = 0.27;
    seen
}

fn evidence<'a>(seen: &'a Observation, truth: &'a [TrueEvent]) -> Evidence<'a> {
    Evidence {
        subject: SUBJECT,
        seen,
        truth,
        twin: None,
    }
}

fn find(criterion: &Criterion, seen: &Observation, twin: Option<&Observation>) -> Verdict {
    let truth = truth();
    let evidence = evidence(seen, &truth);
    criterion.judge(&Evidence { twin, ..evidence })
}

/// `criterion` holds as things should be; what comes of `change`.
fn after(criterion: &Criterion, change: impl Fn(&mut Observation)) -> Verdict {
    let mut run = seen(&truth());
    run.late_torque.add(0.1);
    run.swing_rad = Some((1e-3, 2e-3));
    let right = find(criterion, &run, None);
    assert!(right.holds(), "{criterion}: {right}");
    change(&mut run);
    let wrong = find(criterion, &run, None);
    assert!(!wrong.holds(), "{criterion}: {wrong}");
    wrong
}

#[test]
fn bounds_come_first_and_say_when() {
    let bounds = |change: fn(&mut Observation)| {
        let mut run = seen(&truth());
        change(&mut run);
        common(&evidence(&run, &[])).map(|verdict| verdict.flag(true).to_string())
    };
    assert_eq!(bounds(|_| ()), None);
    let text = |change| bounds(change).unwrap();
    assert_eq!(
        text(|run| run.overflow_s = Some(0.5)),
        "fails, flagged: overflow at t = 0.500 s"
    );
    assert!(text(|run| run.above_s = Some(0.5)).contains("above its limit"));
    assert!(text(|run| run.imbalance = Some(1e-9)).starts_with("degrades"));
    assert!(text(|run| run.imbalance = Some(f64::NAN)).starts_with("degrades"));
    assert_eq!(bounds(|run| run.imbalance = Some(1e-11)), None);
}

#[test]
fn events_are_counted_and_timed() {
    let criterion = events(1e-6);
    let late = after(&criterion, |run| run.events[3].time_s += 1e-5);
    assert!(matches!(late, Verdict::Degrades { .. }), "{late}");
    let lost = after(&criterion, |run| {
        let mut events = truth();
        events.drain(4..6);
        *run = seen(&events);
    });
    assert_eq!(lost.to_string(), "fails: 18 events instead of 20");
    let other = after(&criterion, |run| {
        run.events[3].kind = EventKind::Reverse;
    });
    assert!(other.to_string().contains("same number"), "{other}");
    after(&event_torques(1e-6), |run| run.torques_after_nm[5] += 1e-5);
}

#[test]
fn counts_and_rates_have_both_sides() {
    for (what, least, most) in [(EVENTS, 20, 20), (BREAKS, 9, 10), (REVERSES, 0, 0)] {
        after(&count(what, least, most), |run| {
            run.tally.breaks += 1;
            run.tally.reverses += 1;
        });
    }
    after(&count(EVENTS, 20, 30), |run| run.tally.sticks = 0);
    after(&events_per_step(4), |run| run.tally.most_in_step = 5);
    after(&events_per_second(70.0), |run| run.tally.breaks += 2);
    let rate = |hz| cycle_rate(hz, 1e-6);
    let run = seen(&truth());
    assert!(find(&rate(1.0 / 0.03), &run, None).holds());
    let off = find(&rate(1.0 / 0.031), &run, None);
    assert!(matches!(off, Verdict::Degrades { .. }), "{off}");
    let chatter = find(&rate(1.0), &run, None);
    assert!(matches!(chatter, Verdict::Fails { .. }), "{chatter}");
    let silent = find(&rate(1.0 / 0.03), &seen(&[]), None);
    assert!(matches!(silent, Verdict::Fails { .. }), "{silent}");
}

#[test]
fn intervals_and_slips_have_a_length() {
    let mut uneven = truth();
    uneven[10].event.time_s += 5e-3;
    let uneven = seen(&uneven);
    let variation = interval_variation(0.03);
    after(&variation, |run| *run = uneven.clone());
    after(&variation, |run| *run = seen(&[]));
    let slip = slip_time(20e-3, 1e-6);
    after(&slip, |run| *run = uneven.clone());
    after(&slip, |run| *run = seen(&[]));
    after(&silent_after(0.292), |run| run.tally.last_s = Some(0.293));
}

#[test]
fn torques_stay_return_and_keep_their_band() {
    let band = torque(0.0, 0.0, 0.4, 1e-5);
    after(&band, |run| run.late_torque.add(0.400_02));
    after(&band, |run| run.late_torque.add(-2e-5));
    // Nothing was looked at.
    let none = after(&band, |run| run.late_torque = Extremes::default());
    assert!(none.to_string().contains("no torque"), "{none}");
    let quiet = torque_quiet(0.0, 1e-3);
    after(&quiet, |run| run.late_torque.add(0.102));
    after(&quiet, |run| run.late_torque = Extremes::default());
    after(&torque_stays(0.1), |run| run.last_change = 102);
    after(&torque_returns(1e-9), |run| run.last_torque_nm = 2e-9);
    after(&loop_area(1e-9), |run| run.work_j = -2e-9);
    after(&survives(), |run| run.peak = 1.001);
    after(&no_break_at_rest(), |run| run.tally.breaks_at_rest = 1);
    after(&slips_with_shaft(1e-9), |run| run.lag_rad_s = 1e-6);
}

#[test]
fn bits_hands_and_refusals_are_compared() {
    let mut run = seen(&truth());
    run.torque_bits.add(1);
    let criterion = torque_bits(run.torque_bits.0);
    assert!(find(&criterion, &run, None).holds());
    let other = Input::sampled(Shaft::Constant(1.0), 1.0, 1e-3);
    let same = same_as(other.clone());
    let mirror = mirror_of(other);
    let mut twin = run.clone();
    twin.mirrored_bits = run.torque_bits;
    assert!(find(&same, &run, Some(&twin)).holds());
    assert!(find(&mirror, &run, Some(&twin)).holds());
    twin.torque_bits.add(2);
    twin.mirrored_bits.add(2);
    assert!(!find(&same, &run, Some(&twin)).holds());
    assert!(!find(&mirror, &run, Some(&twin)).holds());
    assert!(!find(&criterion, &twin, None).holds());
    let swing = swing_ratio(2.0, 0.01);
    after(&swing, |run| run.swing_rad = Some((1e-3, 2.1e-3)));
    after(&swing, |run| run.swing_rad = None);
    let refused = after(&refused(), |run| run.accepted = vec!["kr = 0"]);
    assert_eq!(refused.to_string(), "fails: kr = 0");
    after(&subnormals(10), |run| run.subnormals = 11);
}

#[test]
fn a_device_is_held_to_its_rules() {
    let first = first_break_after(0.265, 0.271, 1e-6);
    let late = after(&first, |run| run.events[18].time_s += 1e-5);
    assert!(matches!(late, Verdict::Degrades { .. }), "{late}");
    let other = after(&first, |run| run.events[18].kind = EventKind::Stick);
    assert!(other.to_string().contains("no break"), "{other}");
    after(&first, |run| run.events.truncate(18));
    after(&slip_energy(1e-9), |run| run.slip_energy = 1e-8);
    after(&guard_ticks(0, 0), |run| run.guard_ticks = 1);
    let run = seen(&truth());
    assert!(!find(&guard_ticks(1, 9), &run, None).holds());
}

#[test]
fn a_wrong_symptom_meets_no_criterion() {
    let events = symptom_events(1e-6);
    after(&events, |run| run.symptoms.events[1].time_s += 1e-5);
    after(&events, |run| run.symptoms.events[1].word = Word::Uncap);
    after(&events, |run| {
        run.symptoms.events.remove(1);
    });
    after(&events, |run| run.symptoms.truth = None);
    let torques = symptom_torques(1e-5);
    for error_nm in [Some(2e-5), Some(f64::NAN), None] {
        after(&torques, |run| run.symptoms.torque_error_nm = error_nm);
    }
    let three = words(&[Word::Contact, Word::Cap, Word::Leave]);
    after(&three, |run| run.symptoms.events.swap(0, 1));
    after(&three, |run| run.symptoms.events.clear());
    let once = word_count(Word::Cap, 1, 1);
    after(&once, |run| run.symptoms.events[0].word = Word::Cap);
    after(&once, |run| run.symptoms.events[1].word = Word::Leave);
    let first = first_word(Word::Leave, 0.2, 1e-6);
    after(&first, |run| run.symptoms.events[2].time_s = 0.21);
    after(&first, |run| run.symptoms.events[2].word = Word::Cap);
    after(&springs_return(1.0), |run| run.symptoms.returned = 1.01);
    after(&net_returned(0.28), |run| {
        run.symptoms.net_returned_j = 0.281;
    });
}

#[test]
fn texts_have_the_words_and_the_numbers() {
    for (criterion, text) in [
        (
            events(Limits(1e-12, 5e-6)),
            "same events as the reference, each within 1e-12 s (f64), 5e-6 s (f32)",
        ),
        (exactly(BREAKS, 3), "3 breaks"),
        (
            words(&[Word::Catch, Word::Rearm]),
            "events in their order: catch, rearm",
        ),
        (words(&[]), "no event"),
        (
            net_returned(0.28),
            "the hand gets back at most 0.28 J in any 2 s",
        ),
    ] {
        assert_eq!(criterion.to_string(), text);
    }
    assert!(common_bounds()[2].contains("1e-10 (f64), 1e-4 (f32)"));
}
