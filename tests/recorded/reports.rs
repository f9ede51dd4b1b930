//! Reports of recordings: what they replace, and what they draw.

use crate::support::{crepitus, names, recording, refuses, run, stderr, words};
use crate::{recorded, recording_in_progress, text};
use std::fs;
use std::path::Path;

#[test]
fn a_report_replaces_nothing_but_its_own() {
    let home = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| recorded(home.path(), name));
    let out = home.path().join("out");
    let report = |file: &Path| run(&["report", text(file), "--out", text(&out)]);
    for _ in 0..2 {
        let output = report(&a);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let before = fs::read(out.join("report.html")).unwrap();
    let output = report(&b);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(said.contains("written by `report "), "{said}");
    assert_eq!(fs::read(out.join("report.html")).unwrap(), before);
    // Somebody's own, and results of another kind.
    fs::write(out.join("summary.json"), "{}").unwrap();
    assert_eq!(report(&a).status.code(), Some(2));
}

/// Recordings of either format, also where only the end of the work tells the name.
#[test]
fn results_replace_no_recording() {
    let home = tempfile::tempdir().unwrap();
    let a = recorded(home.path(), "a");
    let scene = ["run", "fig6-ideal-cycle", "--set", "duration_s=0.1"];
    for (name, arguments) in [
        ("report.html", &["report", text(&a)][..]),
        ("summary.json", &["report", text(&a)]),
        ("torque.svg", &["report", text(&a), "--pictures"]),
        ("report.html", &scene),
        ("trace.csv", &scene),
    ] {
        let out = tempfile::tempdir().unwrap();
        let kept = recorded(out.path(), name);
        refuses(
            &[arguments, &["--out", text(out.path())]].concat(),
            2,
            &format!("{name} (not written by crepitus)"),
        );
        assert_eq!(names(out.path()), [name]);
        assert!(recording(&kept).is_complete());
    }
    let out = home.path().join("a-report");
    fs::create_dir(&out).unwrap();
    let log = recording_in_progress(&out.join("report.html"));
    refuses(
        &["report", text(&a)],
        2,
        "report.html (not written by crepitus)",
    );
    assert_eq!(fs::read(out.join("report.html")).unwrap(), log);
}

/// A symptom that was on is drawn: what a recording holds is enough.
#[test]
fn a_symptom_of_a_recording_is_drawn_with_its_limits() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path();
    let scene = "version = 1\ntitle = \"Rigid\"\nduration_s = 3.0\ndevice = true\n\
                 [motion]\nkind = \"constant\"\nvelocity_rad_s = 0.5\n\
                 [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\nprecision = \"f32\"\n\
                 [effects.encoder]\n[effects.lead-pipe]\ntorque_nm = 0.8\n";
    fs::write(folder.join("rigid.toml"), scene).unwrap();
    let output = crepitus()
        .current_dir(folder)
        .args(words(
            "record rigid --device sim --scene rigid.toml --for 2s --arm --zero",
        ))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let output = crepitus()
        .current_dir(folder)
        .args(["report", "rigid", "--pictures"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let report = folder.join("rigid-report");
    for picture in ["lead-pipe-1.svg", "lead-pipe-2.svg"] {
        let drawn = fs::read_to_string(report.join(picture)).unwrap();
        assert!(drawn.contains("limits of the rigidity"), "{picture}");
    }
    let page = fs::read_to_string(report.join("report.html")).unwrap();
    for words in [
        "even resistance",
        "On examination: lead-pipe rigidity",
        "0.80 N·m against bending",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // Nothing else was on, crepitus neither.
    for words in ["Clasp-knife", "rendered together", "broke loose"] {
        assert!(!page.contains(words), "{words}");
    }
    // Before it is armed a symptom has no phase, which is no broken row.
    assert!(!page.contains("not finite"));
}

#[test]
fn the_current_of_the_actuators_coil_is_drawn_where_it_was_driven() {
    let home = tempfile::tempdir().unwrap();
    for (scene, is_drawn) in [("fig8-6-actuator", true), ("passive-examination", false)] {
        let output = crepitus()
            .current_dir(home.path())
            .args(["record", scene, "--device", "sim", "--scene", scene])
            .args(["--for", "600ms", "--arm", "--zero"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let output = crepitus()
            .current_dir(home.path())
            .args(["report", scene])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let page = home.path().join(format!("{scene}-report/report.html"));
        let page = fs::read_to_string(page).unwrap();
        assert_eq!(page.contains("Coil of the actuator"), is_drawn, "{scene}");
        assert!(!page.contains("not finite"), "{scene}");
    }
}
