//! Disks that fail, and power that is cut.

use crate::support::{check_accounting, is_part, metadata, record, rows, rows_of, salvaged, sent};
use crepitus_recording::{Background, Disk, Recorder};
use std::io::{self, ErrorKind};
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Calls of a disk.
#[derive(Clone, Debug)]
enum Asked {
    Append(Vec<u8>),
    Sync,
}

/// Remembers, and fails at one of its calls.
#[derive(Clone, Debug, Default)]
struct Model {
    asked: Arc<Mutex<Vec<Asked>>>,
    fails_at: Option<(usize, i32)>,
}

const ENOSPC: i32 = 28;
const EIO: i32 = 5;

impl Model {
    fn ask(&self, asked: Asked) -> io::Result<()> {
        let mut all = self.asked.lock().unwrap();
        if let Some((at, code)) = self.fails_at
            && all.len() >= at
        {
            // A full disk takes a part.
            if let Asked::Append(bytes) = &asked
                && all.len() == at
            {
                all.push(Asked::Append(bytes[..bytes.len() / 3].to_vec()));
            }
            return Err(io::Error::from_raw_os_error(code));
        }
        all.push(asked);
        Ok(())
    }

    fn asked(&self) -> Vec<Asked> {
        self.asked.lock().unwrap().clone()
    }
}

impl Disk for Model {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.ask(Asked::Append(bytes.to_vec()))
    }

    fn sync(&mut self) -> io::Result<()> {
        self.ask(Asked::Sync)
    }
}

fn bytes(asked: &[Asked]) -> Vec<u8> {
    asked
        .iter()
        .flat_map(|asked| match asked {
            Asked::Append(bytes) => bytes.clone(),
            Asked::Sync => Vec::new(),
        })
        .collect()
}

/// Records on a disk until it fails.
fn run(model: &Model, blocks: u64) -> Result<(), String> {
    let disk = model.clone();
    let mut recorder =
        Recorder::on(disk, Path::new("x"), &metadata("a test")).map_err(|e| e.to_string())?;
    record(&mut recorder, &sent(blocks)).map_err(|e| e.to_string())?;
    recorder.finish().map(|_| ()).map_err(|e| e.to_string())
}

#[test]
fn whatever_write_fails_what_was_written_before_is_read() {
    let all = rows_of(&sent(1_100));
    let whole = Model::default();
    run(&whole, 1_100).unwrap();
    let calls = whole.asked().len();
    assert!(calls > 50);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let mut before = 0;
    for at in 0..calls {
        for (code, word) in [(ENOSPC, "No space left"), (EIO, "Input/output")] {
            let model = Model {
                fails_at: Some((at, code)),
                ..Model::default()
            };
            let error = run(&model, 1_100).unwrap_err();
            assert!(error.contains(word) && error.contains('x'), "{error}");
            let written = bytes(&model.asked());
            if written.len() < 3_000 {
                continue;
            }
            std::fs::write(&path, &written).unwrap();
            let recording = crate::support::open(&path).unwrap();
            assert!(!recording.is_complete() || at + 1 == calls);
            let kept = rows(&recording);
            assert_eq!(kept, all[..kept.len()]);
            assert!(kept.len() >= before);
            check_accounting(&recording);
            before = kept.len();
        }
    }
    assert!(before > 21_000, "{before}");
}

/// After a power cut the file has what was made durable, and of the rest
/// anything: a part of it, or zeros where data never arrived.
#[test]
fn whenever_power_is_cut_everything_up_to_the_last_second_is_read() {
    let all = rows_of(&sent(3_300));
    let model = Model::default();
    run(&model, 3_300).unwrap();
    let asked = model.asked();
    let syncs: Vec<_> = (1..=asked.len())
        .filter(|end| matches!(asked[end - 1], Asked::Sync))
        .collect();
    assert_eq!(syncs.len(), 4, "every second, and at the end");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    // The rows that are durable after so many syncs: each second whole, in the end all.
    let mut durable_rows = vec![0];
    for (second, end) in (1..).zip(&syncs) {
        std::fs::write(&path, bytes(&asked[..*end])).unwrap();
        let kept = rows(&crate::support::open(&path).unwrap()).len();
        let least = all.len().min(second * 20_000);
        assert!(kept >= least, "sync {second}: {kept} of {least}");
        durable_rows.push(kept);
    }
    let mut random = fastrand::Rng::with_seed(3);
    // At the begin and around each sync everywhere, else one in eight, or with CREPITUS_LONG all: each cut
    // reads the file.
    let is_long = std::env::var_os("CREPITUS_LONG").is_some();
    let is_near = |cut: usize| cut < 10 || syncs.iter().any(|end| end.abs_diff(cut) <= 1);
    for cut in (0..=asked.len()).filter(|cut| is_long || cut.is_multiple_of(8) || is_near(*cut)) {
        let seconds = syncs.partition_point(|end| *end <= cut);
        let durable = seconds.checked_sub(1).map_or(0, |last| syncs[last]);
        let sure = durable_rows[seconds];
        let safe = bytes(&asked[..durable]);
        let rest = bytes(&asked[durable..cut]);
        let part = rest[..random.usize(..=rest.len())].to_vec();
        let mut holes = rest.clone();
        for page in holes.chunks_mut(512) {
            if random.bool() {
                page.fill(0);
            }
        }
        let zeros = vec![0; rest.len()];
        for tail in [part, holes, zeros] {
            let file = [&safe[..], &tail[..]].concat();
            if file.len() < 3_000 || file[..21].iter().all(|byte| *byte == 0) {
                continue;
            }
            std::fs::write(&path, &file).unwrap();
            if safe.is_empty() && crate::support::open(&path).is_err() {
                // Nothing was durable yet.
                continue;
            }
            let recording = salvaged(&path);
            let kept = rows(&recording);
            assert!(kept.len() >= sure, "cut at {cut}: {} of {sure}", kept.len());
            assert!(is_part(&kept, &all));
            check_accounting(&recording);
        }
    }
}

/// Takes its time.
struct Slow(Model);

impl Disk for Slow {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        std::thread::sleep(Duration::from_millis(1));
        self.0.append(bytes)
    }

    fn sync(&mut self) -> io::Result<()> {
        std::thread::sleep(Duration::from_millis(300));
        self.0.sync()
    }
}

/// A lease lasts 250 ms and is renewed by the thread that records.
#[test]
fn a_disk_that_stalls_does_not_stall_the_program() {
    let model = Model::default();
    let disk = Background::new(Slow(model.clone()));
    let begun = std::time::Instant::now();
    let mut recorder = Recorder::on(disk, Path::new("x"), &metadata("a test")).unwrap();
    record(&mut recorder, &sent(1_100)).unwrap();
    let longest = begun.elapsed();
    recorder.finish().unwrap();
    let finished = begun.elapsed();
    // Once for the checkpoint, once at the end.
    assert!(finished >= Duration::from_millis(600), "{finished:?}");
    assert!(
        longest + Duration::from_millis(300) < finished,
        "{longest:?}"
    );
    let direct = Model::default();
    run(&direct, 1_100).unwrap();
    assert_eq!(bytes(&model.asked()).len(), bytes(&direct.asked()).len());
}

#[test]
fn an_error_of_a_disk_in_the_background_ends_the_recording() {
    let model = Model {
        fails_at: Some((3, ENOSPC)),
        ..Model::default()
    };
    let mut recorder =
        Recorder::on(Background::new(model), Path::new("x"), &metadata("a test")).unwrap();
    let recorded = record(&mut recorder, &sent(1_100));
    // The cause is reported by every later call, too.
    let finished = recorder.finish().map(|_| ()).unwrap_err();
    for error in recorded.err().iter().chain([&finished]) {
        assert!(error.to_string().contains("No space left"), "{error}");
    }
    assert_eq!(
        io::Error::from_raw_os_error(ENOSPC).kind(),
        ErrorKind::StorageFull
    );
}
