//! Lessons of the sessions' folder: which can be continued, and which trial a recording is of.

use crate::lesson::{Session, trial_of};
use crepitus_files::output::folder_of;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Lessons that can be continued, of a list.
const MOST_LISTED: usize = 20;

/// Folders that are looked into for them, the newest first.
const MOST_READ: usize = 200;

/// Sessions of the folders that one list names, each read once.
#[derive(Default)]
pub(super) struct Sessions(HashMap<PathBuf, Option<Session>>);

impl Sessions {
    /// The trial of a recording: lesson, knee and answers. Null where it is of no lesson; without knee and answers
    /// while those are not to be known.
    pub(super) fn trial(&mut self, recording: &Path) -> Value {
        let folder = folder_of(recording);
        let read = || Session::read(folder).ok();
        let session = self.0.entry(folder.to_owned()).or_insert_with(read);
        let name = recording.file_name().unwrap_or_default().to_string_lossy();
        match (session, trial_of(&name)) {
            (Some(session), Some(trial)) => described(session, trial),
            _ => Value::Null,
        }
    }
}

fn described(session: &Session, trial: usize) -> Value {
    let lesson = &session.lesson;
    if !(1..=lesson.trials()).contains(&trial) {
        return Value::Null;
    }
    let mut value = json!({
        "title": lesson.plan().title,
        "name": lesson.name(),
        "started": session.started,
        "trial": trial,
        "knee": Value::Null,
        "answers": [],
    });
    if !hides(session) {
        let answers = lesson.view(None).answers.into_iter();
        let of_trial: Vec<_> = answers.filter(|answer| answer.trial == trial).collect();
        value["knee"] = json!(lesson.knee_of(trial));
        value["answers"] = json!(of_trial);
    }
    value
}

/// Returns whether recordings of a session tell what must not be known: of a blind lesson that has not ended, also of
/// one that was interrupted.
fn hides(session: &Session) -> bool {
    session.lesson.plan().blind && !session.lesson.ended()
}

/// Returns whether a recording of the sessions' folder must not be opened.
pub(super) fn is_hidden(recording: &Path, sessions: Option<&Path>) -> bool {
    let is_own = sessions.is_some_and(|folder| recording.starts_with(folder));
    is_own && Session::read(folder_of(recording)).is_ok_and(|session| hides(&session))
}

/// Lessons that have not ended, the newest first.
pub(super) fn unfinished(sessions: Option<&Path>) -> Value {
    let entries = sessions.and_then(|folder| std::fs::read_dir(folder).ok());
    let mut folders: Vec<_> = entries
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.is_dir())
        .collect();
    // Their names begin with their times.
    folders.sort();
    let newest = folders.iter().rev().take(MOST_READ);
    let offers = newest.filter_map(|path| offer(path));
    let lessons: Vec<_> = offers.take(MOST_LISTED).collect();
    json!({ "lessons": lessons })
}

fn offer(path: &Path) -> Option<Value> {
    let session = Session::read(path).ok()?;
    let lesson = &session.lesson;
    let folder = path.file_name()?.to_str()?;
    (!lesson.ended()).then(|| {
        json!({
            "folder": folder,
            "title": lesson.plan().title,
            "name": lesson.name(),
            "started": session.started,
            "trial": lesson.trial(),
            "trials": lesson.trials(),
            "students": lesson.students().len(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lesson::{Known, Lesson, SessionFolder, Started, plans};

    /// A lesson in its folder, of which the first trial was answered.
    fn session(parent: &Path, lesson: &str, second: u64) -> (SessionFolder, Session) {
        let known = Known {
            own_preset: &|_| None,
            target: &|_| true,
        };
        let plan = plans::find(lesson).unwrap().read().unwrap();
        let plan = plan.check(known).unwrap();
        let students = ["A", "B"].map(str::to_owned).to_vec();
        let lesson = Lesson::begin(lesson, plan, students, 3).unwrap();
        let started = Started::from_unix(second).unwrap();
        let mut session = Session::new(started, "0.1.0".to_owned(), lesson);
        session.lesson.start().unwrap();
        let _ = session.lesson.answer("A", "clonus", None, 3, 1.0);
        let folder = SessionFolder::create(parent, &session).unwrap();
        (folder, session)
    }

    #[test]
    fn a_recording_is_named_by_knee_and_answers_once_they_may_be_known() {
        let parent = tempfile::tempdir().unwrap();
        let (folder, mut session) = session(parent.path(), "blind-six", 0);
        let recording = folder.recording(1);
        let trial = || Sessions::default().trial(&recording);
        let hidden = trial();
        assert!(hidden["trial"] == 1 && hidden["name"] == "blind-six");
        assert!(hidden["knee"].is_null() && hidden["answers"] == json!([]));
        let is_hidden_in = |sessions| is_hidden(&recording, sessions);
        assert!(is_hidden_in(Some(parent.path())));
        // A file that was named on the command line is opened: somebody has wanted that one.
        assert!(!is_hidden_in(None));
        session.lesson.end().unwrap();
        folder.save(&session).unwrap();
        assert!(!is_hidden_in(Some(parent.path())));
        let told = trial();
        assert_eq!(told["knee"]["preset"], session.lesson.knee_of(1).preset);
        let answer = &told["answers"][0];
        assert!(answer["student"] == "A" && answer["disorder"] == "clonus");
        assert!(answer["right"].is_boolean());
        for other in ["monday.parquet", "trial-07.parquet", "trial-00.parquet"] {
            let path = folder.path().join(other);
            assert_eq!(Sessions::default().trial(&path), Value::Null, "{other}");
        }
        let outside = parent.path().join("trial-01.parquet");
        assert_eq!(Sessions::default().trial(&outside), Value::Null);
    }

    #[test]
    fn lessons_that_have_not_ended_are_listed() {
        let parent = tempfile::tempdir().unwrap();
        let (_, _) = session(parent.path(), "blind-six", 0);
        let (_, _) = session(parent.path(), "first-knees", 86_400);
        let (folder, mut ended) = session(parent.path(), "end-feels", 172_800);
        ended.lesson.end().unwrap();
        folder.save(&ended).unwrap();
        std::fs::create_dir(parent.path().join("1970-01-09-recordings")).unwrap();
        std::fs::write(parent.path().join("session.json"), "{}").unwrap();
        let list = unfinished(Some(parent.path()))["lessons"].clone();
        let names = list.as_array().unwrap().iter().map(|l| &l["name"]);
        assert!(names.eq(["first-knees", "blind-six"]), "{list}");
        assert_eq!(list[1]["folder"], "1970-01-01-000000-blind-six");
        assert!(list[1]["trial"] == 1 && list[1]["trials"] == 6);
        // Nothing of it tells a knee.
        assert!(!list.to_string().contains("preset"));
        assert_eq!(unfinished(None), json!({ "lessons": [] }));
    }
}
