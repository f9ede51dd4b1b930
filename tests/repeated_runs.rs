//! A run's summary holds what is needed to repeat it, and a folder keeps its run.

mod support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use support::{crepitus, names, repository, stderr, stdout, summary};

fn run_in(home: &Path, arguments: &[&str]) -> Output {
    crepitus()
        .arg("run")
        .args(arguments)
        .current_dir(home)
        .output()
        .unwrap()
}

fn done(home: &Path, arguments: &[&str]) -> String {
    let output = run_in(home, arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    stderr(&output)
}

/// The summary without what was timed.
fn numbers(folder: &Path) -> Value {
    let mut summary = summary(folder);
    let object = summary.as_object_mut().unwrap();
    for timed in ["wall_s", "real_time_factor", "effects"] {
        object.remove(timed).unwrap();
    }
    summary
}

#[test]
fn a_summary_repeats_its_run_bit_for_bit() {
    for arguments in [
        &["high-speed", "--set", "effects.crepitus.preset=fine"][..],
        &["encoder", "--solver", "exact", "--precision", "f32"],
        &[
            "everything",
            "--as-device",
            "--set",
            "effects.limb.body_mass_kg=66",
        ],
        &["reversal-inside-stick"],
        &["knee-pass-physical", "--solver", "reference"],
    ] {
        let home = tempfile::tempdir().unwrap();
        let home = home.path();
        done(
            home,
            &[arguments, &["--set", "duration_s=0.4", "--out", "a"]].concat(),
        );
        done(home, &["a/summary.json", "--out", "b"]);
        for file in ["trace.csv", "events.csv"] {
            let [a, b] = ["a", "b"].map(|folder| fs::read(home.join(folder).join(file)).unwrap());
            assert!(a == b, "{file} of {arguments:?}");
        }
        assert_eq!(numbers(&home.join("a")), numbers(&home.join("b")));
        let text = numbers(&home.join("a"))["scene_as_run"].to_string();
        // Defaults, presets and overrides are written out.
        for key in [
            "duration_s = 0.4",
            "substeps = ",
            "trace_step_s = ",
            "device = ",
        ] {
            assert!(text.contains(key), "{key} is missing in {text}");
        }
    }
}

#[test]
fn a_repeated_run_finds_its_recording_from_anywhere_and_notices_another_one() {
    let home = tempfile::tempdir().unwrap();
    let rows: Vec<_> = (0..=50)
        .map(|i| {
            let t = f64::from(i) * 0.01;
            format!("{t:.2},{:.3}", 30.0 - 20.0 * (6.0 * t).cos())
        })
        .collect();
    let data = format!("time_s,knee_deg\n{}\n", rows.join("\n"));
    fs::create_dir(home.path().join("lab")).unwrap();
    fs::write(home.path().join("lab/knee.csv"), &data).unwrap();
    fs::write(
        home.path().join("lab/scene.toml"),
        "version = 1\ntitle = \"A recording\"\nduration_s = 0.4\n[motion]\nkind = \"recording\"\n\
         file = 'knee.csv'\ntime_column = \"time_s\"\nangle_column = \"knee_deg\"\nunit = \"deg\"\n\
         [solver]\nkind = \"exact\"\nstep_s = 5e-5\n[effects.crepitus]\n",
    )
    .unwrap();
    done(home.path(), &["lab/scene.toml", "--out", "a"]);
    let hash = summary(&home.path().join("a"))["data"]["sha256"].clone();
    assert_eq!(hash.as_str().unwrap().len(), 64);
    let elsewhere = tempfile::tempdir().unwrap();
    let first = home.path().join("a/summary.json");
    done(elsewhere.path(), &[first.to_str().unwrap(), "--out", "b"]);
    assert_eq!(
        numbers(&home.path().join("a")),
        numbers(&elsewhere.path().join("b"))
    );

    fs::write(
        home.path().join("lab/knee.csv"),
        data.replace("0.20,", "0.20,0"),
    )
    .unwrap();
    let changed = run_in(elsewhere.path(), &[first.to_str().unwrap(), "--out", "c"]);
    assert_eq!(changed.status.code(), Some(2));
    assert!(
        stderr(&changed).contains("has changed since that run"),
        "{}",
        stderr(&changed)
    );
    assert_eq!(names(elsewhere.path()), ["b"]);
    // With other data it is another run, and takes nothing away.
    let said = done(home.path(), &["lab/scene.toml", "--out", "a"]);
    assert!(said.contains("a-2"), "{said}");
    let hash_in = |folder: &str| summary(&home.path().join(folder))["data"]["sha256"].clone();
    assert!(hash_in("a") == hash && hash_in("a-2") != hash);
}

#[test]
fn a_run_of_another_version_is_repeated_with_a_warning() {
    let home = tempfile::tempdir().unwrap();
    let run = ["fig6-ideal-cycle", "--set", "duration_s=0.1", "--out", "a"];
    assert_eq!(done(home.path(), &run), "");
    let file = home.path().join("a/summary.json");
    assert_eq!(done(home.path(), &["a/summary.json", "--out", "b"]), "");
    let mut summary = summary(&home.path().join("a"));
    summary["crepitus_version"] = "0.0.7".into();
    fs::write(&file, summary.to_string()).unwrap();
    let said = done(home.path(), &["a/summary.json", "--out", "c"]);
    assert!(said.contains("was of crepitus 0.0.7"), "{said}");
    // Between two releases all builds have one version.
    if summary["crepitus_commit"].is_string() {
        summary["crepitus_version"] = env!("CARGO_PKG_VERSION").into();
        summary["crepitus_commit"] = "0123456789ab".into();
        fs::write(&file, summary.to_string()).unwrap();
        let said = done(home.path(), &["a/summary.json", "--out", "d"]);
        assert!(said.contains("was of commit 0123456789ab"), "{said}");
    }
}

#[test]
fn a_run_without_a_trace_leaves_that_of_the_same_run() {
    let home = tempfile::tempdir().unwrap();
    let run = ["fig6-ideal-cycle", "--set", "duration_s=0.1", "--out", "a"];
    done(home.path(), &run);
    let all = names(&home.path().join("a"));
    assert!(all.contains(&"trace.csv".to_owned()), "{all:?}");
    assert_eq!(done(home.path(), &[&run[..], &["--no-trace"]].concat()), "");
    assert_eq!(names(&home.path().join("a")), all);
}

#[test]
fn of_two_runs_at_once_each_has_its_folder() {
    let home = tempfile::tempdir().unwrap();
    let durations = ["0.11", "0.12", "0.13", "0.14"];
    let programs = durations.map(|duration| {
        crepitus()
            .args(["run", "fig6-ideal-cycle", "--set"])
            .arg(format!("duration_s={duration}"))
            .current_dir(home.path())
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap()
    });
    for mut program in programs {
        assert!(program.wait().unwrap().success());
    }
    let out = home.path().join("out");
    let mut found: Vec<_> = names(&out)
        .iter()
        .map(|folder| summary(&out.join(folder))["simulated_s"].as_f64().unwrap())
        .map(|s| format!("{s:.2}"))
        .collect();
    found.sort();
    assert_eq!(found, durations);
}

#[test]
fn a_folder_keeps_its_run() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let short = ["fig6-ideal-cycle", "--set", "duration_s=0.2"];
    let long = ["fig6-ideal-cycle", "--set", "duration_s=0.3"];
    let simulated = |folder: &str| summary(&home.join(folder))["simulated_s"].as_f64().unwrap();
    done(home, &short);
    // The same run again is the same run.
    assert_eq!(done(home, &short), "");
    let said = done(home, &long);
    assert!(
        said.contains("out/fig6-ideal-cycle-2") && said.contains("--force"),
        "{said}"
    );
    assert_eq!(
        names(&home.join("out")),
        ["fig6-ideal-cycle", "fig6-ideal-cycle-2"]
    );
    assert!((simulated("out/fig6-ideal-cycle") - 0.2).abs() < 1e-9);
    assert!((simulated("out/fig6-ideal-cycle-2") - 0.3).abs() < 1e-9);
    let output = run_in(home, &[&long[..], &["--json"]].concat());
    let told: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(told["out"], "out/fig6-ideal-cycle-2");

    // Replaced on request, and nothing of the other run stays.
    done(home, &[&long[..], &["--force", "--no-trace"]].concat());
    assert!((simulated("out/fig6-ideal-cycle") - 0.3).abs() < 1e-9);
    assert_eq!(
        names(&home.join("out/fig6-ideal-cycle")),
        ["events.csv", "summary.json"]
    );

    // Pictures have the names of their figures, or are somebody's own: they stay, and are named.
    done(home, &[&long[..], &["--pictures"]].concat());
    fs::write(home.join("out/fig6-ideal-cycle/bench.svg"), "<svg/>").unwrap();
    let said = done(home, &[&short[..], &["--force", "--pictures"]].concat());
    assert!(said.contains("not of these results: bench.svg\n"), "{said}");
    let said = done(home, &[&long[..], &["--force"]].concat());
    assert!(
        said.contains("bench.svg, ") && said.contains("torque.svg"),
        "{said}"
    );
}

#[test]
fn a_numbered_folder_stands_beside_the_wanted_one() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let run = |duration: &str, out: &str, folder: &Path| {
        let duration = format!("duration_s={duration}");
        run_in(
            folder,
            &["fig6-ideal-cycle", "--set", &duration, "--out", out],
        )
    };
    // A shell completes the name with a slash.
    for (duration, folders) in [("0.1", &["x"][..]), ("0.2", &["x", "x-2"])] {
        let output = run(duration, "x/", home);
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(names(home), folders);
    }
    let inside = home.join("x");
    let files = names(&inside);
    // The same run again, and another one: there is no name to number.
    assert!(run("0.1", ".", &inside).status.success());
    let output = run("0.2", ".", &inside);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(said.contains("no name to add a number to"), "{said}");
    assert_eq!((names(home).len(), names(&inside)), (2, files));
}

/// The build script, in a repository of its own with a program that prints what it has set.
#[test]
fn an_edit_after_a_clean_build_is_in_the_name_of_the_commit() {
    let home = tempfile::tempdir().unwrap();
    let root = home.path();
    let tool = root.join("host/crepitus");
    fs::create_dir_all(tool.join("src")).unwrap();
    fs::create_dir(root.join("model")).unwrap();
    let manifest =
        "[package]\nname = \"named\"\nversion = \"0.1.0\"\nedition = \"2024\"\n[workspace]\n";
    let program = "fn main() { print!(\"{}\", env!(\"CREPITUS_COMMIT\")) }";
    fs::write(tool.join("Cargo.toml"), manifest).unwrap();
    fs::write(tool.join("src/main.rs"), program).unwrap();
    fs::write(root.join("model/lib.rs"), "").unwrap();
    fs::copy(
        repository().join("host/crepitus/build.rs"),
        tool.join("build.rs"),
    )
    .unwrap();
    let done = |program: &str, arguments: &[&str]| {
        let output = Command::new(program)
            .args(arguments)
            .current_dir(root)
            .env("GIT_CONFIG_GLOBAL", "/dev/null")
            .env_remove("GIT_DIR")
            .env_remove("CREPITUS_COMMIT")
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        stdout(&output)
    };
    let commit = || {
        done("git", &["add", "host", "model"]);
        let author = ["-c", "user.name=a", "-c", "user.email=a"];
        done(
            "git",
            &[&author[..], &["commit", "--quiet", "--message", "a"]].concat(),
        );
    };
    let built = || {
        let manifest = "--manifest-path=host/crepitus/Cargo.toml";
        let place = "--target-dir=target";
        done(
            env!("CARGO"),
            &["run", "--quiet", "--offline", manifest, place],
        )
    };
    done("git", &["init", "--quiet"]);
    commit();
    let first = built();
    assert!(!first.is_empty() && !first.ends_with("-dirty"), "{first}");
    fs::write(root.join("model/lib.rs"), "// Edited.\n").unwrap();
    assert_eq!(built(), format!("{first}-dirty"));
    commit();
    let second = built();
    assert!(second != first && !second.ends_with("-dirty"), "{second}");
}

/// Otherwise an edit of a package would not be seen.
#[test]
fn the_build_script_watches_every_package_of_the_program() {
    let script = fs::read_to_string(repository().join("host/crepitus/build.rs")).unwrap();
    let manifest = fs::read_to_string(repository().join("Cargo.toml")).unwrap();
    let paths: Vec<_> = (manifest.lines())
        .filter_map(|line| line.split_once("{ path = \"")?.1.split('"').next())
        .collect();
    assert!(paths.len() > 15, "{paths:?}");
    for path in paths {
        let mut folders = Path::new(path).ancestors();
        assert!(
            folders.any(|folder| script.contains(&format!("\"{}\",", folder.display()))),
            "{path}"
        );
    }
}

#[test]
fn without_a_trace_the_numbers_are_the_same() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    for (scene, more) in [("encoder", &[][..]), ("everything", &["--as-device"])] {
        let arguments = [&[scene, "--set", "duration_s=0.4"], more].concat();
        let [with, without] = ["with", "without"].map(|how| format!("{scene}-{how}"));
        done(home, &[&arguments[..], &["--out", &with]].concat());
        done(
            home,
            &[&arguments[..], &["--out", &without, "--no-trace"]].concat(),
        );
        assert_eq!(names(&home.join(&without)), ["events.csv", "summary.json"]);
        let [with, without] = [with, without].map(|folder| home.join(folder));
        assert_eq!(numbers(&with), numbers(&without));
        let events = |folder: &Path| fs::read(folder.join("events.csv")).unwrap();
        assert!(events(&with) == events(&without));
    }
}

#[test]
fn what_is_no_summary_is_refused() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("x.json"), "{}").unwrap();
    fs::write(home.path().join("y.json"), "not JSON").unwrap();
    for file in ["x.json", "y.json"] {
        let output = run_in(home.path(), &[file]);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            stderr(&output).contains("not the summary of a run"),
            "{}",
            stderr(&output)
        );
    }
    assert!(!run_in(home.path(), &["z.json"]).status.success());
    assert_eq!(names(home.path()), ["x.json", "y.json"]);
}
