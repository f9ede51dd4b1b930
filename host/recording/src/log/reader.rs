//! Reading of the file of a recording in progress, in order to any damage.

use super::frame::{Checkpoint, Content, Entry, Owner};
use super::{FRAME_LIMIT, MAGIC, repair};
use crate::accounting::{Ledger, Totals};
use crate::damage::Damage;
use crate::ending::Ending;
use crate::findings::Findings;
use crate::metadata::Metadata;
use crate::parameters::{History, Named, ParameterSet, values_of};
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::Source;
use crepitus_protocol::accounting::Begin;
use crepitus_protocol::frame::DELIMITER;
use crepitus_protocol::telemetry::Block;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};

/// Reads blocks, and keeps accounting and findings meanwhile.
#[derive(Debug)]
pub(crate) struct LogReader<R> {
    input: R,
    offset: u64,
    chunk: Vec<u8>,
    /// SHA-256 of the bytes since the last checkpoint.
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
    /// Assumptions from which angles follow meanwhile.
    assumed: Findings,
    checkpoints: u64,
    /// Tick of the last checkpoint.
    checked_tick: u64,
    /// The latest sums of a checkpoint.
    said: Option<Totals>,
    /// Damage since the last checkpoint was found.
    is_noted: bool,
    /// Bytes that are no frames, from an offset on.
    damage: Option<(u64, u64)>,
    repeated: u64,
    /// First tick of a subscription that goes back, and the tick that was due before it.
    went_back: Option<(u64, u64)>,
    is_ended: bool,
    ending: Option<Ending>,
    /// First byte of what follows the end.
    more_from: Option<u64>,
    findings: Findings,
}

/// Bytes between two delimiters.
enum Frame {
    Whole(Content),
    Damaged,
    /// No frame: the file ends.
    End,
}

/// Result of reading a whole file.
#[derive(Debug)]
pub(crate) struct Scanned {
    pub(crate) metadata: Metadata,
    pub(crate) ledger: Ledger,
    pub(crate) history: History,
    pub(crate) is_complete: bool,
    /// End that its program has noted.
    pub(crate) ending: Option<Ending>,
    is_disordered: bool,
    said: Option<Totals>,
    assumed: Findings,
    /// Bytes at the end that are no frame.
    pub(crate) cut_bytes: u64,
    pub(crate) findings: Findings,
    /// A copy with frames in their order, if the file has not.
    pub(crate) sorted: Option<File>,
}

/// Reads a whole file. Of one whose frames are out of order, a copy is made if it is salvaged:
/// one that is refused needs none, which takes as much disk as the file.
pub(crate) fn scan(file: &File, damage: Damage) -> io::Result<Scanned> {
    let mut scanned = read_all(file, None)?;
    if scanned.is_disordered {
        scanned = match damage {
            // What has to be assumed shows in their order alone.
            Damage::Refuse => Scanned {
                assumed: Findings::default(),
                ..scanned
            },
            Damage::Salvage => put_in_order(file, scanned)?,
        };
    }
    // Said first: numbers depend on it.
    let mut findings = std::mem::take(&mut scanned.assumed);
    findings.extend(scanned.findings);
    scanned.findings = findings;
    Ok(scanned)
}

/// Reads a file again, in a copy that is in order.
fn put_in_order(file: &File, scanned: Scanned) -> io::Result<Scanned> {
    let sorted = repair::sorted(file, &std::env::temp_dir())?;
    let copy = read_all(&sorted, scanned.said)?;
    Ok(Scanned {
        ledger: copy.ledger,
        history: copy.history,
        assumed: copy.assumed,
        sorted: Some(sorted),
        ..scanned
    })
}

/// Reads a file, or a copy without checkpoints, of which the last one `said` this.
fn read_all(mut file: &File, mut said: Option<Totals>) -> io::Result<Scanned> {
    file.seek(SeekFrom::Start(0))?;
    let mut reader = LogReader::new(BufReader::with_capacity(1 << 16, file))?;
    while let Some(block) = reader.next()? {
        let produced = reader.ledger.accounting().totals.produced;
        if let Some(said) = said.take_if(|said| said.produced <= produced) {
            // This block may have come after it: where those before it are missing.
            let since = (produced - said.produced).min(block.samples.len() as u64);
            let received = said.received.saturating_add(since);
            reader.ledger.expect_received(received);
        }
    }
    if let Some(said) = said {
        reader.ledger.expect_received(said.received);
    }
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
            assumed: Findings::default(),
            checkpoints: 0,
            checked_tick: 0,
            said: None,
            is_noted: false,
            damage: None,
            repeated: 0,
            went_back: None,
            is_ended: false,
            ending: None,
            more_from: None,
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
            let (bytes, are) = match bytes {
                1 => ("1 byte".to_owned(), "is"),
                _ => (format!("{bytes} bytes"), "are"),
            };
            self.findings.add(format!(
                "{bytes} from byte {offset} on {are} damaged, after tick {tick}"
            ));
            self.ledger.damaged();
            self.is_noted = true;
        }
    }

    fn take(&mut self, content: Content, from: u64) -> Option<Box<Block>> {
        if self.is_ended {
            // Once: another recording may follow, with thousands of frames.
            if self.more_from.is_none() {
                self.more_from = Some(from);
                self.findings
                    .add(format!("There is more after its end, from byte {from} on"));
            }
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
            Entry::Subscribed(begin) => self.subscribed(begin),
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

    fn subscribed(&mut self, begin: Begin) {
        if self.ledger.has_passed(begin) {
            self.repeat(begin.first_tick);
        } else {
            let goes_back = self.ledger.goes_back(begin);
            self.went_back = goes_back.then_some((begin.first_tick, self.ledger.next_tick()));
            self.ledger.subscribed(begin);
        }
    }

    /// Counts content that is there already, or belongs before what was read; reports the first.
    fn repeat(&mut self, tick: u64) {
        self.repeated += 1;
        if self.repeated == 1 {
            self.findings.add(format!(
                "Samples or entries are doubled or out of order, first those of tick {tick}"
            ));
        }
        self.is_noted = true;
    }

    fn block(&mut self, block: Box<Block>) -> Option<Box<Block>> {
        let row = self.ledger.accounting().totals.received;
        if !self.ledger.block(&block) {
            self.repeat(block.first_tick);
            return None;
        }
        // Ticks go on as before it: the drive has not restarted, the entry stands too late.
        if let Some((first_tick, next_tick)) = self.went_back.take()
            && next_tick <= block.first_tick
        {
            self.repeat(first_tick);
        }
        match self.history.0.last_mut() {
            // They came before it.
            Some(set) if set.first_row == row && set.revision == block.revision.0 => {
                set.first_tick = block.first_tick;
            }
            Some(set) if set.revision == block.revision.0 => {}
            // Their entry is damaged.
            _ => {
                self.break_history(block.first_tick);
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

    /// Values are not known from a tick on, but angles are computed all the same.
    fn break_history(&mut self, tick: u64) {
        if std::mem::replace(&mut self.is_history_broken, true) {
            return;
        }
        let which = if self.known.is_empty() {
            "default"
        } else {
            "last known"
        };
        let encoder: EncoderSettings = values_of(&self.known).read();
        self.assumed.add(format!(
            "Parameters are unknown from tick {tick} on, up to the next entry with all of them: angles and \
             speeds there are those of the {which} encoder, {} counts a motor turn and gear ratio {}",
            4.0 * encoder.lines,
            encoder.gear_ratio
        ));
    }

    fn parameters(&mut self, number: u64, revision: u32, is_whole: bool, values: Option<Named>) {
        let was_broken = self.is_history_broken || number != self.entries;
        if was_broken && !is_whole {
            self.break_history(self.ledger.next_tick());
        } else {
            self.is_history_broken = false;
        }
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
            first_row: self.ledger.accounting().totals.received,
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
        } else if !is_noted && crepitus_files::output::hex(&sum) != checkpoint.sha256 {
            self.findings.add(format!(
                "What stands between ticks {from} and {tick} is not what was written"
            ));
        }
        self.checkpoints = checkpoint.number + 1;
        // In a file that is out of order, checkpoints may be, too.
        let received = checkpoint.totals.received;
        if self.said.is_none_or(|said| said.received <= received) {
            self.said = Some(checkpoint.totals);
        }
        self.ledger.expect_received(received);
        self.is_ended = checkpoint.is_end;
        if let Some(ending) = &checkpoint.ending {
            self.ledger.ended(ending);
            self.ending = Some(ending.clone());
        }
        if checkpoint.is_end && self.findings.is_empty() {
            let totals = self.ledger.accounting().totals;
            if totals != checkpoint.totals {
                self.findings.add(format!(
                    "Its samples were counted as {}, but its end says {}",
                    totals.text(),
                    checkpoint.totals.text()
                ));
            }
        }
    }

    /// The result of reading, up to here.
    pub(crate) fn finish(mut self) -> Scanned {
        let cut_bytes = self.damage.map_or(0, |(_, bytes)| bytes);
        if self.is_ended && cut_bytes > 0 {
            self.findings.add(match cut_bytes {
                1 => "1 byte follows its end".to_owned(),
                _ => format!("{cut_bytes} bytes follow its end"),
            });
        }
        if self.metadata.is_none() {
            self.findings.add("Its header is missing".to_owned());
        }
        Scanned {
            metadata: self.metadata.unwrap_or_else(Metadata::unknown),
            ledger: self.ledger,
            history: self.history,
            is_complete: self.is_ended,
            ending: self.ending,
            cut_bytes,
            findings: self.findings,
            is_disordered: self.repeated > 0,
            said: self.said,
            assumed: self.assumed,
            sorted: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::frame::of_block;
    use crepitus_protocol::management::Identity;
    use std::io::Write;

    /// A log whose second block stands before its first.
    fn disordered() -> File {
        let header = Metadata::new("a test", &Identity::default(), None);
        let header = Entry::Header(Box::new(header)).frame().expect("JSON");
        let block = |first_tick| {
            let block = Block {
                first_tick,
                ..Block::default()
            };
            of_block(&block).expect("a block fits").to_vec()
        };
        let mut file = tempfile::tempfile().expect("a file");
        for bytes in [MAGIC.to_vec(), header, block(20), block(0)] {
            file.write_all(&bytes).expect("written");
        }
        file
    }

    /// The disk for a copy may be full, or not there.
    #[test]
    fn a_log_out_of_order_is_named_without_a_copy_if_it_is_refused() {
        let file = disordered();
        let scanned = scan(&file, Damage::Refuse).expect("read");
        let said = scanned.findings.to_string();
        assert!(said.contains("out of order"), "{said}");
        assert!(scanned.sorted.is_none());
        let scanned = scan(&file, Damage::Salvage).expect("read");
        assert!(scanned.sorted.is_some());
        assert_eq!(scanned.ledger.accounting().totals.received, 40);
    }

    #[test]
    fn the_folder_in_which_no_copy_can_be_made_is_named() {
        let folder = tempfile::tempdir().expect("a folder").path().join("none");
        let error = repair::sorted(&disordered(), &folder).expect_err("there is no such folder");
        let said = error.to_string();
        assert!(said.contains(&folder.display().to_string()), "{said}");
        assert!(said.contains("out of order"), "{said}");
    }
}
