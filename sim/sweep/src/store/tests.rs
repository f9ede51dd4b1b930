//! A sweep that is killed, merged, or in the way of another one.

use super::*;
use crate::row::Cell;

pub(crate) fn identity(runs: u64, sha256: &str) -> Identity {
    Identity {
        crepitus_version: "0".to_owned(),
        scene: "a".to_owned(),
        title: "b".to_owned(),
        paths: vec!["x".to_owned()],
        runs,
        design_seed: None,
        sha256: sha256.to_owned(),
    }
}

/// The folder of ten runs, with rows of these points.
fn with_rows(folder: &Path, points: Range<u64>) -> Store {
    let mut store = Store::create(folder, &identity(10, "")).unwrap();
    for index in points {
        let cells = vec![("x".to_owned(), Cell::Whole(index.cast_signed()))];
        store.take(Row { index, cells }).unwrap();
    }
    store.flush().unwrap();
    store
}

fn finish(store: &mut Store) -> Result<Written, TableError> {
    store.finish(Format::Csv, &mut |_| true)
}

/// Returns whether a table has all ten rows in their order.
fn is_whole(table: &Written) -> bool {
    let rows = (0..10).fold("index,x,failure\n".to_owned(), |rows, i| {
        rows + &format!("{i},{i},\n")
    });
    fs::read_to_string(&table.file).unwrap() == rows
}

#[test]
fn a_killed_sweep_goes_on_from_its_whole_parts() {
    let home = tempfile::tempdir().unwrap();
    let mut killed = with_rows(home.path(), 0..4);
    let cells = vec![("x".to_owned(), Cell::Whole(4))];
    killed.take(Row { index: 4, cells }).unwrap();
    drop(killed);
    // A part that was being written.
    fs::write(home.path().join("parts/.part-torn"), "x,whole,4,").unwrap();
    let again = with_rows(home.path(), 0..0);
    let missing = again.missing(0..10).unwrap();
    assert!(missing.iter().eq([&(4..10)]), "{missing:?}");
    let mut again = with_rows(home.path(), 4..10);
    let table = finish(&mut again).unwrap();
    assert!(is_whole(&table));
    assert!(!home.path().join("parts").exists());
    // The same command then has nothing to do.
    let done = Store::create(home.path(), &identity(10, "")).unwrap();
    assert_eq!(done.table(), Some(table));
}

#[test]
fn a_part_whose_last_row_is_torn_makes_no_table() {
    let home = tempfile::tempdir().unwrap();
    let mut store = with_rows(home.path(), 0..4);
    let torn = home.path().join("parts/0000000004-0000000010.csv");
    fs::write(&torn, "x,whole,4,5,6,7,8\n").unwrap();
    let error = finish(&mut store).unwrap_err().to_string();
    assert!(error.contains("0000000004-0000000010.csv"), "{error}");
    assert!(store.table().is_none() && !home.path().join("sweep.csv").exists());
    fs::remove_file(torn).unwrap();
    assert!(is_whole(
        &finish(&mut with_rows(home.path(), 4..10)).unwrap()
    ));
}

#[test]
fn a_merge_names_the_points_of_a_missing_shard() {
    let homes = [(); 3].map(|()| tempfile::tempdir().unwrap());
    let [first, second, third] = &homes;
    let mut merged = with_rows(first.path(), 0..4);
    let incomplete = |merged: &mut Store| finish(merged).unwrap_err().to_string();
    let without_last = incomplete(&mut merged);
    assert_eq!(without_last, "6 of 10 runs are not there: points 4 to 9");
    merged
        .take_parts_of(&with_rows(third.path(), 7..10))
        .unwrap();
    let without_middle = incomplete(&mut merged);
    assert_eq!(without_middle, "3 of 10 runs are not there: points 4 to 6");
    assert!(merged.table().is_none() && !first.path().join("sweep.csv").exists());
    merged
        .take_parts_of(&with_rows(second.path(), 4..7))
        .unwrap();
    assert!(is_whole(&finish(&mut merged).unwrap()));
}

#[test]
fn another_sweep_is_refused_and_can_be_cleared() {
    let home = tempfile::tempdir().unwrap();
    let other_home = tempfile::tempdir().unwrap();
    let store = with_rows(home.path(), 0..4);
    for (other, word) in [
        (identity(11, ""), "10 runs, not 11"),
        (identity(10, "another"), "another scene text"),
    ] {
        let error = Store::create(home.path(), &other).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
    }
    let other = Store::create(other_home.path(), &identity(10, "another")).unwrap();
    let error = store.take_parts_of(&other).unwrap_err();
    assert!(matches!(error, StoreError::Another { .. }), "{error}");
    fs::write(home.path().join("notes.txt"), "mine").unwrap();
    Store::clear(home.path()).unwrap();
    let left: Vec<_> = fs::read_dir(home.path()).unwrap().collect();
    assert_eq!(left.len(), 1);
    assert!(matches!(Store::open(home.path()), Err(StoreError::None(_))));
}
