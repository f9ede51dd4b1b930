use super::*;
use crate::lesson::plan::Known;
use crate::lesson::plans;
use serde_json::{Value, json};

fn session() -> Session {
    let known = Known {
        own_preset: &|_| None,
        target: &|_| true,
    };
    let plan = plans::find("blind-six").unwrap().read().unwrap();
    let students = vec!["A".to_owned(), "B".to_owned()];
    let lesson = Lesson::begin("six", plan.check(known).unwrap(), students, 3).unwrap();
    let mut session = Session::new(Started::from_unix(0).unwrap(), "0.1.0".to_owned(), lesson);
    session.lesson.start().unwrap();
    session.lesson.answer("A", "healthy", None, 1, 0.1).unwrap();
    session.recorded(1, "trial-01.parquet");
    session
}

#[test]
fn a_session_reads_back() {
    let mut session = session();
    session.recorded(1, "trial-01-2.parquet");
    assert_eq!(session.recordings.len(), 1);
    assert_eq!(session.recording_of(1), Some("trial-01-2.parquet"));
    assert_eq!(session.recording_of(2), None);
    let again = Session::from_json(&session.to_json().unwrap()).unwrap();
    assert_eq!(again, session);
}

#[test]
fn a_session_that_was_changed_is_rejected() {
    let text = session().to_json().unwrap();
    let answer = json!({ "student": "A", "trial": 1, "disorder": "healthy", "level": null, "confidence": 1, "time_s": 0 });
    let with = |key: &str, value: Value| {
        let mut answer = answer.clone();
        answer[key] = value;
        json!([answer])
    };
    for (key, value, part) in [
        ("format", json!(2), "newer version"),
        ("format", json!("x"), "not a session"),
        ("colour", json!(1), "`colour`"),
        (
            "started",
            json!("2026-02-30 00:00:00"),
            "2026-11-24 15:42:05",
        ),
        ("knees", json!([]), "`knees`"),
        ("order", json!([6]), "`order`"),
        ("order", json!([]), "`trial`"),
        ("trial", json!(0), "`trial`"),
        ("trial", json!(7), "`trial`"),
        ("answers", with("trial", json!(0)), "an answer"),
        ("answers", with("student", json!("C")), "an answer"),
        ("answers", with("confidence", json!(6)), "an answer"),
        ("answers", with("disorder", json!("limp")), "limp"),
        ("answers", with("level", json!("marked")), "moderate"),
        ("answers", json!([answer, answer]), "two answers"),
        (
            "recordings",
            json!([{ "trial": 9, "file": "x" }]),
            "a recording",
        ),
    ] {
        let mut json: Value = serde_json::from_str(&text).unwrap();
        json[key] = value;
        let error = Session::from_json(&json.to_string())
            .expect_err(key)
            .to_string();
        assert!(error.contains(part), "{key} {part}: {error}");
    }
    assert!(Session::from_json("{").is_err());
}

#[test]
fn days_and_times_exist() {
    let day = |year, month, day| Started::new(year, month, day, 0, 0, 0).is_some();
    assert!(day(2024, 2, 29) && day(2000, 2, 29) && day(2026, 12, 31) && day(2026, 4, 30));
    assert!(!day(2026, 2, 29) && !day(1900, 2, 29) && !day(2026, 4, 31) && !day(2026, 13, 1));
    assert!(!day(2026, 0, 1) && !day(2026, 1, 0) && !day(0, 1, 1));
    assert!(Started::new(2026, 1, 1, 24, 0, 0).is_none());
    assert!(Started::new(2026, 1, 1, 23, 60, 0).is_none());
    assert!(Started::new(2026, 1, 1, 23, 59, 60).is_none());
}

/// Seconds and dates of `date -u -d @SECONDS`.
#[test]
fn dates_are_those_of_the_calendar() {
    for (seconds, text) in [
        (0, "1970-01-01 00:00:00"),
        (951_782_399, "2000-02-28 23:59:59"),
        (951_782_400, "2000-02-29 00:00:00"),
        (1_709_251_199, "2024-02-29 23:59:59"),
        (1_795_534_925, "2026-11-24 15:42:05"),
        (4_107_542_400, "2100-03-01 00:00:00"),
        (253_402_300_799, "9999-12-31 23:59:59"),
    ] {
        let started = Started::from_unix(seconds).unwrap();
        assert_eq!(started.to_string(), text);
        assert_eq!(Started::try_from(text.to_owned()).unwrap(), started);
    }
    assert_eq!(Started::from_unix(253_402_300_800), None);
    assert_eq!(Started::from_unix(u64::MAX), None);
    assert_eq!(
        Started::from_unix(1_795_534_925).unwrap().file_name(),
        "2026-11-24-154205"
    );
}
