//! A run takes no more memory for being long, and a disk that is full costs
//! nothing but the run.
#![cfg(target_os = "linux")]

mod support;

use crepitus_protocol::management::Identity;
use crepitus_protocol::telemetry::{Block, BlockFlags};
use crepitus_protocol::{State, Values};
use crepitus_recording::{Begin, Metadata, Recorder};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use support::{crepitus, names, stderr, words};

/// Highest resident memory of a run of so many simulated seconds, kB.
fn peak_of_run_kb(seconds: u32) -> u64 {
    let home = tempfile::tempdir().unwrap();
    let to = home.path().join("out").display().to_string();
    let line = format!("run slow-examination --set duration_s={seconds} --out {to}");
    peak_kb(&words(&line))
}

/// Longest time of a command.
const LONGEST: Duration = Duration::from_mins(2);

/// Highest resident memory of a command that succeeds, kB.
fn peak_kb(arguments: &[&str]) -> u64 {
    let mut child = crepitus()
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > LONGEST {
            child.kill().unwrap();
            panic!("{arguments:?} still runs");
        }
        // The high-water mark; the file is empty once the program has ended.
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        if let Some(line) = text.lines().find(|l| l.starts_with("VmHWM")) {
            peak = line.split_whitespace().nth(1).unwrap().parse().unwrap();
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(child.wait().unwrap().success());
    peak
}

#[test]
fn memory_does_not_grow_with_the_duration() {
    let (short, long) = (peak_of_run_kb(5), peak_of_run_kb(60));
    println!("peak memory: {short} kB for 100 thousand rows, {long} kB for 1.2 million");
    assert!(long < short + 8_000, "{short} kB, then {long} kB");
    assert!(long < 100_000, "{long} kB");
}

/// A recording with right checksums: half a second before a gap of so many ticks, and half a second
/// after it, `times` times.
fn with_gaps(file: &Path, gap: u64, times: u64) {
    let metadata = Metadata::new("a gap", &Identity::default(), None);
    let mut recorder = Recorder::create(file, &metadata).unwrap();
    recorder
        .subscribed(Begin {
            start: 1,
            ..Begin::default()
        })
        .unwrap();
    recorder.announce(Block::default().revision, &Values::default());
    let mut tick = 0;
    for _ in 0..=times {
        for _ in 0..500 {
            let block = Block {
                first_tick: tick,
                flags: BlockFlags::new(State::Armed, true, 1),
                ..Block::default()
            };
            recorder.block(&block).unwrap();
            tick += 20;
        }
        tick += gap;
    }
    recorder.finish().unwrap();
}

/// Sizes follow the samples of a file, not the times that it says they have.
#[test]
fn a_gap_in_time_takes_no_memory() {
    const DAY: u64 = 86_400 * 20_000;
    let home = tempfile::tempdir().unwrap();
    let at = |name: &str| home.path().join(name).display().to_string();
    for (name, gap, times) in [("none", 0, 8), ("days", DAY, 8), ("centuries", 1 << 47, 1)] {
        let file = at(name);
        with_gaps(Path::new(&file), gap, times);
        let out = |form: &str| at(&format!("{name}.{form}"));
        let parquet = out("parquet");
        for arguments in [
            vec!["report", &file, "--out", &out("report")],
            vec!["export", &file, "--format", "csv", "--out", &out("csv")],
            vec!["export", &file, "--format", "mcap", "--out", &out("mcap")],
            vec!["export", &file, "--format", "parquet", "--out", &parquet],
            vec!["report", &parquet, "--out", &out("second")],
        ] {
            let peak = peak_kb(&arguments);
            assert!(peak < 150_000, "{arguments:?}: {peak} kB");
        }
        // A sound keeps the time, and is refused where it would be too long.
        let (folder, wav) = (out("wav"), out("wav.wav"));
        let output = crepitus()
            .args(["report", &file, "--out", &folder, "--wav", &wav])
            .output()
            .unwrap();
        assert_eq!(output.status.success(), gap == 0, "{}", stderr(&output));
        assert!(gap == 0 || stderr(&output).contains("holds 12 hours"));
        // The estimator refuses it by its own checks, and does not abort.
        let output = crepitus()
            .args(["identify", &file, "--weight-kg", "1", "--lever-m", "0.2"])
            .output()
            .unwrap();
        let code = output.status.code();
        assert!(matches!(code, Some(1 | 2)), "{name}: {}", stderr(&output));
    }
}

#[test]
fn a_full_disk_is_an_error_and_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("out");
    // No file may grow beyond 200 blocks of 512 bytes: the write fails as on
    // a full disk.
    let script = format!(
        "trap '' XFSZ; ulimit -f 200; exec '{}' run slow-examination --out '{}'",
        env!("CARGO_BIN_EXE_crepitus"),
        out.display()
    );
    let output = Command::new("sh").args(["-c", &script]).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("writing the results"),
        "{}",
        stderr(&output)
    );
    assert_eq!(names(home.path()), Vec::<String>::new());
}

#[test]
fn an_interrupt_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    let mut child = crepitus()
        .args(words("run slow-examination --set duration_s=100000 --out"))
        .arg(home.path().join("out"))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // Under way as soon as it has begun to write.
    while names(home.path()).is_empty() {
        std::thread::sleep(Duration::from_millis(2));
    }
    std::thread::sleep(Duration::from_millis(100));
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(kill.success());
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(names(home.path()), Vec::<String>::new());
}
