//! Recordings that ended in order, or were cut off.

use crate::support::{
    check_accounting, metadata, open, plain, record, recorded, rows, rows_of, sent, sent_of,
};
use crepitus_pages::recorded::Analysis;
use crepitus_recording::{Cause, ReadError, Recorder, Totals};
use std::fs;

#[test]
fn what_was_recorded_is_read_with_its_gaps_and_parameters() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a recording");
    let sent = sent(1_500);
    recorded(&path, "a test", &sent);
    let recording = open(&path).unwrap();
    assert!(recording.is_complete());
    assert_eq!(recording.metadata().title, "a test");
    assert_eq!(rows(&recording), rows_of(&sent));
    check_accounting(&recording);
    let accounting = recording.accounting();
    assert_eq!(
        accounting.totals,
        Totals {
            produced: 30_000 + 40 + 20 + 4_000 + 20,
            received: 30_000,
            dropped: 4_080,
            by_device: 60,
            not_connected: 4_000,
            damaged: 0,
        }
    );
    let causes: Vec<_> = accounting.gaps.iter().map(|gap| gap.cause).collect();
    assert_eq!(
        causes,
        [
            Cause::Device,
            Cause::OnTheWay,
            Cause::NotConnected,
            Cause::Device
        ]
    );
    assert_eq!(accounting.drive_restarts, 1);
    let mut in_force = recording.parameters().in_force();
    for (row, torque) in [
        (0, 0.401),
        (97 * 20 - 1, 0.401),
        (97 * 20, 0.402),
        (29_999, 0.416),
    ] {
        in_force.at(row);
        let said = in_force.number("crepitus.static_torque_nm").unwrap();
        assert!((said - torque).abs() < 1e-6, "row {row}: {said}");
    }
    let sets = &recording.parameters().0;
    assert!(sets[0].values.as_ref().unwrap().len() > 20);
    assert!(
        sets[1..]
            .iter()
            .all(|set| set.values.as_ref().unwrap().len() == 1)
    );
    let warnings = recording.warnings();
    assert_eq!(
        warnings,
        [
            "4080 of 34080 samples (0.204 s) are missing in 4 gaps: 60 dropped by the device, 20 lost on the \
          way, 4000 not recorded while the connection was lost."
        ]
    );
}

/// Missing samples are in the span, and a restart of the drive takes no time in it.
#[test]
fn a_summary_has_the_span_and_the_recorded_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a recording");
    recorded(&path, "a test", &sent(1_500));
    let recording = open(&path).unwrap();
    let mut analysis = Analysis::new(&recording);
    for row in rows(&recording) {
        analysis.row(&row);
    }
    let summary = analysis.finish();
    assert!((summary.duration_s - 1.5).abs() < 1e-9);
    assert!((summary.span_s - 1.703).abs() < 1e-9, "{}", summary.span_s);
    let warnings = summary.warnings.join("\n");
    assert!(
        warnings.contains("The drive restarted once during the recording"),
        "{warnings}"
    );
}

#[test]
fn one_that_was_killed_is_read_up_to_its_last_whole_block() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let sent = sent(1_100);
    let mut killed = Recorder::create(&path, &metadata("killed")).unwrap();
    record(&mut killed, &sent).unwrap();
    drop(killed);
    let whole = fs::read(&path).unwrap();
    let all = rows_of(&sent);
    let (mut last, mut longest) = (0, 0);
    for cut in (3_000..=whole.len()).step_by(997).chain([whole.len()]) {
        fs::write(&path, &whole[..cut]).unwrap();
        let recording = open(&path).unwrap();
        assert!(!recording.is_complete());
        assert!(recording.warnings()[0].contains("incomplete"));
        let rows = rows(&recording);
        assert_eq!(rows, all[..rows.len()]);
        assert!(rows.len() >= last);
        check_accounting(&recording);
        last = rows.len();
        longest = longest.max(cut);
    }
    assert!(last > 21_000, "{last}");
}

/// A report while it is recorded.
#[test]
fn one_that_grows_is_read_as_it_was_when_it_was_opened() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let sent = sent(300);
    recorded(&path, "whole", &sent);
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let recording = open(&path).unwrap();
    fs::write(&path, &whole).unwrap();
    check_accounting(&recording);
    assert!(!recording.is_complete());
    // Not that it was stopped, which nobody knows.
    let warning = &recording.warnings()[0];
    assert!(
        warning.contains("perhaps its program still runs"),
        "{warning}"
    );
}

#[test]
fn what_is_no_recording_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    for content in [
        &b""[..],
        b"tick,t_s\n1,0.0\n",
        &[0; 5_000],
        &[7; 9_000],
        b"PAR",
    ] {
        fs::write(&path, content).unwrap();
        assert!(matches!(open(&path), Err(ReadError::Foreign(_))));
    }
    assert!(matches!(
        open(&folder.path().join("none")),
        Err(ReadError::Io { .. })
    ));
}

/// Another layout of blocks or frames is another format: then `FORMAT` must
/// change, and this file with it.
#[test]
fn the_first_bytes_ever_written_are_still_read() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden.crepitus");
    let sent = sent_of(10, plain);
    if std::env::var_os("CREPITUS_BLESS").is_some() {
        let _ = fs::remove_file(&path);
        recorded(&path, "golden", &sent);
    }
    let recording = open(&path).unwrap();
    assert_eq!(rows(&recording), rows_of(&sent));
    assert_eq!(recording.metadata().title, "golden");
}
