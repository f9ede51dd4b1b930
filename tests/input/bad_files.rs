//! Every verb and flag that reads a file gets each kind of bad file: a folder, a pipe that nobody writes
//! to, a device without an end, a socket, a giant, a file without permission, a link to nothing. None
//! may wait, take memory or panic; each says what it has found.

mod uses;

use super::support::{crepitus, stderr, stdout};
use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::os::unix::net::UnixListener;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};
use uses::Use::{Endless, Ends, Every, Written};
use uses::{NO_FILES, USES};

/// Longest time of a case: on a busy computer, too, it takes a tenth.
const TIMEOUT: Duration = Duration::from_secs(20);

/// Most address space of a case, kB: threads and the program itself take most of it.
const MEMORY_KB: u32 = 3_000_000;

/// Bad files by name, with parts of the error of a reader that expects a regular file, of which one is there.
const KINDS: [(&str, &str); 7] = [
    ("folder", "a folder"),
    ("pipe", "a pipe"),
    ("device", "a device"),
    ("socket", "a socket"),
    ("giant", ""),
    ("forbidden", ""),
    ("dangling", "does not exist|there is no|No such file"),
];

/// Those that a reader could wait for or read for ever.
const ENDLESS: [usize; 2] = [1, 2];

fn help(arguments: &[&str]) -> String {
    let output = crepitus().args(arguments).arg("--help").output().unwrap();
    stdout(&output)
}

/// The commands below a verb, or of the program.
fn commands(help: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    lines
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

/// The arguments of a command that have a value: flag or placeholder, and placeholder.
fn arguments(verb: &str, help: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let words = verb.split_whitespace().count() + 2;
    let usage = help
        .lines()
        .find(|line| line.starts_with("Usage:"))
        .unwrap_or_default();
    let mut is_value = false;
    for word in usage.split_whitespace().skip(words) {
        let name = word.trim_matches(|c| "<>[].".contains(c));
        if !std::mem::replace(&mut is_value, word.starts_with("--"))
            && !is_value
            && name != "OPTIONS"
        {
            found.push((name.to_owned(), name.to_owned()));
        }
    }
    for line in help
        .lines()
        .map(str::trim_start)
        .filter(|line| line.starts_with('-'))
    {
        let Some((_, rest)) = line.split_once("--") else {
            continue;
        };
        let name: String = rest
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '-')
            .collect();
        let Some(value) = rest[name.len()..]
            .trim_start_matches([' ', '['])
            .strip_prefix('<')
        else {
            continue;
        };
        if let Some((value, _)) = value.split_once('>') {
            found.push((format!("--{name}"), value.to_owned()));
        }
    }
    found
}

/// A verb or flag that reads a file cannot be forgotten.
#[test]
fn the_list_has_every_argument_of_the_program() {
    let mut unlisted = BTreeSet::new();
    let mut listed: BTreeSet<_> = USES.iter().map(|(name, _)| *name).collect();
    assert_eq!(listed.len(), USES.len(), "one is listed twice");
    let mut check = |verb: &str, help: &str, is_below: bool| {
        for (name, value) in arguments(verb, help) {
            // Those of all commands below a verb are listed once.
            let of = verb.split_whitespace().next().unwrap_or_default();
            let key = match name.as_str() {
                "--scene" if is_below => format!("{of} {name}"),
                _ => format!("{verb} {name}"),
            };
            if !listed.remove(key.as_str())
                && !USES.iter().any(|(name, _)| *name == key)
                && !NO_FILES.contains(&value.as_str())
            {
                unlisted.insert(format!("{key} <{value}>"));
            }
        }
    };
    let verbs = commands(&help(&[]));
    assert!(verbs.len() > 20, "{verbs:?}");
    for verb in &verbs {
        let text = help(&[verb]);
        check(verb, &text, false);
        for below in commands(&text) {
            check(&format!("{verb} {below}"), &help(&[verb, &below]), true);
        }
    }
    assert!(
        unlisted.is_empty(),
        "arguments without a case: {unlisted:?}"
    );
    assert!(listed.is_empty(), "cases of no argument: {listed:?}");
}

/// The bad files, and `abx.toml`, a protocol, in a folder.
fn bad_files(folder: &Path) -> UnixListener {
    let at = |name: &str| folder.join(name);
    fs::create_dir(at("folder")).unwrap();
    let made = Command::new("mkfifo").arg(at("pipe")).status().unwrap();
    assert!(made.success());
    symlink("/dev/zero", at("device")).unwrap();
    // Sparse: it takes no room on the disk.
    fs::File::create(at("giant"))
        .unwrap()
        .set_len(1 << 40)
        .unwrap();
    fs::write(at("forbidden"), "of no use").unwrap();
    fs::set_permissions(at("forbidden"), fs::Permissions::from_mode(0o000)).unwrap();
    symlink("nothing", at("dangling")).unwrap();
    let abx = "title = 'A or B'\n[abx]\ntrials = 2\na = {}\nb = { preset = 'coarse' }";
    fs::write(at("abx.toml"), abx).unwrap();
    UnixListener::bind(at("socket")).unwrap()
}

/// Runs a command with little memory; none if it has not ended in time.
fn limited(arguments: &[String]) -> Option<Output> {
    let mut shell = Command::new("sh");
    let script = format!("ulimit -v {MEMORY_KB}; exec \"$@\"");
    shell.args(["-c", &script, "sh", env!("CARGO_BIN_EXE_crepitus")]);
    let mut child = shell
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > TIMEOUT {
            child.kill().unwrap();
            child.wait().unwrap();
            return None;
        }
        thread::sleep(Duration::from_millis(5));
    }
    Some(child.wait_with_output().unwrap())
}

/// Fault of a case, if it has one.
fn fault(folder: &Path, number: usize, case: (&str, bool, usize)) -> Option<String> {
    let (template, only_ends, kind) = case;
    let (name, parts) = KINDS[kind];
    let place = |name: &str| folder.join(name).display().to_string();
    let arguments: Vec<_> = template
        .split(' ')
        .map(|word| match word {
            "{}" => place(name),
            "{ok}" => place("ok.crepitus"),
            "{csv}" => place("chirp.csv"),
            "{abx}" => place("abx.toml"),
            "{out}" => place(&format!("out-{number}")),
            word => word.to_owned(),
        })
        .collect();
    let case = arguments.join(" ");
    let Some(output) = limited(&arguments) else {
        return Some(format!("{case}: still runs after {} s", TIMEOUT.as_secs()));
    };
    let said = stderr(&output);
    let is_named = parts.split('|').any(|part| said.contains(part));
    let code = output.status.code();
    let is_right = (only_ends || code == Some(2) && is_named) && !said.contains("panicked");
    (!is_right).then(|| format!("{case}: {code:?}, expected 2 and {parts:?}: {said}"))
}

#[test]
fn no_verb_waits_for_a_bad_file_or_reads_it_for_ever() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path();
    let _socket = bad_files(folder);
    let ok = folder.join("ok.crepitus");
    let recorded = crepitus()
        .args([
            "record",
            ok.to_str().unwrap(),
            "--device",
            "sim",
            "--for",
            "100ms",
        ])
        .output()
        .unwrap();
    assert!(recorded.status.success(), "{}", stderr(&recorded));
    fs::write(folder.join("chirp.csv"), chirp()).unwrap();
    let mut cases = Vec::new();
    for (_, used) in USES {
        match used {
            Every(case) => cases.extend((0..KINDS.len()).map(|kind| (*case, false, kind))),
            Endless(case) => cases.extend(ENDLESS.map(|kind| (*case, false, kind))),
            Ends(case) => cases.extend(ENDLESS.map(|kind| (*case, true, kind))),
            Written => {}
        }
    }
    let next = AtomicUsize::new(0);
    let work = || {
        let mut faults = Vec::new();
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(case) = cases.get(number) else {
                return faults;
            };
            faults.extend(fault(folder, number, *case));
        }
    };
    let faults: Vec<_> = thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(work)).collect();
        threads
            .into_iter()
            .flat_map(|thread| thread.join().unwrap())
            .collect()
    });
    assert!(
        faults.is_empty(),
        "{} of {}:\n{}",
        faults.len(),
        cases.len(),
        faults.join("\n")
    );
}

/// A chirp that can be read.
fn chirp() -> String {
    let row = |n: i32| {
        let t_s = f64::from(n) * 1e-3;
        let volts = (std::f64::consts::TAU * (8.0 + 4.0 * t_s) * t_s).sin();
        format!("{t_s},{volts},{}\n", 0.1 * volts)
    };
    let rows = (0..10_000).map(row);
    rows.fold("t_s,volts,amperes\n".to_owned(), |text, row| text + &row)
}

/// Files that are read without being named: a scene's motion, one's own presets, results of before.
#[test]
fn nor_for_a_file_that_it_finds_by_itself() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path();
    let _socket = bad_files(folder);
    let presets = folder.join("presets");
    fs::create_dir(&presets).unwrap();
    let bad = ["pipe", "device", "socket", "giant", "dangling"];
    for name in bad {
        symlink(folder.join(name), presets.join(name).with_extension("toml")).unwrap();
        let scene = format!(
            "version = 1\ntitle = \"bad\"\nduration_s = 1\n[motion]\nkind = \"recording\"\nfile = '{name}'\n\
             time_column = \"t\"\nangle_column = \"a\"\nunit = \"deg\"\n[solver]\nkind = \"exact\"\nstep_s = 1e-3\n\
             [effects.crepitus]\n"
        );
        fs::write(folder.join("motion.toml"), scene).unwrap();
        let file = folder.join("motion.toml").display().to_string();
        let out = folder.join("out").display().to_string();
        let output = limited(&["run", &file, "--out", &out].map(str::to_owned)).expect("in time");
        assert_eq!(output.status.code(), Some(2), "{name}: {}", stderr(&output));
    }
    let begun = Instant::now();
    let output = crepitus()
        .env("CREPITUS_PRESETS", &presets)
        .arg("presets")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(begun.elapsed() < TIMEOUT);
    for (name, part) in bad.iter().zip([
        "a pipe",
        "a device",
        "a socket",
        "longer than",
        "does not exist",
    ]) {
        let said = stderr(&output);
        let is_named = said
            .lines()
            .any(|line| line.contains(name) && line.contains(part));
        assert!(is_named, "{name}: {said}");
    }
    // A sweep's own notes, and results of before.
    for (name, arguments) in [
        (
            "sweep.json",
            "sweep fig6-ideal-cycle --vary duration_s=0.1 --out {out}",
        ),
        ("summary.json", "report {ok} --out {out}"),
    ] {
        let out = folder.join(format!("has-{name}"));
        fs::create_dir(&out).unwrap();
        symlink(folder.join("pipe"), out.join(name)).unwrap();
        let ok = folder.join("ok.crepitus").display().to_string();
        let words = arguments
            .replace("{out}", &out.display().to_string())
            .replace("{ok}", &ok);
        let words: Vec<_> = words.split(' ').map(str::to_owned).collect();
        assert!(limited(&words).is_some(), "{name}: waits");
    }
}
