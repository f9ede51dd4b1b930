//! The Parquet file of a recording.

use crate::support::{
    check_accounting, is_part, mangled, open, plain, recorded, rows, rows_of, salvaged, sent,
    sent_of,
};
use crepitus_pages::recorded::Analysis;
use crepitus_recording::{Cause, Damage, Format, Recording, Row, parquet_writer};
use parquet::file::reader::{FileReader, SerializedFileReader};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::thread;

/// Five seconds: three groups.
const BLOCKS: u64 = 5_000;

struct Bench {
    folder: tempfile::TempDir,
    whole: Vec<u8>,
    all: Vec<Row>,
}

impl Bench {
    fn new(blocks: u64) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log");
        let sent = sent(blocks);
        recorded(&log, "a test", &sent);
        let parquet = folder.path().join("parquet");
        converted(&log, &parquet);
        Self {
            whole: fs::read(parquet).unwrap(),
            all: rows_of(&sent),
            folder,
        }
    }

    fn write(&self, bytes: &[u8]) -> PathBuf {
        // A file for each thread of a test.
        let name = format!("damaged {:?}", thread::current().id());
        let path = self.folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    }

    /// The file is refused; salvaged, it has this many rows at least.
    fn check(&self, bytes: &[u8], least: usize) -> String {
        let path = self.write(bytes);
        let said = open(&path).expect_err("nothing was noticed").to_string();
        let recording = salvaged(&path);
        let kept = rows(&recording);
        assert!(is_part(&kept, &self.all));
        assert!(kept.len() >= least, "{} rows kept: {said}", kept.len());
        check_accounting(&recording);
        let mut analysis = Analysis::new(&recording);
        for row in &kept {
            analysis.row(row);
        }
        let warnings = analysis.finish().warnings.join("\n");
        assert!(!warnings.contains("Counted"), "{warnings}");
        said
    }
}

fn converted(from: &Path, to: &Path) {
    let recording = open(from).unwrap();
    let file = File::create(to).unwrap();
    parquet_writer().unwrap()(&recording, &file, &mut |_| true).unwrap();
}

#[test]
fn the_file_holds_all_that_the_log_held() {
    let bench = Bench::new(BLOCKS);
    let log = open(&bench.folder.path().join("log")).unwrap();
    let parquet = open(&bench.folder.path().join("parquet")).unwrap();
    assert_eq!(parquet.format(), Format::Parquet);
    assert_eq!(parquet.metadata(), log.metadata());
    assert_eq!(parquet.accounting(), log.accounting());
    assert_eq!(parquet.parameters(), log.parameters());
    assert_eq!(parquet.warnings(), log.warnings());
    assert!(parquet.is_complete());
    assert_eq!(rows(&parquet), bench.all);
    let bits = |rows: &[Row]| -> Vec<_> {
        let bits = |row: &Row| {
            (
                row.time_s.to_bits(),
                row.angle_rad.to_bits(),
                row.omega_rad_s.to_bits(),
            )
        };
        rows.iter().map(bits).collect()
    };
    assert_eq!(bits(&rows(&parquet)), bits(&rows(&log)));
    check_accounting(&parquet);
    let again = bench.folder.path().join("again");
    converted(&bench.folder.path().join("parquet"), &again);
    assert_eq!(
        fs::read(again).unwrap(),
        bench.whole,
        "the same bytes from either"
    );
}

/// A file that is whole, of one that was not, and another one of that.
#[test]
fn what_was_wrong_with_the_log_is_said_of_files_that_are_made_of_it() {
    let bench = Bench::new(300);
    let mut log = fs::read(bench.folder.path().join("log")).unwrap();
    let middle = log.len() / 2;
    log[middle] ^= 1;
    let log = salvaged(&bench.write(&log));
    let path = bench.folder.path().join("of the damaged one");
    let file = File::create(&path).unwrap();
    parquet_writer().unwrap()(&log, &file, &mut |_| true).unwrap();
    let warnings = open(&path).unwrap().warnings();
    assert!(
        warnings[0].contains("was made of a damaged file"),
        "{warnings:?}"
    );
    assert_eq!(warnings[1..], log.warnings()[1..]);
    let again = bench.folder.path().join("again");
    converted(&path, &again);
    assert_eq!(open(&again).unwrap().warnings(), warnings);
    // Damage of the file itself is another matter.
    let mut bytes = fs::read(&again).unwrap();
    let late = bytes.len() - 100;
    bytes[late] ^= 1;
    let said = salvaged(&bench.write(&bytes)).warnings();
    let earlier = warnings.len() - 1;
    assert_eq!(said[..earlier], warnings[..earlier]);
    assert!(said[earlier].contains("The file is damaged"), "{said:?}");
}

#[test]
fn every_flipped_bit_is_noticed_and_costs_two_seconds_at_most() {
    // Two groups, the second one short.
    let bench = Bench::new(2_100);
    let mut random = fastrand::Rng::with_seed(4);
    let bits = bench.whole.len() * 8;
    let places = (0..800).map(|_| random.usize(..bits));
    // Of the footer more than its share.
    let ends = (0..160).step_by(7).chain((bits - 8_000..bits).step_by(40));
    let flips: Vec<_> = places.chain(ends).enumerate().collect();
    // The number of those after which all rows were kept.
    let try_all = |flips: &[(usize, usize)]| {
        let mut whole = 0;
        for &(n, bit) in flips {
            let mut flipped = bench.whole.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            if n % 10 > 0 {
                open(&bench.write(&flipped)).expect_err("nothing was noticed");
                continue;
            }
            bench.check(&flipped, 2_000);
            whole += usize::from(rows(&salvaged(&bench.write(&flipped))).len() == bench.all.len());
        }
        whole
    };
    let whole = thread::scope(|scope| {
        let (first, rest) = flips.split_at(flips.len() / 2);
        let first = scope.spawn(|| try_all(first));
        try_all(rest) + first.join().unwrap()
    });
    assert!(whole > 15, "a flip in the footer costs nothing: {whole}");
}

#[test]
fn wherever_it_is_cut_the_groups_before_are_kept() {
    let bench = Bench::new(BLOCKS);
    let length = bench.whole.len();
    for (share, least) in [(0.999, 100_000), (0.9, 80_000), (0.6, 40_000)] {
        let cut = (length as f64 * share) as usize;
        let said = bench.check(&bench.whole[..cut], least);
        assert!(said.contains("checksum"), "{said}");
    }
    let path = bench.write(&bench.whole[..10]);
    assert!(
        open(&path)
            .unwrap_err()
            .to_string()
            .contains("nothing is left")
    );
}

/// Bytes that are missing or too many move all that stands behind them.
#[test]
fn groups_that_have_moved_are_found_before_their_seals() {
    let bench = Bench::new(BLOCKS);
    let early = bench.whole.len() / 20;
    let without = [&bench.whole[..early], &bench.whole[early + 1..]].concat();
    bench.check(&without, 60_000);
    let doubled = [&bench.whole[..early + 900], &bench.whole[early..]].concat();
    bench.check(&doubled, 60_000);
}

#[test]
fn a_zeroed_page_costs_its_group() {
    let bench = Bench::new(BLOCKS);
    let every = if std::env::var_os("CREPITUS_LONG").is_some() {
        11
    } else {
        37
    };
    for page in (0..bench.whole.len() / 4_096).step_by(every) {
        let mut zeroed = bench.whole.clone();
        zeroed[page * 4_096..(page + 1) * 4_096].fill(0);
        bench.check(&zeroed, 20_000);
    }
}

#[test]
fn a_group_that_is_lost_leaves_rows_and_parameters_in_step() {
    let bench = Bench::new(BLOCKS);
    let mut damaged = bench.whole.clone();
    // In the first group.
    let early = damaged.len() / 20;
    damaged[early] ^= 1;
    let recording = salvaged(&bench.write(&damaged));
    let kept = rows(&recording);
    assert_eq!(kept, bench.all[40_000..]);
    let mut in_force = recording.parameters().in_force();
    let whole = open(&bench.folder.path().join("log")).unwrap();
    let mut expected = whole.parameters().in_force();
    for row in [0, 1_939, 1_940, 30_000, 59_999] {
        in_force.at(row);
        expected.at(row + 40_000);
        let name = "crepitus.static_torque_nm";
        assert_eq!(in_force.number(name), expected.number(name), "row {row}");
    }
    let totals = recording.accounting().totals;
    assert_eq!(totals.damaged, 40_000);
    let warnings = recording.warnings().join("\n");
    assert!(
        warnings.contains("Rows 0 to 39999 of 100000 are damaged"),
        "{warnings}"
    );
    assert!(warnings.contains("40000 damaged in the file"), "{warnings}");
    let gap = recording.accounting().gaps[0];
    assert_eq!(
        (gap.row, gap.first_tick, gap.cause),
        (0, 1_000, Cause::Damaged)
    );
}

/// Positions of the seals of a file; the first one has no group.
fn seals(file: &[u8]) -> Vec<usize> {
    let mark = b"\xe7crepitus group\x1c";
    let marks = file.windows(mark.len()).enumerate();
    marks
        .filter(|(_, window)| window == mark)
        .map(|(at, _)| at)
        .collect()
}

/// Position of the footer of a file.
fn footer_at(file: &[u8]) -> usize {
    let (rest, tail) = file.split_last_chunk::<8>().unwrap();
    let [a, b, c, d, ..] = *tail;
    rest.len() - u32::from_le_bytes([a, b, c, d]) as usize
}

/// The seal before the first group cannot be found.
fn without_head(file: &[u8]) -> Vec<u8> {
    let mut bytes = file.to_vec();
    bytes[seals(file)[0]] ^= 1;
    bytes
}

/// Neither metadata in the seal before the first group nor in the footer.
fn without_metadata(file: &[u8]) -> Vec<u8> {
    let mut bytes = without_head(file);
    bytes[footer_at(file)..].fill(0);
    bytes
}

/// Another recording as a file, of the same device.
fn another(bench: &Bench) -> Vec<u8> {
    let log = bench.folder.path().join("another log");
    recorded(&log, "another", &sent(2_100));
    let other = bench.folder.path().join("another");
    converted(&log, &other);
    fs::read(other).unwrap()
}

#[test]
fn rows_are_kept_without_any_metadata() {
    let bench = Bench::new(BLOCKS);
    let damaged = without_metadata(&bench.whole);
    let said = bench.check(&damaged, bench.all.len());
    assert!(said.contains("Its metadata is lost"), "{said}");
    let recording = salvaged(&bench.write(&damaged));
    assert_eq!(rows(&recording), bench.all);
    let whole = open(&bench.folder.path().join("parquet")).unwrap();
    assert_eq!(recording.metadata().id, whole.metadata().id);
    assert_eq!(recording.metadata().columns, whole.metadata().columns);
    let accounting = recording.accounting();
    assert_eq!(accounting.drive_restarts, 1);
    // But for those that the drive produced first after its restart, and dropped.
    let totals = whole.accounting().totals;
    assert_eq!(accounting.totals.received, totals.received);
    assert_eq!(accounting.totals.dropped, totals.dropped - 20);
    // A group that is damaged besides: the rest is kept.
    let mut damaged = damaged;
    damaged[bench.whole.len() / 20] ^= 1;
    let said = bench.check(&damaged, 60_000);
    assert!(said.contains("Rows 0 to 39999 are damaged"), "{said}");
    let totals = salvaged(&bench.write(&damaged)).accounting().totals;
    assert_eq!((totals.received, totals.damaged), (60_000, 40_000));
    // Cut off in the last group.
    let cut = bench.whole.len() * 9 / 10;
    bench.check(&without_head(&bench.whole)[..cut], 80_000);
}

#[test]
fn the_footer_of_another_recording_is_named_and_costs_no_row() {
    let bench = Bench::new(BLOCKS);
    let other = another(&bench);
    let own = footer_at(&bench.whole);
    let foreign = [&bench.whole[..own], &other[footer_at(&other)..]].concat();
    for bytes in [foreign.clone(), without_head(&foreign)] {
        let said = bench.check(&bytes, bench.all.len());
        assert!(said.contains("footer is that of another"), "{said}");
        assert!(!said.contains("Rows of another recording"), "{said}");
    }
    // The recording's own footer is not.
    let said = bench.check(&without_head(&bench.whole), bench.all.len());
    assert!(said.contains("metadata could not be checked"), "{said}");
    assert!(!said.contains("another"), "{said}");
}

/// Each with its seal.
#[test]
fn groups_that_are_out_of_order_are_named_and_kept() {
    let bench = Bench::new(BLOCKS);
    let w = &bench.whole;
    let ends = seal_ends(w);
    let swapped = [
        &w[..ends[0]],
        &w[ends[1]..ends[2]],
        &w[ends[0]..ends[1]],
        &w[ends[2]..],
    ]
    .concat();
    let said = bench.check(&swapped, bench.all.len());
    assert!(
        said.contains("Rows are out of order, first those from 0 on"),
        "{said}"
    );
    assert_eq!(rows(&salvaged(&bench.write(&swapped))), bench.all);
}

/// End of each seal.
fn seal_ends(file: &[u8]) -> Vec<usize> {
    let end = |at: &usize| {
        let length = file[at + 16..].first_chunk().unwrap();
        at + 24 + u32::from_le_bytes(*length) as usize
    };
    seals(file).iter().map(end).collect()
}

/// The recording is one group.
#[test]
fn a_recording_of_less_than_two_seconds_is_lost_with_its_group() {
    let bench = Bench::new(1_900);
    let mut damaged = bench.whole.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    bench.check(&damaged, 0);
    let recording = salvaged(&bench.write(&damaged));
    assert_eq!(
        recording.accounting().totals.damaged,
        bench.all.len() as u64
    );
}

/// The groups of one where those of another were, seals and all.
#[test]
fn a_group_of_another_recording_is_named_and_left_out() {
    let bench = Bench::new(BLOCKS);
    let log = bench.folder.path().join("other log");
    recorded(&log, "another", &sent(2 * BLOCKS)[4..]);
    let other = bench.folder.path().join("other");
    converted(&log, &other);
    let other = fs::read(other).unwrap();
    let (own, foreign) = (seals(&bench.whole), seals(&other));
    let spliced = [
        &bench.whole[..own[1]],
        &other[foreign[1]..foreign[3]],
        &bench.whole[own[2]..],
    ]
    .concat();
    let said = bench.check(&spliced, 20_000);
    assert!(
        said.contains("Rows of another recording stand in it"),
        "{said}"
    );
}

/// Any content of a file: an error, or rows whose accounting add up.
#[test]
fn no_bytes_are_too_strange() {
    let bench = Bench::new(2_100);
    let mut random = fastrand::Rng::with_seed(6);
    let mut read = 0;
    for _ in 0..100 {
        let bytes = mangled(&bench.whole, &mut random);
        let path = bench.write(&bytes);
        assert!(open(&path).is_err(), "nothing was noticed");
        if let Ok(recording) = Recording::open(&path, Damage::Salvage) {
            check_accounting(&recording);
            read += 1;
        }
    }
    assert!(read > 30, "{read}");
}

#[test]
fn writing_stops_when_it_is_told_to() {
    let bench = Bench::new(BLOCKS);
    let recording = open(&bench.folder.path().join("log")).unwrap();
    let file = File::create(bench.folder.path().join("stopped")).unwrap();
    let error = parquet_writer().unwrap()(&recording, &file, &mut |_| false).unwrap_err();
    assert_eq!(error.kind(), std::io::ErrorKind::Interrupted);
}

/// Of columns that a later version has besides it says nothing.
#[test]
fn the_first_parquet_file_with_these_columns_is_still_read() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let path = tests.join("golden.parquet");
    if std::env::var_os("CREPITUS_BLESS").is_some() {
        let _ = fs::remove_file(&path);
        converted(&tests.join("golden.crepitus"), &path);
    }
    let file = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    let columns = file.metadata().file_metadata().schema_descr().columns();
    let cells = |rows: &[Row]| -> Vec<Vec<_>> {
        let of_row = |row: &Row| {
            let object = row.to_json();
            let cell = |name: &str| object.get(name).cloned();
            columns.iter().map(|column| cell(column.name())).collect()
        };
        rows.iter().map(of_row).collect()
    };
    let recording = open(&path).unwrap();
    let read = cells(&rows(&recording));
    assert!(read.iter().flatten().all(Option::is_some), "{columns:?}");
    assert_eq!(read, cells(&rows_of(&sent_of(10, plain))));
    check_accounting(&recording);
}
