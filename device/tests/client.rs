//! `docs/examples/client.py`, written from the book alone, against a device.

mod support;

use crepitus_device::usb_port::HostBytes;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::{State, parameters};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};
use support::{Bench, Boots};

/// Timeout of the client.
const PATIENCE: Duration = Duration::from_mins(1);

/// The most lines of it that are neither empty nor a comment.
const MOST_LINES: usize = 60;

fn script() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/examples/client.py")
}

#[test]
fn the_example_client_is_short_and_knows_the_parameters() {
    let text = std::fs::read_to_string(script()).unwrap();
    let lines = text
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    assert!(lines.count() <= MOST_LINES);
    let (id, _) = parameters::find("crepitus.static_torque_nm").unwrap();
    assert!(text.contains(&format!("values[{id}] = 0.45")));
}

#[test]
fn the_example_client_communicates_with_a_device() {
    let Some(bench) = run(&[]) else { return };
    assert_eq!(bench.drive.counters().get(DriveCounter::Armings), 0);
}

/// The client arms with the nonce of its session, renews its lease and disarms at the end.
#[test]
fn the_example_client_arms_a_device() {
    let Some(bench) = run(&["--arm"]) else { return };
    assert_eq!(bench.drive.counters().get(DriveCounter::Armings), 1);
    let comms = bench.comms.counters();
    assert!(comms.get(CommsCounter::Renewals) >= 3);
    assert_eq!(comms.get(CommsCounter::LeasesExpired), 0);
    assert_eq!(bench.comms.state(), State::Disarmed);
}

/// Runs the client with a device until it ends; none without Python.
fn run(arguments: &[&str]) -> Option<Bench> {
    let started = Command::new("python3")
        .arg(script())
        .arg("-")
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut client = match started {
        Ok(client) => client,
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let is_needed = std::env::var_os("CREPITUS_NEEDS_PYTHON").is_some();
            assert!(!is_needed, "there is no python3");
            eprintln!("left out: there is no python3");
            return None;
        }
        Err(error) => panic!("{error}"),
    };
    let mut to_client = client.stdin.take().unwrap();
    let mut from_client = client.stdout.take().unwrap();
    let (sender, received) = mpsc::channel();
    thread::spawn(move || {
        let mut bytes = [0; 256];
        while let Ok(count @ 1..) = from_client.read(&mut bytes) {
            if sender.send(bytes[..count].to_vec()).is_err() {
                break;
            }
        }
    });
    let mut bench = Bench::new(&Boots::new());
    let mut received_text = Vec::new();
    let started = Instant::now();
    while client.try_wait().unwrap().is_none() {
        assert!(started.elapsed() < PATIENCE, "the client does not end");
        bench.device_millisecond();
        for bytes in received.try_iter() {
            bench.comms.received(&bytes);
            received_text.extend(bytes);
        }
        let run = bench.comms.to_send().len();
        // A client that has ended does not read; the asserts below show why.
        let _ = to_client.write_all(bench.comms.to_send());
        bench.comms.sent(run);
        thread::sleep(Duration::from_micros(200));
    }
    received_text.extend(received.iter().flatten());
    // The client ends with its last answer, perhaps before the status that says the same.
    for _ in 0..20 {
        bench.device_millisecond();
    }
    let output = client.wait_with_output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let received_text = String::from_utf8_lossy(&received_text);
    assert!(received_text.contains("count 0, model "), "{received_text}");
    assert_eq!(bench.drive.revision(), bench.comms.revision());
    assert_eq!(bench.drive.revision().0, 2, "one commit");
    Some(bench)
}
