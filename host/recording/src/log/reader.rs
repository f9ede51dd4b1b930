//! Reading of the file of a recording in progress, in order to any damage.

use super::frame::{Checkpoint, Content, Entry, Owner};
use super::{FRAME_LIMIT, MAGIC, repair};
use crate::books::Ledger;
use crate::findings::Findings;
use crate::metadata::Metadata;
use crate::parameters::{History, Named, ParameterSet};
use crepitus_protocol::frame::DELIMITER;
use crepitus_protocol::telemetry::Block;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};

/// Reads blocks, and keeps books and findings meanwhile.
#[derive(Debug)]
pub(crate) struct LogReader<R> {
    input: R,
    offset: u64,
    chunk: Vec<u8>,
    /// Of the bytes since the last checkpoint.
    sum: Sha256,
    owner: Owner,
    metadata: Option<Metadata>,
    ledger: Ledger,
    history: History,
    /// All parameters of the last known set.
    known: Named,
    /// Parameter entries that were read or have been missed.
    entries: u64,
    /// The set that changes refer to is missing.
    is_history_broken: bool,
    checkpoints: u64,
    /// Tick of the last checkpoint.
    checked_tick: u64,
    /// Damage since the last checkpoint was found.
    is_noted: bool,
    /// Bytes that are no frames, from an offset on.
    damage: Option<(u64, u64)>,
    repeated: u64,
    is_ended: bool,
    findings: Findings,
}

/// Bytes between two delimiters.
enum Frame {
    Whole(Content),
    Damaged,
    /// Nothing: the file ends.
    End,
}

/// Result of reading a whole file.
#[derive(Debug)]
pub(crate) struct Scanned {
    pub(crate) metadata: Metadata,
    pub(crate) ledger: Ledger,
    pub(crate) history: History,
    pub(crate) is_complete: bool,
    is_disordered: bool,
    /// Bytes at the end that are no frame.
    pub(crate) cut_bytes: u64,
    pub(crate) findings: Findings,
    /// A copy with frames in their order, if the file has not.
    pub(crate) sorted: Option<File>,
}

/// Reads a whole file. Of one whose frames are out of order, a copy is made.
pub(crate) fn scan(file: &File) -> io::Result<Scanned> {
    let scanned = read_all(file)?;
    if !scanned.is_disordered {
        return Ok(scanned);
    }
    let sorted = repair::sorted(file)?;
    let copy = read_all(&sorted)?;
    Ok(Scanned {
        ledger: copy.ledger,
        history: copy.history,
        sorted: Some(sorted),
        ..scanned
    })
}

fn read_all(mut file: &File) -> io::Result<Scanned> {
    file.seek(SeekFrom::Start(0))?;
    let mut reader = LogReader::new(BufReader::with_capacity(1 << 16, file))?;
    while reader.next()?.is_some() {}
    Ok(reader.finish())
}

impl<R: BufRead> LogReader<R> {
    /// Begins at the start of a file.
    pub(crate) fn new(mut input: R) -> io::Result<Self> {
        let mut chunk = Vec::new();
        (&mut input)
            .take(MAGIC.len() as u64)
            .read_to_end(&mut chunk)?;
        let mut findings = Findings::default();
        if chunk != MAGIC {
            findings.add("Its first bytes are not those of a recording".to_owned());
        }
        Ok(Self {
            input,
            offset: chunk.len() as u64,
            sum: Sha256::new_with_prefix(&chunk),
            chunk,
            owner: Owner::default(),
            metadata: None,
            ledger: Ledger::default(),
            history: History::default(),
            known: Named::new(),
            entries: 0,
            is_history_broken: false,
            checkpoints: 0,
            checked_tick: 0,
            is_noted: false,
            damage: None,
            repeated: 0,
            is_ended: false,
            findings,
        })
    }

    /// The next block that is newer than the one before.
    pub(crate) fn next(&mut self) -> io::Result<Option<Box<Block>>> {
        loop {
            let from = self.offset;
            match self.frame()? {
                Frame::Whole(content) => {
                    self.note_damage();
                    if let Some(block) = self.take(content, from) {
                        return Ok(Some(block));
                    }
                }
                Frame::Damaged => {
                    let (first, bytes) = self.damage.unwrap_or((from, 0));
                    self.damage = Some((first, bytes + self.chunk.len() as u64));
                }
                Frame::End => return Ok(None),
            }
        }
    }

    /// The next frame.
    fn frame(&mut self) -> io::Result<Frame> {
        self.chunk.clear();
        let read = (&mut self.input)
            .take(FRAME_LIMIT)
            .read_until(DELIMITER, &mut self.chunk)?;
        if read == 0 {
            return Ok(Frame::End);
        }
        self.offset += read as u64;
        let Some((&DELIMITER, frame)) = self.chunk.split_last() else {
            self.sum.update(&self.chunk);
            return Ok(Frame::Damaged);
        };
        let content = Content::of(&mut frame.to_vec());
        let is_checkpoint = matches!(&content, Some(Content::Entry(entry)) if matches!(**entry, Entry::Checkpoint(_)));
        if !is_checkpoint {
            self.sum.update(&self.chunk);
        }
        Ok(content.map_or(Frame::Damaged, Frame::Whole))
    }

    /// Frames follow bytes that are none.
    fn note_damage(&mut self) {
        if let Some((offset, bytes)) = self.damage.take() {
            let tick = self.ledger.next_tick();
            self.findings.add(format!(
                "{bytes} bytes from byte {offset} on are damaged, after tick {tick}"
            ));
            self.ledger.damaged();
            self.is_noted = true;
        }
    }

    fn take(&mut self, content: Content, from: u64) -> Option<Box<Block>> {
        if self.is_ended {
            self.findings
                .add(format!("There is more after its end, from byte {from} on"));
            return None;
        }
        let is_own = self.owner.owns(&content);
        let entry = match content {
            Content::Block(_) if !is_own => return None,
            Content::Block(block) => return self.block(block),
            Content::Entry(entry) => *entry,
        };
        match entry {
            Entry::Header(_) if self.metadata.is_some() => {
                let what = if is_own {
                    "Its header is there twice"
                } else {
                    "Another recording begins in it, and its samples are left out"
                };
                self.findings.add(format!("{what}, at byte {from}"));
                self.is_noted = true;
            }
            Entry::Header(metadata) => self.metadata = Some(*metadata),
            _ if !is_own => {}
            Entry::Subscribed(begin) => self.ledger.subscribed(begin),
            Entry::Parameters {
                number,
                revision,
                is_whole,
                values,
            } => self.parameters(number, revision, is_whole, values),
            Entry::Checkpoint(checkpoint) => self.checkpoint(&checkpoint),
        }
        None
    }

    fn block(&mut self, block: Box<Block>) -> Option<Box<Block>> {
        let row = self.ledger.books().totals.received;
        if !self.ledger.block(&block) {
            self.repeated += 1;
            if self.repeated == 1 {
                self.findings.add(format!(
                    "Samples are doubled or out of order, first those of tick {}",
                    block.first_tick
                ));
            }
            self.is_noted = true;
            return None;
        }
        match self.history.0.last_mut() {
            // They came before it.
            Some(set) if set.first_row == row && set.revision == block.revision.0 => {
                set.first_tick = block.first_tick;
            }
            Some(set) if set.revision == block.revision.0 => {}
            // Their entry is damaged.
            _ => {
                self.is_history_broken = true;
                self.history.0.push(ParameterSet {
                    revision: block.revision.0,
                    first_row: row,
                    first_tick: block.first_tick,
                    values: None,
                });
            }
        }
        Some(block)
    }

    fn parameters(&mut self, number: u64, revision: u32, is_whole: bool, values: Option<Named>) {
        let was_broken = self.is_history_broken || number != self.entries;
        self.is_history_broken = was_broken && !is_whole;
        self.entries = number + 1;
        let mut values = values.filter(|_| !self.is_history_broken);
        if let Some(values) = &mut values {
            if !was_broken {
                values.retain(|name, value| self.known.get(name) != Some(value));
            }
            let new = values
                .iter()
                .map(|(name, value)| (name.clone(), value.clone()));
            self.known.extend(new);
        }
        self.history.0.push(ParameterSet {
            revision,
            first_row: self.ledger.books().totals.received,
            first_tick: self.ledger.next_tick(),
            values,
        });
    }

    fn checkpoint(&mut self, checkpoint: &Checkpoint) {
        let sum = std::mem::take(&mut self.sum).finalize();
        let tick = self.ledger.next_tick();
        let (from, is_noted) = (self.checked_tick, self.is_noted);
        (self.checked_tick, self.is_noted) = (tick, false);
        let id = self.metadata.as_ref().map(|metadata| &metadata.id);
        if id.is_some_and(|id| *id != checkpoint.id) {
            self.findings.add(format!(
                "Samples of another recording stand in it, before tick {tick}"
            ));
            return;
        }
        if checkpoint.number != self.checkpoints {
            self.findings.add(format!(
                "Checkpoint {} is missing or out of order before tick {tick}",
                self.checkpoints
            ));
        } else if !is_noted && crate::hex(&sum) != checkpoint.sha256 {
            self.findings.add(format!(
                "What stands between ticks {from} and {tick} is not what was written"
            ));
        }
        self.checkpoints = checkpoint.number + 1;
        self.ledger.expect_received(checkpoint.totals.received);
        self.is_ended = checkpoint.is_end;
        if checkpoint.is_end && self.findings.is_empty() {
            let totals = self.ledger.books().totals;
            if totals != checkpoint.totals {
                self.findings.add(format!(
                    "Its samples are {totals:?}, but its books say {:?}",
                    checkpoint.totals
                ));
            }
        }
    }

    /// The result of reading, up to here.
    pub(crate) fn finish(mut self) -> Scanned {
        let cut_bytes = self.damage.map_or(0, |(_, bytes)| bytes);
        if self.is_ended && cut_bytes > 0 {
            self.findings
                .add(format!("{cut_bytes} bytes follow its end"));
        }
        if self.metadata.is_none() {
            self.findings.add("Its header is missing".to_owned());
        }
        Scanned {
            metadata: self.metadata.unwrap_or_else(Metadata::unknown),
            ledger: self.ledger,
            history: self.history,
            is_complete: self.is_ended,
            cut_bytes,
            findings: self.findings,
            is_disordered: self.repeated > 0,
            sorted: None,
        }
    }
}
