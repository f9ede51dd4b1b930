//! Lessons: trials that are recorded, answers that are stored, and sound that a trial hides.

use super::{Alone, Flood, device_thread, hides, take_all};
use crate::control::Page;
use crate::device_thread::DeviceThread;
use crate::device_thread::recording::extension;
use crate::frame::{HEADER, Kind};
use crate::lesson::Session;
use crate::request::{LessonBegin, Request};
use crate::tokens::Role;
use axum::body::Bytes;
use crepitus_protocol::parameters::id;
use serde_json::{Value, json};
use std::time::{Duration, Instant};
use tokio::sync::broadcast;

/// A full disk, for example: the teacher starts it again once there is room.
#[test]
fn a_trial_that_cannot_be_recorded_has_not_begun() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let sessions = tempfile::tempdir().unwrap();
    device_thread.sessions = Some(sessions.path().to_owned());
    let knees = json!([{ "preset": "coarse" }]);
    let lesson = LessonBegin {
        lesson: None,
        plan: Some(json!({ "title": "One", "blind": true, "knees": knees })),
        students: vec!["A".to_owned()],
        seed: Some(7),
        repeats: None,
    };
    device_thread.begin_lesson(&lesson).expect("a lesson");
    let folder = std::fs::read_dir(sessions.path()).unwrap().next().unwrap();
    let in_the_way = folder
        .unwrap()
        .path()
        .join("trial-01")
        .with_extension(extension());
    std::fs::create_dir(&in_the_way).unwrap();
    let knee = device_thread.preset.clone();
    assert!(device_thread.start_trial().is_err());
    assert_eq!(device_thread.preset, knee);
    assert!(!hides(&mut device_thread));
    std::fs::remove_dir(&in_the_way).unwrap();
    device_thread.start_trial().expect("a trial");
    assert!(device_thread.recording.is_some());
}

/// Torque does not wait for the disk as often as there are students.
#[test]
fn a_class_that_answers_together_is_stored_once_and_then_confirmed() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let shared = device_thread.shared.clone();
    let sessions = tempfile::tempdir().unwrap();
    device_thread.sessions = Some(sessions.path().to_owned());
    device_thread.open_class(true);
    let pages: Vec<_> = (0..10).map(|_| shared.control.page()).collect();
    for page in &pages {
        let name = format!("s{page}");
        device_thread.join(*page, &name, None).expect("a seat");
    }
    let lesson = LessonBegin {
        lesson: Some("blind-six".to_owned()),
        plan: None,
        students: Vec::new(),
        seed: Some(7),
        repeats: None,
    };
    device_thread.begin_lesson(&lesson).expect("a lesson");
    device_thread.start_trial().expect("a trial");
    let answer = Request::Answer {
        trial: 1,
        disorder: "clonus".to_owned(),
        level: None,
        confidence: 3,
    };
    let queued = |page: &Page| shared.order(answer.clone(), *page, Role::Student);
    let mut outcomes: Vec<_> = pages.iter().map(|page| queued(page).unwrap()).collect();
    let folder = std::fs::read_dir(sessions.path()).unwrap().next().unwrap();
    let folder = folder.unwrap().path();
    let stored = || Session::read(&folder).unwrap().lesson.answers().len();
    take_all(&mut device_thread);
    assert_eq!(stored(), 0);
    assert!(
        outcomes
            .iter_mut()
            .all(|outcome| outcome.try_recv().is_err())
    );
    device_thread.store_answers();
    assert_eq!(stored(), pages.len());
    for mut outcome in outcomes {
        assert_eq!(outcome.try_recv(), Ok(Ok(Value::Null)));
    }
}

/// The number of samples that a page has received by now.
pub(super) fn received(listening: &mut broadcast::Receiver<Bytes>) -> usize {
    let frames = std::iter::from_fn(|| listening.try_recv().ok());
    let samples = frames.map(|frame| {
        assert_eq!(frame[1], Kind::Samples as u8);
        (frame.len() - HEADER) / 4
    });
    samples.sum()
}

/// A brace is heard by itself. Who moves the leg by pointer has nothing else that tells a slight crepitus.
#[test]
fn in_a_blind_trial_a_page_that_listens_hears_a_simulated_leg_and_no_brace() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let mut listening = device_thread.shared.samples.subscribe();
    let mut hear = |device_thread: &mut DeviceThread<'_, Flood>| {
        let (began, mut heard) = (Instant::now(), 0);
        while heard < 1_000 {
            device_thread.step();
            heard += received(&mut listening);
            assert!(began.elapsed() < Duration::from_secs(10), "{heard} samples");
        }
    };
    hear(&mut device_thread);
    let plan = json!({ "title": "One", "blind": true, "knees": [{ "preset": "coarse" }] });
    let lesson = LessonBegin {
        lesson: None,
        plan: Some(plan),
        students: vec!["A".to_owned()],
        seed: Some(7),
        repeats: None,
    };
    device_thread.begin_lesson(&lesson).expect("a lesson");
    device_thread.start_trial().expect("a trial");
    hear(&mut device_thread);
    assert!(hides(&mut device_thread));
    device_thread.hand = None;
    received(&mut listening);
    let hidden = Instant::now();
    while hidden.elapsed() < Duration::from_millis(100) {
        device_thread.step();
    }
    assert!(device_thread.masks().torque);
    assert_eq!(received(&mut listening), 0);
}

/// The program was killed, and the device was not.
#[test]
fn a_lesson_that_goes_on_begins_with_a_healthy_knee() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let sessions = tempfile::tempdir().unwrap();
    device_thread.sessions = Some(sessions.path().to_owned());
    let plan = json!({ "title": "One", "blind": true, "knees": [{ "preset": "coarse" }] });
    let lesson = LessonBegin {
        lesson: None,
        plan: Some(plan),
        students: vec!["A".to_owned()],
        seed: Some(7),
        repeats: None,
    };
    device_thread.begin_lesson(&lesson).expect("a lesson");
    device_thread.start_trial().expect("a trial");
    assert_eq!(device_thread.values.get(id::CREPITUS), Some(1.0));
    let folder = std::fs::read_dir(sessions.path()).unwrap().next().unwrap();
    let folder = folder.unwrap().file_name().into_string().unwrap();
    device_thread.end_recording();
    device_thread.lesson = None;
    device_thread.resume_lesson(&folder).expect("a lesson");
    let knee = device_thread.preset.as_ref();
    assert_eq!(knee.map(|(name, _)| name.as_str()), Some("healthy"));
    assert_eq!(device_thread.values.get(id::CREPITUS), Some(0.0));
}
