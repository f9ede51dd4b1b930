//! Commands that need a person at a terminal: `crepitus monitor`, and the steps of `crepitus calibrate`.
#![cfg(target_os = "linux")]

mod support;

use std::fs;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;
use support::served::Served;
use support::terminal::Terminal;
use support::{names, run, stderr};

#[test]
fn monitor_shows_a_device_and_obeys_keys() {
    let mut terminal = Terminal::new("monitor --device sim --zero --arm --target medium", None);
    terminal.until("medium:");
    terminal.until("ARMED");
    // Not the end of another word.
    assert!(!terminal.shown().contains("DISARMED"));
    terminal.press("m");
    terminal.press("t");
    terminal.until("ashworth");
    terminal.press("s");
    terminal.until("DIS");
    terminal.press("q");
    let (code, shown) = terminal.end();
    assert_eq!(code, 0, "{shown}");
    // The screen is given back before the marks are printed.
    let (_, after) = shown
        .rsplit_once("\u{1b}[?1049l")
        .expect("the other screen is left");
    assert!(after.contains("mark 1 at "), "{after}");
}

#[test]
fn monitor_stops_what_another_program_has_armed() {
    let served = Served::new();
    let mut armed = served
        .command(&["arm", "--device", "knee", "--zero", "--for", "20s"])
        .stdin(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut terminal = Terminal::new("monitor --device knee", Some(served.home.path()));
    terminal.until("`crepitus");
    terminal.press("d");
    terminal.until("rejected:");
    terminal.press("\u{1b}");
    terminal.until("DIS");
    assert!(!armed.wait().unwrap().success(), "it says why it ended");
    terminal.press("q");
    assert_eq!(terminal.end().0, 0);
}

#[test]
fn without_a_terminal_monitor_says_what_to_use() {
    let output = run(&["monitor", "--device", "sim"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("crepitus stream"),
        "{}",
        stderr(&output)
    );
}

/// A joint at rest for ten seconds, that a hand then moves to -10 degrees, to 128 and back.
const BENT_AFTER_TEN_SECONDS: &str = "\
version = 1
title = \"A range\"
duration_s = 60.0
[motion]
kind = \"velocity-knots\"
knots = [
    { t_s = 0.0, omega_rad_s = 0.0 },
    { t_s = 10.0, omega_rad_s = 0.0 },
    { t_s = 10.25, omega_rad_s = -0.2327 },
    { t_s = 10.75, omega_rad_s = -0.2327 },
    { t_s = 11.0, omega_rad_s = 0.0 },
    { t_s = 11.5, omega_rad_s = 1.6057 },
    { t_s = 12.5, omega_rad_s = 1.6057 },
    { t_s = 13.0, omega_rad_s = 0.0 },
    { t_s = 13.5, omega_rad_s = -1.4893 },
    { t_s = 14.5, omega_rad_s = -1.4893 },
    { t_s = 15.0, omega_rad_s = 0.0 },
    { t_s = 60.0, omega_rad_s = 0.0 },
]
[solver]
kind = \"exact-events\"
step_s = 5e-5
precision = \"f32\"
[effects.encoder]
[effects.motor]
";

#[test]
fn calibrate_says_what_to_do_and_goes_on_by_enter() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("range.toml");
    fs::write(&scene, BENT_AFTER_TEN_SECONDS).unwrap();
    let out = folder.path().join("out");
    let mut terminal = Terminal::new(
        &format!(
            "calibrate --device sim --scene {} --steps zero,range,polarity --out {}",
            scene.display(),
            out.display()
        ),
        None,
    );
    terminal.until("Enter goes on, s skips the step, Ctrl-C ends the program");
    terminal.press("\r");
    terminal.until("zero: good");
    // The motion is that between two presses, however long it takes.
    terminal.until("Enter begins, Enter again ends it");
    terminal.press("\r");
    sleep(Duration::from_secs(15));
    terminal.press("\r");
    terminal.until("range: good");
    terminal.until("polarity: ");
    // A key that means nothing does nothing.
    terminal.press("x");
    sleep(Duration::from_millis(500));
    assert!(!terminal.shown().contains("left out by hand"));
    terminal.press("s");
    terminal.until("left out by hand");
    let (code, shown) = terminal.end();
    assert_eq!(code, 0, "{shown}");
    assert!(names(&out).contains(&"report.html".to_owned()), "{shown}");
}

#[test]
fn calibrate_ends_by_ctrl_c_at_a_question_and_in_a_motion() {
    let folder = tempfile::tempdir().unwrap();
    for moves in [false, true] {
        let out = folder.path().join(format!("out{moves}"));
        let mut terminal = Terminal::new(
            &format!(
                "calibrate --device sim --scene weight-on-the-arm --steps zero,range --out {}",
                out.display()
            ),
            None,
        );
        terminal.until("Ctrl-C ends the program");
        if moves {
            terminal.press("\r");
            terminal.until("Enter again ends it");
            terminal.press("\r");
            // Shown while samples arrive.
            terminal.until("samples");
        }
        terminal.press("\u{3}");
        let (code, shown) = terminal.end();
        assert_eq!(code, 1, "{shown}");
        assert!(
            shown.contains("interrupted: torque is off, nothing was written"),
            "{shown}"
        );
        assert!(names(&out).is_empty(), "{shown}");
    }
}
