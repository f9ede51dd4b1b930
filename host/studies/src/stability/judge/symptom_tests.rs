//! Tests of the judge for criteria of symptoms besides crepitus.

use super::*;
use crate::stability::criterion::Limits;
use crepitus_model::Convention;
use crepitus_model::render::effects::symptom::Word;
use crepitus_scene::scene::Precision;

fn event(time_s: f64, word: Word) -> SymptomEvent {
    SymptomEvent {
        time_s,
        word,
        omega_rad_s: 1.0,
        before_nm: 0.0,
        after_nm: 0.0,
    }
}

fn seen() -> Observation {
    let events = vec![
        event(0.05, Word::Contact),
        event(0.1, Word::Cap),
        event(0.2, Word::Leave),
    ];
    let mut seen = Observation {
        steps: 300,
        step_s: 1e-3,
        ..Observation::default()
    };
    seen.late_torque.add(1.0);
    seen.symptoms.truth = Some(events.clone());
    seen.symptoms.events = events;
    seen.symptoms.torque_error_nm = Some(1e-6);
    seen.symptoms.returned = 0.9;
    seen.symptoms.net_returned_j = 0.27;
    seen
}

fn verdict(criterion: &Criterion, seen: &Observation) -> Verdict {
    let evidence = Evidence {
        subject: Subject {
            solver: Rung::Ladder(Solver::ExactEvents),
            convention: Convention::Frozen,
            precision: Precision::F32,
        },
        seen,
        truth: &[],
        twin: None,
    };
    judge(criterion, &evidence).verdict(false)
}

fn fails_after(criterion: &Criterion, change: impl Fn(&mut Observation)) {
    let mut run = seen();
    let right = verdict(criterion, &run);
    assert!(right.holds(), "{criterion}: {right}");
    change(&mut run);
    let wrong = verdict(criterion, &run);
    assert!(!wrong.holds(), "{criterion}: {wrong}");
}

#[test]
fn a_wrong_symptom_meets_no_criterion() {
    let within_s = Limits::both(1e-6);
    let events = Criterion::SymptomEvents { within_s };
    fails_after(&events, |run| run.symptoms.events[1].time_s += 1e-5);
    fails_after(&events, |run| run.symptoms.events[1].word = Word::Uncap);
    fails_after(&events, |run| {
        run.symptoms.events.remove(1);
    });
    fails_after(&events, |run| run.symptoms.truth = None);
    let torques = Criterion::SymptomTorques {
        within_nm: Limits::both(1e-5),
    };
    fails_after(&torques, |run| run.symptoms.torque_error_nm = Some(2e-5));
    fails_after(&torques, |run| {
        run.symptoms.torque_error_nm = Some(f64::NAN);
    });
    fails_after(&torques, |run| run.symptoms.torque_error_nm = None);
    let words = Criterion::Words(&[Word::Contact, Word::Cap, Word::Leave]);
    fails_after(&words, |run| run.symptoms.events.swap(0, 1));
    fails_after(&words, |run| run.symptoms.events.clear());
    let once = Criterion::WordCount {
        word: Word::Cap,
        least: 1,
        most: 1,
    };
    fails_after(&once, |run| run.symptoms.events[0].word = Word::Cap);
    fails_after(&once, |run| run.symptoms.events[1].word = Word::Leave);
    let first = Criterion::FirstWord {
        word: Word::Leave,
        at_s: 0.2,
        within_s,
    };
    fails_after(&first, |run| run.symptoms.events[2].time_s = 0.21);
    fails_after(&first, |run| run.symptoms.events[2].word = Word::Cap);
    let quiet = Criterion::TorqueQuiet {
        from_s: 0.1,
        most_nm: 1e-3,
    };
    fails_after(&quiet, |run| run.late_torque.add(1.2));
    let springs = Criterion::SpringsReturn { most: 1.0 };
    fails_after(&springs, |run| run.symptoms.returned = 1.01);
    let net = Criterion::NetReturned { most_j: 0.28 };
    fails_after(&net, |run| run.symptoms.net_returned_j = 0.281);
}

#[test]
fn texts_have_the_words_and_the_numbers() {
    let text = |criterion: Criterion| criterion.to_string();
    assert_eq!(
        text(Criterion::Words(&[Word::Catch, Word::Rearm])),
        "events in their order: catch, rearm"
    );
    assert_eq!(text(Criterion::Words(&[])), "no event");
    assert_eq!(
        text(Criterion::NetReturned { most_j: 0.28 }),
        "the hand gets back at most 0.28 J in any 2 s"
    );
}
