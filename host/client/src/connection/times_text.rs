//! Times of a device's hardware tasks, as text and as JSON: with what its cycles are.

use crate::Handshake;
use crepitus_protocol::management::Identity;
use crepitus_protocol::task_times::{
    COMMS_TASKS, CORE_HZ, DRIVE_TASKS, DeviceTimes, MEAN_PARTS, TaskCycles, TaskTimes,
};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

/// Words about a controller without times.
const NONE: &str = "not measured: a simulated device counts no cycles, and firmware reports its first ones a \
                    second after a start";

/// Meaning of a controller's cycles.
fn kind(identity: &Identity) -> &'static str {
    if identity.is_emulated() {
        "emulated cycles, not measured on hardware"
    } else {
        "cycles measured on the board"
    }
}

fn us(cycles: f64) -> f64 {
    cycles / f64::from(CORE_HZ) * 1e6
}

fn mean(task: &TaskCycles) -> f64 {
    f64::from(task.mean_256) / f64::from(MEAN_PARTS)
}

/// A controller with its tasks and its times.
type Part<'a> = (
    &'static str,
    Option<&'a Identity>,
    &'static [&'static str],
    Option<&'a TaskTimes>,
);

fn parts<'a>(handshake: &'a Handshake, times: &'a DeviceTimes) -> [Part<'a>; 2] {
    let (drive, comms) = (handshake.drive.as_ref(), Some(&handshake.comms));
    [
        ("drive", drive, &DRIVE_TASKS, times.drive.as_ref()),
        ("comms", comms, &COMMS_TASKS, times.comms.as_ref()),
    ]
}

/// Jitter of the sampling instant, late ticks: of the drive.
fn sampling(times: &TaskTimes) -> String {
    let jitter = times.sampling_jitter();
    format!(
        "sampling jitter {jitter} cycles ({:.2} µs), {} late ticks",
        us(f64::from(jitter)),
        times.late_ticks
    )
}

fn stack(times: &TaskTimes) -> String {
    let (used, all) = (times.stack_used, times.stack_bytes);
    format!("at most {used} of {all} bytes of stack in use")
}

/// Main times of the drive and of comms, a line each: the doctor's.
pub fn summaries(handshake: &Handshake, times: &DeviceTimes) -> [(&'static str, String); 2] {
    parts(handshake, times).map(|(who, identity, tasks, times)| {
        let found = identity.zip(times);
        let text = found.map(|(identity, times)| summary(identity, tasks, times));
        (who, text.unwrap_or_else(|| NONE.to_owned()))
    })
}

fn summary(identity: &Identity, tasks: &[&str], times: &TaskTimes) -> String {
    let all = tasks.iter().zip(&times.tasks);
    let worst = all.map(|(name, task)| format!("{name} {:.1} µs", us(f64::from(task.worst))));
    let worst: Vec<_> = worst.collect();
    let mut text = format!("worst of {}; {}", worst.join(", "), stack(times));
    if times.latest_sample > 0 {
        let _ = write!(text, "; {}", sampling(times));
    }
    let _ = write!(text, " ({})", kind(identity));
    text
}

/// A table for each controller.
pub fn table(handshake: &Handshake, times: &DeviceTimes) -> String {
    let mut text = String::new();
    for (who, identity, names, times) in parts(handshake, times) {
        let (Some(identity), Some(times)) = (identity, times) else {
            // Writing to a string does not fail.
            let _ = writeln!(text, "\ntimes of {who}: {NONE}");
            continue;
        };
        let _ = writeln!(text, "\ntimes of {who} since its reset: {}", kind(identity));
        for (name, task) in names.iter().zip(&times.tasks) {
            let _ = writeln!(
                text,
                "  {name:<15} mean {:>7.1}, worst {:>6} cycles ({:.2} µs) in {} runs",
                mean(task),
                task.worst,
                us(f64::from(task.worst)),
                task.runs
            );
        }
        if times.latest_sample > 0 {
            let _ = writeln!(text, "  {}", sampling(times));
        }
        let _ = writeln!(text, "  {}", stack(times));
    }
    text
}

/// Times of both controllers as JSON; null without any.
pub fn json(handshake: &Handshake, times: &DeviceTimes) -> Value {
    let parts = parts(handshake, times).map(|(who, identity, names, times)| {
        let value = identity.zip(times).map(|(identity, times)| {
            let tasks: Map<_, _> = names
                .iter()
                .zip(&times.tasks)
                .map(|(name, task)| {
                    let value = json!({
                        "runs": task.runs,
                        "mean_cycles": mean(task),
                        "worst_cycles": task.worst,
                    });
                    ((*name).to_owned(), value)
                })
                .collect();
            json!({
                "is_emulated": identity.is_emulated(),
                "core_hz": CORE_HZ,
                "tasks": tasks,
                "sampling_jitter_cycles": times.sampling_jitter(),
                "late_ticks": times.late_ticks,
                "stack_used_bytes": times.stack_used,
                "stack_bytes": times.stack_bytes,
            })
        });
        (who.to_owned(), json!(value))
    });
    Value::Object(parts.into_iter().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::management::EMULATED_SERIAL;

    fn handshake(serial: [u8; 12]) -> Handshake {
        let identity = Identity {
            serial,
            ..Identity::default()
        };
        Handshake {
            comms: identity,
            drive: Some(identity),
        }
    }

    fn times() -> DeviceTimes {
        let mut drive = TaskTimes {
            earliest_sample: 40,
            latest_sample: 61,
            late_ticks: 3,
            stack_used: 2_120,
            stack_bytes: 65_536,
            ..TaskTimes::default()
        };
        drive.tasks[1] = TaskCycles {
            runs: 20_000,
            worst: 1_680,
            mean_256: 1_400 * MEAN_PARTS + MEAN_PARTS / 2,
        };
        DeviceTimes {
            drive: Some(drive),
            comms: None,
        }
    }

    #[test]
    fn emulated_cycles_are_called_so_and_measured_ones_too() {
        let emulated = table(&handshake(EMULATED_SERIAL), &times());
        assert!(emulated.contains("times of drive since its reset: emulated cycles"));
        let board = table(&handshake(*b"123456789012"), &times());
        assert!(board.contains("times of drive since its reset: cycles measured on the board"));
        for text in [emulated, board] {
            assert!(text.contains("command_motor   mean  1400.5, worst   1680 cycles (10.00 µs)"));
            assert!(text.contains("sampling jitter 21 cycles (0.12 µs), 3 late ticks"));
            assert!(text.contains("at most 2120 of 65536 bytes of stack"));
            assert!(text.contains("times of comms: not measured"));
        }
    }

    #[test]
    fn as_json_nothing_is_invented() {
        let value = json(&handshake(EMULATED_SERIAL), &times());
        assert_eq!(value["comms"], Value::Null);
        let drive = &value["drive"];
        assert_eq!(drive["is_emulated"], true);
        assert_eq!(drive["sampling_jitter_cycles"], 21);
        assert_eq!(drive["tasks"]["command_motor"]["mean_cycles"], 1400.5);
        assert_eq!(drive["tasks"]["link"]["runs"], 0);
    }
}
