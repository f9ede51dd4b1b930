//! Usage that is wrong: named before anything runs.

use crate::support::names;
use crate::{done, refused};

#[test]
fn what_is_wrong_is_said_before_anything_runs() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    for (arguments, word) in [
        ("low-speed", "nothing is varied"),
        ("low-speed --vary effects.crepitus.stifness=1,2", "stifness"),
        ("low-speed --vary duration_s=0:1:log3", "above 0"),
        ("low-speed --vary duration_s=1:2", "how many values"),
        ("nothing --vary duration_s=1,2", "no such scene ships"),
        (
            "low-sped --vary duration_s=1,2",
            "no such scene ships (did you mean low-speed?)",
        ),
        (
            "low-speed --vary duration_s=1,2 --shard 4/3",
            "no part 4 of 3",
        ),
        (
            "low-speed --vary duration_s=1:2 --latin 0",
            "at least one run",
        ),
        (
            "low-speed --vary duration_s=1,2 --threads 0",
            "expected at least 1, got 0",
        ),
        (
            "low-speed --vary duration_s=1,2 --seed 7",
            "--seed: only --latin and --sobol",
        ),
        (
            "low-speed --vary duration_s=1,2 --set duration_s=1",
            "--set duration_s: it is varied, too",
        ),
        (
            "low-speed --vary duration_s=1,2 --set title=a --set title=b",
            "`title` is set twice",
        ),
        ("....toml --vary duration_s=1,2", "no such scene ships"),
        ("--merge .", "sweep.json is missing"),
        ("low-speed --points none.csv", "none.csv"),
    ] {
        let text = refused(home, arguments, 2);
        assert!(text.contains(word), "{arguments:?}: {text}");
    }
    assert_eq!(names(home), Vec::<String>::new());
}

#[test]
fn a_part_that_is_missing_is_told_even_if_the_table_is_there() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    done(home, "low-speed --vary duration_s=0.01,0.02");
    let long = "x".repeat(300);
    for missing in ["nowhere", &long] {
        refused(home, &format!("--merge out/sweep-low-speed {missing}"), 2);
    }
}
