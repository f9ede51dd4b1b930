//! A blind lesson of six knees with two students, from its plan to its report: killed in between,
//! and read again.
//!
//! The folders stay in `target/tmp/lesson` to look at.

use crepitus_panel::lesson::{
    By, Feedback, Finding, Known, Lesson, Plan, Session, SessionFolder, Started, View, plans,
};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Seed of the order.
const SEED: u64 = 20_261_124;

fn fresh(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("lesson")
        .join(name);
    // Absent at the first run.
    let _ = fs::remove_dir_all(&folder);
    folder
}

fn begin(feedback: Feedback) -> Session {
    let mut plan: Plan = plans::find("blind-six").unwrap().read().unwrap();
    plan.feedback = feedback;
    let known = Known {
        own_preset: &|_| None,
        target: &|_| true,
    };
    let plan = plan.check(known).unwrap();
    let students = ["Ada", "Ben 2"].map(str::to_owned).to_vec();
    let lesson = Lesson::begin("blind-six", plan, students, SEED).unwrap();
    let started = Started::new(2026, 11, 24, 15, 42, 5).unwrap();
    Session::new(started, "0.1.0".to_owned(), lesson)
}

/// Ada is right but once; Ben takes one disorder for another, and is unsure of levels.
fn answers(trial: usize, session: &Session) -> [(Finding, Option<&'static str>, u8); 2] {
    let knee = session.lesson.knee_of(trial);
    let truth = knee.disorder.unwrap();
    let level = knee.level.map(crepitus_scene::preset::Level::name);
    let wrong = if truth.name() == "clasp-knife" {
        "spasticity"
    } else {
        truth.name()
    };
    let ada = Finding::find(wrong).unwrap();
    let ben = match truth.name() {
        "rigidity" => "cogwheel",
        "spasticity" => "clasp-knife",
        name => name,
    };
    let ben = (Finding::find(ben).unwrap(), level.map(|_| "moderate"), 2);
    [(ada, level, 5 - u8::from(ada != truth)), ben]
}

fn trial(session: &mut Session, folder: &SessionFolder) {
    let number = session.lesson.trial();
    let time_s = 60.0 * f64::from(u8::try_from(number).unwrap());
    session.lesson.start().unwrap();
    folder.save(session).unwrap();
    let recording = folder.recording(number);
    fs::write(&recording, "a recording").unwrap();
    let name = recording.file_name().unwrap().to_str().unwrap();
    assert_eq!(name, format!("trial-{number:02}.parquet"));
    session.recorded(number, name);
    let given = answers(number, session);
    for (student, (finding, level, confidence)) in ["Ada", "Ben 2"].into_iter().zip(given) {
        // The knee is hidden until both have answered.
        assert!(hides(&session.lesson.view(None), session));
        let lesson = &mut session.lesson;
        lesson
            .answer(student, finding.name(), level, confidence, time_s)
            .unwrap();
        folder.save(session).unwrap();
    }
}

/// Returns whether nothing in the page's message tells the knee of this trial.
fn hides(view: &View, session: &Session) -> bool {
    let json = serde_json::to_value(view).unwrap();
    let knee = session.lesson.knee();
    let text = json.to_string();
    let of_this = view.answers.iter().filter(|a| a.trial == view.trial);
    json["knee"].is_null()
        && json["summary"].is_null()
        && of_this
            .clone()
            .all(|a| a.right.is_none() && a.level_right.is_none())
        && !text.contains(&knee.title)
        && (knee.preset == "healthy" || !text.contains(&format!("\"{}\"", knee.preset)))
}

#[test]
fn a_blind_lesson_from_plan_to_report() {
    let parent = fresh("blind");
    let mut session = begin(Feedback::Each);
    let folder = SessionFolder::create(&parent, &session).unwrap();
    assert_eq!(folder.path(), parent.join("2026-11-24-154205-blind-six"));
    for _ in 0..3 {
        trial(&mut session, &folder);
        let view = session.lesson.view(None);
        assert_eq!(view.knee.unwrap().preset, session.lesson.knee().preset);
        session.lesson.next_trial().unwrap();
    }
    session.lesson.start().unwrap();
    let note = "=HYPERLINK is \"text\" <b>here</b>, too; Ben asked to repeat this knee";
    session.lesson.note(201.5, note, By::Teacher).unwrap();
    let given = answers(4, &session);
    let (finding, level, confidence) = given[0];
    session
        .lesson
        .answer("Ada", finding.name(), level, confidence, 210.0)
        .unwrap();
    folder.save(&session).unwrap();

    // The program is killed here, while it writes the next version of a file.
    let before = session.lesson.view(None);
    drop(session);
    fs::write(
        folder.path().join(".crepitus-x1y2z3"),
        "{\"format\": 1, \"sta",
    )
    .unwrap();
    let (folder, mut session) = SessionFolder::open(folder.path()).unwrap();
    assert_eq!(session.lesson.view(None), before);
    assert!(session.lesson.is_hidden() && session.lesson.began());

    let (finding, level, confidence) = given[1];
    session
        .lesson
        .answer("Ben 2", finding.name(), level, confidence, 230.0)
        .unwrap();
    for _ in 0..2 {
        session.lesson.next_trial().unwrap();
        trial(&mut session, &folder);
    }
    session.lesson.end().unwrap();
    folder.save(&session).unwrap();
    assert_eq!(Session::read(folder.path()).unwrap(), session);

    let summary = session.lesson.view(None).summary.unwrap();
    assert_eq!((summary.answers, summary.right), (12, 9));
    let [ada, ben] = &summary.students[..] else {
        panic!("two students")
    };
    assert_eq!((ada.scores.right, ben.scores.right), (5, 4));
    assert_eq!(ada.scores.confidence_right, Some(5.0));
    assert_eq!(ada.scores.confidence_wrong, Some(4.0));
    // 5 of 6 right; spasticity answered twice: pe = 1/6, κ = (5/6 - 1/6) / (1 - 1/6).
    assert!((ada.scores.kappa.unwrap().value - 0.8).abs() < 1e-12);
    assert!(ada.scores.level_kappa.unwrap().value > 0.99);
    check_files(&folder, &session);
}

fn check_files(folder: &SessionFolder, session: &Session) {
    // They hold what students have answered; recordings are files of others.
    #[cfg(unix)]
    let own = ["session.json", "answers.csv", "notes.csv", "report.html"];
    #[cfg(unix)]
    for entry in fs::read_dir(folder.path()).unwrap() {
        use std::os::unix::fs::PermissionsExt;
        let entry = entry.unwrap();
        let name = entry.file_name().to_string_lossy().into_owned();
        if !own.contains(&name.as_str()) {
            continue;
        }
        let mode = entry.metadata().unwrap().permissions().mode();
        assert_eq!(mode & 0o077, 0, "{}: {mode:o}", entry.path().display());
    }
    let mut answers = csv::Reader::from_path(folder.path().join("answers.csv")).unwrap();
    let rows: Vec<_> = answers.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 12);
    assert_eq!(rows[0].get(0), Some("1"));
    assert_eq!(rows[1].get(4), Some("Ben 2"));
    assert_eq!(rows[11].get(11), Some("trial-06.parquet"));
    let right = rows.iter().filter(|row| row.get(8) == Some("true"));
    assert_eq!(right.count(), 9);
    let mut notes = csv::Reader::from_path(folder.path().join("notes.csv")).unwrap();
    let notes: Vec<_> = notes.records().map(Result::unwrap).collect();
    assert_eq!((notes.len(), notes[0].get(2)), (1, Some("teacher")));
    assert!(notes[0].get(3).unwrap().starts_with("'=HYPERLINK"));

    for (name, page) in reports(folder, session) {
        assert!(page.contains(&format!("<html lang=\"{name}\">")));
        assert!(page.contains("20261124") && page.contains("2026-11-24 15:42:05"));
        assert!(page.contains("&lt;b&gt;here&lt;/b&gt;") && !page.contains("<script"));
        assert!(!page.contains("style=\""));
    }
}

/// The panel's texts of a language.
fn texts(language: &str) -> BTreeMap<String, String> {
    let strings = Path::new(env!("CARGO_MANIFEST_DIR")).join("../panel/assets/strings");
    let table = fs::read_to_string(strings.join(language).with_extension("json")).unwrap();
    serde_json::from_str(&table).unwrap()
}

/// The report in both languages, kept beside each other.
fn reports(folder: &SessionFolder, session: &Session) -> [(&'static str, String); 2] {
    ["en", "de"].map(|name| {
        let table = texts(name);
        let text = |key: &str| table[key].clone();
        let path = folder.save_report(session, &text).unwrap();
        let copy = folder.path().join(format!("report-{name}.html"));
        fs::copy(&path, copy).unwrap();
        (name, fs::read_to_string(&path).unwrap())
    })
}

/// The widest confusion matrix: the students answer every disorder there is.
#[test]
fn a_report_holds_every_disorder() {
    let mut session = begin(Feedback::Each);
    let folder = SessionFolder::create(&fresh("wide"), &session).unwrap();
    let mut findings = Finding::all().chain(Finding::all());
    for number in 1..=6 {
        let lesson = &mut session.lesson;
        lesson.start().unwrap();
        for student in ["Ada", "Ben 2"] {
            let name = findings.next().unwrap().name();
            let level = Some("moderate");
            lesson.answer(student, name, level, 3, 1.5).unwrap();
        }
        if number < 6 {
            lesson.next_trial().unwrap();
        }
    }
    session.lesson.end().unwrap();
    let summary = session.lesson.view(None).summary.unwrap();
    assert_eq!(summary.all.confusion.columns.len(), 10);
    for (language, page) in reports(&folder, &session) {
        assert!(page.contains("class=\"student\""));
        let texts = texts(language);
        let tables = page.split("<table class=\"confusion\">").skip(1);
        let tables: Vec<_> = tables
            .map(|rest| rest.split_once("</table>").unwrap().0)
            .collect();
        assert_eq!(tables.len(), summary.students.len());
        for finding in Finding::all() {
            let text = &texts[&format!("report.disorder.{}", finding.name())];
            let heading = format!("<th scope=\"col\"><span>{text}</span></th>");
            let mut is_anywhere = false;
            for (student, table) in summary.students.iter().zip(&tables) {
                let is_here = table.contains(&heading);
                let columns = &student.scores.confusion.columns;
                assert_eq!(is_here, columns.contains(&finding), "{language}: {text}");
                is_anywhere |= is_here;
            }
            assert!(is_anywhere, "{language}: {text}");
        }
    }
}

#[test]
fn with_feedback_at_the_end_nothing_is_told_before() {
    let parent = fresh("end");
    let mut session = begin(Feedback::End);
    let folder = SessionFolder::create(&parent, &session).unwrap();
    for number in 1..=6 {
        trial(&mut session, &folder);
        let view = session.lesson.view(None);
        assert!(hides(&view, &session));
        assert!(
            view.answers
                .iter()
                .all(|a| a.right.is_none() && a.level_right.is_none())
        );
        if number < 6 {
            session.lesson.next_trial().unwrap();
        }
    }
    session.lesson.end().unwrap();
    let view = session.lesson.view(Some("folder"));
    assert!(view.knee.is_some() && view.answers.iter().all(|a| a.right.is_some()));
    assert_eq!(view.summary.unwrap().right, 9);
    // Another lesson of the same second has a folder of its own.
    let second = SessionFolder::create(&parent, &session).unwrap();
    assert_eq!(second.path(), parent.join("2026-11-24-154205-blind-six-2"));
}

/// Names the folder in which [`saves_on_a_full_disk`] saves.
#[cfg(target_os = "linux")]
const FULL: &str = "CREPITUS_LESSON_FULL_DISK";

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_keeps_what_was_there() {
    let session = begin(Feedback::Each);
    let folder = SessionFolder::create(&fresh("full"), &session).unwrap();
    // No file may grow beyond 2 blocks of 512 bytes: the write fails as on a full disk.
    let script = format!(
        "trap '' XFSZ; ulimit -f 2; exec '{}' --ignored --exact saves_on_a_full_disk",
        std::env::current_exe().unwrap().display()
    );
    let output = std::process::Command::new("sh")
        .args(["-c", &script])
        .env(FULL, folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && text.contains("1 passed"),
        "{text}"
    );
    assert_eq!(Session::read(folder.path()).unwrap(), session);
    // The session's three, and their list.
    let files = fs::read_dir(folder.path()).unwrap();
    assert_eq!(files.count(), 4);
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "a part of a_full_disk_keeps_what_was_there, in a process of its own"]
fn saves_on_a_full_disk() {
    let Some(path) = std::env::var_os(FULL) else {
        return;
    };
    let path = PathBuf::from(path);
    let (folder, mut session) = SessionFolder::open(&path).unwrap();
    session.lesson.start().unwrap();
    let error = folder.save(&session).unwrap_err().to_string();
    assert!(
        error.contains("session.json") && error.contains("the disk has room"),
        "{error}"
    );
}
