//! Writing of a recording as the samples arrive.

use super::disk::{Background, Disk};
use super::frame::{Checkpoint, Entry, of_block};
use super::{CHECKPOINT_BLOCKS, MAGIC};
use crate::accounting::{Ledger, Totals};
use crate::ending::{EndCause, Ending};
use crate::metadata::Metadata;
use crate::parameters::named_values;
use crepitus_files::output::{folder_of, sync_folder_of, temporary_in};
use crepitus_protocol::accounting::Begin;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Revision, Values};
use sha2::{Digest, Sha256};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Parameter entries of which one holds all parameters.
const WHOLE_EVERY: u64 = 16;

/// Errors of recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// A file of this name exists.
    #[error("{0} already exists: choose another name, or remove it")]
    Exists(PathBuf),
    /// A write error.
    #[error("{path}: {doing}: {source}")]
    Disk {
        /// The file.
        path: PathBuf,
        /// The action that failed.
        doing: &'static str,
        /// Cause of the failure.
        source: io::Error,
    },
}

/// A recording in progress.
#[derive(Debug)]
pub struct Recorder<D = Background> {
    path: PathBuf,
    disk: D,
    /// Bytes to be appended.
    pending: Vec<u8>,
    /// Bytes since the last checkpoint.
    sum: Sha256,
    id: String,
    checkpoints: u64,
    /// Blocks since the last checkpoint.
    blocks: u64,
    ledger: Ledger,
    /// Revision of the last block.
    revision: Option<Revision>,
    /// The last known values that were written.
    values: Option<Values>,
    /// Parameter entries.
    sets: u64,
    /// Announced before their first block.
    announced: Vec<(Revision, Values)>,
}

impl Recorder {
    /// Begins a recording in a file that must not exist. It appears with its
    /// header: there is no instant at which it cannot be read.
    ///
    /// # Errors
    /// [`RecordError`] if it exists, or cannot be written.
    pub fn create(path: &Path, metadata: &Metadata) -> Result<Self, RecordError> {
        let failed = |source| RecordError::Disk {
            path: path.to_owned(),
            doing: "cannot be created",
            source,
        };
        let head = head(metadata).map_err(failed)?;
        let mut file = temporary_in(folder_of(path)).map_err(failed)?;
        file.write_all(&head).map_err(failed)?;
        file.as_file().sync_all().map_err(failed)?;
        let file = file
            .persist_noclobber(path)
            .map_err(|error| match error.error.kind() {
                io::ErrorKind::AlreadyExists => RecordError::Exists(path.to_owned()),
                _ => failed(error.error),
            })?;
        // And its name: a power cut in the first second leaves a file, too.
        sync_folder_of(path).map_err(failed)?;
        Ok(Self::behind(&head, Background::new(file), path, metadata))
    }
}

/// The first bytes of a recording.
fn head(metadata: &Metadata) -> io::Result<Vec<u8>> {
    let header = Entry::Header(Box::new(metadata.clone())).frame()?;
    Ok([MAGIC, &header].concat())
}

impl<D: Disk> Recorder<D> {
    /// Begins a recording on an empty disk; errors name `path`.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be written.
    pub fn on(mut disk: D, path: &Path, metadata: &Metadata) -> Result<Self, RecordError> {
        let written = head(metadata).and_then(|head| {
            disk.append(&head)?;
            Ok(head)
        });
        let head = written.map_err(|source| RecordError::Disk {
            path: path.to_owned(),
            doing: WRITING,
            source,
        })?;
        Ok(Self::behind(&head, disk, path, metadata))
    }

    /// Goes on behind the first bytes.
    fn behind(head: &[u8], disk: D, path: &Path, metadata: &Metadata) -> Self {
        Self {
            path: path.to_owned(),
            disk,
            pending: Vec::new(),
            sum: Sha256::new_with_prefix(head),
            id: metadata.id.clone(),
            checkpoints: 0,
            blocks: 0,
            ledger: Ledger::default(),
            revision: None,
            values: None,
            sets: 0,
            announced: Vec::new(),
        }
    }

    /// A subscription begins, the first one or after a lost connection.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be written.
    pub fn subscribed(&mut self, begin: Begin) -> Result<(), RecordError> {
        self.ledger.subscribed(begin);
        self.entry(&Entry::Subscribed(begin))
    }

    /// Announces the parameters of a revision, before its first block.
    pub fn announce(&mut self, revision: Revision, values: &Values) {
        self.announced.retain(|(known, _)| *known != revision);
        self.announced.push((revision, *values));
    }

    /// Takes a block; one that is not newer than the last is left out.
    ///
    /// # Errors
    /// [`RecordError`] if a checkpoint cannot be written.
    pub fn block(&mut self, block: &Block) -> Result<(), RecordError> {
        if !self.ledger.block(block) {
            return Ok(());
        }
        self.note_parameters(block.revision)?;
        let frame = of_block(block)
            .map_err(|_| self.failed("a block is too long", io::ErrorKind::InvalidData.into()))?;
        self.put(&frame);
        self.blocks += 1;
        if self.blocks >= CHECKPOINT_BLOCKS {
            self.checkpoint(None)?;
            self.flush()?;
            self.disk
                .sync()
                .map_err(|error| self.failed(WRITING, error))?;
        }
        Ok(())
    }

    /// Writes the parameters of a revision, if they are not those in force.
    fn note_parameters(&mut self, revision: Revision) -> Result<(), RecordError> {
        let at = (self.announced.iter()).position(|(known, _)| *known == revision);
        let values = at.map(|at| self.announced.remove(at).1);
        if self.revision == Some(revision) && (values.is_none() || values == self.values) {
            return Ok(());
        }
        self.revision = Some(revision);
        // Now and then all, so that damage before does not matter any more.
        let is_whole =
            values.is_some() && (self.values.is_none() || self.sets.is_multiple_of(WHOLE_EVERY));
        let changed = values.map(|values| {
            let mut named = named_values(&values);
            if let Some(before) = self.values.replace(values)
                && !is_whole
            {
                let before = named_values(&before);
                named.retain(|name, value| before.get(name) != Some(value));
            }
            named
        });
        let number = self.sets;
        self.sets += 1;
        self.entry(&Entry::Parameters {
            number,
            revision: revision.0,
            is_whole,
            values: changed,
        })
    }

    /// Sums so far.
    pub fn totals(&self) -> Totals {
        self.ledger.accounting().totals
    }

    /// The tick after the last sample.
    pub fn next_tick(&self) -> u64 {
        self.ledger.next_tick()
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Appends what is pending to the file.
    ///
    /// # Errors
    /// [`RecordError`] if that fails. What was written before can be read.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        if self.pending.is_empty() {
            return Ok(());
        }
        let written = self.disk.append(&self.pending);
        self.pending.clear();
        written.map_err(|error| self.failed(WRITING, error))
    }

    /// Finishes the recording as its user intended.
    ///
    /// # Errors
    /// Those of [`Self::end`].
    pub fn finish(self) -> Result<Totals, RecordError> {
        self.end(Ending::of(EndCause::Requested))
    }

    /// Finishes the recording: the last checkpoint with its end, then everything is durable. Samples
    /// that the device had produced by then, and that did not arrive, count as missing.
    ///
    /// # Errors
    /// [`RecordError`] if a write fails.
    pub fn end(mut self, ending: Ending) -> Result<Totals, RecordError> {
        self.ledger.ended(&ending);
        self.checkpoint(Some(ending))?;
        self.flush()?;
        self.disk
            .finish()
            .map_err(|error| self.failed(WRITING, error))?;
        Ok(self.totals())
    }

    fn checkpoint(&mut self, ending: Option<Ending>) -> Result<(), RecordError> {
        let sum = std::mem::take(&mut self.sum).finalize();
        let checkpoint = Entry::Checkpoint(Checkpoint {
            id: self.id.clone(),
            number: self.checkpoints,
            sha256: crepitus_files::output::hex(&sum),
            totals: self.totals(),
            is_end: ending.is_some(),
            ending,
        });
        self.entry(&checkpoint)?;
        // The checkpoint is covered by its own checksum.
        self.sum = Sha256::new();
        self.checkpoints += 1;
        self.blocks = 0;
        Ok(())
    }

    fn entry(&mut self, entry: &Entry) -> Result<(), RecordError> {
        let frame = entry.frame().map_err(|error| self.failed(WRITING, error))?;
        self.put(&frame);
        Ok(())
    }

    fn put(&mut self, bytes: &[u8]) {
        self.sum.update(bytes);
        self.pending.extend(bytes);
    }

    fn failed(&self, doing: &'static str, source: io::Error) -> RecordError {
        RecordError::Disk {
            path: self.path.clone(),
            doing,
            source,
        }
    }
}

/// The action in most errors.
const WRITING: &str = "the samples cannot be written";
