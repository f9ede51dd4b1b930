//! Refused runs: bad input, bad usage, places where nothing can be.

use crate::support::{self, crepitus, names, run, stderr, stdout};
use std::fs;

#[test]
fn bad_input_is_exit_code_2_and_writes_nothing() {
    let home = tempfile::tempdir().unwrap();
    let bad = home.path().join("bad.toml");
    fs::write(&bad, "version = 1\ntitle = \"x\"\nduration_s = 1\n").unwrap();
    let latin = home.path().join("latin.toml");
    fs::write(&latin, b"title = \"45\xb0\"\n").unwrap();
    let before = names(home.path());
    let cases: [(&[&str], &str); 9] = [
        (&["run", "nothing.toml"], "no such file"),
        (&["run", "bad.toml"], "[motion]"),
        (&["run", "latin.toml"], "UTF-8"),
        (&["run", "."], "cannot be read"),
        (
            &["run", "low-speed", "--solver", "exat"],
            "did you mean exact",
        ),
        (&["run", "low-speed", "--step", "-1"], "above 0"),
        (
            &["run", "low-speed", "--set", "duration_s=forever"],
            "a number",
        ),
        (
            &["run", "low-speed", "--set", "effects.crepitus.stiffness=3"],
            "stiffness_nm_per_rad",
        ),
        (
            &["run", "encoder", "--solver", "reference"],
            "[effects.encoder]",
        ),
    ];
    for (arguments, part) in cases {
        let output = crepitus()
            .args(arguments)
            .current_dir(home.path())
            .output()
            .unwrap();
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(
            message.starts_with("error: ") && message.contains(part),
            "{arguments:?}: {message}"
        );
        let json = crepitus()
            .arg("--json")
            .args(arguments)
            .current_dir(home.path())
            .output()
            .unwrap();
        let printed: serde_json::Value = serde_json::from_str(&stdout(&json)).unwrap();
        assert_eq!(printed["error"]["exit_code"], 2);
    }
    assert_eq!(names(home.path()), before);
}

#[test]
fn bad_usage_is_exit_code_2() {
    for arguments in [
        &["fly"][..],
        &["run"],
        &["run", "low-speed", "--set", "x"],
        &["run", "low-speed", "--trace-every", "0"],
    ] {
        assert_eq!(run(arguments).status.code(), Some(2), "{arguments:?}");
    }
}

/// Reported before the run, and as bad input.
#[test]
fn places_where_nothing_can_be_are_bad_input() {
    let home = tempfile::tempdir().unwrap();
    let at = |name: &str| home.path().join(name).to_str().unwrap().to_owned();
    let folder = at("folder.wav");
    fs::create_dir(&folder).unwrap();
    let (long, missing, out) = (at(&"x".repeat(300)), at("no/such.wav"), at("out"));
    for arguments in [
        &["--out", &long][..],
        &["--out", "/dev/null/x"],
        &["--out", &out, "--wav", &missing],
        &["--out", &out, "--wav", &folder],
    ] {
        // A run that took its time would not be ended by an error of its place.
        let mut all = vec!["run", "fig6-ideal-cycle", "--set", "duration_s=1e5"];
        all.extend(arguments);
        let output = run(&all);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(!text.contains(".crepitus-"), "{text}");
    }
    assert_eq!(names(home.path()), ["folder.wav"]);
}

#[test]
fn no_run_goes_beside_its_folder() {
    let home = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(support::repository().join("scenes/low-speed.toml")).unwrap();
    fs::write(home.path().join("...toml"), text).unwrap();
    let output = support::crepitus()
        .args(["run", "...toml"])
        .current_dir(home.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("name one with --out"));
    assert_eq!(names(home.path()), ["...toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_without_an_end_is_no_scene() {
    support::refuses(
        &["run", "/dev/zero"],
        2,
        "it is a device, expected a regular file",
    );
}

#[test]
fn a_broken_summary_is_named_itself() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("summary.json");
    let file = file.to_str().unwrap();
    fs::write(
        file,
        r#"{"scene": "scenes/low-speed.toml", "scene_as_run": "version = 1"}"#,
    )
    .unwrap();
    support::refuses(
        &["run", file],
        2,
        &format!("{file}: `duration_s`: in `scene_as_run`"),
    );
}

/// A seat on a leg without mass has no frequency to warn of.
#[test]
fn a_shell_needs_a_limb() {
    let shell = [
        "--set",
        "effects.shell.mass_kg=0.25",
        "--set",
        "duration_s=1",
    ];
    let mut arguments = vec!["run", "slow-examination"];
    arguments.extend(shell);
    support::refuses(&arguments, 2, "needs [effects.limb]");
}

#[test]
fn as_many_draws_as_nobody_waits_for_are_refused() {
    support::refuses(&["vibration", "--draws", "99999999999"], 2, "0..=1000000");
}

/// The speeds of the study replaced what was set, silently.
#[test]
fn a_study_of_vibration_takes_speeds_from_one_place() {
    for set in [
        "motion.velocity_rad_s=0.3",
        "motion.from_deg=40",
        "duration_s=1",
    ] {
        support::refuses(&["vibration", "--set", set], 2, "use --speeds");
    }
    let strokes = ["vibration", "passive-examination", "--speeds", "0.5"];
    support::refuses(&strokes, 2, "leave --speeds out");
}
