//! One device and several programs, each a process of its own.
#![cfg(target_os = "linux")]

mod support;

use crepitus_board::{Start, VirtualDevice};
use crepitus_protocol::State;
use crepitus_protocol::counters::CommsCounter;
use crepitus_recording::Recording;
use crepitus_scene::{Overrides, Scene};
use crepitus_usb::pty::Pty;
use std::fs;
use std::io::{BufRead, BufReader, Lines, Write};
use std::os::unix::fs::{MetadataExt, chown};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{JoinHandle, sleep};
use std::time::{Duration, Instant};
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

/// The books of a recording that ended in order, recounted.
fn check_books(file: &Path) -> [u64; 3] {
    let recording = recording(file);
    assert!(recording.is_complete());
    let totals = support::check_books(&recording);
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
    assert!(stdout(&streamed).lines().count() > 250);
    let path = file(&served, "a.csv");
    let recorded = served.run(&["record", path.to_str().unwrap(), "--for", "500ms"]);
    assert!(recorded.status.success(), "{}", stderr(&recorded));
    let [_, received, dropped] = check_books(&path);
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
    // It serves before anybody looks, as it cannot know of the other's folder.
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

/// As an ordinary user: root may open what nobody else may.
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
        let [_, received, dropped] = check_books(path);
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

/// What a program has subscribed to with one that served before ends with it, too.
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

/// What the program that serves has left open when it is killed, the next one ends: the others
/// were told of it.
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

/// A program that serves and is stopped, as by Ctrl-Z: the others are told, and
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

/// As when the system removes the runtime folder of a user who logs out.
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
        let [_, received, dropped] = check_books(&path);
        assert!(received > 5_000, "{name}");
        assert_eq!(dropped, 0, "{name}");
        let info = served.info();
        assert_eq!(info["counters"]["drive"]["armings"], 1, "{name}");
        assert_eq!(info["status"]["state"], "disarmed", "{name}");
        assert_eq!(info["counters"]["drive"]["faults"], 0, "{name}");
    }
}

/// Many programs at once, each killed sooner or later: no torque without a
/// renewal, and every sample accounted for. A minute of it with
/// `CREPITUS_LONG=1`, three seconds without.
#[test]
fn many_programs_are_killed_at_random() {
    const PROGRAMS: usize = 20;
    let is_long = std::env::var_os("CREPITUS_LONG").is_some();
    let duration = Duration::from_secs(if is_long { 60 } else { 3 });
    let bench = Bench::start();
    let mut rng = fastrand::Rng::with_seed(16);
    let signals = [ending_signals(), vec!["-KILL"]].concat();
    let mut files = Vec::new();
    let mut running: Vec<Child> = Vec::new();
    let (mut kills, mut ended_in_order) = (0, 0);
    let begun = Instant::now();
    while begun.elapsed() < duration {
        while running.len() < PROGRAMS {
            let path = bench.home.path().join(format!("{}.csv", files.len()));
            let file = path.to_str().unwrap().to_owned();
            let arguments = match rng.u8(0..10) {
                0..=3 => vec!["record", &file],
                4 => vec!["record", &file, "--arm", "--zero"],
                5 | 6 => vec!["stream", "--rate", "100"],
                7 => vec!["arm", "--zero"],
                8 => vec!["params", "set", "crepitus.static_torque_nm=0.42"],
                _ => vec!["stream", "--rate", "10", "--arm", "--zero"],
            };
            if arguments[0] == "record" {
                files.push(path.clone());
            }
            running.push(bench.spawn(&arguments));
        }
        sleep(Duration::from_millis(rng.u64(0..60)));
        let victim = rng.usize(0..running.len());
        signal(&running[victim], rng.choice(&signals).unwrap());
        kills += 1;
        let mut child = running.swap_remove(victim);
        ended_in_order += usize::from(ended(&mut child).code().is_some());
    }
    for child in &running {
        signal(child, "-INT");
    }
    for mut child in running {
        ended(&mut child);
    }
    sleep(Duration::from_millis(400));
    let (observed, _home) = bench.stop();
    println!("{kills} signals, {ended_in_order} programs ended in order, {observed:?}");
    assert!(observed.longest_without_renewal <= 5_001, "{observed:?}");
    assert!(
        observed.driven_ticks > 0 && !observed.is_driven,
        "{observed:?}"
    );
    let (mut rows, mut complete) = (0, 0);
    for path in files.iter().filter(|path| path.exists()) {
        let recording = readable(path);
        rows += recording.books().totals.received;
        complete += usize::from(recording.is_complete());
    }
    println!(
        "{rows} rows in {} recordings, {complete} of them complete",
        files.len()
    );
    assert!(rows > 10_000 && complete > 3);
}

/// A recording, complete or not, whose books are true.
fn readable(path: &Path) -> Recording {
    let recording = recording(path);
    support::check_books(&recording);
    if !recording.is_complete() {
        let warnings = recording.warnings();
        assert!(warnings[0].contains("incomplete"), "{warnings:?}");
    }
    recording
}

/// `record --arm` is killed at any instant: the file is there and true, or not
/// there; torque is off. 500 kills with `CREPITUS_LONG=1`, 16 without.
#[test]
fn record_is_killed_at_any_instant() {
    let is_long = std::env::var_os("CREPITUS_LONG").is_some();
    let kills = if is_long { 500 } else { 16 };
    let bench = Bench::start();
    let mut rng = fastrand::Rng::with_seed(500);
    let signals = [ending_signals(), vec!["-KILL"]].concat();
    let (mut absent, mut cut, mut complete, mut samples, mut expired) = (0, 0, 0, 0, 0);
    for n in 0..kills {
        let path = bench.home.path().join(format!("recording {n}.json"));
        let mut child = bench.spawn(&["record", path.to_str().unwrap(), "--arm", "--zero"]);
        // As often while it begins as when torque is on.
        let ms = if rng.bool() {
            rng.u64(0..80)
        } else {
            rng.u64(80..600)
        };
        sleep(Duration::from_millis(ms));
        let name = signals[n % signals.len()];
        signal(&child, name);
        let status = child.wait().unwrap();
        let ended_in_order = status.code().is_some();
        if ended_in_order {
            // Torque is off when the program has ended.
            sleep(Duration::from_millis(5));
            assert!(!bench.is_driven(), "{name} after {ms} ms");
        }
        if path.exists() {
            let recording = readable(&path);
            // A program that had not come to its handlers is killed by them all.
            assert!(
                !ended_in_order || recording.is_complete(),
                "{name} after {ms} ms"
            );
            samples += recording.books().totals.received;
            complete += usize::from(recording.is_complete());
            cut += usize::from(!recording.is_complete());
        } else {
            absent += 1;
        }
        // The next one can arm only if nothing is left of this one.
        until("the lease has ended", || !bench.is_driven());
        sleep(Duration::from_millis(260));
        expired += usize::from(bench.is_faulted());
        bench.spawn(&["clear-fault"]).wait().unwrap();
    }
    let others: Vec<_> = fs::read_dir(bench.home.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.starts_with(".crepitus-"))
        .collect();
    let (observed, _home) = bench.stop();
    println!(
        "{kills} kills: {absent} without a file, {cut} cut off, {complete} complete, {samples} samples, \
         {expired} leases expired; {} temporary files left; {observed:?}",
        others.len()
    );
    assert!(observed.longest_without_renewal <= 5_001, "{observed:?}");
    assert!(observed.driven_ticks > 0 && cut > 0 && complete > 0);
    assert!(expired > 0 || !is_long, "no lease was ever left to expire");
    assert!(others.len() <= kills / 4, "only SIGKILL leaves any");
}

/// A simulated device in this process, in real time, at a pty.
struct Bench {
    home: tempfile::TempDir,
    is_over: Arc<AtomicBool>,
    now: Arc<Now>,
    thread: JoinHandle<Observed>,
}

/// What the simulator has seen of the torque.
#[derive(Clone, Copy, Debug, Default)]
struct Observed {
    driven_ticks: u64,
    /// Most ticks from a renewal, or from arming, to torque.
    longest_without_renewal: u64,
    is_driven: bool,
}

/// State of the device at this moment.
#[derive(Debug, Default)]
struct Now {
    is_driven: AtomicBool,
    is_faulted: AtomicBool,
}

impl Bench {
    fn is_driven(&self) -> bool {
        self.now.is_driven.load(Ordering::Relaxed)
    }

    fn is_faulted(&self) -> bool {
        self.now.is_faulted.load(Ordering::Relaxed)
    }

    fn start() -> Self {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("crepitus");
        fs::create_dir(&folder).unwrap();
        // As a program that serves the name has it.
        let lock = fs::File::create(folder.join("knee.lock")).unwrap();
        lock.lock().unwrap();
        let is_over = Arc::new(AtomicBool::new(false));
        let over = is_over.clone();
        let now = Arc::new(Now::default());
        let of_device = now.clone();
        let link = folder.join("knee");
        let (ready, is_ready) = std::sync::mpsc::channel();
        let thread = std::thread::spawn(move || {
            let scene = include_str!("../scenes/passive-examination.toml");
            let scene = Scene::parse(Path::new("knee.toml"), scene, &Overrides::default()).unwrap();
            let mut device = VirtualDevice::of(&scene, &Start::default()).unwrap();
            let mut pty = Pty::new(Some(&link)).unwrap();
            writeln!(&lock, "{}", fs::read_link(&link).unwrap().display()).unwrap();
            ready.send(()).unwrap();
            let observed = observe(&mut device, &mut pty, &over, &of_device);
            drop(lock);
            observed
        });
        is_ready.recv().unwrap();
        Self {
            home,
            is_over,
            now,
            thread,
        }
    }

    fn spawn(&self, arguments: &[&str]) -> Child {
        support::crepitus()
            .args(arguments)
            .env("XDG_RUNTIME_DIR", self.home.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    }

    fn stop(self) -> (Observed, tempfile::TempDir) {
        self.is_over.store(true, Ordering::Relaxed);
        (self.thread.join().unwrap(), self.home)
    }
}

/// Runs the device in real time; where the machine is too slow for that, time
/// passes more slowly.
fn observe(device: &mut VirtualDevice, pty: &mut Pty, over: &AtomicBool, now: &Now) -> Observed {
    const TICKS_PER_MS: u64 = 20;
    let mut observed = Observed::default();
    let (mut renewals, mut was_arming, mut renewed) = (0, false, None);
    while !over.load(Ordering::Relaxed) {
        let begun = Instant::now();
        for _ in 0..TICKS_PER_MS {
            device.tick();
            let board = device.board();
            let now_renewals = board.comms().counters().get(CommsCounter::Renewals);
            let is_arming = board.comms().state() == State::Arming;
            if now_renewals != renewals || is_arming && !was_arming {
                renewed = Some(board.now());
            }
            (renewals, was_arming) = (now_renewals, is_arming);
            observed.is_driven = board.is_driven();
            if observed.is_driven {
                observed.driven_ticks += 1;
                let silence = board.now() - renewed.expect("a renewal");
                observed.longest_without_renewal = observed.longest_without_renewal.max(silence);
            }
        }
        now.is_driven.store(observed.is_driven, Ordering::Relaxed);
        let is_faulted = device.board().comms().state() == State::Faulted;
        now.is_faulted.store(is_faulted, Ordering::Relaxed);
        pty.exchange(device.host().expect("a cable")).unwrap();
        sleep(Duration::from_millis(1).saturating_sub(begun.elapsed()));
    }
    observed
}
