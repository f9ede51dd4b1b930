//! A sweep that is killed, merged, or in the way of another one.

use super::*;
use crate::sweep::recipe::Drawing;
use crate::sweep::row::Cell;
use crepitus_scene::Overrides;
use std::path::PathBuf;
use std::slice::from_ref;

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

fn recipe() -> Recipe {
    Recipe {
        crepitus_commit: None,
        scene_toml: "version = 1".to_owned(),
        scene_as_run: String::new(),
        data: None,
        overrides: Overrides::default(),
        design: Drawing::Grid { vary: Vec::new() },
    }
}

fn opening(shard: &str, force: bool) -> Opening {
    Opening {
        shard: shard.parse().unwrap(),
        format: Format::Csv,
        traces: false,
        claim: Claim::by("sweep").force(force),
    }
}

/// Opens the folder of ten runs.
fn create(folder: &Path, shard: &str) -> Result<Store, StoreError> {
    Store::create(folder, &identity(10, ""), &recipe(), &opening(shard, false))
}

fn rows(store: &mut Store, points: Range<u64>) {
    for index in points {
        let cells = vec![("x".to_owned(), Cell::Whole(index.cast_signed()))];
        store.take(Row { index, cells }).unwrap();
    }
    store.flush().unwrap();
}

/// The folder of ten runs, with rows of these points.
fn with_rows(folder: &Path, points: Range<u64>) -> Store {
    let mut store = create(folder, "1/1").unwrap();
    rows(&mut store, points);
    store
}

/// The same, after the program has ended.
fn left(folder: &Path, points: Range<u64>) {
    drop(with_rows(folder, points));
}

/// Everything in a folder: paths with contents, and folders.
fn everything(folder: &Path) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(everything(&path));
        }
        all.insert(path.clone(), fs::read(path).ok());
    }
    all
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
    // A part that was being written, and the lock of the killed program.
    let identity = identity(10, "");
    let parts = Parts::of(home.path().join("parts"), &identity, Shard::WHOLE);
    parts.temporary().unwrap().into_temp_path().keep().unwrap();
    let lock = home
        .path()
        .join("parts/.running-0000000000-0000000010.lock");
    fs::write(lock, "crepitus sweep: running\n").unwrap();
    let again = with_rows(home.path(), 0..0);
    let missing = again.missing(0..10).unwrap();
    assert!(missing.iter().eq([&(4..10)]), "{missing:?}");
    drop(again);
    let mut again = with_rows(home.path(), 4..10);
    let table = finish(&mut again).unwrap();
    assert!(is_whole(&table));
    assert!(!home.path().join("parts").exists());
    // A repetition of the command then has nothing to do.
    let done = create(home.path(), "1/1").unwrap();
    assert_eq!(done.table(), Some(table));
}

/// A thousand single bits of the parts of a merge, in the first folder or another: each is noticed, no table is
/// written, and no part is lost.
#[test]
fn every_flipped_bit_is_noticed_by_a_merge() {
    let home = tempfile::tempdir().unwrap();
    let (here, there) = (home.path().join("here"), home.path().join("there"));
    left(&here, 0..6);
    left(&there, 6..10);
    let part = |folder: &Path, name: &str| folder.join("parts").join(name);
    let files = [
        part(&here, "0000000000-0000000006.csv"),
        part(&there, "0000000006-0000000010.csv"),
    ];
    let mut random = fastrand::Rng::with_seed(1);
    let merge = || -> Result<Written, String> {
        let text = |e: StoreError| e.to_string();
        let mut merged = Store::open(&here, Format::Csv, Claim::by("sweep")).map_err(text)?;
        let other = Store::read(&there).map_err(text)?;
        merged.take_parts_of(&other).map_err(text)?;
        finish(&mut merged).map_err(|e| e.to_string())
    };
    for _ in 0..1000 {
        let file = random.choice(&files).unwrap();
        let whole = fs::read(file).unwrap();
        let bit = random.usize(..whole.len() * 8);
        let mut damaged = whole.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        fs::write(file, &damaged).unwrap();
        let error = merge().expect_err("a damaged part");
        let name = file.file_name().unwrap().to_str().unwrap();
        assert!(error.contains(name), "bit {bit}: {error}");
        assert!(!here.join("sweep.csv").exists());
        assert_eq!(fs::read(file).unwrap(), damaged);
        fs::write(file, whole).unwrap();
    }
    assert!(is_whole(&merge().unwrap()));
    assert!(!here.join("parts").exists() && there.join("parts").exists());
}

#[test]
fn a_merge_names_the_points_of_a_missing_shard() {
    let homes = [(); 3].map(|()| tempfile::tempdir().unwrap());
    let [first, second, third] = &homes;
    let mut merged = with_rows(first.path(), 0..4);
    let incomplete = |merged: &mut Store| finish(merged).unwrap_err().to_string();
    let without_last = incomplete(&mut merged);
    assert_eq!(without_last, "6 of 10 runs are not there: points 4 to 9");
    left(third.path(), 7..10);
    let third = Store::read(third.path()).unwrap();
    merged.take_parts_of(&third).unwrap();
    let without_middle = incomplete(&mut merged);
    assert_eq!(without_middle, "3 of 10 runs are not there: points 4 to 6");
    assert!(merged.table().is_none() && !first.path().join("sweep.csv").exists());
    // Another shard's file under the name of the missing one.
    let parts = first.path().join("parts");
    let renamed = parts.join("0000000004-0000000007.csv");
    fs::copy(parts.join("0000000007-0000000010.csv"), &renamed).unwrap();
    let text = incomplete(&mut merged);
    assert!(text.contains("0000000004-0000000007.csv"), "{text}");
    fs::remove_file(renamed).unwrap();
    left(second.path(), 4..7);
    let second = Store::read(second.path()).unwrap();
    merged.take_parts_of(&second).unwrap();
    // And again.
    merged.take_parts_of(&second).unwrap();
    assert!(is_whole(&finish(&mut merged).unwrap()));
}

#[test]
fn another_sweep_is_refused_and_replaced_with_force() {
    let home = tempfile::tempdir().unwrap();
    let other_home = tempfile::tempdir().unwrap();
    let store = with_rows(home.path(), 0..4);
    for (other, word) in [
        (identity(11, ""), "10 runs, not 11"),
        (identity(10, "another"), "another scene text"),
    ] {
        let error =
            Store::create(home.path(), &other, &recipe(), &opening("1/1", false)).unwrap_err();
        assert!(error.to_string().contains(word), "{error}");
    }
    let another = identity(10, "another");
    let other = Store::create(
        other_home.path(),
        &another,
        &recipe(),
        &opening("1/1", false),
    )
    .unwrap();
    let error = store.take_parts_of(&other).unwrap_err();
    assert!(matches!(error, StoreError::Another { .. }), "{error}");
    // Not while it runs.
    let error = Store::create(home.path(), &another, &recipe(), &opening("1/1", true)).unwrap_err();
    assert!(matches!(error, StoreError::Running { .. }), "{error}");
    drop(store);
    let notes = home.path().join("parts/notes.txt");
    fs::write(home.path().join("notes.txt"), "mine").unwrap();
    fs::write(&notes, "mine").unwrap();
    // The folder of the parts is not only this program's any more.
    let error = Store::create(home.path(), &another, &recipe(), &opening("1/1", true)).unwrap_err();
    assert!(matches!(error, StoreError::Output(_)), "{error}");
    assert_eq!(fs::read_to_string(&notes).unwrap(), "mine");
    fs::remove_file(notes).unwrap();
    fs::remove_dir(home.path().join("parts")).unwrap();
    let store = Store::create(home.path(), &another, &recipe(), &opening("1/1", true)).unwrap();
    assert_eq!(store.identity().sha256, "another");
    assert_eq!(store.missing(0..10).unwrap().len(), 1);
    assert!(home.path().join("notes.txt").exists());
}

#[test]
fn points_are_run_by_one_program_at_a_time() {
    let home = tempfile::tempdir().unwrap();
    let mut first = create(home.path(), "1/2").unwrap();
    let mut second = create(home.path(), "2/2").unwrap();
    for shard in ["1/1", "1/2", "2/3"] {
        let text = create(home.path(), shard).unwrap_err().to_string();
        assert!(text.contains("another program is running points"), "{text}");
    }
    rows(&mut first, 0..5);
    rows(&mut second, 5..10);
    let merge = || Store::open(home.path(), Format::Csv, Claim::by("sweep"));
    assert!(matches!(merge(), Err(StoreError::Running { .. })));
    drop(first);
    drop(second);
    assert!(is_whole(&finish(&mut merge().unwrap()).unwrap()));
    let left = everything(home.path());
    let names = [".crepitus.sha256", "sweep.csv", ABOUT].map(|name| home.path().join(name));
    assert!(left.keys().eq(&names), "{left:?}");
}

/// Foreign files and folders under the names that the sweep needs stay to the byte; with force only files of
/// just these names are replaced.
#[test]
fn what_is_foreign_stays() {
    let deep = "parts/cad/deep/brace.step";
    let part = "parts/0000000000-0000000010.csv";
    for (path, yields) in [
        (deep, false),
        (part, false),
        ("parts", false),
        ("sweep.json", true),
        ("sweep.csv", true),
    ] {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, "mine").unwrap();
        let before = everything(home.path());
        let error = create(home.path(), "1/1").expect_err("it is in the way");
        assert!(matches!(error, StoreError::Output(_)), "{error}");
        assert_eq!(everything(home.path()), before, "{path:?}");
        let forced = Store::create(
            home.path(),
            &identity(10, ""),
            &recipe(),
            &opening("1/1", true),
        );
        assert_eq!(forced.is_ok(), yields, "{path:?}");
        if yields {
            let mut forced = forced.unwrap();
            rows(&mut forced, 0..10);
            assert!(is_whole(&finish(&mut forced).unwrap()));
        } else {
            assert_eq!(everything(home.path()), before, "{path:?}");
        }
    }
}

#[test]
fn a_trace_of_somebody_else_is_in_the_way_with_force_alone_replaced() {
    let home = tempfile::tempdir().unwrap();
    let store = create(home.path(), "1/1").unwrap();
    store.traces(from_ref(&(0..10))).unwrap();
    drop(store);
    let traces = home.path().join("traces");
    for name in ["0000000003.csv", "3.csv", "mine.csv"] {
        fs::write(traces.join(name), "mine").unwrap();
    }
    let store = create(home.path(), "1/1").unwrap();
    store.traces(from_ref(&(4..10))).unwrap();
    let text = store.traces(from_ref(&(0..10))).unwrap_err().to_string();
    assert!(text.contains("0000000003.csv (not written"), "{text}");
    drop(store);
    // Another sweep takes its place, and nothing of theirs.
    let another = identity(10, "another");
    Store::create(home.path(), &another, &recipe(), &opening("1/1", true)).unwrap();
    assert_eq!(everything(&traces).len(), 3);
}

#[test]
fn a_table_that_was_changed_is_not_passed_for_the_sweeps() {
    let home = tempfile::tempdir().unwrap();
    let mut store = with_rows(home.path(), 0..10);
    let table = finish(&mut store).unwrap();
    drop(store);
    let whole = fs::read_to_string(&table.file).unwrap();
    fs::write(&table.file, whole.replace("\n3,3,", "\n3,4,")).unwrap();
    let text = create(home.path(), "1/1").unwrap_err().to_string();
    assert!(text.contains("sweep.csv (changed since"), "{text}");
    // One that was removed is made again.
    fs::remove_file(&table.file).unwrap();
    let mut again = with_rows(home.path(), 0..10);
    assert_eq!(finish(&mut again).unwrap(), table);
}
