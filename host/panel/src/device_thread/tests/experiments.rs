//! Sessions of experiments: what the device has, and what pages see.

use super::lessons::received;
use super::{Alone, Flood, device_thread, done, hides};
use crate::control::Page;
use crate::device_thread::DeviceThread;
use crate::experiment::Experiments;
use crate::request::{ExperimentStep, LessonBegin, Request};
use crate::shared::Outcome;
use crate::tokens::Role;
use crepitus_protocol::parameters::id;
use serde_json::{Value, json};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const PROTOCOL: &str = "title = 'Two'\n[threshold]\npreset = 'coarse'\nquantity = 'crepitus.static_torque_nm'\n\
    reference = 0.4\n[threshold.constant]\ndifferences = [0.2]\nrepeats = 4";

/// Gives it a folder with a protocol, control to a page, and torque.
fn prepare(device_thread: &mut DeviceThread<'_, Flood>) -> (TempDir, Page) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("two.toml"), PROTOCOL).unwrap();
    device_thread
        .experiment
        .set_folder(Experiments::open(folder.path()).unwrap());
    let page = device_thread.shared.control.page();
    device_thread.client.zero().expect("a zero");
    done(device_thread, page, Request::Take).expect("control");
    done(device_thread, page, Request::Arm).expect("torque");
    (folder, page)
}

fn begin(device_thread: &mut DeviceThread<'_, Flood>, page: Page) -> Outcome {
    let begin = ExperimentStep::Begin {
        file: "two.toml".to_owned(),
        participant: "P01".to_owned(),
        consented: None,
    };
    done(device_thread, page, Request::Experiment(begin))
}

fn step(device_thread: &mut DeviceThread<'_, Flood>, page: Page, step: ExperimentStep) -> Outcome {
    done(device_thread, page, Request::Experiment(step))
}

/// The break-away torque of the device, if it renders crepitus.
fn torque_nm(device_thread: &DeviceThread<'_, Flood>) -> Option<f64> {
    let is_on = device_thread.values.get(id::CREPITUS) == Some(1.0);
    device_thread
        .values
        .get(id::STATIC_TORQUE)
        .filter(|_| is_on)
}

#[test]
fn the_device_has_what_the_engine_decides_and_no_page_sees_it() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let mut listening = device_thread.shared.samples.subscribe();
    let (_folder, page) = prepare(&mut device_thread);
    begin(&mut device_thread, page).expect("a session");
    device_thread.step();
    received(&mut listening);
    for trial in 1..=4 {
        // Healthy before each trial: the last interval must not be felt any more.
        assert_eq!(torque_nm(&device_thread), None);
        let mut felt = [1, 2].map(|interval| {
            let feel = ExperimentStep::Feel { trial, interval };
            step(&mut device_thread, page, feel).expect("felt");
            assert!(hides(&mut device_thread));
            torque_nm(&device_thread).expect("crepitus")
        });
        felt.sort_by(f64::total_cmp);
        assert_eq!(felt.map(|nm| (nm * 1e3).round()), [400.0, 600.0]);
        let choose = ExperimentStep::Choose { trial, answer: 1 };
        step(&mut device_thread, page, choose).expect("stored");
        assert!(hides(&mut device_thread));
    }
    // Neither the remote, which else is told the knee, nor a page that plays it as sound.
    let until = Instant::now() + Duration::from_millis(100);
    while Instant::now() < until {
        device_thread.step();
    }
    assert_eq!(received(&mut listening), 0);
    let latest = device_thread.shared.latest.borrow().clone();
    let knee: Value = serde_json::from_str(&latest.knee).unwrap();
    assert_eq!(knee, json!({ "knee": { "now": null, "next": null } }));
    let experiment: Value = serde_json::from_str(&latest.experiment).unwrap();
    assert_eq!(experiment["experiment"]["over"], true);
    for role in [Role::Viewer, Role::Remote, Role::Student] {
        let messages = latest.messages(role, page);
        assert!(messages.iter().all(|message| !message.contains("P01")));
    }
    let leave = Request::Experiment(ExperimentStep::Leave);
    done(&mut device_thread, page, leave).expect("left");
    // Torque still ramps down.
    let left_s = device_thread.now_s;
    while device_thread.now_s < left_s + 0.5 {
        device_thread.step();
        assert!(hides(&mut device_thread));
    }
    while device_thread.now_s < left_s + 2.0 {
        device_thread.step();
    }
    assert!(!hides(&mut device_thread));
}

#[test]
fn a_trial_in_which_the_motor_went_off_is_felt_again() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let (_folder, page) = prepare(&mut device_thread);
    begin(&mut device_thread, page).expect("a session");
    let feel = |interval| ExperimentStep::Feel { trial: 1, interval };
    let choose = || ExperimentStep::Choose {
        trial: 1,
        answer: 2,
    };
    for interval in [1, 2] {
        step(&mut device_thread, page, feel(interval)).expect("felt");
    }
    done(&mut device_thread, page, Request::Disarm).expect("off");
    device_thread.step();
    assert_eq!(torque_nm(&device_thread), None);
    let error = step(&mut device_thread, page, choose()).unwrap_err();
    assert!(error.contains("with the motor on"), "{error}");
    let error = step(&mut device_thread, page, feel(1)).unwrap_err();
    assert!(error.contains("turn it on"), "{error}");
    done(&mut device_thread, page, Request::Arm).expect("torque");
    for interval in [1, 2] {
        step(&mut device_thread, page, feel(interval)).expect("felt");
    }
    step(&mut device_thread, page, choose()).expect("stored");
}

/// Requests that would tell a level, or change what is felt.
#[test]
fn nothing_disturbs_a_session() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let (folder, page) = prepare(&mut device_thread);
    device_thread.sessions = Some(folder.path().join("sessions"));
    let other = device_thread.shared.control.page();
    begin(&mut device_thread, page).expect("a session");
    let feel = || ExperimentStep::Feel {
        trial: 1,
        interval: 1,
    };
    assert!(step(&mut device_thread, other, feel()).is_err());
    step(&mut device_thread, page, feel()).expect("felt");
    let lesson = LessonBegin {
        lesson: Some("blind-six".to_owned()),
        plan: None,
        students: vec!["A".to_owned()],
        seed: None,
        repeats: None,
    };
    for request in [
        Request::Apply {
            preset: "fine".to_owned(),
            add: false,
        },
        Request::Set {
            changes: Vec::new(),
        },
        Request::Reset,
        Request::Save,
        Request::Severity { worse: true },
        Request::Record {
            running: true,
            name: "a".to_owned(),
        },
        Request::LessonBegin(lesson),
    ] {
        let error = done(&mut device_thread, page, request.clone()).unwrap_err();
        assert!(error.contains("leave"), "{request:?}: {error}");
    }
    assert!(
        begin(&mut device_thread, page)
            .unwrap_err()
            .contains("leave")
    );
    let results = done(&mut device_thread, page, Request::ExperimentResults);
    assert!(results.unwrap_err().contains("leave"));
    assert!(torque_nm(&device_thread).is_some());
}
