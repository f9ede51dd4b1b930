//! CPU time of a run with a trace, against that of the same run without one.
//!
//! The only test of its program: the system adds up the CPU time of all children, so another one would
//! add its own.
#![cfg(unix)]

mod support;

use crepitus_scene::run::is_stepless;
use crepitus_scene::{Overrides, shipped};
use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeValLike;
use std::fs;
use std::path::Path;
use support::{repository, run, stderr};

/// Most that a trace, its report and their hashes may cost, as a multiple of the run without them.
///
/// 3 is what users are promised. In a build for tests digits, hash and drawing cost more beside the
/// simulation, whose crates are optimised there, and a machine may hash without instructions for it.
const MOST: f64 = if cfg!(debug_assertions) { 5.0 } else { 3.0 };

/// A run without a trace that makes every step, also where in f64 it would go from event to event.
fn stepping(scene: &str) -> &'static [&'static str] {
    let read = shipped::scene(Path::new(scene), &Overrides::default()).unwrap();
    if is_stepless(&read) {
        &["--no-trace", "--set", "solver.precision=f32"]
    } else {
        &["--no-trace"]
    }
}

/// Runs of which the quickest counts, where a busy machine made the first one slow.
const MOST_RUNS: u32 = 8;

/// CPU time of all threads of a run into a new folder, in user and system, ms.
fn cpu_ms(scene: &str, more: &[&str]) -> f64 {
    let spent = || {
        let usage = getrusage(UsageWho::RUSAGE_CHILDREN).unwrap();
        (usage.user_time() + usage.system_time()).num_microseconds()
    };
    let home = tempfile::tempdir_in(Path::new(env!("CARGO_TARGET_TMPDIR"))).unwrap();
    let out = home.path().join("out");
    let begun = spent();
    let output = run(&[&["run", scene, "--out", out.to_str().unwrap()], more].concat());
    assert!(output.status.success(), "{scene}: {}", stderr(&output));
    #[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
    let spent_us = (spent() - begun) as f64;
    spent_us / 1e3
}

#[test]
fn the_trace_of_a_shipped_scene_costs_a_bounded_multiple_of_its_run() {
    let entries = fs::read_dir(repository().join("scenes")).unwrap();
    let mut scenes: Vec<_> = entries
        .filter_map(|entry| Some(entry.unwrap().path().file_stem()?.to_str()?.to_owned()))
        .collect();
    scenes.sort();
    let mut over = Vec::new();
    for scene in &scenes {
        let (mut with, mut without) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..MOST_RUNS {
            with = with.min(cpu_ms(scene, &[]));
            without = without.min(cpu_ms(scene, stepping(scene)));
            if with <= MOST * without {
                break;
            }
        }
        let ratio = with / without;
        let line =
            format!("{scene:26} {without:6.1} ms, with a trace {with:6.1}: {ratio:.2} times");
        println!("{line}");
        if ratio > MOST {
            over.push(line);
        }
    }
    assert!(scenes.len() > 40 && over.is_empty(), "{over:#?}");
}
