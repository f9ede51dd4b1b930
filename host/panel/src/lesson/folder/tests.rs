use super::*;
use crate::lesson::lesson::Lesson;
use crate::lesson::plan::Known;
use crate::lesson::plans;
use crate::lesson::session::Started;
use std::collections::BTreeMap;

fn session(name: &str) -> Session {
    let known = Known {
        own_preset: &|_| None,
        target: &|_| true,
    };
    let plan = plans::find("blind-six").unwrap().read().unwrap();
    let lesson = Lesson::begin(name, plan.check(known).unwrap(), vec!["A".to_owned()], 3).unwrap();
    Session::new(Started::from_unix(0).unwrap(), "0.1.0".to_owned(), lesson)
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != crepitus_files::output::MARKER)
        .collect();
    names.sort();
    names
}

#[test]
fn names_of_folders_are_sanitised() {
    for (name, folder) in [
        ("blind-six", "blind-six"),
        ("Six knees: Monday", "six-knees-monday"),
        ("../../etc/passwd", "etc-passwd"),
        ("C:\\x", "c-x"),
        ("Übung", "uebung"),
        ("…", "lesson"),
        ("", "lesson"),
    ] {
        assert_eq!(sanitised(name), folder, "{name}");
    }
    assert_eq!(sanitised(&"x".repeat(99)).len(), 40);
}

#[test]
fn a_parent_that_is_a_file_is_an_error() {
    let parent = tempfile::tempdir().unwrap();
    let file = parent.path().join("file");
    fs::write(&file, "x").unwrap();
    let error = SessionFolder::create(&file, &session("x")).unwrap_err();
    assert!(error.to_string().contains("cannot write"), "{error}");
}

/// The disk cannot take the new file: the old one stays, and no other is left behind.
#[test]
fn a_file_that_cannot_be_written_leaves_the_old_one() {
    let parent = tempfile::tempdir().unwrap();
    let mut session = session("x");
    let folder = SessionFolder::create(parent.path(), &session).unwrap();
    // Nothing can be renamed over a folder that has something in it.
    fs::remove_file(folder.path().join(ANSWERS)).unwrap();
    fs::create_dir(folder.path().join(ANSWERS)).unwrap();
    fs::write(folder.path().join(ANSWERS).join("x"), "x").unwrap();
    session.lesson.start().unwrap();
    let error = folder.save(&session).unwrap_err();
    assert!(matches!(&error, FolderError::Write { path, .. } if path.ends_with(ANSWERS)));
    // The session was written before.
    assert_eq!(Session::read(folder.path()).unwrap(), session);
    assert_eq!(
        names(folder.path()),
        ["answers.csv", "notes.csv", "session.json"]
    );

    fs::remove_dir_all(folder.path()).unwrap();
    assert!(folder.save(&session).is_err());
    assert!(folder.save_report(&session, &str::to_owned).is_err());
}

/// A teacher marks answers in a spreadsheet while the lesson goes on.
#[test]
fn an_edited_table_stays_and_the_answers_are_in_the_session() {
    let parent = tempfile::tempdir().unwrap();
    let mut session = session("x");
    let folder = SessionFolder::create(parent.path(), &session).unwrap();
    let answers = folder.path().join(ANSWERS);
    fs::write(&answers, "edited").unwrap();
    session.lesson.start().unwrap();
    let error = folder.save(&session).unwrap_err().to_string();
    assert!(error.contains("answers.csv (changed since"), "{error}");
    assert_eq!(fs::read_to_string(&answers).unwrap(), "edited");
    assert_eq!(Session::read(folder.path()).unwrap(), session);
    fs::rename(&answers, parent.path().join("edited.csv")).unwrap();
    folder.save(&session).unwrap();
    folder.save(&session).unwrap();
}

#[test]
fn what_is_no_session_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let error = Session::read(folder.path()).unwrap_err().to_string();
    assert!(error.contains("session.json"), "{error}");
    fs::write(folder.path().join(SESSION), "{}").unwrap();
    let error = SessionFolder::open(folder.path()).unwrap_err();
    assert!(matches!(error, FolderError::Session { .. }), "{error}");
}

#[test]
fn keys_are_read_back_and_removed() {
    let parent = tempfile::tempdir().unwrap();
    let folder = SessionFolder::create(parent.path(), &session("x")).unwrap();
    assert!(folder.keys().is_empty());
    let key = "0123456789abcdef0123456789abcdef";
    let keys = BTreeMap::from([("Ada".to_owned(), key.to_owned())]);
    folder.save_keys(&keys).unwrap();
    folder.save_keys(&keys).unwrap();
    assert_eq!(folder.keys(), keys);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let metadata = fs::metadata(folder.path().join("class.json")).unwrap();
        assert_eq!(metadata.permissions().mode() & 0o077, 0);
    }
    folder.save_keys(&BTreeMap::new()).unwrap();
    assert_eq!(
        names(folder.path()),
        ["answers.csv", "notes.csv", "session.json"]
    );
    // What is no key is left out.
    let text = format!("{{\"Ada\": \"short\", \"<b>\": \"{key}\", \"Ben\": \"{key}\"}}");
    fs::write(folder.path().join("class.json"), text).unwrap();
    assert_eq!(folder.keys().into_keys().collect::<Vec<_>>(), ["Ben"]);
}

#[test]
fn the_recording_of_a_trial_that_was_interrupted_stays() {
    let parent = tempfile::tempdir().unwrap();
    let mut session = session("x");
    let folder = SessionFolder::create(parent.path(), &session).unwrap();
    let mut files = Vec::new();
    for _ in 0..3 {
        let path = folder.next_recording(&session, 1, "parquet");
        assert!(!path.exists());
        fs::write(&path, "a recording").unwrap();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert_eq!(trial_of(&name), Some(1));
        session.recorded(1, &name);
        files.push(name);
    }
    let expected = [
        "trial-01.parquet",
        "trial-01-2.parquet",
        "trial-01-3.parquet",
    ];
    assert_eq!(files, expected);
    assert_eq!(trial_of("trial-12.crepitus"), Some(12));
    for other in ["trial-", "trial-x.parquet", "monday.parquet", ""] {
        assert_eq!(trial_of(other), None, "{other}");
    }
}
