//! A simulated device as a serial port: other programs, other processes, and
//! what happens to them.
#![cfg(target_os = "linux")]

mod support;

use crepitus_virtual_device::usb::pty::Pty;
use serde_json::Value;
use std::fs;
use std::io::Read;
use std::os::fd::AsFd;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;
use support::served::{Served, ended, signal, until};
use support::{
    HALF_A_SECOND, check_accounting, crepitus, length, recording, repository, rows, stderr, stdout,
};

#[test]
fn it_is_found_and_talks() {
    let served = Served::new();
    let devices = stdout(&served.run(&["devices", "--json"]));
    let devices: Value = serde_json::from_str(&devices).unwrap();
    assert!(
        devices
            .as_array()
            .unwrap()
            .iter()
            .any(|d| d["name"] == "knee"),
        "{devices}"
    );
    // The only one needs no name; any of its names will do.
    assert_eq!(served.info()["status"]["state"], "disarmed");
    for name in ["knee", served.port().to_str().unwrap()] {
        let output = served.run(&["zero", "--device", name]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    // What one program sets, the next one finds.
    let set = served.run(&["params", "set", "crepitus.static_torque_nm=0.45"]);
    assert!(set.status.success(), "{}", stderr(&set));
    let got = stdout(&served.run(&["params", "get", "crepitus.static_torque_nm"]));
    assert!(got.contains("0.45"), "{got}");
}

/// Process that does not share the port: it is not this user's.
#[test]
fn a_port_held_by_another_process_is_reported() {
    let served = Served::new();
    let file = served.home.path().join("held.csv");
    let other = tempfile::tempdir().unwrap();
    let mut holder = crepitus()
        .args(["record", file.to_str().unwrap(), "--device"])
        .arg(served.port())
        .env("XDG_RUNTIME_DIR", other.path())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    until("the recording has begun", || length(&file) > 10_000);
    let output = served.run(&["info"]);
    assert_eq!(output.status.code(), Some(2));
    let text = stderr(&output);
    assert!(
        text.contains("has it open") && text.contains(&holder.id().to_string()),
        "{text}"
    );
    signal(&holder, "-INT");
    assert!(holder.wait().unwrap().success());
}

#[test]
fn ctrl_c_disarms_first() {
    let served = Served::new();
    let file = served.home.path().join("a.csv");
    let child = served
        .command(&["record", file.to_str().unwrap(), "--arm", "--zero"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    until("half a second is recorded", || {
        length(&file) > HALF_A_SECOND
    });
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let info = served.info();
    // Disarmed in order: no fault, as there would be without a renewed lease.
    assert_eq!(info["status"]["state"], "disarmed");
    assert_eq!(info["counters"]["drive"]["armings"], 1);
    assert_eq!(info["counters"]["drive"]["faults"], 0);
}

#[test]
fn a_host_that_is_killed_leaves_a_device_without_torque_and_a_recording() {
    let served = Served::new();
    let file = served.home.path().join("a.csv");
    let mut child = served
        .command(&["record", file.to_str().unwrap(), "--arm", "--zero"])
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    until("half a second is recorded", || {
        length(&file) > HALF_A_SECOND
    });
    signal(&child, "-KILL");
    child.wait().unwrap();
    sleep(Duration::from_millis(400));
    let info = served.info();
    assert_eq!(info["status"]["state"], "faulted");
    assert!(
        info["faults"][0].as_str().unwrap().contains("lease"),
        "{info:#}"
    );
    // The doctor finds it, too.
    let output = served.run(&["doctor", "--json"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["fine"], false, "{report:#}");
    let checks = report["checks"].as_array().unwrap();
    let faults = checks.iter().find(|check| check["what"] == "faults");
    let faults = faults.expect("a check of faults");
    assert_eq!(faults["fine"], false, "{report:#}");
    let found = faults["found"].as_str().unwrap();
    assert!(found.contains("lease"), "{found}");
    // It continues without a restart.
    assert!(served.run(&["clear-fault"]).status.success());
    let armed = served.run(&["arm", "--zero", "--for", "200ms"]);
    assert!(armed.status.success(), "{}", stderr(&armed));
    // The file on disk is a valid recording.
    let output = served.run(&["report", file.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("incomplete"),
        "{}",
        stdout(&output)
    );
    assert!(check_accounting(&recording(&file)).received > 9_000);
}

/// Loss and return of the device, as when the cable is pulled and the device restarts.
#[test]
fn a_recording_goes_on_when_the_device_comes_back() {
    let served = Served::new();
    let file = served.home.path().join("a");
    let child = served
        .command(&["record", file.to_str().unwrap()])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    until("half a second is recorded", || {
        length(&file) > HALF_A_SECOND
    });
    let served = Served::at(served.kill());
    let before = length(&file);
    until("more is recorded", || {
        length(&file) > before + HALF_A_SECOND
    });
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("reconnected"),
        "{}",
        stderr(&output)
    );
    let recording = recording(&file);
    let accounting = recording.accounting();
    assert!(recording.is_complete());
    assert_eq!(
        (accounting.drive_restarts, accounting.segments.len()),
        (1, 2)
    );
    let rows = rows(&recording);
    assert_eq!(rows.len() as u64, accounting.totals.received);
    assert!(rows.len() > 18_000);
    let second = usize::try_from(accounting.segments[1].first_row).unwrap();
    assert!(rows[second].tick < rows[second - 1].tick, "a new start");
    assert!(rows.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
    drop(served);
}

#[test]
fn a_full_disk_ends_a_recording_that_can_still_be_reported() {
    let served = Served::new();
    let file = served.home.path().join("a.csv");
    let script = format!(
        "trap '' XFSZ; ulimit -f 400; exec '{}' record '{}' --arm --zero",
        env!("CARGO_BIN_EXE_crepitus"),
        file.display()
    );
    let output = Command::new("sh")
        .args(["-c", &script])
        .env("XDG_RUNTIME_DIR", served.home.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("`crepitus report` can read"),
        "{}",
        stderr(&output)
    );
    // It has disarmed in order.
    assert_eq!(served.info()["status"]["state"], "disarmed");
    let output = served.run(&["report", file.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
}

/// The page about the wires is enough to write a client.
#[test]
fn a_client_in_python_communicates_with_it() {
    let python = Command::new("python3").arg("--version").output();
    if !python.is_ok_and(|output| output.status.success()) {
        eprintln!("left out: there is no python3");
        return;
    }
    let served = Served::new();
    let output = Command::new("python3")
        .arg(repository().join("docs/examples/client.py"))
        .arg(served.port())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let got = stdout(&served.run(&["params", "get", "crepitus.static_torque_nm"]));
    assert!(got.contains("0.45"), "{got}");
}

/// … and to run beside a program that has the port open.
#[test]
fn a_client_in_python_runs_beside_a_recording() {
    let python = Command::new("python3").arg("--version").output();
    if !python.is_ok_and(|output| output.status.success()) {
        eprintln!("left out: there is no python3");
        return;
    }
    let served = Served::new();
    let file = served.home.path().join("beside.crepitus");
    let mut recording = served
        .command(&["record", "--for", "4s"])
        .arg(&file)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let folder = served.home.path().join("crepitus/shared");
    let is_socket = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "socket");
    let socket = (0..200)
        .find_map(|_| {
            sleep(Duration::from_millis(20));
            let mut entries = fs::read_dir(&folder).ok()?.flatten();
            entries.find_map(|entry| Some(entry.path()).filter(is_socket))
        })
        .expect("a socket");
    let output = Command::new("python3")
        .arg(repository().join("docs/examples/client.py"))
        .arg(&socket)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(ended(&mut recording).success());
    let got = stdout(&served.run(&["params", "get", "crepitus.static_torque_nm"]));
    assert!(got.contains("0.45"), "{got}");
}

#[test]
fn a_name_in_use_is_refused_and_one_that_was_left_is_taken() {
    let served = Served::new();
    let again = served.run(&["serve-sim", "--name", "knee"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(
        stderr(&again).contains("another program serves"),
        "{}",
        stderr(&again)
    );
    assert_eq!(served.info()["status"]["state"], "disarmed");
    // Killed, it leaves its link.
    let home = served.kill();
    let link = home.path().join("crepitus/knee");
    assert!(link.is_symlink());
    let ask = |device: &str| {
        crepitus()
            .args(["info", "--device", device])
            .env("XDG_RUNTIME_DIR", home.path())
            .output()
            .unwrap()
    };
    // As if its pty were somebody's terminal now: it is not opened.
    fs::remove_file(&link).unwrap();
    let other = home.path().join("other");
    fs::write(&other, "").unwrap();
    symlink(&other, &link).unwrap();
    for device in ["knee", link.to_str().unwrap()] {
        let output = ask(device);
        assert_eq!(output.status.code(), Some(2), "{device}");
        assert!(stderr(&output).contains("serve-sim"), "{}", stderr(&output));
    }
    assert_eq!(fs::read(&other).unwrap(), b"");
    fs::remove_file(&link).unwrap();
    symlink("/dev/pts/999999", &link).unwrap();
    let served = Served::at(home);
    assert_eq!(served.info()["status"]["state"], "disarmed");
}

/// Somebody has replaced the link of a device that is served: what it leads to gets no byte.
#[test]
fn a_link_that_leads_elsewhere_is_no_device() {
    let served = Served::new();
    let (home, link) = (served.home.path(), served.port());
    let pty = fs::read_link(&link).unwrap();
    let other = Pty::new(None).unwrap();
    let mut heard = fs::File::from(other.as_fd().try_clone_to_owned().unwrap());
    let file = home.join("file");
    fs::write(&file, "").unwrap();
    for target in [other.path(), file.as_path(), home, Path::new("/dev/null")] {
        fs::remove_file(&link).unwrap();
        symlink(target, &link).unwrap();
        let devices = stdout(&served.run(&["devices", "--json"]));
        assert!(!devices.contains("\"knee\""), "{devices}");
        assert_eq!(served.run(&["info"]).status.code(), Some(2));
        for device in ["knee", link.to_str().unwrap()] {
            let output = served.run(&["info", "--device", device]);
            assert_eq!(output.status.code(), Some(2));
            for path in [target, pty.as_path()] {
                let said = format!("{}", path.display());
                assert!(stderr(&output).contains(&said), "{}", stderr(&output));
            }
        }
    }
    // Its other end is closed by now, or says nothing.
    assert_eq!(heard.read(&mut [0; 200]).unwrap_or(0), 0);
    // The name is in use all the same, and the device is where the error says.
    let again = served.run(&["serve-sim", "--name", "knee"]);
    assert!(stderr(&again).contains("another program serves"));
    let info = served.run(&["info", "--device", pty.to_str().unwrap()]);
    assert!(info.status.success(), "{}", stderr(&info));
}

#[test]
fn a_file_instead_of_the_folder_is_named() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("crepitus"), "").unwrap();
    let output = crepitus()
        .arg("serve-sim")
        .env("XDG_RUNTIME_DIR", home.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("it is no folder"));
}
