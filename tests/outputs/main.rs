//! Nothing that the program did not write is replaced or removed: every verb and flag that writes, with a foreign
//! file, folder, link and read-only file of each name that it writes.

#![cfg(unix)]

mod cases;
#[path = "../support/mod.rs"]
mod support;

use cases::{CASES, Case, DRAWN, HEARD, OTHERS, Place, READ};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::thread;
use support::{crepitus, names, run, stderr, stdout};

/// Kinds of what may be in the way.
const KINDS: [&str; 5] = ["file", "folder", "link", "read-only", "dangling"];

/// Puts something of a kind there.
fn plant(path: &Path, kind: &str, elsewhere: &Path) {
    match kind {
        "file" => fs::write(path, "mine").unwrap(),
        "read-only" => {
            fs::write(path, "mine").unwrap();
            let mut permissions = fs::metadata(path).unwrap().permissions();
            permissions.set_readonly(true);
            fs::set_permissions(path, permissions).unwrap();
        }
        "folder" => {
            fs::create_dir_all(path.join("cad/deep")).unwrap();
            fs::write(path.join("cad/deep/brace.step"), "mine").unwrap();
        }
        "link" => std::os::unix::fs::symlink(elsewhere, path).unwrap(),
        _ => std::os::unix::fs::symlink("nowhere", path).unwrap(),
    }
}

/// Everything below a folder: mode, and bytes or the end of a link.
fn everything(folder: &Path) -> BTreeMap<PathBuf, (u32, Vec<u8>)> {
    use std::os::unix::ffi::OsStringExt;
    use std::os::unix::fs::MetadataExt;
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let metadata = fs::symlink_metadata(&path).unwrap();
        let bytes = if metadata.is_symlink() {
            fs::read_link(&path).unwrap().into_os_string().into_vec()
        } else if metadata.is_dir() {
            all.extend(everything(&path));
            Vec::new()
        } else {
            fs::read(&path).unwrap()
        };
        all.insert(path, (metadata.mode(), bytes));
    }
    all
}

/// A recording, made once.
fn recording() -> &'static Path {
    static MADE: OnceLock<(tempfile::TempDir, PathBuf)> = OnceLock::new();
    let make = || {
        let home = tempfile::tempdir().unwrap();
        let file = home.path().join("recording");
        let path = file.to_str().unwrap();
        let output = run(&["record", path, "--device", "sim", "--for", "100ms"]);
        assert!(output.status.success(), "{}", stderr(&output));
        (home, file)
    };
    &MADE.get_or_init(make).1
}

/// The folder of a study, made once.
fn study() -> &'static Path {
    use crepitus_studies::experiment::protocol::{EXAMPLES, Known};
    use crepitus_studies::experiment::store::{Beginning, Store};
    static MADE: OnceLock<(tempfile::TempDir, PathBuf)> = OnceLock::new();
    let make = || {
        let home = tempfile::tempdir().unwrap();
        let (protocol, study) = (home.path().join("p.toml"), home.path().join("study"));
        fs::write(&protocol, EXAMPLES[2]).unwrap();
        let beginning = Beginning {
            protocol: &protocol,
            participant: "P1",
            seed: None,
            has_consented: false,
            unix_s: 7,
        };
        let store = Store::create(&study).unwrap();
        store.begin(beginning, Known::SHIPPED).unwrap();
        (home, study)
    };
    &MADE.get_or_init(make).1
}

/// The verbs of the program.
fn verbs() -> Vec<String> {
    let help = stdout(&run(&["--help"]));
    let (_, listed) = help.split_once("Commands:\n").expect("a list of verbs");
    let lines = listed.lines().take_while(|line| !line.is_empty());
    let names = lines.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names
        .filter_map(|line| line.split_whitespace().next())
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_verb_and_every_path_of_the_program_is_looked_at() {
    let verbs = verbs();
    assert!(verbs.len() > 25, "{verbs:?}");
    for verb in &verbs {
        let cases: Vec<_> = CASES.iter().filter(|case| case.verb == verb).collect();
        assert_eq!(cases.is_empty(), OTHERS.contains(&verb.as_str()), "{verb}");
        let help = stdout(&run(&[verb, "--help"]));
        for line in help
            .lines()
            .map(str::trim)
            .filter(|line| line.starts_with("--"))
        {
            let (option, value) = line.split_once(' ').unwrap_or((line, ""));
            let is_path = ["DIR", "FILE", "FOLDER"]
                .iter()
                .any(|kind| value.contains(kind));
            let is_tested = cases.iter().any(|case| case.flag == option);
            assert!(
                !is_path || is_tested || READ.contains(&option),
                "{verb} {line}: is it written?"
            );
            // Pictures and traces are files, too.
            let is_more = ["--pictures", "--traces"].contains(&option.split('[').next().unwrap());
            if is_more && verb == "run" || option == "--traces" {
                let has = |case: &&&Case| case.arguments.iter().any(|a| option.starts_with(a));
                assert!(cases.iter().any(|case| has(&case)), "{verb} {option}");
            }
        }
        // Whatever writes a folder has the same option.
        let writes_folder = cases.iter().any(|c| matches!(c.place, Place::Folder(_)));
        assert!(!writes_folder || help.contains("--force"), "{verb}");
    }
}

/// Tries a case with something of each kind under each of its names.
fn try_case(case: &Case) {
    // All verbs check in one place; those that are slow have no other way to it.
    let kinds = if case.is_slow { &KINDS[..3] } else { &KINDS };
    for name in case.names() {
        for kind in kinds.iter().copied() {
            let what = format!("{} {:?}, {kind} {name}", case.verb, case.arguments);
            let home = tempfile::tempdir().unwrap();
            let place = home.path().join("place");
            let elsewhere = home.path().join("elsewhere");
            fs::create_dir(&place).unwrap();
            fs::write(&elsewhere, "mine").unwrap();
            plant(&place.join(name), kind, &elsewhere);
            let before = everything(home.path());
            let output = case.run(home.path(), &place, &[]);
            // A run beside a summary that it cannot read goes to another folder.
            let goes_aside = case.verb == "run" && name == "summary.json" && kind != "dangling";
            let after = everything(home.path());
            if goes_aside {
                let kept = before
                    .iter()
                    .all(|(path, content)| after.get(path) == Some(content));
                assert!(kept, "{what}: {}", stderr(&output));
            } else {
                let text = stderr(&output);
                assert_eq!(output.status.code(), Some(2), "{what}: {text}");
                assert!(text.contains(name), "{what}: {text}");
                // A sound is written beside results, which are not written then either.
                assert_eq!(before, after, "{what}: {text}");
            }
            let yields = kind != "folder" && !["parts", "traces"].contains(&name);
            if case.is_slow && yields || case.verb == "record" {
                continue;
            }
            let output = case.run(home.path(), &place, &["--force"]);
            let text = stderr(&output);
            if yields {
                assert_eq!(output.status.code(), Some(0), "{what}: {text}");
                assert_eq!(fs::read(&elsewhere).unwrap(), b"mine", "{what}");
                let new = fs::symlink_metadata(place.join(name)).unwrap();
                assert!(new.is_file() && new.len() > 10, "{what}");
            } else {
                assert_eq!(output.status.code(), Some(2), "{what}: {text}");
                let after = everything(home.path());
                let kept = before
                    .iter()
                    .all(|(path, content)| after.get(path) == Some(content));
                assert!(kept, "{what}: {text}");
            }
        }
    }
}

#[test]
fn what_is_foreign_stays_whatever_the_verb() {
    recording();
    thread::scope(|scope| {
        for cases in CASES.chunks(CASES.len().div_ceil(4)) {
            scope.spawn(move || cases.iter().for_each(try_case));
        }
    });
}

#[test]
fn a_verb_replaces_its_own_files_without_a_word() {
    for case in CASES.iter().filter(|case| !case.is_slow) {
        let Place::Folder(names_written) = case.place else {
            continue;
        };
        let home = tempfile::tempdir().unwrap();
        let place = home.path().join("place");
        let mut before = Vec::new();
        for _ in 0..2 {
            let output = case.run(home.path(), &place, &[]);
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
            let written: BTreeSet<_> = names(&place).into_iter().collect();
            for name in names_written {
                // Parts are gone when the table is there.
                let is_gone = *name == "parts" && written.contains("sweep.csv");
                assert!(is_gone || written.contains(*name), "{} {name}", case.verb);
            }
            if case.arguments != DRAWN {
                let all = |name: &String| names_written.contains(&name.as_str());
                assert!(written.iter().all(all), "{}: {written:?}", case.verb);
            }
            if !before.is_empty() {
                assert_eq!(names(&place), before);
            }
            before = names(&place);
        }
    }
}

/// The input of a run under the name of a result, by whatever path, force or not.
#[test]
fn an_input_is_not_replaced() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let scene = |file: &str| {
        format!(
            "version = 1\ntitle = \"A recording\"\nduration_s = 0.2\n[motion]\nkind = \"recording\"\n\
             file = '{file}'\ntime_column = \"t\"\nangle_column = \"a\"\nunit = \"deg\"\n[solver]\n\
             kind = \"exact-events\"\nstep_s = 5e-5\n[effects.crepitus]\npreset = \"coarse\"\n"
        )
    };
    let rows = (0..40).fold("t,a\n".to_owned(), |rows, i| {
        let t = 0.01 * f64::from(i);
        rows + &format!("{t:.2},{:.3}\n", 20.0 + 30.0 * t)
    });
    fs::create_dir(home.join("data")).unwrap();
    let in_home = |path: &str| home.join(path);
    for (name, is_link) in [
        ("trace.csv", false),
        ("trace.csv", true),
        ("events.csv", true),
    ] {
        let _ = fs::remove_file(in_home(name));
        if is_link {
            fs::write(in_home("data/mine.csv"), &rows).unwrap();
            fs::hard_link(in_home("data/mine.csv"), in_home(name)).unwrap();
            fs::write(in_home("scene.toml"), scene("./data/../data/mine.csv")).unwrap();
        } else {
            fs::write(in_home(name), &rows).unwrap();
            fs::write(in_home("scene.toml"), scene("./data/../trace.csv")).unwrap();
        }
        for more in [&[][..], &["--force"]] {
            let output = crepitus()
                .args(["run", "scene.toml", "--out", "."])
                .args(more)
                .current_dir(home)
                .output()
                .unwrap();
            let text = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{name} {more:?}: {text}");
            assert!(text.contains(name) && text.contains("an input"), "{text}");
            assert_eq!(fs::read_to_string(in_home(name)).unwrap(), rows);
            assert!(!in_home("summary.json").exists());
        }
        fs::remove_file(in_home(name)).unwrap();
    }
    // Of other verbs: points, recording, scene.
    let points = "effects.crepitus.static_torque_nm\n2.5\n";
    fs::write(in_home("sweep.csv"), points).unwrap();
    let recorded = fs::read(recording()).unwrap();
    fs::write(in_home("report.html"), &recorded).unwrap();
    fs::write(in_home("summary.json"), scene("data/mine.csv")).unwrap();
    for arguments in [
        &[
            "sweep",
            "low-speed",
            "--points",
            "sweep.csv",
            "--format",
            "csv",
            "--out",
            ".",
        ][..],
        &["report", "report.html", "--out", "."],
        &[
            "export",
            "report.html",
            "--format",
            "csv",
            "--out",
            "./data/../report.html",
        ],
        &["report", "report.html", "--out", "o", "--wav", "x.wav"],
    ] {
        let link = in_home("x.wav");
        let _ = fs::remove_file(&link);
        fs::hard_link(in_home("report.html"), &link).unwrap();
        let output = crepitus()
            .args(arguments)
            .arg("--force")
            .current_dir(home)
            .output()
            .unwrap();
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains("an input"), "{arguments:?}: {text}");
        assert_eq!(fs::read_to_string(in_home("sweep.csv")).unwrap(), points);
        assert!(fs::read(in_home("report.html")).unwrap() == recorded);
    }
}

#[test]
fn results_of_an_earlier_version_are_named_as_such() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("place");
    let case = &CASES[0];
    let first = case.run(home.path(), &place, &[]);
    assert!(first.status.success(), "{}", stderr(&first));
    fs::remove_file(place.join(".crepitus.sha256")).unwrap();
    let output = case.run(home.path(), &place, &[]);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    for word in ["earlier versions", "trace.csv", "--force"] {
        assert!(text.contains(word), "{text}");
    }
    let output = case.run(home.path(), &place, &["--force"]);
    assert!(output.status.success(), "{}", stderr(&output));
    // From then on they are its own; one that was edited is not.
    fs::write(place.join("events.csv"), "my notes").unwrap();
    let text = stderr(&case.run(home.path(), &place, &[]));
    assert!(text.contains("events.csv (changed since"), "{text}");
    assert_eq!(fs::read(place.join("events.csv")).unwrap(), b"my notes");
}

#[test]
fn standard_output_takes_a_file_and_no_folder() {
    let home = tempfile::tempdir().unwrap();
    for case in CASES
        .iter()
        .filter(|case| matches!(case.place, Place::Folder(_)))
    {
        for place in ["-", "/dev/stdout"] {
            let output = case.run(home.path(), Path::new(place), &[]);
            let text = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{}: {text}", case.verb);
            assert!(
                text.contains("not standard output"),
                "{}: {text}",
                case.verb
            );
            assert!(output.stdout.is_empty(), "{}", case.verb);
        }
    }
    assert_eq!(names(home.path()), Vec::<String>::new());
    let piped = |arguments: &[&str]| {
        let output = crepitus()
            .args(arguments)
            .current_dir(home.path())
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(!stderr(&output).is_empty());
        output.stdout
    };
    let recording = recording().to_str().unwrap();
    for place in ["-", "/dev/stdout"] {
        let csv = piped(&["export", recording, "--format", "csv", "--out", place]);
        assert!(
            csv.starts_with(b"tick,") || csv.starts_with(b"time_s,"),
            "{:?}",
            &csv[..20]
        );
        assert!(csv.split(|c| *c == b'\n').count() > 1000);
        let sound = piped(&[&["run"], HEARD, &["--wav", place]].concat());
        assert!(sound.starts_with(b"RIFF"));
    }
    assert_eq!(names(home.path()), ["o"]);
    let export = [
        "export", recording, "--format", "csv", "--out", "-", "--json",
    ];
    let output = run(&export);
    assert_eq!(output.status.code(), Some(2));
    assert!(stdout(&output).contains("would both write to standard output"));
    support::refuses(&["record", "-", "--device", "sim"], 2, "crepitus stream");
}
