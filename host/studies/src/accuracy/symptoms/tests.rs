use super::*;
use crate::accuracy::symptoms::table::symptoms_table;
use crate::symptoms::event::own;
use crate::symptoms::follow::follow;
use crate::symptoms::truth::true_events;
use crate::watcher::Cancelled;
use std::collections::BTreeSet;

struct Patient(f64);

impl Watcher for Patient {
    fn progress(&mut self, fraction: f64) -> Result<(), Cancelled> {
        assert!(fraction >= self.0 && fraction <= 1.0, "{fraction}");
        self.0 = fraction;
        Ok(())
    }
}

const BOTH: [Precision; 2] = [Precision::F32, Precision::F64];

fn studied(steps_s: &[f64]) -> Vec<SymptomPoint> {
    let plan = SymptomPlan {
        steps_s,
        precisions: &BOTH,
        repeats: 3,
    };
    points(&plan, &mut Patient(0.0)).unwrap()
}

#[test]
fn every_symptom_is_within_what_the_device_promises() {
    let points = studied(&[5e-5]);
    assert_eq!(points.len(), 2 * Given::all().len());
    for p in &points {
        println!(
            "{:12} {:8} {}: {} events of {}, {:.1e} s, {:.1e} N·m, rms {:.1e}; {:.1} ns, {:.1} × crepitus",
            p.symptom,
            p.form.unwrap_or(""),
            p.precision,
            p.events,
            p.events_true,
            p.max_event_error_s,
            p.max_tick_torque_error_nm,
            p.rms_tick_torque_error_nm,
            p.ns_per_step,
            p.time_ratio
        );
        assert_eq!((p.unmatched, p.events), (0, p.events_true), "{p:?}");
        assert_eq!(p.events == 0, p.symptom == "lead-pipe", "{p:?}");
        let (event_s, torque_nm) = if p.precision == "f64" {
            (1e-7, 1e-4)
        } else {
            (2e-6, 2e-4)
        };
        assert!(p.events == 0 || p.max_event_error_s < event_s, "{p:?}");
        assert!(p.max_tick_torque_error_nm < torque_nm, "{p:?}");
        assert!(p.ns_per_step > 0.0 && p.time_ratio > 0.0, "{p:?}");
    }
}

#[test]
fn a_shorter_step_is_more_exact_and_all_have_a_row() {
    let steps = [1e-3, 1e-4];
    let points = studied(&steps);
    for pair in points.chunks(2) {
        let [long, short] = pair else { panic!() };
        assert_eq!((long.step_s, short.step_s), (1e-3, 1e-4));
        assert_eq!((long.symptom, long.form), (short.symptom, short.form));
        if long.precision == "f64" {
            let rounding = short.rms_tick_torque_error_nm < 1e-9;
            let worse = rounding || long.rms_tick_torque_error_nm >= short.rms_tick_torque_error_nm;
            assert!(worse, "{long:?} {short:?}");
        }
    }
    let csv = symptoms_table(&points).to_csv();
    assert_eq!(csv.lines().count(), 1 + points.len());
    assert!(csv.starts_with("symptom,form,precision,step_s,events,"));
}

#[test]
fn the_motions_reach_every_word_that_a_symptom_has() {
    let mut words = BTreeSet::new();
    for given in Given::all() {
        for (_, hand, duration_s) in motions() {
            let events = own(true_events(&given, &hand.motion(), duration_s).unwrap());
            words.extend(events.iter().map(|e| (given.name(), e.word.name())));
        }
    }
    let of = |name: &str| {
        let own = words.iter().filter(|(symptom, _)| symptom == name);
        own.map(|(_, word)| *word).collect::<Vec<_>>()
    };
    assert_eq!(of("range-limit"), ["cap", "contact", "leave"]);
    assert_eq!(of("cogwheel (space)"), ["catch", "give"]);
    assert_eq!(of("cogwheel (time)"), ["catch", "give"]);
    assert_eq!(of("spasticity (catch)"), ["catch", "rearm"]);
    assert_eq!(
        of("spasticity (reflex)"),
        ["cap", "offset", "onset", "uncap"]
    );
    assert_eq!(of("clasp-knife (angle)"), ["onset", "rearm", "release"]);
    assert_eq!(of("clasp-knife (torque)"), ["onset", "rearm", "release"]);
    assert_eq!(of("clonus"), ["beat", "start", "stop"]);
    assert_eq!(of("texture"), ["snap"]);
}

/// A law whose torque or events are wrong is seen as wrong.
#[test]
fn a_wrong_torque_and_a_missing_event_are_measured() {
    let given = Given::new("texture", &[], &[]);
    let (_, hand, duration_s) = motions()[0].clone();
    let motion = hand.motion();
    let sampling = Sampling::new(&motion, duration_s, 5e-5);
    let truth = Truth::new(&given, &motion, &sampling, 1).unwrap();
    let mut torques_nm = Vec::new();
    let mut found =
        own(follow::<f64>(&given, &sampling, &mut |_, nm| torques_nm.push(nm)).unwrap());
    let errors = |found: &[_], torques_nm: &[f64]| {
        let mut errors = Errors::default();
        errors.compare(&sampling, &truth, found, torques_nm);
        errors
    };
    let right = errors(&found, &torques_nm);
    assert_eq!(right.unmatched, 0);
    assert!(right.torque_nm.most() < 1e-6 && right.event_s.most() < 1e-9);
    torques_nm[1000] += 1e-3;
    let wrong = errors(&found, &torques_nm);
    assert!((wrong.torque_nm.most() - 1e-3).abs() < 1e-6);
    // An event that is found late hides its own ticks only.
    found[5].time_s += 2e-3;
    let late = errors(&found, &torques_nm);
    assert!((late.event_s.most() - 2e-3).abs() < 1e-9);
    found.remove(7);
    assert_eq!(errors(&found, &torques_nm).unmatched, 1);
    torques_nm[2000] = f64::NAN;
    assert!(errors(&found, &torques_nm).torque_nm.most().is_nan());
}

/// A reflex of 50 ms remembers 2,048 steps at most.
#[test]
fn a_step_that_a_law_refuses_is_left_out() {
    let points = studied(&[2e-5]);
    assert_eq!(points.len(), 2 * (Given::all().len() - 1));
    assert!(points.iter().all(|p| p.form != Some("reflex")));
    assert!(points.iter().all(|p| p.unmatched == 0), "{points:?}");
}
