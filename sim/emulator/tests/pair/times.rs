//! Times of both controllers' tasks, as a host's program gets them.

use crate::host::{connected, run};
use crepitus_client::Event;
use crepitus_client::connection::times_text;
use crepitus_protocol::task_times::{COMMS_TASKS, DeviceTimes, TaskTimes};

/// Time of device that is listened to, ms: two reports.
const LISTENED_MS: u64 = 2_200;

/// Runs of the first task of each in a second.
const DRIVE_RUNS: u32 = 20_000;
const COMMS_RUNS: u32 = 4_000;

fn check(times: &TaskTimes, tasks: usize, runs: u32) {
    for task in &times.tasks[..tasks] {
        let worst_256 = task.worst * 256;
        assert!(task.worst > 0 && task.runs > 0, "{times:?}");
        assert!((1..=worst_256).contains(&task.mean_256), "{times:?}");
    }
    assert!((runs..3 * runs).contains(&times.tasks[0].runs), "{times:?}");
    let used = times.stack_used;
    assert!(
        (1_000..times.stack_bytes / 8 * 7).contains(&used),
        "{times:?}"
    );
}

#[test]
fn both_controllers_report_once_a_second() {
    let Some(mut host) = connected() else { return };
    assert_eq!(host.times().expect("an answer"), DeviceTimes::default());
    host.subscribe().expect("a subscription");
    let events = run(&mut host, LISTENED_MS);
    let reports = events.iter().filter_map(|event| match event {
        Event::Times(times) => Some(**times),
        _ => None,
    });
    let reports: Vec<DeviceTimes> = reports.collect();
    assert_eq!(reports.len(), 2);
    let handshake = *host.handshake();
    let times = host.times().expect("an answer");
    let table = times_text::table(&handshake, &times);
    println!("{table}");
    let (drive, comms) = (times.drive.expect("measured"), times.comms.expect("too"));
    assert_eq!(reports.last().and_then(|times| times.drive), Some(drive));
    check(&drive, drive.tasks.len(), DRIVE_RUNS);
    check(&comms, COMMS_TASKS.len(), COMMS_RUNS);
    assert!(drive.latest_sample > 0 && comms.latest_sample == 0);
    // No chip measures itself here.
    assert_eq!(table.matches("emulated cycles").count(), 2, "{table}");
}
