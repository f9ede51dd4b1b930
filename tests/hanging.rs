//! Failures of others: a program that passes samples on hangs, nobody reads what is written, a device is gone
//! and its name is another's. Each a process of its own.
#![cfg(target_os = "linux")]

mod support;

use crepitus_virtual_device::usb::pty::Pty;
use std::fs;
use std::io::Read;
use std::os::fd::AsFd;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use support::served::{Served, ended, ending_signals, signal, until};
use support::{HALF_A_SECOND, recording, stderr, stdout};

fn start(served: &Served, arguments: &[&str], out: Stdio) -> Child {
    served
        .command(arguments)
        .stdout(out)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn said(child: &mut Child) -> String {
    let mut text = String::new();
    child
        .stderr
        .as_mut()
        .unwrap()
        .read_to_string(&mut text)
        .unwrap();
    text
}

fn state(served: &Served) -> String {
    served.info()["status"]["state"]
        .as_str()
        .unwrap()
        .to_owned()
}

fn file(served: &Served, name: &str) -> PathBuf {
    served.home.path().join(name)
}

fn until_half_a_second_is_in(path: &Path) {
    until("half a second is recorded", || {
        fs::metadata(path).is_ok_and(|data| data.len() > HALF_A_SECOND)
    });
}

/// The device goes on, and its samples come nowhere: no gap in the file tells of them.
#[test]
fn a_recording_whose_last_samples_a_hanging_program_has_is_not_complete() {
    let served = Served::new();
    let mut hub = start(&served, &["stream", "--for", "60s"], Stdio::null());
    until("it serves", || {
        served.run(&["info"]).status.success() && fs::read_dir(file(&served, "crepitus")).is_ok()
    });
    let path = file(&served, "a");
    let arguments = ["record", path.to_str().unwrap(), "--for", "3s"];
    let mut recorder = start(&served, &arguments, Stdio::null());
    until_half_a_second_is_in(&path);
    signal(&hub, "-STOP");
    let status = ended(&mut recorder);
    let text = said(&mut recorder);
    signal(&hub, "-KILL");
    hub.wait().unwrap();
    assert_eq!(status.code(), Some(1), "{text}");
    assert!(text.contains("nothing was heard for the last"), "{text}");
    assert!(text.contains("the recording is not complete"), "{text}");
    // Which program it is, is said before.
    let is_named = text.contains("does not respond") && text.contains(&hub.id().to_string());
    assert!(is_named, "{text}");
    assert!(!recording(&path).is_complete());
}

/// As when the computer sleeps from half a second on, to the end of the time and longer.
#[test]
fn a_recording_whose_end_was_slept_through_counts_what_is_missing() {
    let served = Served::new();
    let path = file(&served, "a");
    let arguments = ["record", path.to_str().unwrap(), "--for", "2s"];
    let mut recorder = start(&served, &arguments, Stdio::null());
    until_half_a_second_is_in(&path);
    signal(&recorder, "-STOP");
    sleep(Duration::from_secs(3));
    signal(&recorder, "-CONT");
    let status = ended(&mut recorder);
    let text = said(&mut recorder);
    assert_eq!(status.code(), Some(1), "{text}");
    assert!(
        text.contains("missing at the end of the recording"),
        "{text}"
    );
    let recording = recording(&path);
    let totals = recording.accounting().totals;
    assert!(totals.produced > 55_000, "{totals:?}");
    assert!(totals.dropped > 30_000, "{totals:?}");
    let warnings = recording.warnings().join("\n");
    assert!(warnings.contains("samples"), "{warnings}");
    let out = file(&served, "out");
    let report = served.run(&[
        "report",
        path.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    assert!(report.status.success(), "{}", stderr(&report));
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("are missing"));
}

/// Stalled reader, as a pager whose user has gone, or a terminal that was stopped by Ctrl-S.
#[test]
fn a_program_that_nobody_reads_obeys_signals() {
    let served = Served::new();
    for name in ending_signals() {
        let arguments = ["stream", "--arm", "--zero", "--rate", "20000"];
        let mut child = start(&served, &arguments, Stdio::piped());
        // The pipe is full, and the program waits: the lease ends.
        until("the lease ends", || state(&served) == "faulted");
        let begun = Instant::now();
        signal(&child, name);
        ended(&mut child);
        assert!(begun.elapsed() < Duration::from_secs(5), "{name}");
        assert!(served.run(&["clear-fault"]).status.success());
    }
}

#[test]
fn a_program_that_looks_for_its_device_obeys_signals() {
    let served = Served::new();
    let path = file(&served, "a");
    let arguments = ["record", path.to_str().unwrap()];
    let mut recorder = start(&served, &arguments, Stdio::null());
    until_half_a_second_is_in(&path);
    let _home = served.kill();
    sleep(Duration::from_millis(500));
    let begun = Instant::now();
    signal(&recorder, "-TERM");
    ended(&mut recorder);
    assert!(begun.elapsed() < Duration::from_secs(3));
    // What the device has done since is not known.
    assert!(!recording(&path).is_complete(), "{}", said(&mut recorder));
}

/// The number of a pseudo-terminal that is closed is given to the next one.
#[test]
fn another_terminal_of_the_same_number_is_no_device() {
    let served = Served::new();
    let port = fs::canonicalize(served.port()).unwrap();
    let path = file(&served, "a");
    let arguments = [
        "record",
        path.to_str().unwrap(),
        "--device",
        port.to_str().unwrap(),
    ];
    let mut recorder = start(&served, &arguments, Stdio::null());
    until_half_a_second_is_in(&path);
    let _home = served.kill();
    let mut others = Vec::new();
    until("its number is given again", || {
        others.push(Pty::new(None).unwrap());
        others.last().unwrap().path() == port
    });
    let mut heard = fs::File::from(others.last().unwrap().as_fd().try_clone_to_owned().unwrap());
    sleep(Duration::from_secs(1));
    assert_eq!(heard.read(&mut [0; 200]).unwrap_or(0), 0);
    signal(&recorder, "-TERM");
    ended(&mut recorder);
}

/// Stop with a full disk, or with a file where the folder should be.
#[test]
fn a_stop_needs_no_folder() {
    let served = Served::new();
    let port = fs::canonicalize(served.port()).unwrap();
    let runtime = file(&served, "runtime");
    fs::create_dir_all(runtime.join("crepitus")).unwrap();
    fs::write(runtime.join("crepitus/shared"), "").unwrap();
    let run = |verb: &str| {
        served
            .command(&[verb, "--device", port.to_str().unwrap()])
            .env("XDG_RUNTIME_DIR", &runtime)
            .output()
            .unwrap()
    };
    let info = run("info");
    assert_eq!(info.status.code(), Some(2));
    assert!(
        stderr(&info).contains("cannot be shared"),
        "{}",
        stderr(&info)
    );
    let stop = run("stop");
    assert!(stop.status.success(), "{}", stderr(&stop));
    assert_eq!(stdout(&stop), "stopped\n");
}
