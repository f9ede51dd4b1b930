//! Parts that were damaged, changed, renamed, or are of another sweep.

use super::*;
use crate::sweep::row::Cell;
use crate::sweep::store::tests::identity;

fn row(index: u64) -> Row {
    let mut cells = vec![
        ("same".to_owned(), Cell::Number(0.1)),
        (
            "count".to_owned(),
            Cell::Whole(-7 * i64::try_from(index).unwrap()),
        ),
        (
            "a, \"quoted\"".to_owned(),
            Cell::Text(format!("x\n{index}")),
        ),
    ];
    if index % 2 == 1 {
        cells.push(("odd".to_owned(), Cell::Number(f64::NAN)));
    }
    Row { index, cells }
}

fn parts_in(folder: &Path) -> Parts {
    Parts::of(folder.to_owned(), &identity(100, ""), Shard::WHOLE)
}

#[test]
fn what_is_written_is_read_and_neighbours_share_a_part() {
    let home = tempfile::tempdir().unwrap();
    let parts = parts_in(home.path());
    assert!(parts.points().unwrap().is_empty());
    let rows: Vec<_> = [4, 5, 6, 9, 2].map(row).into();
    parts.write(&rows).unwrap();
    assert_eq!(parts.points().unwrap(), [2..3, 4..7, 9..10]);
    let columns = parts.read(&(4..7)).unwrap();
    assert_eq!(columns[0].cells, Cells::Constant("0.1".to_owned()));
    assert_eq!(columns[1].cells.get(2), "-42");
    assert_eq!(columns[2].cells.get(1), "x\n5");
    assert_eq!(
        columns[3].cells,
        Cells::Each(["", "NaN", ""].map(str::to_owned).into())
    );
    // Writing the same rows again makes no other part.
    parts.write(&rows).unwrap();
    let foreign = ["notes.txt", "4-7.csv", ".part-torn"];
    for name in foreign {
        fs::write(home.path().join(name), "mine").unwrap();
    }
    let left = parts.temporary().unwrap().into_temp_path().keep().unwrap();
    parts.remove().unwrap();
    assert!(!left.exists() && parts.points().unwrap().is_empty());
    for name in foreign {
        assert_eq!(fs::read_to_string(home.path().join(name)).unwrap(), "mine");
    }
}

#[test]
fn gaps_are_what_is_missing() {
    type Points<'a> = &'a [(u64, u64)];
    let ranges = |points: Points<'_>| -> Vec<Range<u64>> {
        points.iter().map(|&(start, end)| start..end).collect()
    };
    let cases: [(Points<'_>, Points<'_>); 5] = [
        (&[], &[(10, 20)]),
        (&[(0, 30)], &[]),
        (&[(10, 12), (12, 13), (15, 16)], &[(13, 15), (16, 20)]),
        (&[(0, 11), (5, 12), (19, 25)], &[(12, 19)]),
        (&[(0, 5), (25, 30)], &[(10, 20)]),
    ];
    for (there, gaps) in cases {
        assert_eq!(missing(10..20, &ranges(there)), ranges(gaps), "{there:?}");
    }
}

/// A thousand single bits of parts of several forms: each is noticed, and the part stays.
#[test]
fn every_flipped_bit_is_noticed() {
    let home = tempfile::tempdir().unwrap();
    let parts = parts_in(home.path());
    let rows: Vec<_> = [0, 1, 2, 3, 10, 20, 21].map(row).into();
    parts.write(&rows).unwrap();
    let mut random = fastrand::Rng::with_seed(52);
    let there = parts.points().unwrap();
    assert_eq!(there.len(), 3);
    for _ in 0..1000 {
        let points = random.choice(&there).unwrap();
        let file = parts.file(points);
        let whole = fs::read(&file).unwrap();
        let bit = random.usize(..whole.len() * 8);
        let mut damaged = whole.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        fs::write(&file, &damaged).unwrap();
        let error = parts.read(points).expect_err("a damaged part");
        let name = name_of(points);
        assert!(error.to_string().contains(&name), "bit {bit}: {error}");
        fs::write(&file, whole).unwrap();
    }
    // What is damaged is not known to be a part, and not removed.
    let file = parts.file(&there[1]);
    let damaged = [&fs::read(&file).unwrap()[..], b"\n"].concat();
    fs::write(&file, &damaged).unwrap();
    assert!(parts.verified().is_err());
    parts.remove().unwrap();
    assert_eq!(parts.points().unwrap(), there[1..2]);
    assert_eq!(fs::read(&file).unwrap(), damaged);
}

#[test]
fn a_part_that_is_not_of_the_sweep_is_refused_with_its_reason() {
    let home = tempfile::tempdir().unwrap();
    let parts = parts_in(home.path());
    let rows: Vec<_> = (0..3).map(row).collect();
    parts.write(&rows).unwrap();
    let file = parts.file(&(0..3));
    let whole = fs::read_to_string(&file).unwrap();
    let other = |identity: &Identity, shard: &str, points: Range<u64>| {
        let folder = tempfile::tempdir().unwrap();
        let other = Parts::of(folder.path().to_owned(), identity, shard.parse().unwrap());
        let rows: Vec<_> = points.clone().map(row).collect();
        other.write(&rows).unwrap();
        fs::read_to_string(other.file(&points)).unwrap()
    };
    let same = identity(100, "");
    let line = |n: usize| whole.lines().nth(n).unwrap().to_owned() + "\n";
    let cases = [
        (String::new(), "not a part of a sweep"),
        // Of a version without checksums.
        ("x,number,1,2,3\n".to_owned(), "earlier version"),
        (whole.replacen(",1,", ",2,", 1), "another version"),
        (
            other(&identity(100, "another"), "1/1", 0..3),
            "of another sweep",
        ),
        (other(&identity(101, ""), "1/1", 0..3), "of another sweep"),
        // Another part, and another shard's, under this name.
        (other(&same, "1/1", 3..6), "points 3 to 5"),
        (other(&same, "2/2", 50..53), "points 50 to 52"),
        (other(&same, "2/2", 0..3), "not of shard 2/2"),
        // A changed number, and three columns less.
        (whole.replace("-14", "-15"), "SHA-256"),
        (whole.replace(&line(1), ""), "SHA-256"),
        (whole.trim_end().to_owned(), "SHA-256"),
        (whole.clone() + "\n", "SHA-256"),
    ];
    for (text, word) in cases {
        assert_ne!(text, whole, "{word}");
        fs::write(&file, &text).unwrap();
        let error = parts.read(&(0..3)).expect_err(word).to_string();
        assert!(
            error.contains(word) && error.contains("0000000003.csv"),
            "{word}: {error}"
        );
        // Nothing is written over it.
        assert!(parts.write(&rows).is_err(), "{word}");
        assert_eq!(fs::read_to_string(&file).unwrap(), text);
    }
    fs::write(&file, &whole).unwrap();
    parts.read(&(0..3)).unwrap();
}
