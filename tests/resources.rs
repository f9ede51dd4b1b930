//! A run takes no more memory for being long, and a disk that is full costs
//! nothing but the run.
#![cfg(target_os = "linux")]

mod support;

use std::process::{Command, Stdio};
use std::time::Duration;
use support::{crepitus, names, stderr};

/// Highest resident memory of a run of so many simulated seconds, kB.
fn peak_kb(seconds: u32) -> u64 {
    let home = tempfile::tempdir().unwrap();
    let mut child = crepitus()
        .args([
            "run",
            "slow-examination",
            "--set",
            &format!("duration_s={seconds}"),
        ])
        .args(["--out", home.path().join("out").to_str().unwrap()])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
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
    let (short, long) = (peak_kb(5), peak_kb(60));
    println!("peak memory: {short} kB for 100 thousand rows, {long} kB for 1.2 million");
    assert!(long < short + 8_000, "{short} kB, then {long} kB");
    assert!(long < 100_000, "{long} kB");
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
        .args([
            "run",
            "slow-examination",
            "--set",
            "duration_s=100000",
            "--out",
        ])
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
