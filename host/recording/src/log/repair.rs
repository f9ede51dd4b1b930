//! Frames that are out of order, put in order again: a copy of the file for
//! reading on.

use super::MAGIC;
use super::frame::{Content, Entry, Owner};
use crepitus_protocol::frame::DELIMITER;
use std::collections::{BTreeMap, HashSet};
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// A frame and where it belongs: the ticks of a start of the drive, or, of
/// parameters, the block that follows them.
#[derive(Clone, Copy, Debug)]
struct Place {
    start: u8,
    tick: u64,
    /// A block stands behind the entries of its tick.
    is_block: bool,
    from: u64,
    bytes: u64,
}

/// Copies what is readable: blocks and subscriptions by start and tick, entries each once;
/// parameters stay before the block that they stand before. Checkpoints are left out.
/// The copy is a nameless file in a folder.
pub(super) fn sorted(file: &File, folder: &Path) -> io::Result<File> {
    let (header, places) = places(file)?;
    copied(file, header.iter().chain(&places), folder).map_err(|error| {
        let text = format!(
            "its samples are out of order, and a copy in order cannot be made in the folder for \
             temporary files, {}: {error}",
            folder.display()
        );
        io::Error::new(error.kind(), text)
    })
}

fn copied<'p>(
    file: &File,
    frames: impl Iterator<Item = &'p Place>,
    folder: &Path,
) -> io::Result<File> {
    let mut copy = BufWriter::new(tempfile::tempfile_in(folder)?);
    copy.write_all(MAGIC)?;
    for place in frames {
        let mut file = file;
        file.seek(SeekFrom::Start(place.from))?;
        io::copy(&mut file.take(place.bytes), &mut copy)?;
    }
    let mut copy = copy.into_inner().map_err(io::IntoInnerError::into_error)?;
    copy.seek(SeekFrom::Start(0))?;
    Ok(copy)
}

/// The header, and every other frame in its order.
fn places(mut file: &File) -> io::Result<(Option<Place>, Vec<Place>)> {
    file.seek(SeekFrom::Start(MAGIC.len() as u64))?;
    let mut input = BufReader::new(file);
    let (mut header, mut places, mut waiting) = (None, Vec::new(), Vec::new());
    let mut entries = HashSet::new();
    let mut owner = Owner::default();
    let mut from = MAGIC.len() as u64;
    let mut chunk = Vec::new();
    loop {
        chunk.clear();
        let bytes = input
            .by_ref()
            .take(super::FRAME_LIMIT)
            .read_until(DELIMITER, &mut chunk)? as u64;
        if bytes == 0 {
            break;
        }
        let mut place = Place {
            start: 0,
            tick: 0,
            is_block: false,
            from,
            bytes,
        };
        from += bytes;
        let frame = chunk.strip_suffix(&[DELIMITER]).unwrap_or_default();
        let content = Content::of(&mut frame.to_vec());
        match content.filter(|content| owner.owns(content)) {
            Some(Content::Block(block)) => {
                (place.start, place.tick) = (block.flags.start(), block.first_tick);
                for mut entry in waiting.drain(..) {
                    let Place { from, bytes, .. } = entry;
                    entry = Place {
                        from,
                        bytes,
                        ..place
                    };
                    places.push(entry);
                }
                place.is_block = true;
                places.push(place);
            }
            Some(Content::Entry(entry)) => match *entry {
                Entry::Header(_) => header = header.or(Some(place)),
                Entry::Checkpoint(_) => {}
                _ if !entries.insert(chunk.clone()) => {}
                Entry::Subscribed(begin) => {
                    (place.start, place.tick) = (begin.start, begin.first_tick);
                    places.push(place);
                }
                Entry::Parameters { .. } => waiting.push(place),
            },
            None => {}
        }
    }
    // Starts in the order in which most of their blocks stand.
    let mut sums: BTreeMap<u8, (u128, u128)> = BTreeMap::new();
    for (at, place) in (0_u128..).zip(&places) {
        let (sum, count) = sums.entry(place.start).or_default();
        (*sum, *count) = (*sum + at, *count + 1);
    }
    let rank = |place: &Place| sums.get(&place.start).map(|(sum, count)| sum / count);
    // Stable: entries stay in their order.
    places.sort_by_key(|place| (rank(place), place.start, place.tick, place.is_block));
    Ok((header, places))
}
