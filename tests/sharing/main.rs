//! One device and several programs, each a process of its own.
#![cfg(target_os = "linux")]

mod killed;
#[path = "../support/mod.rs"]
mod support;

use std::fs;
use std::io::{BufRead, BufReader, Lines};
use std::os::unix::fs::{MetadataExt, chown};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;
use support::served::{Served, ended, ending_signals, signal, until};
use support::{HALF_A_SECOND, names, recording, stderr, stdout};

/// Starts a program whose outputs are kept.
fn start(served: &Served, arguments: &[&str]) -> Child {
    served
        .command(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn until_armed(served: &Served) {
    until("armed", || served.info()["status"]["state"] == "armed");
}

fn file(served: &Served, name: &str) -> PathBuf {
    served.home.path().join(name)
}

/// The accounting of a recording that ended in order, recounted.
fn check_accounting(file: &Path) -> [u64; 3] {
    let recording = recording(file);
    assert!(recording.is_complete());
    let totals = support::check_accounting(&recording);
    [totals.produced, totals.received, totals.dropped]
}

#[test]
fn everything_works_while_another_program_is_armed() {
    let served = Served::new();
    let arm = start(&served, &["arm", "--zero", "--for", "60s"]);
    until_armed(&served);

    // Another terminal changes parameters, looks, streams and records.
    let set = served.run(&["params", "set", "crepitus.static_torque_nm=0.45"]);
    assert!(set.status.success(), "{}", stderr(&set));
    let streamed = served.run(&["stream", "--for", "300ms", "--rate", "1000"]);
    assert!(streamed.status.success(), "{}", stderr(&streamed));
    // 300 in time; fewer where this computer is too busy for the simulation to keep up.
    assert!(stdout(&streamed).lines().count() > 100);
    let path = file(&served, "a.csv");
    let recorded = served.run(&["record", path.to_str().unwrap(), "--for", "500ms"]);
    assert!(recorded.status.success(), "{}", stderr(&recorded));
    let [_, received, dropped] = check_accounting(&path);
    assert!(received >= 9_000 && dropped == 0, "{received} {dropped}");
    let info = served.info();
    assert_eq!(info["status"]["state"], "armed");
    assert_eq!(info["counters"]["drive"]["dropped-samples"], 0);

    // Recording with torque is refused, and leaves nothing.
    let refused = file(&served, "refused");
    let output = served.run(&["record", refused.to_str().unwrap(), "--arm", "--zero"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(!refused.exists());

    // What concerns the torque is for the one that has armed, who is named.
    let process = format!("`crepitus arm --zero --for 60s`, process {},", arm.id());
    for verb in ["disarm", "arm", "zero", "clear-fault"] {
        let refused = served.run(&[verb]);
        assert_eq!(refused.status.code(), Some(1), "{verb}");
        assert!(stderr(&refused).contains(&process), "{}", stderr(&refused));
    }
    assert!(stderr(&served.run(&["disarm"])).contains("--force"));
    assert_eq!(served.info()["status"]["state"], "armed");

    // Stopping is for everybody, and says who was armed.
    let stopped = stdout(&served.run(&["stop"]));
    assert_eq!(
        stopped,
        format!("stopped; {} had armed it\n", process.trim_end_matches(','))
    );
    let armed = arm.wait_with_output().unwrap();
    assert_eq!(armed.status.code(), Some(1));
    assert!(stderr(&armed).contains("another program has disarmed"));
    assert_eq!(served.info()["status"]["state"], "disarmed");
    assert_eq!(stdout(&served.run(&["stop"])), "stopped\n");
}

/// A program that was started without a runtime folder, as by `cron`, and one with: they meet.
#[test]
fn programs_with_different_environments_meet() {
    let served = Served::new();
    let temporary = served.home.path().join("temporary");
    fs::create_dir(&temporary).unwrap();
    let port = fs::canonicalize(served.port()).unwrap();
    let device = ["--device", port.to_str().unwrap()];
    let mut arm = served.command(&["arm", "--zero", "--for", "60s"]);
    let mut arm = arm
        .args(device)
        .env("TMPDIR", &temporary)
        .env_remove("XDG_RUNTIME_DIR")
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let with_folder = |arguments: &[&str]| {
        let mut command = served.command(arguments);
        command.args(device).env("TMPDIR", &temporary);
        command.output().unwrap()
    };
    // `arm` serves before anybody looks, as it cannot know of the other's folder.
    let mut told = BufReader::new(arm.stderr.take().unwrap()).lines();
    let armed = told.find(|line| line.as_ref().is_ok_and(|line| line.contains("disarms")));
    assert!(armed.is_some(), "it has ended");
    let info = with_folder(&["info", "--json"]);
    assert!(info.status.success(), "{}", stderr(&info));
    let stopped = with_folder(&["stop"]);
    assert!(stopped.status.success(), "{}", stderr(&stopped));
    assert!(
        stdout(&stopped).contains("had armed it"),
        "{}",
        stdout(&stopped)
    );
    assert!(!ended(&mut arm).success());
}

/// Runs the programs as an ordinary user: root may open what nobody else may.
#[test]
fn the_others_go_on_when_the_first_program_of_a_user_is_killed() {
    const NOBODY: u32 = 65_534;
    let is_root = fs::metadata("/proc/self").unwrap().uid() == 0;
    let home = tempfile::tempdir().unwrap();
    // One that this user can read.
    let program = home.path().join("program");
    fs::copy(env!("CARGO_BIN_EXE_crepitus"), &program).unwrap();
    if is_root {
        chown(home.path(), Some(NOBODY), Some(NOBODY)).unwrap();
    }
    let command = |arguments: &[&str]| {
        let mut command = Command::new(&program);
        command.args(arguments).env("XDG_RUNTIME_DIR", home.path());
        command.current_dir(home.path()).stderr(Stdio::piped());
        if is_root {
            command.uid(NOBODY).gid(NOBODY);
        }
        command
    };
    let mut simulator = command(&["serve-sim", "--name", "knee"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(simulator.stdout.as_mut().unwrap())
        .read_line(&mut line)
        .unwrap();
    assert!(line.contains("is served as"), "{line}");
    let count = || {
        let output = command(&["info", "--json"]).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
    };
    for _ in 0..3 {
        let mut first = command(&["stream", "--for", "60s"])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(first.stdout.as_mut().unwrap())
            .read_line(&mut line)
            .unwrap();
        let mut second = command(&["record", "a", "--for", "2s"]).spawn().unwrap();
        sleep(Duration::from_millis(500));
        signal(&first, "-KILL");
        first.wait().unwrap();
        assert!(ended(&mut second).success());
        count();
        assert!(
            simulator.try_wait().unwrap().is_none(),
            "the simulator has ended"
        );
        fs::remove_file(home.path().join("a")).ok();
        fs::remove_file(home.path().join("a.parquet")).ok();
    }
    simulator.kill().unwrap();
    simulator.wait().unwrap();
}

#[test]
fn disarming_by_force_is_for_everybody() {
    let served = Served::new();
    let mut arm = start(&served, &["arm", "--zero", "--for", "60s"]);
    until_armed(&served);
    let forced = served.run(&["disarm", "--force"]);
    assert!(forced.status.success(), "{}", stderr(&forced));
    assert_eq!(arm.wait().unwrap().code(), Some(1));
    let info = served.info();
    assert_eq!(info["status"]["state"], "disarmed");
    assert_eq!(info["counters"]["drive"]["faults"], 0);
}

/// The one that serves is killed: the others take over, and an armed one stays
/// armed.
#[test]
fn the_others_go_on_when_the_first_program_ends() {
    let served = Served::new();
    let [first, second, third] = ["1.csv", "2.csv", "3.csv"].map(|name| file(&served, name));
    let record = |path: &Path, more: &[&str]| {
        let arguments = [&["record", path.to_str().unwrap()], more].concat();
        let child = start(&served, &arguments);
        until("rows", || {
            fs::metadata(path).is_ok_and(|data| data.len() > 10_000)
        });
        child
    };
    let mut serving = record(&first, &[]);
    let armed = record(&second, &["--arm", "--zero"]);
    let other = record(&third, &[]);
    until_armed(&served);
    signal(&serving, "-KILL");
    serving.wait().unwrap();
    sleep(Duration::from_millis(700));
    let info = served.info();
    assert_eq!(info["status"]["state"], "armed", "{info:#}");
    for child in [&armed, &other] {
        signal(child, "-INT");
    }
    for child in [armed, other] {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(!stderr(&output).contains("lost"), "{}", stderr(&output));
    }
    for path in [&second, &third] {
        let [_, received, dropped] = check_accounting(path);
        // The time in which nobody had the port open.
        assert!(received > 10_000 && dropped < 4_000, "{received} {dropped}");
    }
    let info = served.info();
    assert_eq!(info["status"]["state"], "disarmed");
    assert_eq!(info["counters"]["drive"]["faults"], 0);
}

/// A program that is killed without being able to do anything is disarmed by
/// the one that serves.
#[test]
fn the_one_that_serves_disarms_for_a_program_that_is_killed() {
    let served = Served::new();
    let mut serving = start(&served, &["stream", "--rate", "10"]);
    until("it serves", || {
        fs::read_dir(served.home.path().join("crepitus/shared"))
            .is_ok_and(|entries| entries.count() == 2)
    });
    let mut armed = start(&served, &["arm", "--zero"]);
    until_armed(&served);
    signal(&armed, "-KILL");
    armed.wait().unwrap();
    until("disarmed", || {
        let info = served.info();
        assert_ne!(info["status"]["state"], "faulted", "{info:#}");
        info["status"]["state"] == "disarmed"
    });
    signal(&serving, "-INT");
    serving.wait().unwrap();
}

/// A program that streams. The reader is to be kept, as a closed one would end it.
fn streaming(served: &Served) -> (Child, Lines<BufReader<ChildStdout>>) {
    let mut child = start(served, &["stream", "--rate", "10"]);
    let mut rows = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(rows.nth(1).unwrap().is_ok(), "a first row");
    (child, rows)
}

/// A program's subscription with one that served before ends with that program, too.
#[test]
fn the_next_one_that_serves_knows_what_was_subscribed_before() {
    let served = Served::new();
    let port = fs::canonicalize(served.port()).unwrap();
    let stream = || streaming(&served);
    let serves = |child: &Child| {
        let files = fs::read_dir(format!("/proc/{}/fd", child.id())).unwrap();
        files
            .filter_map(|file| fs::read_link(file.ok()?.path()).ok())
            .any(|target| target == port)
    };
    let (mut first, _rows) = stream();
    assert!(serves(&first));
    let mut others = [stream(), stream()];
    signal(&first, "-INT");
    first.wait().unwrap();
    until("another serves", || {
        others.iter().any(|(child, _)| serves(child))
    });
    sleep(Duration::from_millis(300));
    others.sort_by_key(|(child, _)| serves(child));
    let [(mut member, _), (mut serving, _)] = others;
    signal(&member, "-KILL");
    member.wait().unwrap();
    sleep(Duration::from_millis(300));
    signal(&serving, "-INT");
    serving.wait().unwrap();
    let sent = || {
        served.info()["counters"]["comms"]["sent-samples"]
            .as_u64()
            .unwrap()
    };
    let before = sent();
    sleep(Duration::from_millis(500));
    assert_eq!(sent(), before, "samples are sent to nobody");
}

/// The next program that serves ends what the killed one has left open: that was reported to the
/// others.
#[test]
fn the_next_one_that_serves_ends_what_the_killed_one_has_left_open() {
    let served = Served::new();
    let (mut first, _rows) = streaming(&served);
    let armed = start(&served, &["arm", "--zero"]);
    until_armed(&served);
    // Those that wait for a reader in vain are dropped.
    let subscribed = || {
        let counters = &served.info()["counters"]["comms"];
        let count = |name: &str| counters[name].as_u64().unwrap();
        count("sent-samples") + count("dropped-samples")
    };
    let before = subscribed();
    sleep(Duration::from_millis(100));
    assert!(subscribed() > before);
    signal(&first, "-KILL");
    first.wait().unwrap();
    // Not by looking often: each look is a session, and 32 of them drive out the oldest.
    sleep(Duration::from_secs(1));
    let before = subscribed();
    sleep(Duration::from_millis(200));
    assert_eq!(subscribed(), before, "samples are sent to nobody");
    assert_eq!(served.info()["status"]["state"], "armed");
    signal(&armed, "-INT");
    assert!(armed.wait_with_output().unwrap().status.success());
}

/// A program that serves and is stopped, as by Ctrl-Z: it is reported to the others, and
/// torque has ended.
#[test]
fn a_program_that_serves_and_hangs_is_named() {
    let served = Served::new();
    let path = file(&served, "a.csv");
    let mut serving = start(
        &served,
        &["record", path.to_str().unwrap(), "--arm", "--zero"],
    );
    until("half a second is recorded", || {
        fs::metadata(&path).is_ok_and(|data| data.len() > HALF_A_SECOND)
    });
    signal(&serving, "-STOP");
    let stop = served.run(&["stop"]);
    assert_eq!(stop.status.code(), Some(1));
    let text = stderr(&stop);
    assert!(
        text.contains("does not respond") && text.contains(&serving.id().to_string()),
        "{text}"
    );
    signal(&serving, "-KILL");
    serving.wait().unwrap();
    let info = served.info();
    assert_eq!(info["status"]["state"], "faulted");
    assert!(info["faults"][0].as_str().unwrap().contains("lease"));
}

/// Removed sockets, as when the system removes the runtime folder of a user who logs out.
#[test]
fn a_program_whose_socket_was_removed_is_found_again_and_ends_in_order() {
    let served = Served::new();
    let runtime = file(&served, "runtime");
    let temporary = file(&served, "temporary");
    fs::create_dir(&temporary).unwrap();
    let port = fs::canonicalize(served.port()).unwrap();
    let command = |arguments: &[&str]| {
        let mut command = served.command(arguments);
        command
            .arg("--device")
            .arg(&port)
            .env("XDG_RUNTIME_DIR", &runtime)
            .env("TMPDIR", &temporary)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    };
    let socket = || {
        let shared = runtime.join("crepitus/shared");
        let mut names = names(&shared).into_iter();
        let name = names.find(|name| name.ends_with(".socket"));
        name.map(|name| shared.join(name))
    };
    let arm = || {
        fs::create_dir_all(&runtime).unwrap();
        let child = command(&["arm", "--zero", "--for", "60s"]).spawn().unwrap();
        until("armed", || {
            let info = command(&["info", "--json"]).output().unwrap();
            stdout(&info).contains("\"armed\"")
        });
        // One of those may have served until now.
        until("it serves", || socket().is_some());
        (child, socket().unwrap())
    };
    for lost in ["socket", "folder", "runtime folder"] {
        let (child, socket) = arm();
        let path = match lost {
            "socket" => socket,
            "folder" => runtime.join("crepitus"),
            _ => runtime.clone(),
        };
        // At once, unlike removing a folder.
        fs::rename(path, file(&served, &format!("lost {lost}"))).unwrap();
        let mut said = String::new();
        until("stopped", || {
            let output = command(&["stop"]).output().unwrap();
            said = stdout(&output);
            output.status.success()
        });
        assert!(said.contains("had armed it"), "{lost}: {said}");
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{lost}");
    }
    // Nor is a socket needed to end: none can be made where a folder is that is not empty.
    let (mut child, socket) = arm();
    let full = file(&served, "full");
    fs::create_dir_all(full.join("inside")).unwrap();
    while fs::rename(&full, &socket).is_err() {
        let _ = fs::remove_file(&socket);
    }
    signal(&child, "-TERM");
    assert!(ended(&mut child).success());
    let info = served.info();
    assert_eq!(info["status"]["state"], "disarmed");
    assert_eq!(info["counters"]["drive"]["faults"], 0);
    assert!(socket.join("inside").is_dir());
}

#[test]
fn signals_end_a_command_in_order() {
    for name in ending_signals() {
        let served = Served::new();
        let path = file(&served, "a.csv");
        let child = start(
            &served,
            &["record", path.to_str().unwrap(), "--arm", "--zero"],
        );
        // Armed, and nobody else has had the port open.
        until("half a second is recorded", || {
            fs::metadata(&path).is_ok_and(|data| data.len() > HALF_A_SECOND)
        });
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{name}: {}", stderr(&output));
        let [_, received, dropped] = check_accounting(&path);
        assert!(received > 5_000, "{name}");
        assert_eq!(dropped, 0, "{name}");
        let info = served.info();
        assert_eq!(info["counters"]["drive"]["armings"], 1, "{name}");
        assert_eq!(info["status"]["state"], "disarmed", "{name}");
        assert_eq!(info["counters"]["drive"]["faults"], 0, "{name}");
    }
}
