//! Programs that are killed at any instant: nothing stays driven, and every file can be read.

use super::support;
use crepitus_protocol::State;
use crepitus_protocol::counters::CommsCounter;
use crepitus_recording::Recording;
use crepitus_scene::{Overrides, Scene};
use crepitus_virtual_device::usb::pty::Pty;
use crepitus_virtual_device::{Start, VirtualDevice};
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{JoinHandle, sleep};
use std::time::{Duration, Instant};
use support::recording;
use support::served::{ended, ending_signals, signal, until};

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
        rows += recording.accounting().totals.received;
        complete += usize::from(recording.is_complete());
    }
    println!(
        "{rows} rows in {} recordings, {complete} of them complete",
        files.len()
    );
    assert!(rows > 10_000 && complete > 3);
}

/// A recording, complete or not, whose accounting is true.
fn readable(path: &Path) -> Recording {
    let recording = recording(path);
    support::check_accounting(&recording);
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
            samples += recording.accounting().totals.received;
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

/// Torque over the whole run, as the simulator measured it.
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
            let scene = include_str!("../../scenes/passive-examination.toml");
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
