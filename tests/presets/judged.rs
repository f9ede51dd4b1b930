//! Experiments on a terminal, and what they leave at the presets.

use super::*;
use std::io::Write;
use std::process::Stdio;

/// A folder with a protocol of each kind, a study, and presets.
struct Laboratory {
    home: tempfile::TempDir,
}

const REALISM: &str = "title = \"Knees of spring\"\nconsent = \"consent.txt\"\n[realism]\npresets = [\"coarse\", \
    \"mas-2-catch\"]\nrepeats = 1\nhealthy = 1\nfeatures = [\"grating\"]\n";

impl Laboratory {
    fn new() -> Self {
        let home = tempfile::tempdir().unwrap();
        fs::write(home.path().join("realism.toml"), REALISM).unwrap();
        fs::write(home.path().join("consent.txt"), "I agree.").unwrap();
        Self { home }
    }

    /// Runs a command with these lines on its standard input.
    fn run(&self, arguments: &[&str], lines: &str) -> Output {
        let mut command = crepitus();
        command
            .args(arguments)
            .current_dir(self.home.path())
            .env("CREPITUS_PRESETS", self.home.path().join("presets"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let written = child.stdin.take().unwrap().write_all(lines.as_bytes());
        let output = child.wait_with_output().unwrap();
        // A program that ends early does not read all of it.
        let _ = written;
        output
    }

    fn session(&self, protocol: &str, participant: &str, lines: &str) -> Output {
        let words = [
            "experiment",
            "run",
            protocol,
            "--study",
            "study",
            "--participant",
            participant,
        ];
        let more = ["--consented", "--zero", "--device", "sim"];
        self.run(&[&words[..], &more].concat(), lines)
    }
}

fn succeeded(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
    stdout(output)
}

/// Output of a session, with its questions.
fn dialogue(output: &Output) -> String {
    succeeded(output) + &stderr(output)
}

/// Answers to one knee.
const KNEE: &str = "\ngrates like sand\n4\n6\n3\nmild\ncrepitus\n";

#[test]
fn a_realism_session_is_evidence_wherever_its_presets_are_shown() {
    let laboratory = Laboratory::new();
    // It ends between the third knee's description and its rating.
    let lines = KNEE.repeat(2) + "\nclicks at the end\nq\n";
    let text = dialogue(&laboratory.session("realism.toml", "C1", &lines));
    assert!(text.contains("2 trials are stored"), "{text}");
    for hidden in ["coarse", "mas-2", "healthy knee"] {
        assert!(!text.contains(hidden), "{text}");
    }
    // The same command goes on, after the two.
    let text = dialogue(&laboratory.session("realism.toml", "C1", "\n4\n3\nmild\ncrepitus\n"));
    assert!(text.contains("goes on after 2 answered trials"), "{text}");
    assert!(text.contains("you felt: clicks at the end"), "{text}");
    assert!(text.contains("the session is over: 3 trials"), "{text}");
    succeeded(&laboratory.session("realism.toml", "C2", &KNEE.repeat(3)));

    let results = succeeded(&laboratory.run(&["experiment", "results", "study", "--out", "o"], ""));
    assert!(
        results.contains("Healthy knees that were named a disorder: 2 of 2"),
        "{results}"
    );
    let trials = fs::read(laboratory.home.path().join("o/trials-1.csv")).unwrap();
    assert_eq!(String::from_utf8(trials).unwrap().lines().count(), 1 + 6);

    succeeded(&laboratory.run(&["experiment", "evidence", "study"], ""));
    // Evaluated again, it replaces what it said before.
    succeeded(&laboratory.run(&["experiment", "evidence", "study"], ""));
    let shown = succeeded(&laboratory.run(&["presets", "coarse"], ""));
    let judged = "realism 4.0 (95 % 4.0 to 4.0) of 5; type right 2 of 2; 2 clinicians, 2 ratings, Knees of spring";
    assert_eq!(shown.matches(judged).count(), 1, "{shown}");
    let list = succeeded(&laboratory.run(&["presets"], ""));
    assert_eq!(
        list.matches("(judged by 2 clinicians)").count(),
        2,
        "{list}"
    );
    let json: Value = serde_json::from_str(&succeeded(
        &laboratory.run(&["presets", "coarse", "--json"], ""),
    ))
    .unwrap();
    let hash = json["judged"][0]["sha256"].as_str().unwrap();
    let summary: Value =
        serde_json::from_slice(&fs::read(laboratory.home.path().join("o/summary.json")).unwrap())
            .unwrap();
    assert_eq!(summary[0]["sha256"], hash);
}

#[test]
fn without_consent_or_with_a_name_nothing_begins() {
    let laboratory = Laboratory::new();
    let words = [
        "experiment",
        "run",
        "realism.toml",
        "--study",
        "study",
        "--device",
        "sim",
        "--participant",
    ];
    for (participant, expected) in [("C1", "consent"), ("Anna", "never a name")] {
        let output = laboratory.run(&[&words[..], &[participant]].concat(), "");
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
    let left = fs::read_dir(laboratory.home.path().join("study")).unwrap();
    assert_eq!(left.count(), 1);
}

#[test]
fn choices_are_made_by_the_number_of_an_interval() {
    let laboratory = Laboratory::new();
    for kind in ["threshold", "constant", "abx"] {
        let file = format!("{kind}.toml");
        succeeded(&laboratory.run(&["experiment", "new", kind, &file], ""));
        // Two intervals, or A, B and X; no answer, what is felt again, an answer; then the end of the lines.
        let lines = match kind {
            "threshold" => "\n\n7\n1\n\n\nq\n",
            "constant" => "\n\nagain 2\n1\n\n\nq\n",
            _ => "\n\n\nagain X\nb\n\n\n\nq\n",
        };
        let text = succeeded(&laboratory.session(&file, "P1", lines));
        assert!(text.contains("1 trials are stored"), "{kind}: {text}");
    }
    let results = succeeded(&laboratory.run(&["experiment", "results", "study", "--json"], ""));
    let results: Value = serde_json::from_str(&results).unwrap();
    assert_eq!(results.as_array().unwrap().len(), 3);
    succeeded(&laboratory.run(
        &["experiment", "export", "study", "P1", "--out", "of-P1"],
        "",
    ));
    assert!(
        laboratory
            .home
            .path()
            .join("of-P1/two-rules-of-restart-1/trials.csv")
            .is_file()
    );
    let gone = succeeded(&laboratory.run(&["experiment", "delete", "study", "P1"], ""));
    assert!(gone.contains("3 sessions"), "{gone}");
    let none = laboratory.run(&["experiment", "results", "study"], "");
    assert!(stderr(&none).contains("no session has begun yet"));
}
