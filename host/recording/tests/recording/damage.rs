//! Files that are not what was written: each is noticed and named, and what is
//! readable is kept.

use crate::support::{
    Sent, check_accounting, is_part, mangled, open, recorded, rows, rows_of, salvaged, sent,
};
use crepitus_protocol::parameters::id;
use crepitus_recording::{Damage, ReadError, Recording};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A recording of 1,100 blocks: a checkpoint, and the end.
struct Bench {
    folder: tempfile::TempDir,
    whole: Vec<u8>,
    all: Vec<crepitus_recording::Row>,
    produced: u64,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("whole");
        let sent = sent(1_100);
        recorded(&path, "a test", &sent);
        Self {
            whole: fs::read(&path).unwrap(),
            all: rows_of(&sent),
            produced: open(&path).unwrap().accounting().totals.produced,
            folder,
        }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("damaged")
    }

    /// The file is refused, or said to be incomplete; salvaged, it has this
    /// many rows at least, each one that was recorded. Returns what is said.
    fn check(&self, bytes: &[u8], rows_least: usize) -> String {
        let path = self.path();
        fs::write(&path, bytes).unwrap();
        let said = noticed(&path);
        let salvaged = salvaged(&path);
        let kept = rows(&salvaged);
        assert!(is_part(&kept, &self.all), "{said}");
        assert!(kept.len() >= rows_least, "{} rows kept: {said}", kept.len());
        check_accounting(&salvaged);
        assert!(!salvaged.warnings().is_empty());
        said
    }

    /// Does [`check`](Self::check) for a file in which everything else is in its order: nothing is
    /// counted that is not known.
    fn check_in_order(&self, bytes: &[u8], rows_least: usize) -> String {
        let said = self.check(bytes, rows_least);
        let produced = salvaged(&self.path()).accounting().totals.produced;
        assert!(produced <= self.produced, "{produced} samples: {said}");
        said
    }

    /// Does [`Self::check_in_order`], then checks that accounting and parameters are those of the whole file.
    fn check_mended(&self, bytes: &[u8]) -> String {
        let said = self.check_in_order(bytes, self.all.len());
        let whole = open(&self.folder.path().join("whole")).unwrap();
        let salvaged = salvaged(&self.path());
        assert_eq!(salvaged.accounting(), whole.accounting(), "{said}");
        assert_eq!(salvaged.parameters(), whole.parameters(), "{said}");
        said
    }

    /// The frames, with their delimiters.
    fn frames(&self) -> Vec<Range<usize>> {
        let mut frames = Vec::new();
        let mut from = 0;
        for (at, byte) in self.whole.iter().enumerate() {
            if *byte == 0 {
                frames.push(from..at + 1);
                from = at + 1;
            }
        }
        frames
    }
}

/// The message on opening a damaged file.
fn noticed(path: &Path) -> String {
    match open(path) {
        Err(error @ ReadError::Damaged { .. }) => error.to_string(),
        Err(error) => panic!("{error}"),
        Ok(recording) => {
            assert!(!recording.is_complete(), "nothing was noticed");
            recording.warnings().join(" ")
        }
    }
}

#[test]
fn every_flipped_bit_is_noticed_and_costs_a_few_blocks() {
    let bench = Bench::new();
    let mut random = fastrand::Rng::with_seed(1);
    let bits = bench.whole.len() * 8;
    let rows = bench.all.len();
    // Everywhere, and all of the first and last bytes; more of them with CREPITUS_LONG.
    let everywhere = if std::env::var_os("CREPITUS_LONG").is_some() {
        1_000
    } else {
        200
    };
    let places = (0..everywhere).map(|_| random.usize(..bits));
    for bit in places
        .chain((0..200).step_by(3))
        .chain((bits - 200..bits).step_by(3))
    {
        let mut flipped = bench.whole.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        bench.check_in_order(&flipped, rows - 60);
    }
}

#[test]
fn frames_that_are_missing_doubled_or_elsewhere_are_noticed() {
    let bench = Bench::new();
    let frames = bench.frames();
    let rows = bench.all.len();
    let mut random = fastrand::Rng::with_seed(2);
    for _ in 0..60 {
        let one = frames[random.usize(1..frames.len())].clone();
        let other = frames[random.usize(1..frames.len())].clone();
        let [one, other] = if one.start <= other.start {
            [one, other]
        } else {
            [other, one]
        };
        let w = &bench.whole;
        let missing = [&w[..one.start], &w[one.end..]].concat();
        bench.check_in_order(&missing, rows - 20);
        let doubled = [&w[..one.end], &w[one.start..]].concat();
        bench.check_in_order(&doubled, rows);
        if one != other {
            let (a, b) = (&w[one.clone()], &w[other.clone()]);
            let swapped = [
                &w[..one.start],
                b,
                &w[one.end..other.start],
                a,
                &w[other.end..],
            ]
            .concat();
            // An entry that stands elsewhere costs what depends on it, no row.
            bench.check(&swapped, rows - 20);
        }
    }
}

/// No restart of the drive, and no row twice.
#[test]
fn samples_that_are_doubled_with_the_begin_of_their_subscription_are_counted_once() {
    let bench = Bench::new();
    let frames = bench.frames();
    let w = &bench.whole;
    for (from, to) in [(2, 500), (600, 900)] {
        let (from, to) = (frames[from].start, frames[to].start);
        let said = bench.check_mended(&[&w[..to], &w[from..]].concat());
        assert!(said.contains("doubled"), "{said}");
    }
}

#[test]
fn the_begin_of_a_subscription_that_stands_too_late_is_put_back() {
    let bench = Bench::new();
    let frames = bench.frames();
    let w = &bench.whole;
    let mark = br#""entry":"subscribed""#;
    let is_begin = |frame: &Range<usize>| w[frame.clone()].windows(mark.len()).any(|w| w == mark);
    let begins: Vec<_> = (0..frames.len())
        .filter(|n| is_begin(&frames[*n]))
        .collect();
    assert_eq!(begins.len(), 2);
    for (begin, behind) in [(begins[0], 299), (begins[1], begins[1] + 40)] {
        let (begin, behind) = (frames[begin].clone(), frames[behind].end);
        let moved = [
            &w[..begin.start],
            &w[begin.end..behind],
            &w[begin],
            &w[behind..],
        ]
        .concat();
        let said = bench.check_mended(&moved);
        assert!(said.contains("first those of tick"), "{said}");
        assert!(said.contains("with `--salvage`"), "{said}");
        assert!(said.contains("are put in order"), "{said}");
    }
}

/// Frames at the edges of what was moved are damaged.
#[test]
fn samples_that_are_damaged_where_others_are_out_of_order_were_not_lost_on_the_way() {
    let bench = Bench::new();
    let frames = bench.frames();
    let w = &bench.whole;
    // The whole file, and one that was cut off behind its last checkpoint.
    for (end, rows) in [
        (w.len(), bench.all.len()),
        (frames[frames.len() - 10].start, bench.all.len() - 9 * 20),
    ] {
        let (a, b, c) = (100_000, 104_096, 108_192);
        let swapped = [&w[..a], &w[b..c], &w[a..b], &w[c..end]].concat();
        bench.check(&swapped, rows - 10 * 20);
        let totals = salvaged(&bench.path()).accounting().totals;
        assert!(totals.damaged > 0);
        assert_eq!(totals.received + totals.damaged, rows as u64);
        assert_eq!((totals.by_device, totals.on_the_way()), (60, 20));
    }
}

/// Angles are computed all the same.
#[test]
fn the_encoder_that_is_assumed_where_parameters_are_lost_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let mut sent = sent(300);
    for sent in &mut sent {
        if let Sent::Parameters(_, values) = sent {
            values.set(id::LINES, 1_000.0);
        }
    }
    recorded(&path, "a test", &sent);
    let whole = fs::read(&path).unwrap();
    let all = rows_of(&sent);
    for (number, tick, encoder, lines) in [
        (0, 1_000, "default encoder, 2048 counts", 512.0),
        (2, 8_940, "last known encoder, 4000 counts", 1_000.0),
    ] {
        let mark = format!(r#""number":{number},"revision""#).into_bytes();
        let at = whole.windows(mark.len()).position(|window| window == mark);
        let mut damaged = whole.clone();
        damaged[at.expect("an entry in plain text")] ^= 1;
        fs::write(&path, &damaged).unwrap();
        let salvaged = salvaged(&path);
        let said = salvaged.warnings().join("\n");
        let from = format!("Parameters are unknown from tick {tick} on");
        assert!(said.contains(&from) && said.contains(encoder), "{said}");
        let rows = rows(&salvaged);
        assert_eq!(rows.len(), all.len());
        for (row, whole) in rows.iter().zip(&all).filter(|(row, _)| row.tick >= tick) {
            let expected = whole.angle_rad * 1_000.0 / lines;
            assert!((row.angle_rad - expected).abs() < 1e-9, "{}", row.tick);
        }
    }
}

/// Metadata common to all recordings, known without the header.
#[test]
fn columns_have_their_meaning_without_the_header() {
    let bench = Bench::new();
    let mut damaged = bench.whole.clone();
    let header = bench.frames()[1].clone();
    damaged[header.start + header.len() / 2] ^= 1;
    let said = bench.check_in_order(&damaged, bench.all.len());
    assert!(said.contains("Its header is missing"), "{said}");
    let whole = open(&bench.folder.path().join("whole")).unwrap();
    let salvaged = salvaged(&bench.path());
    assert_eq!(salvaged.metadata().columns, whole.metadata().columns);
    assert_eq!(salvaged.metadata().ticks_per_s, 20_000);
}

/// Values that depend on a lost entry are not made up; the next entry with all of
/// them ends that.
#[test]
fn parameters_behind_a_lost_entry_are_unknown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("whole");
    // 21 entries; the first and the seventeenth have all values.
    recorded(&path, "a test", &sent(2_000));
    let whole = fs::read(&path).unwrap();
    let value_at = |recording: &Recording, row: u64| {
        let mut in_force = recording.parameters().in_force();
        in_force.at(row);
        in_force.number("crepitus.static_torque_nm")
    };
    let expected = open(&path).unwrap();
    // The third entry: from row 2·97·20 on.
    let mark = br#""number":2,"revision":3"#;
    let at = whole.windows(mark.len()).position(|window| window == mark);
    let mut damaged = whole.clone();
    damaged[at.expect("an entry in plain text")] ^= 1;
    let path = folder.path().join("damaged");
    fs::write(&path, &damaged).unwrap();
    let salvaged = salvaged(&path);
    for (entry, is_known) in [
        (0, true),
        (1, true),
        (2, false),
        (3, false),
        (15, false),
        (16, true),
        (20, true),
    ] {
        let row = entry * 97 * 20 + 5;
        let known = value_at(&expected, row).filter(|_| is_known);
        assert_eq!(value_at(&salvaged, row), known, "entry {entry}");
    }
}

#[test]
fn samples_whose_frame_is_missing_are_damaged_in_the_file() {
    let bench = Bench::new();
    let frames = bench.frames();
    // Blocks in the middle of the first second.
    let (from, to) = (frames[110].start, frames[112].end);
    let w = &bench.whole;
    let said = bench.check(&[&w[..from], &w[to..]].concat(), bench.all.len() - 60);
    assert!(said.contains("is not what was written"), "{said}");
    let totals = salvaged(&bench.path()).accounting().totals;
    assert_eq!((totals.damaged, totals.on_the_way()), (60, 20));
}

/// Any content of a file: an error, or rows whose accounting add up.
#[test]
fn no_bytes_are_too_strange() {
    let bench = Bench::new();
    let mut random = fastrand::Rng::with_seed(5);
    let mut read = 0;
    for _ in 0..300 {
        let bytes = mangled(&bench.whole, &mut random);
        let path = bench.path();
        fs::write(&path, &bytes).unwrap();
        if let Ok(recording) = Recording::open(&path, Damage::Salvage) {
            check_accounting(&recording);
            read += 1;
        }
    }
    assert!(read > 100, "{read}");
}

#[test]
fn a_zeroed_page_is_named_and_the_rest_is_kept() {
    let bench = Bench::new();
    let rows = bench.all.len();
    for page in 0..bench.whole.len() / 4_096 {
        let mut zeroed = bench.whole.clone();
        zeroed[page * 4_096..(page + 1) * 4_096].fill(0);
        let said = bench.check(&zeroed, rows - 14 * 20);
        if page > 0 && (page + 2) * 4_096 < bench.whole.len() {
            assert!(said.contains("bytes from byte"), "{said}");
        }
    }
}

#[test]
fn a_part_of_another_recording_is_named() {
    let bench = Bench::new();
    let path = bench.folder.path().join("other");
    recorded(&path, "another", &sent(1_100));
    let other = fs::read(&path).unwrap();
    let both = [&bench.whole[..], &other[..]].concat();
    let said = bench.check(&both, bench.all.len());
    assert_eq!(said.matches("more after its end").count(), 1, "{said}");
    assert!(!said.contains("more like these"), "{said}");
    let said = bench.check(&[&bench.whole[..], &[7]].concat(), bench.all.len());
    assert!(said.contains("1 byte follows its end"), "{said}");
    // The header of one, the samples of the other.
    let header = bench.frames()[1].end;
    let mixed = [&bench.whole[..header], &other[header..]].concat();
    let said = bench.check(&mixed, bench.all.len());
    assert!(said.contains("of another recording"), "{said}");
    // One that was cut off, and the other one behind it, with ticks of its own.
    let cut = bench.frames()[800].end;
    let path = bench.folder.path().join("later");
    recorded(&path, "a later one", &sent(2_600)[1_400..]);
    let later = fs::read(&path).unwrap();
    let spliced = [&bench.whole[..cut], &later[..]].concat();
    let said = bench.check(&spliced, 700 * 20);
    assert!(said.contains("Another recording begins in it"), "{said}");
    // The other one stands in the middle: behind the next checkpoint the rest is kept.
    let spliced = [&bench.whole[..cut], &later[..], &bench.whole[cut..]].concat();
    let said = bench.check(&spliced, 850 * 20);
    assert!(said.contains("Another recording begins in it"), "{said}");
}

#[test]
fn cut_rows_of_an_ended_recording_are_said_to_be_missing() {
    let bench = Bench::new();
    for cut in [1, 100, 5_000, 200_000] {
        let said = bench.check(&bench.whole[..bench.whole.len() - cut], 9_000);
        assert!(said.contains("incomplete"), "{said}");
    }
}
