use super::*;
use std::collections::BTreeMap;

const CONSTANT: &str = "title = 'Constant'\nquestion = 'Which was rougher?'\nconsent = 'consent.txt'\n[threshold]\n\
    preset = 'coarse'\nquantity = 'crepitus.static_torque_nm'\nreference = 0.4\ndesign = '2afc'\n\
    [threshold.constant]\ndifferences = [0.1, 0.2]\nrepeats = 3\ncatch_trials = 2";
const STAIRCASE: &str = "title = 'Staircase'\n[threshold]\nquantity = 'torque'\nreference = 1.0\n\
    [threshold.staircase]\nrule = '1-up-2-down'\nstart = 0.5\nsteps = [0.1]\nleast = 0.1\nmost = 1\nreversals = 4\n\
    trials = 8\ninterleaved = 2";
const ABX: &str = "title = 'A or B'\n[abx]\ntrials = 6\na = { preset = 'coarse' }\n\
    b = { preset = 'coarse', values = { 'crepitus.restart' = 1.0 } }";
const REALISM: &str = "title = 'Realism'\n[realism]\npresets = ['coarse', 'mas-2-catch']\nrepeats = 2\nhealthy = 2\n\
    features = ['grating']";
const FILES: [(&str, &str); 4] = [
    ("constant.toml", CONSTANT),
    ("staircase.toml", STAIRCASE),
    ("abx.toml", ABX),
    ("realism.toml", REALISM),
];
const CONSENT: &str = "You may stop at any time.\n";

/// A folder with these protocols and a text of consent.
fn folder() -> (tempfile::TempDir, Experiments) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in FILES {
        fs::write(folder.path().join(name), text).unwrap();
    }
    fs::write(folder.path().join("consent.txt"), CONSENT).unwrap();
    let experiments = Experiments::open(folder.path()).unwrap();
    (folder, experiments)
}

fn begin(experiments: &Experiments, file: &str, participant: &str) -> Result<Run, String> {
    let hash = hash_of(CONSENT.as_bytes());
    let begin = Begin {
        file,
        participant,
        consented: (file == "constant.toml").then_some(hash.as_str()),
        unix_s: 1_700_000_000,
    };
    experiments.begin(&[], begin)
}

/// Feels every interval of the current trial; the stimuli.
fn feel(run: &mut Run) -> Vec<crepitus_studies::experiment::Stimulus> {
    let trial = run.answered() + 1;
    let count = run.view()["trial"]["felt"].as_array().unwrap().len();
    let of = |interval| {
        let stimulus = run.interval(trial, interval).unwrap();
        run.feel(interval);
        stimulus
    };
    (1..=count).map(of).collect()
}

/// Answers the current trial.
fn answer(run: &mut Run) {
    let trial = run.answered() + 1;
    if run.view()["kind"] == "realism" {
        run.describe(trial, " it grates ", 1.0).unwrap();
        assert_eq!(run.view()["trial"]["described"], "it grates");
        run.rate(trial, &[4, 3], ["mild", "crepitus"], 2.0).unwrap();
    } else {
        run.choose(trial, 1, 2.0).unwrap();
    }
}

/// Two participants have other levels in another order, and pages see the same.
#[test]
fn what_a_page_sees_does_not_depend_on_the_level() {
    let (_folder, experiments) = folder();
    for (file, _) in FILES {
        let mut runs = ["P01", "P02"].map(|name| begin(&experiments, file, name).unwrap());
        let mut is_equal = true;
        let seen = |run: &Run| {
            let mut view = run.view();
            view["participant"] = Value::Null;
            view["folder"] = Value::Null;
            view
        };
        while runs.iter().all(|run| !run.is_over()) {
            let [one, other] = &mut runs;
            assert_eq!(seen(one), seen(other), "{file}");
            is_equal &= feel(one) == feel(other);
            assert_eq!(seen(one), seen(other), "{file}");
            answer(one);
            answer(other);
        }
        assert!(
            !is_equal,
            "{file}: both have one order, which shows nothing"
        );
    }
    let list = experiments.list(&[]).to_string();
    for secret in [
        "difference",
        "reference",
        "static_torque",
        "coarse",
        "restart",
        "levels",
    ] {
        assert!(!list.contains(secret), "{secret}: {list}");
    }
}

#[test]
fn no_answer_counts_before_every_interval_was_felt() {
    let (_folder, experiments) = folder();
    let mut run = begin(&experiments, "staircase.toml", "P01").unwrap();
    let error = run.choose(1, 1, 1.0).unwrap_err();
    assert!(error.contains("with the motor on"), "{error}");
    assert!(run.interval(1, 2).unwrap_err().contains("interval 1 first"));
    assert!(run.interval(1, 3).unwrap_err().contains("expected 1 to 2"));
    assert!(run.interval(1, 0).is_err());
    assert!(
        run.interval(2, 1)
            .unwrap_err()
            .contains("now it is trial 1")
    );
    run.feel(1);
    assert!(run.interval(1, 1).unwrap_err().contains("felt once"));
    assert!(run.choose(1, 1, 1.0).is_err());
    run.feel(2);
    assert!(run.interrupt() && !run.interrupt());
    assert!(run.choose(1, 1, 1.0).is_err());
    feel(&mut run);
    let error = run.choose(1, 3, 1.0).unwrap_err();
    assert!(
        error.contains("expected") || error.contains("1 to 2"),
        "{error}"
    );
    run.choose(1, 2, 1.0).unwrap();
    // Sent twice, it is no answer to the next trial.
    assert!(
        run.choose(1, 2, 1.0)
            .unwrap_err()
            .contains("now it is trial 2")
    );
    // In 2AFC each is felt as often as wanted, in any order.
    let mut run = begin(&experiments, "constant.toml", "P01").unwrap();
    for interval in [2, 1, 1, 2] {
        run.interval(1, interval).unwrap();
        run.feel(interval);
    }
    run.choose(1, 2, 1.0).unwrap();
}

#[test]
fn a_knee_is_described_and_then_rated() {
    let (_folder, experiments) = folder();
    let mut run = begin(&experiments, "realism.toml", "P01").unwrap();
    feel(&mut run);
    let rated = |run: &mut Run, realism: &[u8], words| run.rate(1, realism, words, 2.0);
    let error = rated(&mut run, &[3, 3], ["mild", "clonus"]).unwrap_err();
    assert!(error.contains("description"), "{error}");
    assert!(run.choose(1, 1, 1.0).is_err());
    assert!(run.describe(1, "  ", 1.0).is_err());
    assert!(run.describe(1, &"x".repeat(1_001), 1.0).is_err());
    run.describe(1, "it grates", 1.0).unwrap();
    let error = run.describe(1, "no, it does not", 1.0).unwrap_err();
    assert!(error.contains("rate it"), "{error}");
    for (realism, words, expected) in [
        (&[3][..], ["mild", "clonus"], "number of ratings"),
        (&[3, 6], ["mild", "clonus"], "realism"),
        (&[3, 0], ["mild", "clonus"], "realism"),
        (&[3, 3], ["awful", "clonus"], "expected one of none, mild"),
        (&[3, 3], ["mild", "gout"], "expected one of healthy"),
    ] {
        let error = rated(&mut run, realism, words).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
    rated(&mut run, &[3, 3], ["mild", "clonus"]).unwrap();
    assert_eq!(run.answered(), 1);
}

#[test]
fn a_session_goes_on_where_its_program_was_killed() {
    let (folder, experiments) = folder();
    let mut stimuli = BTreeMap::new();
    for round in 0..3 {
        let mut run = begin(&experiments, "staircase.toml", "P01").unwrap();
        assert_eq!(run.answered(), 2 * round);
        for _ in 0..2 {
            let trial = run.answered() + 1;
            stimuli.insert(trial, feel(&mut run));
            answer(&mut run);
            // Nothing is said before the disk has it.
            let table = fs::read_to_string(run.held_folder().join("trials.csv")).unwrap();
            assert_eq!(table.lines().count(), 1 + trial);
        }
        // Of the trial that was interrupted nothing is left.
        feel(&mut run);
        let list = experiments.list(&[]);
        assert_eq!(list["unfinished"][0]["answered"], 2 * round + 2, "{list}");
        assert_eq!(list["unfinished"][0]["file"], "staircase.toml");
        let twice = begin(&experiments, "staircase.toml", "P01").unwrap_err();
        assert!(twice.contains("another program runs"), "{twice}");
    }
    // In one go they are the same.
    let other = tempfile::tempdir().unwrap();
    fs::write(other.path().join("staircase.toml"), STAIRCASE).unwrap();
    let whole = Experiments::open(other.path()).unwrap();
    let mut run = begin(&whole, "staircase.toml", "P01").unwrap();
    for (trial, expected) in stimuli {
        assert_eq!(feel(&mut run), expected, "{trial}");
        answer(&mut run);
    }
    // A protocol that was changed is another one.
    fs::write(
        folder.path().join("staircase.toml"),
        STAIRCASE.replace("0.5", "0.6"),
    )
    .unwrap();
    let list = experiments.list(&[]);
    assert_eq!(list["unfinished"][0]["file"], Value::Null, "{list}");
}

#[test]
fn bad_input_says_what_to_do() {
    let (folder, experiments) = folder();
    let missing = Experiments::open(&folder.path().join("nothing"))
        .unwrap_err()
        .to_string();
    assert!(
        missing.contains("crepitus experiment new threshold"),
        "{missing}"
    );
    let error = experiments.results(&[]).unwrap_err();
    assert!(error.contains("no session has begun"), "{error}");
    for file in ["../constant.toml", "consent.txt", "nothing.toml", ""] {
        let error = begin(&experiments, file, "P01").unwrap_err();
        assert!(error.contains("reload the page"), "{file}: {error}");
    }
    let error = begin(&experiments, "abx.toml", "Anna").unwrap_err();
    assert!(error.contains("such as P01"), "{error}");
    let consented = |consented: Option<&str>| {
        let begin = Begin {
            file: "constant.toml",
            participant: "P01",
            consented,
            unix_s: 0,
        };
        experiments.begin(&[], begin).unwrap_err()
    };
    assert!(consented(None).contains("without the participant's consent"));
    assert!(consented(Some("0")).contains("changed since it was shown"));
    for (name, text, expected) in [
        ("bad.toml", "title = 'T'", "expected one of [threshold]"),
        ("form.toml", "titel = 'T'", "cannot be read"),
        (
            "gone.toml",
            &CONSTANT.replace("consent.txt", "gone.txt"),
            "gone.txt",
        ),
        (
            "two.toml",
            &ABX.replace("'coarse' }", "'coarse', device = 'b' }"),
            "need Python",
        ),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        let error = begin(&experiments, name, "P01").unwrap_err();
        assert!(error.contains(expected), "{error}");
        let list = experiments.list(&[]);
        let protocols = list["protocols"].as_array().unwrap();
        let own = protocols
            .iter()
            .find(|protocol| protocol["file"] == name)
            .unwrap();
        assert_eq!(own["error"], error);
    }
    // The consent is kept with the session, by its hash.
    begin(&experiments, "constant.toml", "P01").unwrap();
    let kept = format!("{}.txt", hash_of(CONSENT.as_bytes()));
    let kept = folder.path().join(STUDY).join("consent").join(kept);
    assert_eq!(fs::read_to_string(kept).unwrap(), CONSENT);
    let page = experiments.results(&[]).unwrap();
    assert!(page.contains("Constant") && !page.contains("<script"));
}
