//! Tables of parts that overlap, or are not complete.

use super::*;
use crate::sweep::plan::Shard;
use crate::sweep::row::{Cell, Row};
use crate::sweep::store::tests::identity;
use std::fs;

/// Rows whose columns come, go, and change from counts to numbers to texts.
fn rows(random: &mut fastrand::Rng, count: u64) -> Vec<Row> {
    let row = |index| {
        let mut cells = vec![("x".to_owned(), Cell::Number(random.f64() - 0.5))];
        for name in ["n", "mixed", "text.of, \"it\"", "rare"] {
            match random.u32(..6) {
                0 => {}
                1 if name == "rare" => {
                    cells.push((name.to_owned(), Cell::Number(f64::MIN_POSITIVE)));
                }
                _ if name == "rare" => {}
                2 if name == "mixed" => cells.push((name.to_owned(), Cell::Number(0.1))),
                _ if name.starts_with("text") => {
                    let text = format!("ä\n{}", random.u32(..3));
                    cells.push((name.to_owned(), Cell::Text(text)));
                }
                _ => cells.push((name.to_owned(), Cell::Whole(random.i64(..) >> 12))),
            }
        }
        Row { index, cells }
    };
    (0..count).map(row).collect()
}

#[test]
fn what_is_missing_is_named_and_an_end_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    let parts = Parts::of(home.path().to_owned(), &identity(32, ""), Shard::WHOLE);
    let rows = rows(&mut fastrand::Rng::with_seed(1), 30);
    for piece in [0..10, 11..20, 25..30] {
        parts.write(&rows[piece]).unwrap();
    }
    let attempt = |runs, goes_on| {
        let identity = identity(runs, "");
        let table = write(&parts, &identity, Format::Csv, &mut |_| goes_on);
        table.unwrap_err().to_string()
    };
    let text = attempt(32, true);
    assert_eq!(
        text,
        "8 of 32 runs are not there: points 10, 20 to 24, 30 to 31"
    );
    let text = attempt(10, false);
    assert!(text.contains("interrupted"), "{text}");
    assert_eq!(fs::read_dir(home.path()).unwrap().count(), 3);
}

#[test]
fn a_point_in_two_parts_has_one_row_or_makes_no_table() {
    let home = tempfile::tempdir().unwrap();
    let parts = Parts::of(home.path().to_owned(), &identity(20, ""), Shard::WHOLE);
    let rows = rows(&mut fastrand::Rng::with_seed(2), 20);
    for piece in [0..12, 5..20, 7..9] {
        parts.write(&rows[piece]).unwrap();
    }
    let attempt = || write(&parts, &identity(20, ""), Format::Csv, &mut |_| true);
    assert_eq!(attempt().unwrap().doubled, 9);
    let mut other = rows[8..14].to_vec();
    other[3].cells[0].1 = Cell::Number(2.0);
    parts.write(&other).unwrap();
    let text = attempt().unwrap_err().to_string();
    for word in [
        "0000000000-0000000012.csv",
        "0000000008-0000000014.csv",
        "point 11",
    ] {
        assert!(text.contains(word), "{text}");
    }
}

#[test]
fn a_table_that_the_disk_has_not_taken_is_noticed() {
    let table = tempfile::NamedTempFile::new().unwrap();
    for bytes in ["a,b\n1,2\n", "a,b\n1,3\n", "a,b\n", ""] {
        let mut hashing = Hashing::of(table.reopen().unwrap());
        hashing.write_all(b"a,b\n1,2\n").unwrap();
        fs::write(table.path(), bytes).unwrap();
        let is_same = bytes == "a,b\n1,2\n";
        let outcome = hashing.read_back(table.path());
        let is_noticed = matches!(outcome, Err(TableError::ReadBack));
        assert!(
            outcome.is_ok() == is_same && is_noticed != is_same,
            "{bytes:?}"
        );
    }
}

#[test]
fn a_column_that_one_part_has_alone_is_a_difference() {
    let home = tempfile::tempdir().unwrap();
    let parts = Parts::of(home.path().to_owned(), &identity(2, ""), Shard::WHOLE);
    let row = |index, names: &[&str]| Row {
        index,
        cells: names
            .iter()
            .map(|n| ((*n).to_owned(), Cell::Whole(1)))
            .collect(),
    };
    parts.write(&[row(0, &["x", "y"]), row(1, &["x"])]).unwrap();
    parts.write(&[row(0, &["x"])]).unwrap();
    let table = write(&parts, &identity(2, ""), Format::Csv, &mut |_| true);
    let text = table.unwrap_err().to_string();
    assert!(text.contains("point 0"), "{text}");
}

#[cfg(feature = "parquet")]
mod both_formats {
    use super::{identity, rows};
    use crate::sweep::kind::Kind;
    use crate::sweep::parts::{Cells, Parts};
    use crate::sweep::plan::Shard;
    use crate::sweep::row::Cell;
    use crate::sweep::table::{Content, Format, of_parts, read, write};
    use ::parquet::file::reader::{FileReader, SerializedFileReader};
    use ::parquet::record::Field as Value;
    use std::collections::HashMap;
    use std::fs::{self, File};
    use std::path::Path;

    /// A Parquet file as texts, a map of columns a row.
    fn parquet_rows(file: &Path) -> Vec<HashMap<String, String>> {
        let reader = SerializedFileReader::new(File::open(file).unwrap()).unwrap();
        let text = |value: &Value| match value {
            Value::Null => String::new(),
            Value::Long(whole) => whole.to_string(),
            Value::Double(number) => format!("{number:?}"),
            Value::Str(text) => text.clone(),
            other => panic!("{other:?}"),
        };
        let rows = reader.get_row_iter(None).unwrap();
        rows.map(|row| {
            let row = row.unwrap();
            let columns = row.get_column_iter();
            columns
                .map(|(name, value)| (name.clone(), text(value)))
                .collect()
        })
        .collect()
    }

    /// Content with whole numbers among others as numbers, which Parquet makes of them.
    fn values(mut content: Content) -> Content {
        let numbers = content.columns.iter_mut();
        for column in numbers.filter(|column| column.kind == Kind::Number) {
            let number = |row| match column.cells.get(row).parse() {
                Ok(number) => Cell::Number(number).to_string(),
                Err(_) => column.cells.get(row).to_owned(),
            };
            column.cells = Cells::Each((0..content.index.len()).map(number).collect());
        }
        content
    }

    #[test]
    fn parquet_and_csv_hold_the_same_rows_in_the_same_order() {
        let mut random = fastrand::Rng::with_seed(4);
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("parts");
        fs::create_dir(&folder).unwrap();
        let identity = identity(500, "");
        let parts = Parts::of(folder, &identity, Shard::WHOLE);
        let rows = rows(&mut random, 500);
        // In pieces that overlap, and not in their order.
        for piece in [300..500, 0..120, 100..250, 200..310] {
            parts.write(&rows[piece]).unwrap();
        }
        for format in [Format::Csv, Format::Parquet] {
            let table = write(&parts, &identity, format, &mut |_| true).unwrap();
            assert_eq!(table.doubled, 20 + 50 + 10);
            table.file.persist(home.path().join(format.file())).unwrap();
        }
        let content = of_parts(&parts, &identity).unwrap();
        assert_eq!(content.index, (0..500).collect::<Vec<_>>());
        for format in [Format::Csv, Format::Parquet] {
            let back = read(&home.path().join(format.file())).unwrap();
            assert!(values(back) == values(content.clone()), "{format:?}");
        }
        let parquet = parquet_rows(&home.path().join("sweep.parquet"));
        let mut csv = csv::Reader::from_path(home.path().join("sweep.csv")).unwrap();
        let header = csv.headers().unwrap().clone();
        let mut count = 0;
        for (record, row) in csv.records().zip(&parquet) {
            let record = record.unwrap();
            assert_eq!(record[0], count.to_string());
            let given = &rows[count].cells;
            assert_eq!(
                record.iter().filter(|cell| !cell.is_empty()).count(),
                given.len() + 1
            );
            for (name, cell) in header.iter().zip(&record) {
                let same = match (cell.parse::<f64>(), row[name].parse::<f64>()) {
                    (Ok(a), Ok(b)) => a.to_bits() == b.to_bits(),
                    _ => cell == row[name],
                };
                assert!(same, "row {count}, {name}: {cell} and {}", row[name]);
            }
            count += 1;
        }
        assert_eq!((count, parquet.len()), (500, 500));
    }
}
