//! Measures of an examination: of whose they are, and which of them a blind trial hides.

use super::{Alone, Flood, device_thread};
use crate::device_thread::DeviceThread;
use crate::request::{AimAt, LessonBegin};
use serde_json::{Value, json};

/// The examination and the target, as pages get them.
fn examined(device_thread: &mut DeviceThread<'_, Flood>) -> (Value, Value) {
    device_thread.publish_examination();
    device_thread.publish_target();
    let latest = device_thread.shared.latest.borrow();
    let read = |text: &str, key: &str| {
        let message: Value = serde_json::from_str(text).unwrap();
        message[key].clone()
    };
    (
        read(&latest.examination, "examination"),
        read(&latest.target, "target"),
    )
}

/// Begins a blind lesson of this knee alone, twice, and its first trial.
fn begin_blind(device_thread: &mut DeviceThread<'_, Flood>, preset: &str) {
    let plan = json!({ "title": "One", "blind": true, "knees": [{ "preset": preset }] });
    let lesson = LessonBegin {
        lesson: None,
        plan: Some(plan),
        students: vec!["A".to_owned()],
        seed: Some(7),
        repeats: Some(2),
    };
    device_thread.begin_lesson(&lesson).expect("a lesson");
    device_thread.start_trial().expect("a trial");
}

/// Takes what comes in this time of the device.
fn go_on(device_thread: &mut DeviceThread<'_, Flood>, time_s: f64) {
    let until_s = device_thread.now_s + time_s;
    while device_thread.now_s < until_s {
        device_thread.pump();
    }
}

/// The measures and signs of a stroke and a half, by a person or by a simulated examiner, whose speed is
/// nobody's score; in a blind trial nothing of the knee.
#[test]
fn what_is_examined_is_measured_and_a_simulated_examiner_is_not_judged() {
    let program = Alone::default();
    for (is_simulated, is_blind) in [(false, false), (true, false), (false, true)] {
        let mut device_thread = device_thread(&program);
        if !is_simulated {
            // A brace is moved by the person at it.
            device_thread.hand = None;
        }
        if is_blind {
            begin_blind(&mut device_thread, "coarse");
        }
        let slow = AimAt::Named("slow".to_owned());
        device_thread.set_target(Some(slow)).expect("a target");
        device_thread.set_scoring(true).expect("a score");
        device_thread.client.zero().expect("a zero");
        device_thread.client.arm().expect("armed");
        go_on(&mut device_thread, 4.0);
        let (examination, target) = examined(&mut device_thread);
        assert_eq!(examination["by_person"], !is_simulated);
        assert_eq!(target["by_person"], !is_simulated);
        assert_eq!(target["strokes"] == 0, is_simulated, "{target}");
        assert!(examination["measures"][0].as_f64() > Some(50.0));
        let findings = &examination["findings"];
        if is_blind {
            // R2: the angle is shown, but where it met an end is of the torque.
            assert!(findings.is_null() && examination["measures"][5].is_null());
        } else {
            assert_eq!(findings[0]["effect"], "crepitus");
            assert_eq!(findings[0]["outcome"], "shown");
        }
        // Another knee is another examination.
        if !is_blind {
            device_thread.apply("mas-1-catch", false).expect("a knee");
            let (examination, _) = examined(&mut device_thread);
            assert!(examination["measures"][0].is_null());
            assert_eq!(examination["findings"][0]["outcome"], "not-moved");
        }
    }
}

#[test]
fn a_person_is_examined_while_the_leg_is_in_his_or_her_hand() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let hand = device_thread.client.transport_mut().device.hand();
    let hand = hand.expect("a simulated leg");
    for by_person in [false, true, false] {
        if by_person {
            hand.aim(0.5);
        } else {
            hand.release();
        }
        go_on(&mut device_thread, 0.2);
        let (examination, target) = examined(&mut device_thread);
        assert_eq!(examination["by_person"], by_person);
        assert_eq!(target["by_person"], by_person);
    }
}

/// The person lets go of the leg before the answer, and then feels the knee again beside a healthy one.
#[test]
fn what_was_missed_is_kept_once_an_answer_has_revealed_the_knee() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let hand = device_thread.client.transport_mut().device.hand();
    let hand = hand.expect("a simulated leg");
    let outcome = |device_thread: &DeviceThread<'_, Flood>| {
        let mut findings = device_thread.examined.examination.findings();
        findings.next().expect("a sign").outcome.name()
    };
    device_thread.client.zero().expect("a zero");
    device_thread.client.arm().expect("armed");
    begin_blind(&mut device_thread, "mas-2-catch");
    for angle_rad in [0.3, 1.3] {
        hand.aim(angle_rad);
        go_on(&mut device_thread, 1.5);
    }
    let found = outcome(&device_thread);
    assert_ne!(found, "not-moved");
    for _ in 0..2 {
        hand.release();
        go_on(&mut device_thread, 0.05);
        assert_eq!(outcome(&device_thread), "not-moved", "of the machine");
        hand.aim(1.3);
        go_on(&mut device_thread, 0.05);
        assert_eq!(outcome(&device_thread), found, "of the person");
    }
    hand.release();
    go_on(&mut device_thread, 0.05);
    assert!(examined(&mut device_thread).0["of_answer"].is_null());
    let answered = device_thread.answer("A", "healthy", None, 3);
    answered.expect("an answer");
    let (examination, _) = examined(&mut device_thread);
    let kept = examination["of_answer"].clone();
    assert_eq!(kept["trial"], 1);
    assert_eq!(kept["by_person"], true);
    assert_eq!(kept["findings"][0]["effect"], "spasticity");
    assert_eq!(kept["findings"][0]["outcome"], found);
    for knee in ["mas-2-catch", "healthy"] {
        device_thread.apply(knee, false).expect("a knee");
        go_on(&mut device_thread, 0.05);
        assert_eq!(examined(&mut device_thread).0["of_answer"], kept, "{knee}");
    }
    device_thread.next_trial().expect("the next one");
    device_thread.start_trial().expect("a trial");
    assert!(examined(&mut device_thread).0["of_answer"].is_null());
}
