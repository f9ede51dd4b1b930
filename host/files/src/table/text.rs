//! A file as lines of text, whatever its encoding and its line ends.
//!
//! UTF-16 is known by its mark or its zeros, UTF-8 by being valid; a line that is neither has an
//! encoding guessed from it, which is kept for the rest. Lines end with LF, CR LF or CR alone and are
//! counted as an editor counts them.

use super::{Problem, TableError};
use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{Decoder, Encoding, UTF_16BE, UTF_16LE};
use std::io::{self, BufRead, BufReader, Chain, Cursor, Read};

/// Longest line, bytes: a row of more than 100,000 numbers.
const LINE_BYTES: usize = 4_000_000;

/// Bytes at the start that decide what a file is.
const FIRST_BYTES: usize = 8_192;

/// The lines of a file.
pub(super) struct Lines<R> {
    reader: BufReader<Decoded<Chain<Cursor<Vec<u8>>, R>>>,
    bytes: Vec<u8>,
    number: u64,
    is_after_cr: bool,
    /// Encoding of lines that are not UTF-8.
    fallback: Option<&'static Encoding>,
    utf_16: Option<&'static Encoding>,
}

impl<R: Read> Lines<R> {
    /// Opens a file, and returns its first bytes.
    pub(super) fn open(mut reader: R) -> io::Result<(Self, Vec<u8>)> {
        let mut first = Vec::new();
        let most = FIRST_BYTES as u64;
        reader.by_ref().take(most).read_to_end(&mut first)?;
        let utf_16 = utf_16(&first);
        let whole = Cursor::new(first.clone()).chain(reader);
        let decoded = Decoded {
            reader: whole,
            decoder: utf_16.map(Encoding::new_decoder_with_bom_removal),
            text: Vec::new(),
            at: 0,
        };
        let lines = Self {
            reader: BufReader::with_capacity(1 << 16, decoded),
            bytes: Vec::new(),
            number: 0,
            is_after_cr: false,
            fallback: None,
            utf_16,
        };
        Ok((lines, first))
    }

    /// Name of the encoding, where it is not UTF-8.
    pub(super) fn encoding(&self) -> Option<&'static str> {
        self.utf_16.or(self.fallback).map(Encoding::name)
    }

    /// Reads the next line into `text`; returns its number, from 1, and none at the end.
    pub(super) fn next(&mut self, text: &mut String) -> Result<Option<u64>, TableError> {
        text.clear();
        self.bytes.clear();
        let mut is_any = false;
        loop {
            let buffer = self.reader.fill_buf().map_err(|source| TableError {
                line: None,
                problem: Problem::Unreadable(source),
            })?;
            let Some(&first) = buffer.first() else {
                break;
            };
            if std::mem::take(&mut self.is_after_cr) && first == b'\n' {
                self.reader.consume(1);
                continue;
            }
            is_any = true;
            let end = buffer.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            let (line, _) = buffer.split_at(end.unwrap_or(buffer.len()));
            self.bytes.extend_from_slice(line);
            let length = line.len();
            if end.is_some() {
                self.is_after_cr = buffer.get(length) == Some(&b'\r');
                self.reader.consume(length + 1);
                break;
            }
            self.reader.consume(length);
            if self.bytes.len() > LINE_BYTES {
                return Err(TableError {
                    line: Some(self.number + 1),
                    problem: Problem::LongLine { bytes: LINE_BYTES },
                });
            }
        }
        if !is_any {
            return Ok(None);
        }
        self.number += 1;
        match str::from_utf8(&self.bytes) {
            Ok(line) => text.push_str(line),
            Err(_) => text.push_str(&decode(&mut self.fallback, &self.bytes)),
        }
        if self.number == 1 && text.starts_with('\u{feff}') {
            text.remove(0);
        }
        Ok(Some(self.number))
    }
}

fn decode(fallback: &mut Option<&'static Encoding>, bytes: &[u8]) -> String {
    let encoding = fallback.get_or_insert_with(|| {
        let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
        detector.feed(bytes, true);
        detector.guess(None, Utf8Detection::Deny)
    });
    encoding.decode_without_bom_handling(bytes).0.into_owned()
}

/// Returns the kind of UTF-16 that a file begins with.
fn utf_16(first: &[u8]) -> Option<&'static Encoding> {
    match first {
        [0xff, 0xfe, ..] => return Some(UTF_16LE),
        [0xfe, 0xff, ..] => return Some(UTF_16BE),
        _ => {}
    }
    // Without a mark: nearly every second byte of a table is zero.
    let zeros = |from: usize| {
        let every_second = first.iter().skip(from).step_by(2);
        let (all, zero) = (
            every_second.clone().count(),
            every_second.filter(|b| **b == 0).count(),
        );
        all >= 4 && zero * 10 >= all * 9
    };
    match (zeros(0), zeros(1)) {
        (false, true) => Some(UTF_16LE),
        (true, false) => Some(UTF_16BE),
        _ => None,
    }
}

/// Bytes of UTF-8 from those of another encoding.
struct Decoded<R> {
    reader: R,
    decoder: Option<Decoder>,
    text: Vec<u8>,
    at: usize,
}

impl<R: Read> Read for Decoded<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let rest = self.text.get(self.at..).unwrap_or_default();
            if !rest.is_empty() {
                let length = rest.len().min(buffer.len());
                for (to, from) in buffer.iter_mut().zip(rest) {
                    *to = *from;
                }
                self.at += length;
                return Ok(length);
            }
            let Some(decoder) = &mut self.decoder else {
                return self.reader.read(buffer);
            };
            let mut bytes = [0; 4_096];
            let read = self.reader.read(&mut bytes)?;
            let (bytes, _) = bytes.split_at(read);
            // Room for the longest text of so many bytes, and for what was pending.
            self.text.resize(3 * read + 16, 0);
            let (_, _, written, _) = decoder.decode_to_utf8(bytes, &mut self.text, read == 0);
            self.text.truncate(written);
            self.at = 0;
            if read == 0 {
                self.decoder = None;
            }
        }
    }
}
