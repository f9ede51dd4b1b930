//! Time, size and memory of recordings, exports and reports.

use crate::support::{self, crepitus};
use crate::text;
use std::fs;

/// Cost of a program.
#[derive(Clone, Copy)]
struct Took {
    seconds: f64,
    /// Its highest memory, kB.
    kilobytes: u64,
}

impl std::fmt::Display for Took {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let megabytes = self.kilobytes / 1_000;
        write!(f, "{:.2} s, at most {megabytes} MB of memory", self.seconds)
    }
}

fn took(arguments: &[&str]) -> Took {
    let begun = std::time::Instant::now();
    let mut child = crepitus()
        .args(arguments)
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let mut kilobytes = 0;
    let status = loop {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let highest = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let now = highest.and_then(|text| text.trim().strip_suffix(" kB")?.parse().ok());
        kilobytes = kilobytes.max(now.unwrap_or(0));
        match child.try_wait().unwrap() {
            Some(status) => break status,
            None => std::thread::sleep(std::time::Duration::from_millis(2)),
        }
    };
    assert!(status.success(), "{arguments:?}");
    Took {
        seconds: begun.elapsed().as_secs_f64(),
        kilobytes,
    }
}

/// Time and size of each format, and memory over a long recording: a minute and
/// an hour of device time with `CREPITUS_LONG=1`, five and twenty seconds
/// without.
#[test]
fn memory_does_not_grow_with_the_recording() {
    let is_long = std::env::var_os("CREPITUS_LONG").is_some();
    let durations = if is_long {
        ["60s", "60m"]
    } else {
        ["5s", "20s"]
    };
    let home = tempfile::tempdir().unwrap();
    let mut highest = Vec::new();
    for duration in durations {
        let file = home.path().join(duration);
        let mut all = vec![took(&[
            "record",
            text(&file),
            "--device",
            "sim",
            "--arm",
            "--zero",
            "--for",
            duration,
        ])];
        println!("record --for {duration}: {}", all[0]);
        for format in ["csv", "parquet", "mcap"] {
            let out = home.path().join("out");
            let took = took(&[
                "export",
                text(&file),
                "--format",
                format,
                "--out",
                text(&out),
            ]);
            println!(
                "{duration} as {format}: {took}, {} bytes",
                support::length(&out)
            );
            fs::remove_file(out).unwrap();
            all.push(took);
        }
        all.push(took(&[
            "report",
            text(&file),
            "--out",
            text(&home.path().join(format!("report-{duration}"))),
        ]));
        println!("report of {duration}: {}", all[4]);
        highest.push(all);
    }
    // Fifteen seconds of samples are few: 14 bytes of each would be as much.
    let most = if is_long { 24_000 } else { 4_000 };
    for (short, long) in highest[0].iter().zip(&highest[1]) {
        assert!(long.kilobytes < short.kilobytes + most, "{short}; {long}");
    }
}
