//! Reading of a recording, in whichever format it is.

use crate::accounting::SampleAccounting;
use crate::damage::Damage;
use crate::ending::Ending;
use crate::findings::Findings;
use crate::log::MAGIC;
use crate::log::frame::Content;
use crate::log::reader::{self, LogReader};
use crate::metadata::{FORMAT, Metadata};
use crate::parameters::{History, InForce};
#[cfg(feature = "parquet")]
use crate::parquet;
use crate::row::{Row, seconds};
use crate::samples::Samples;
use crepitus_files::input;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Errors of reading.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be read.
    #[error("{path}: cannot be read: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// Cause of the failure.
        source: io::Error,
    },
    /// Something else.
    #[error(
        "{0}: not a recording: expected a file that `crepitus record` has written, not one that was \
         exported from it"
    )]
    Foreign(PathBuf),
    /// The format is unknown, of a later version.
    #[error(
        "{path}: expected a recording of version {FORMAT}, got {found}: read it with the crepitus that wrote it"
    )]
    Format {
        /// The file.
        path: PathBuf,
        /// Version of the recording.
        found: u32,
    },
    /// This program was built without what reads it.
    #[error(
        "{0}: a Parquet file, and this crepitus was built without that format: build it with \
         `--features parquet`"
    )]
    NoParquet(PathBuf),
    /// The file is not what was written.
    #[error(
        "{path}: damaged:{findings}\nwith `--salvage` all that is readable is kept, and samples that \
         are out of order are put in order"
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Damage that was found in it.
        findings: Findings,
    },
}

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Format of a recording in progress.
    Log,
    /// Parquet.
    Parquet,
}

/// A recording.
#[derive(Debug)]
pub struct Recording {
    path: PathBuf,
    metadata: Metadata,
    accounting: SampleAccounting,
    history: History,
    is_complete: bool,
    ending: Option<Ending>,
    cut_bytes: u64,
    findings: Findings,
    /// Damage of the file that this one was made of, in sentences.
    earlier_damage: Vec<String>,
    source: Source,
}

#[derive(Debug)]
enum Source {
    Log(File),
    #[cfg(feature = "parquet")]
    Parquet(parquet::Reader),
}

impl Recording {
    /// Opens a recording, and reads all of it once to check it.
    ///
    /// # Errors
    /// [`ReadError`] if it is none, or damaged and that is refused.
    pub fn open(path: &Path, damage: Damage) -> Result<Self, ReadError> {
        let failed = |source| ReadError::Io {
            path: path.to_owned(),
            source,
        };
        let format = format_of(path)
            .map_err(failed)?
            .ok_or_else(|| ReadError::Foreign(path.to_owned()))?;
        let recording = match format {
            Format::Log => Self::log(path, damage).map_err(failed)?,
            #[cfg(feature = "parquet")]
            Format::Parquet => Self::parquet(path).map_err(failed)?,
            #[cfg(not(feature = "parquet"))]
            Format::Parquet => return Err(ReadError::NoParquet(path.to_owned())),
        };
        // 0: its header is damaged.
        if ![0, FORMAT].contains(&recording.metadata.format) {
            return Err(ReadError::Format {
                path: path.to_owned(),
                found: recording.metadata.format,
            });
        }
        if damage == Damage::Refuse && !recording.findings.is_empty() {
            return Err(ReadError::Damaged {
                path: path.to_owned(),
                findings: recording.findings,
            });
        }
        Ok(recording)
    }

    fn log(path: &Path, damage: Damage) -> io::Result<Self> {
        let file = input::open(path)?;
        let scanned = reader::scan(&file, damage)?;
        Ok(Self {
            path: path.to_owned(),
            metadata: scanned.metadata,
            accounting: scanned.ledger.into_accounting(),
            history: scanned.history,
            is_complete: scanned.is_complete,
            ending: scanned.ending,
            cut_bytes: scanned.cut_bytes,
            findings: scanned.findings,
            earlier_damage: Vec::new(),
            source: Source::Log(scanned.sorted.unwrap_or(file)),
        })
    }

    #[cfg(feature = "parquet")]
    fn parquet(path: &Path) -> io::Result<Self> {
        let (reader, read, findings) = parquet::Reader::open(path)?;
        Ok(Self {
            path: path.to_owned(),
            metadata: read.metadata,
            accounting: read.accounting,
            history: read.parameters,
            is_complete: read.is_complete,
            ending: read.ending,
            cut_bytes: 0,
            findings,
            earlier_damage: read.damage,
            source: Source::Parquet(reader),
        })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Title, device, program.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// The accounting, counted in what is readable.
    pub fn accounting(&self) -> &SampleAccounting {
        &self.accounting
    }

    /// The parameters.
    pub fn parameters(&self) -> &History {
        &self.history
    }

    /// True if it was ended in order, not cut off, and nothing is missing at its end.
    pub fn is_complete(&self) -> bool {
        self.is_complete && self.accounting.missing_at_end == 0
    }

    /// True if its program has written its end.
    #[cfg(feature = "parquet")]
    pub(crate) fn is_ended(&self) -> bool {
        self.is_complete
    }

    /// The end that its program has noted.
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }

    /// The format of the file.
    pub fn format(&self) -> Format {
        match self.source {
            Source::Log(_) => Format::Log,
            #[cfg(feature = "parquet")]
            Source::Parquet(_) => Format::Parquet,
        }
    }

    /// Damage and missing samples, in sentences.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self
            .damage("The file is damaged, and this is what could be read of it. What is wrong:");
        if !self.is_complete {
            let cut = match self.cut_bytes {
                0 => String::new(),
                1 => " Its last byte is no whole sample.".to_owned(),
                bytes => format!(" Its last {bytes} bytes are no whole sample."),
            };
            warnings.push(format!(
                "The recording is incomplete, its end is missing: perhaps its program still runs, was stopped \
                 or could not write.{cut}"
            ));
        }
        warnings.extend(self.ending.as_ref().and_then(Ending::warning));
        warnings.extend(self.missing());
        warnings.extend(self.missing_at_end());
        warnings
    }

    /// Damage, to be said of a file that is made of this one.
    #[cfg(feature = "parquet")]
    pub(crate) fn inherited_damage(&self) -> Vec<String> {
        self.damage(
            "It was made of a damaged file, and this is what could be read of that. What was wrong:",
        )
    }

    /// Damage of the file it was made of, and its own behind a heading.
    fn damage(&self, heading: &str) -> Vec<String> {
        let mut damage = self.earlier_damage.clone();
        if !self.findings.is_empty() {
            damage.push(heading.to_owned());
            damage.extend(self.findings.sentences());
        }
        damage
    }

    fn missing(&self) -> Option<String> {
        let totals = &self.accounting.totals;
        let causes = [
            ("dropped by the device", totals.by_device),
            ("lost on the way", totals.on_the_way()),
            (
                "not recorded while the connection was lost",
                totals.not_connected,
            ),
            ("damaged in the file", totals.damaged),
        ];
        let causes: Vec<_> = causes
            .iter()
            .filter(|(_, samples)| *samples > 0)
            .map(|(cause, samples)| format!("{samples} {cause}"))
            .collect();
        (totals.dropped > 0).then(|| {
            format!(
                "{} of {} samples ({:.3} s) are missing in {} gap{}: {}.",
                totals.dropped,
                totals.produced,
                seconds(totals.dropped),
                self.accounting.gap_count,
                if self.accounting.gap_count == 1 {
                    ""
                } else {
                    "s"
                },
                causes.join(", ")
            )
        })
    }

    fn missing_at_end(&self) -> Option<String> {
        let samples = self.accounting.missing_at_end;
        (samples > 0).then(|| {
            format!(
                "Its end is missing, {samples} samples ({:.3} s): the device had produced them by then, and \
                 they did not arrive. The computer may have slept, or the connection hung.",
                seconds(samples)
            )
        })
    }

    /// Samples of the recording in order.
    ///
    /// # Errors
    /// [`ReadError::Io`].
    pub fn rows(&self) -> Result<Rows<'_>, ReadError> {
        let source = match &self.source {
            Source::Log(file) => LogRows::new(file, &self.history, self.accounting.totals.received)
                .map(|rows| RowSource::Log(Box::new(rows))),
            #[cfg(feature = "parquet")]
            Source::Parquet(reader) => Ok(RowSource::Parquet(reader.rows())),
        };
        Ok(Rows {
            path: &self.path,
            source: source.map_err(|source| self.failed(source))?,
        })
    }

    fn failed(&self, source: io::Error) -> ReadError {
        ReadError::Io {
            path: self.path.clone(),
            source,
        }
    }
}

/// The samples of a recording.
#[derive(Debug)]
pub struct Rows<'r> {
    path: &'r Path,
    source: RowSource<'r>,
}

#[derive(Debug)]
enum RowSource<'r> {
    Log(Box<LogRows<'r>>),
    #[cfg(feature = "parquet")]
    Parquet(parquet::ParquetRows<'r>),
}

impl Iterator for Rows<'_> {
    type Item = Result<Row, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        let row = match &mut self.source {
            RowSource::Log(rows) => rows.next(),
            #[cfg(feature = "parquet")]
            RowSource::Parquet(rows) => rows.next(),
        };
        row.map_err(|source| ReadError::Io {
            path: self.path.to_owned(),
            source,
        })
        .transpose()
    }
}

/// Rows of the blocks of a log.
#[derive(Debug)]
struct LogRows<'r> {
    reader: LogReader<BufReader<&'r File>>,
    in_force: InForce<'r>,
    samples: Samples,
    /// Rows of the block at hand.
    block: std::vec::IntoIter<Row>,
    count: u64,
    /// Number of rows of the file when it was opened: it may be growing.
    rows: u64,
}

impl<'r> LogRows<'r> {
    fn new(mut file: &'r File, history: &'r History, rows: u64) -> io::Result<Self> {
        file.seek(SeekFrom::Start(0))?;
        Ok(Self {
            reader: LogReader::new(BufReader::with_capacity(1 << 16, file))?,
            in_force: history.in_force(),
            samples: Samples::default(),
            block: Vec::new().into_iter(),
            count: 0,
            rows,
        })
    }

    fn next(&mut self) -> io::Result<Option<Row>> {
        if let Some(row) = self.block.next() {
            return Ok(Some(row));
        }
        if self.count >= self.rows {
            return Ok(None);
        }
        let Some(block) = self.reader.next()? else {
            return Ok(None);
        };
        if self.in_force.at(self.count) {
            // Where they are unknown, a finding says that these are taken.
            self.samples.set(&self.in_force.last_values());
        }
        self.count += block.samples.len() as u64;
        let rows: Vec<_> = self.samples.rows(&block).collect();
        self.block = rows.into_iter();
        Ok(self.block.next())
    }
}

/// First and last bytes of a Parquet file.
const PARQUET: &[u8; 4] = b"PAR1";

/// Bytes in which a damaged recording has at least one frame in order.
const HEAD_BYTES: u64 = 1 << 16;

/// The format of a file, also of one whose first bytes are damaged; none if it
/// is no recording.
fn format_of(path: &Path) -> io::Result<Option<Format>> {
    let mut file = input::open(path)?;
    let mut head = Vec::new();
    (&mut file).take(HEAD_BYTES).read_to_end(&mut head)?;
    if head.starts_with(MAGIC) {
        return Ok(Some(Format::Log));
    }
    if head.starts_with(PARQUET) {
        return Ok(Some(Format::Parquet));
    }
    let length = file.metadata()?.len();
    if length > PARQUET.len() as u64 {
        let mut tail = Vec::new();
        file.seek(SeekFrom::End(-4))?;
        file.read_to_end(&mut tail)?;
        if tail == PARQUET {
            return Ok(Some(Format::Parquet));
        }
    }
    let mut frames = head.split_mut(|byte| *byte == 0);
    let is_log = frames.any(|frame| !frame.is_empty() && Content::of(frame).is_some());
    Ok(is_log.then_some(Format::Log))
}
