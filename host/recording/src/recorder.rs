//! Writing of a recording as the samples arrive.

use crate::row::COLUMNS;
use crate::samples::Samples;
use crate::sidecar::{Gap, ParameterSet, Sidecar, Totals, named_values};
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Revision, Values};
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Limit of listed gaps; further ones are only counted.
const LISTED_GAPS: usize = 1_000;

/// Errors of recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// A recording of this name exists.
    #[error("{0} already exists: choose another name, or remove it")]
    Exists(PathBuf),
    /// A write error.
    #[error("{path}: {doing}: {source}")]
    Disk {
        /// The file.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
        /// Why not.
        source: io::Error,
    },
}

/// A recording in progress.
#[derive(Debug)]
pub struct Recorder {
    path: PathBuf,
    csv: File,
    /// Pending lines.
    lines: String,
    sidecar: Sidecar,
    samples: Samples,
    /// Parameters announced before their first block.
    announced: Vec<(Revision, Values)>,
    /// The tick after the last block; none before the first one.
    next_tick: Option<u64>,
    start: u8,
}

/// The JSON file that belongs to a CSV file.
pub(crate) fn sidecar_path(csv: &Path) -> PathBuf {
    csv.with_extension("json")
}

impl Recorder {
    /// Begins a recording in `path`, a CSV file that must not exist, and in
    /// the JSON file beside it.
    ///
    /// # Errors
    /// [`RecordError`] if one exists, or cannot be written.
    pub fn create(path: &Path, sidecar: Sidecar) -> Result<Self, RecordError> {
        let json = sidecar_path(path);
        if json.exists() {
            return Err(RecordError::Exists(json));
        }
        let csv = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(path)
            .map_err(|error| match error.kind() {
                io::ErrorKind::AlreadyExists => RecordError::Exists(path.to_owned()),
                _ => disk(path, "cannot be created", error),
            })?;
        let header: Vec<_> = COLUMNS.iter().map(|(name, _)| *name).collect();
        let mut recorder = Self {
            path: path.to_owned(),
            csv,
            lines: header.join(",") + "\n",
            sidecar,
            samples: Samples::default(),
            announced: Vec::new(),
            next_tick: None,
            start: 0,
        };
        recorder.flush()?;
        recorder.write_sidecar()?;
        Ok(recorder)
    }

    /// Announces the parameters of a revision, before its first block.
    pub fn announce(&mut self, revision: Revision, values: &Values) {
        self.announced.push((revision, *values));
    }

    /// Takes a block. [`Self::flush`] writes it.
    ///
    /// # Errors
    /// [`RecordError`] if new parameters cannot be written.
    pub fn block(&mut self, block: &Block) -> Result<(), RecordError> {
        match self.next_tick {
            Some(due) if block.flags.start() != self.start || block.first_tick < due => {
                self.sidecar.drive_restarts += 1;
            }
            Some(due) if block.first_tick > due => self.note_gap(due, block.first_tick - due),
            _ => {}
        }
        self.start = block.flags.start();
        self.next_tick = Some(block.end_tick());
        self.note_parameters(block)?;
        for row in self.samples.rows(block) {
            row.append_to(&mut self.lines);
        }
        let samples = block.samples.len() as u64;
        self.sidecar.telemetry.produced += samples;
        self.sidecar.telemetry.received += samples;
        Ok(())
    }

    fn note_gap(&mut self, first_tick: u64, samples: u64) {
        self.sidecar.telemetry.produced += samples;
        self.sidecar.telemetry.dropped += samples;
        if self.sidecar.drops.len() < LISTED_GAPS {
            self.sidecar.drops.push(Gap {
                first_tick,
                samples,
            });
        }
    }

    /// Records the parameters of a block, if it is the first with them.
    fn note_parameters(&mut self, block: &Block) -> Result<(), RecordError> {
        let known = self.sidecar.parameters.last().map(|set| set.revision);
        if known == Some(block.revision.0) {
            return Ok(());
        }
        let Some(at) = self
            .announced
            .iter()
            .position(|(revision, _)| *revision == block.revision)
        else {
            return Ok(());
        };
        let (revision, values) = self.announced.remove(at);
        self.samples.set(&values);
        self.sidecar.parameters.push(ParameterSet {
            revision: revision.0,
            first_tick: block.first_tick,
            values: named_values(&values),
        });
        self.write_sidecar()
    }

    /// Totals so far.
    pub fn totals(&self) -> Totals {
        self.sidecar.telemetry
    }

    /// Writes all pending lines to the CSV file.
    ///
    /// # Errors
    /// [`RecordError`] if a write fails. What was written before can be read.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        let written = self.csv.write_all(self.lines.as_bytes());
        self.lines.clear();
        written.map_err(|error| disk(&self.path, "the samples cannot be written", error))
    }

    /// Finishes the recording: flushes, and marks it complete.
    ///
    /// # Errors
    /// [`RecordError`] if a write fails.
    pub fn finish(mut self) -> Result<Sidecar, RecordError> {
        self.flush()?;
        self.csv
            .sync_all()
            .map_err(|error| disk(&self.path, "the samples cannot be written", error))?;
        self.sidecar.complete = true;
        self.write_sidecar()?;
        Ok(self.sidecar)
    }

    /// Replaces the JSON file atomically.
    fn write_sidecar(&self) -> Result<(), RecordError> {
        let path = sidecar_path(&self.path);
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let write = || -> io::Result<()> {
            let mut builder = tempfile::Builder::new();
            builder.prefix(".crepitus-");
            // The usual permissions, not those of a temporary file.
            #[cfg(unix)]
            let builder = builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
            let mut file = builder.tempfile_in(folder)?;
            serde_json::to_writer_pretty(&mut file, &self.sidecar)?;
            file.write_all(b"\n")?;
            file.as_file().sync_all()?;
            file.persist(&path)?;
            Ok(())
        };
        write().map_err(|error| disk(&path, "cannot be written", error))
    }
}

fn disk(path: &Path, doing: &'static str, source: io::Error) -> RecordError {
    RecordError::Disk {
        path: path.to_owned(),
        doing,
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Recording;
    use crepitus_protocol::management::Identity;
    use crepitus_protocol::parameters::id;
    use crepitus_protocol::telemetry::{BLOCK_SAMPLES, BlockFlags, NO_CURRENT, Sample};
    use crepitus_protocol::{State, TICK_S};

    fn block(first_tick: u64, revision: u32) -> Block {
        let sample = |n: usize| Sample {
            count: i32::try_from(n).unwrap(),
            model_torque_nm: 0.25,
            current_ma: if n == 3 { NO_CURRENT } else { -75 },
            ..Sample::default()
        };
        Block {
            first_tick,
            revision: Revision(revision),
            flags: BlockFlags::new(State::Disarmed, false, 1),
            samples: core::array::from_fn::<_, BLOCK_SAMPLES, _>(sample),
            ..Block::default()
        }
    }

    fn recorder(path: &Path) -> Recorder {
        let sidecar = Sidecar::new("a test", 7, &Identity::default(), None);
        Recorder::create(path, sidecar).unwrap()
    }

    #[test]
    fn what_was_recorded_is_read_with_its_gaps_and_parameters() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let mut recorder = recorder(&path);
        let mut values = Values::default();
        recorder.announce(Revision(1), &values);
        values.set(id::STATIC_TORQUE, 0.5);
        recorder.announce(Revision(2), &values);
        for (tick, revision) in [(1_000, 1), (1_020, 1), (1_080, 2), (1_100, 2)] {
            recorder.block(&block(tick, revision)).unwrap();
        }
        let sidecar = recorder.finish().unwrap();
        assert_eq!(
            sidecar.telemetry,
            Totals {
                produced: 120,
                received: 80,
                dropped: 40
            }
        );
        let recording = Recording::open(&path).unwrap();
        assert_eq!(recording.sidecar(), &sidecar);
        assert!(sidecar.complete);
        assert_eq!(
            sidecar.drops,
            [Gap {
                first_tick: 1_040,
                samples: 40
            }]
        );
        let sets: Vec<_> = sidecar
            .parameters
            .iter()
            .map(|p| (p.revision, p.first_tick))
            .collect();
        assert_eq!(sets, [(1, 1_000), (2, 1_080)]);
        assert_eq!(
            sidecar.number(Revision(2), "crepitus.static_torque_nm"),
            Some(0.5)
        );
        let rows: Vec<_> = recording.rows().unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 80);
        assert_eq!((rows[40].tick, rows[40].revision), (1_080, 2));
        assert_eq!((rows[3].current_a, rows[4].current_a), (None, Some(-0.075)));
        assert!((rows[79].time_s - 119.0 * TICK_S).abs() < 1e-12);
    }

    #[test]
    fn one_that_was_killed_is_read_up_to_its_last_whole_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let mut killed = recorder(&path);
        killed.announce(Revision(1), &Values::default());
        for n in 0..10 {
            killed.block(&block(20 * n, 1)).unwrap();
        }
        killed.flush().unwrap();
        drop(killed);
        let whole = std::fs::read(&path).unwrap();
        assert!(whole.is_ascii());
        let mut last = 0;
        for cut in (200..whole.len()).rev().step_by(37) {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let recording = Recording::open(&path).unwrap();
            assert!(!recording.sidecar().complete);
            let rows: Vec<_> = recording.rows().unwrap().collect();
            let text = std::str::from_utf8(&whole[..cut]).unwrap();
            let lines = text.matches('\n').count() - 1;
            assert_eq!(rows.iter().filter(|row| row.is_ok()).count(), lines);
            assert_eq!(rows.len(), lines, "a cut line is no error");
            last = rows.len();
        }
        assert!(last < 10);
    }

    #[test]
    fn nothing_is_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        recorder(&path);
        let sidecar = Sidecar::new("another", 7, &Identity::default(), None);
        assert!(matches!(
            Recorder::create(&path, sidecar),
            Err(RecordError::Exists(_))
        ));
    }

    #[test]
    fn a_restart_of_the_drive_is_no_gap() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let mut recorder = recorder(&path);
        recorder.block(&block(5_000, 1)).unwrap();
        let mut again = block(0, 1);
        again.flags = BlockFlags::new(State::Disarmed, false, 2);
        recorder.block(&again).unwrap();
        let sidecar = recorder.finish().unwrap();
        assert_eq!((sidecar.drive_restarts, sidecar.telemetry.dropped), (1, 0));
    }
}
