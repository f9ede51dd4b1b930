//! Files appear whole or not at all, and never over those of others.

use super::*;
use std::fs;
use std::io::Write;

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != MARKER)
        .collect();
    names.sort();
    names
}

fn claim() -> Claim {
    Claim::by("test")
}

/// Writes files of these names and contents into a folder.
fn write(target: &Path, claim: Claim, files: &[(&str, &str)]) -> Result<(), OutputError> {
    let folder = Folder::create(target, claim, files.iter().map(|(name, _)| name))?;
    for (name, content) in files {
        let mut file = folder.file(name).unwrap();
        file.write_all(content.as_bytes()).unwrap();
        folder.finish(file).unwrap();
    }
    folder.commit()
}

fn reasons(error: OutputError) -> Vec<(String, Reason)> {
    match error {
        OutputError::InTheWay { names, .. } => {
            names.into_iter().map(|n| (n.name, n.reason)).collect()
        }
        OutputError::Exists { path, reason } => {
            let name = path.file_name().unwrap().to_str().unwrap();
            one(name, reason)
        }
        error => panic!("{error}"),
    }
}

fn one(name: &str, reason: Reason) -> Vec<(String, Reason)> {
    vec![(name.to_owned(), reason)]
}

#[test]
fn files_appear_at_once_and_replace_their_like() {
    let home = tempfile::tempdir().unwrap();
    let target = home.path().join("out/run");
    for content in ["first", "second", "third"] {
        write(&target, claim(), &[("a.txt", content)]).unwrap();
        assert_eq!(fs::read_to_string(target.join("a.txt")).unwrap(), content);
    }
    assert_eq!(names(&home.path().join("out")), ["run"]);
    // The list can be checked by another program.
    let list = fs::read_to_string(target.join(MARKER)).unwrap();
    let hash = sha256("third".as_bytes()).unwrap();
    let lines: Vec<_> = list.lines().filter(|l| !l.starts_with('#')).collect();
    assert_eq!(lines, [format!("{hash}  a.txt")]);
}

#[test]
fn what_is_foreign_stays_and_is_named() {
    let home = tempfile::tempdir().unwrap();
    let target = home.path();
    let files = [("a.txt", "new"), ("b.txt", "new"), ("c.txt", "new")];
    fs::write(target.join("a.txt"), "mine").unwrap();
    fs::create_dir_all(target.join("c.txt/deep")).unwrap();
    let error = write(target, claim(), &files).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("a.txt (not written by crepitus)"), "{text}");
    assert!(text.contains("earlier versions"), "{text}");
    assert_eq!(
        reasons(error),
        [one("a.txt", Reason::Foreign), one("c.txt", Reason::Folder)].concat()
    );
    assert_eq!(names(target), ["a.txt", "c.txt"]);
    // A folder yields to nothing, and then nothing is written.
    let error = write(target, claim().force(true), &files).unwrap_err();
    assert_eq!(reasons(error), one("c.txt", Reason::Folder));
    assert_eq!(fs::read_to_string(target.join("a.txt")).unwrap(), "mine");
    fs::remove_dir_all(target.join("c.txt")).unwrap();
    write(target, claim().force(true), &files).unwrap();
    assert_eq!(fs::read_to_string(target.join("a.txt")).unwrap(), "new");
    // From now on they are this program's: of this verb, not of another.
    write(target, claim(), &files).unwrap();
    let error = write(target, Claim::by("other"), &files[..1]).unwrap_err();
    assert_eq!(reasons(error), one("a.txt", Reason::By("test".to_owned())));
}

#[test]
fn a_message_names_ten_files_at_most() {
    let home = tempfile::tempdir().unwrap();
    let all: Vec<_> = (10..25).map(|i| format!("f{i}")).collect();
    for name in &all {
        fs::write(home.path().join(name), "").unwrap();
    }
    let files: Vec<_> = all.iter().map(|name| (name.as_str(), "")).collect();
    let text = write(home.path(), claim(), &files).unwrap_err().to_string();
    assert!(text.contains("f19 and 5 more (not written by"), "{text}");
    assert!(!text.contains("f20"), "{text}");
}

#[test]
fn a_changed_file_is_foreign_and_a_removed_one_is_free() {
    let home = tempfile::tempdir().unwrap();
    let files = [("a.txt", "a"), ("b.txt", "b")];
    write(home.path(), claim(), &files).unwrap();
    fs::remove_file(home.path().join("a.txt")).unwrap();
    fs::write(home.path().join("b.txt"), "edited").unwrap();
    let error = write(home.path(), claim(), &files).unwrap_err();
    assert_eq!(reasons(error), one("b.txt", Reason::Changed));
    assert_eq!(names(home.path()), ["b.txt"]);
    write(home.path(), claim(), &files[..1]).unwrap();
    let mut folder = OwnedFolder::open(home.path(), claim()).unwrap();
    assert!(folder.remove("a.txt").unwrap() && !folder.remove("b.txt").unwrap());
    assert_eq!(names(home.path()), ["b.txt"]);
}

#[cfg(unix)]
#[test]
fn links_and_read_only_files_stay_and_no_link_is_followed() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let home = tempfile::tempdir().unwrap();
    let (target, elsewhere) = (home.path().join("out"), home.path().join("elsewhere"));
    fs::create_dir(&elsewhere).unwrap();
    fs::write(elsewhere.join("a.txt"), "mine").unwrap();
    let files = [("a.txt", "new"), ("b.txt", "new")];
    write(&target, claim(), &files).unwrap();
    fs::remove_file(target.join("a.txt")).unwrap();
    symlink(elsewhere.join("a.txt"), target.join("a.txt")).unwrap();
    fs::set_permissions(target.join("b.txt"), PermissionsExt::from_mode(0o444)).unwrap();
    let error = write(&target, claim(), &files).unwrap_err();
    let link = one("a.txt", Reason::Link);
    assert_eq!(
        reasons(error),
        [link, one("b.txt", Reason::ReadOnly)].concat()
    );
    // With force the link is replaced, not the file behind it.
    write(&target, claim().force(true), &files).unwrap();
    assert!(!target.join("a.txt").is_symlink());
    assert_eq!(fs::read_to_string(elsewhere.join("a.txt")).unwrap(), "mine");
    // A link in place of an own folder is none.
    symlink(&elsewhere, target.join("parts")).unwrap();
    let folder = OwnedFolder::open(&target, claim().force(true)).unwrap();
    let error = folder.subfolder("parts").unwrap_err();
    assert_eq!(reasons(error), one("parts", Reason::NoFolder));
}

#[cfg(unix)]
#[test]
fn an_input_is_never_replaced_whatever_its_name() {
    let home = tempfile::tempdir().unwrap();
    let path = |name: &str| home.path().join(name);
    fs::write(path("mine.csv"), "mine").unwrap();
    fs::hard_link(path("mine.csv"), path("a.txt")).unwrap();
    std::os::unix::fs::symlink("mine.csv", path("b.txt")).unwrap();
    let spelling = home.path().join("./x/../mine.csv");
    fs::create_dir(path("x")).unwrap();
    let claim = || claim().force(true).reading(Inputs::of([&spelling]));
    for name in ["mine.csv", "a.txt", "b.txt"] {
        let error = write(home.path(), claim(), &[(name, "new")]).unwrap_err();
        assert_eq!(reasons(error), one(name, Reason::Input));
        let error = NewFile::create(&path(name), true, &claim().inputs).unwrap_err();
        assert_eq!(reasons(error), one(name, Reason::Input));
    }
    assert_eq!(fs::read_to_string(path("a.txt")).unwrap(), "mine");
}

#[test]
fn a_list_that_is_damaged_or_lies_proves_nothing() {
    let home = tempfile::tempdir().unwrap();
    let files = [("a.txt", "a")];
    write(home.path(), claim(), &files).unwrap();
    let list = home.path().join(MARKER);
    let text = fs::read_to_string(&list).unwrap();
    let hash = sha256("a".as_bytes()).unwrap();
    let other = sha256("b".as_bytes()).unwrap();
    let in_the_way = |text: String| {
        fs::write(&list, text).unwrap();
        let outcome = write(home.path(), claim(), &files);
        assert_eq!(fs::read_to_string(home.path().join("a.txt")).unwrap(), "a");
        reasons(outcome.expect_err("not proven"))
    };
    let foreign = one("a.txt", Reason::Foreign);
    // Another file's hash, a damaged line, a torn line, a name outside.
    let lies = text.replace(&hash, &other);
    assert_eq!(in_the_way(lies), one("a.txt", Reason::Changed));
    assert_eq!(in_the_way(text.replace(&hash, &hash[1..])), foreign);
    assert_eq!(in_the_way(text.trim_end().to_owned()), foreign);
    assert_eq!(in_the_way(text.replace("  a.txt", "  ../a.txt")), foreign);
    // No list of this program, or of another version of it.
    let version = text.replace("# crepitus 1:", "# crepitus 2:");
    assert_eq!(in_the_way(version), one(MARKER, Reason::OtherVersion));
    assert_eq!(
        in_the_way(text[10..].to_owned()),
        one(MARKER, Reason::Foreign)
    );
    // The list itself is replaced with force alone.
    write(home.path(), claim().force(true), &files).unwrap();
    write(home.path(), claim(), &files).unwrap();
    // Each single bit of it: either the file is proven, or it is in the way; it never changes.
    let text = fs::read(&list).unwrap();
    for bit in 0..text.len() * 8 {
        let mut damaged = text.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        fs::write(&list, damaged).unwrap();
        let state = OwnedFolder::open(home.path(), claim()).and_then(|f| f.state("a.txt"));
        let line_begins = text.len() - "hash  a.txt\n".len() - 60;
        if bit / 8 >= line_begins {
            assert!(!matches!(state, Ok(State::Own)), "bit {bit}: {state:?}");
        }
    }
}

#[test]
fn a_file_of_a_killed_program_is_its_own() {
    let home = tempfile::tempdir().unwrap();
    write(home.path(), claim(), &[("a.txt", "first")]).unwrap();
    // Killed between the list and the file, in the middle of the next line.
    let second = sha256("second".as_bytes()).unwrap();
    marker::append(home.path(), "test", &[("a.txt", &second)]).unwrap();
    let list = home.path().join(MARKER);
    let torn = fs::read_to_string(&list).unwrap() + &second[..20];
    fs::write(&list, torn).unwrap();
    write(home.path(), claim(), &[("b.txt", "b")]).unwrap();
    for content in ["first", "second"] {
        fs::write(home.path().join("a.txt"), content).unwrap();
        let folder = OwnedFolder::open(home.path(), claim()).unwrap();
        assert_eq!(folder.state("a.txt").unwrap(), State::Own, "{content}");
    }
}

#[test]
fn files_are_on_the_list_before_the_first_of_them_appears() {
    let home = tempfile::tempdir().unwrap();
    let mut folder = OwnedFolder::open(home.path(), claim()).unwrap();
    let hashed = |name: &str| {
        let path = folder.temporary().unwrap().into_temp_path();
        (name.to_owned(), Hashed::of(path).unwrap())
    };
    let files = vec![hashed("a.txt"), hashed("b.txt")];
    // The second one cannot be moved any more.
    fs::remove_file(&files[1].1.path).unwrap();
    let error = folder.put_all(files).unwrap_err();
    assert!(matches!(error, OutputError::Io { .. }), "{error}");
    assert_eq!(names(home.path()), ["a.txt"]);
    let folder = OwnedFolder::open(home.path(), claim()).unwrap();
    assert_eq!(folder.state("a.txt").unwrap(), State::Own);
}

#[test]
fn a_subfolder_is_removed_with_own_files_alone() {
    let home = tempfile::tempdir().unwrap();
    let outer = OwnedFolder::open(home.path(), claim()).unwrap();
    for foreign in [false, true] {
        let mut inner = outer.subfolder("parts").unwrap();
        let mut file = inner.temporary().unwrap();
        file.write_all(b"a").unwrap();
        let file = Hashed::of(file.into_temp_path()).unwrap();
        inner.put(file, "a.txt").unwrap();
        if foreign {
            fs::create_dir_all(home.path().join("parts/deep")).unwrap();
        }
        outer.subfolder("parts").unwrap().remove_own().unwrap();
        assert_eq!(home.path().join("parts").exists(), foreign);
    }
    assert_eq!(names(&home.path().join("parts")), ["deep"]);
    // The folder is not this program's any more.
    let error = outer.subfolder("parts").unwrap_err();
    assert_eq!(reasons(error), one("parts", Reason::Folder));
}

#[test]
fn of_two_new_folders_one_is_there() {
    let home = tempfile::tempdir().unwrap();
    let target = home.path().join("run");
    let prepared = |name: &str| {
        let folder = Folder::create(&target, claim(), [name]).unwrap();
        folder.finish(folder.file(name).unwrap()).unwrap();
        folder
    };
    let (first, mut second) = (prepared("a.txt"), prepared("b.txt"));
    assert!(first.commit_new().unwrap());
    assert!(!second.commit_new().unwrap());
    second.aim_at(&home.path().join("run-2"));
    assert!(second.commit_new().unwrap());
    drop((first, second));
    assert_eq!(names(home.path()), ["run", "run-2"]);
    assert_eq!(names(&home.path().join("run-2")), ["b.txt"]);
    write(&target, claim(), &[("a.txt", "again")]).unwrap();
}

#[cfg(unix)]
#[test]
fn others_may_read_it_as_any_folder_and_an_empty_one_keeps_its_mode() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let home = tempfile::tempdir().unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().mode();
    let any = home.path().join("any");
    fs::create_dir(&any).unwrap();
    let target = home.path().join("run");
    let commit = |target: &Path| {
        let folder = Folder::create(target, claim(), ["a.txt"]).unwrap();
        folder.finish(folder.file("a.txt").unwrap()).unwrap();
        folder.commit_new().unwrap()
    };
    assert!(commit(&target));
    assert_eq!(mode(&target), mode(&any));
    fs::set_permissions(&any, PermissionsExt::from_mode(0o700)).unwrap();
    let before = mode(&any);
    assert!(commit(&any));
    assert_eq!(
        (mode(&any), names(&any)),
        (before, vec!["a.txt".to_owned()])
    );
    assert!(!commit(&any));
}

/// Shared memory is another file system than that of temporary files, as a rule.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_on_another_file_system_is_filled() {
    let Ok(other) = tempfile::tempdir_in("/dev/shm") else {
        eprintln!("left out: there is no /dev/shm");
        return;
    };
    let home = tempfile::tempdir().unwrap();
    let target = home.path().join("run");
    std::os::unix::fs::symlink(other.path(), &target).unwrap();
    drop(Folder::create(&target, claim(), ["a.txt"]).unwrap());
    assert_eq!(names(other.path()), Vec::<String>::new());
    let folder = Folder::create(&target, claim(), ["a.txt"]).unwrap();
    folder.finish(folder.file("a.txt").unwrap()).unwrap();
    assert!(!folder.commit_new().unwrap(), "it is there already");
    folder.commit().unwrap();
    assert_eq!(names(other.path()), ["a.txt"]);
    assert_eq!(names(home.path()), ["run"]);
}

#[test]
fn what_is_not_committed_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    let target = home.path().join("run");
    let folder = Folder::create(&target, claim(), ["a.txt"]).unwrap();
    folder.file("a.txt").unwrap().write_all(b"half").unwrap();
    drop(folder);
    assert_eq!(names(home.path()), Vec::<String>::new());
}

#[test]
fn places_where_no_folder_can_be() {
    let home = tempfile::tempdir().unwrap();
    let create = |path: &Path| Folder::create(path, claim().force(true), [""; 0]).unwrap_err();
    let error = create(&home.path().join("x".repeat(300)));
    assert!(matches!(error, OutputError::Io { .. }), "{error}");
    for stdout in ["-", "/dev/stdout"] {
        let text = create(Path::new(stdout)).to_string();
        assert!(text.contains("not standard output"), "{text}");
    }
    let file = home.path().join("file");
    fs::write(&file, "mine").unwrap();
    for (path, word) in [
        (file.clone(), "a file of this name"),
        (file.join("run"), "in is a file"),
    ] {
        let text = create(&path).to_string();
        assert!(text.contains(word), "{text}");
    }
    assert_eq!(fs::read_to_string(file).unwrap(), "mine");
    assert_eq!(names(home.path()), ["file"]);
}

#[test]
fn a_single_file_is_replaced_with_force_alone() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("a.wav");
    let attempt = |force| -> Result<(), OutputError> {
        let file = NewFile::create(&path, force, &Inputs::default())?;
        file.as_file().write_all(b"new").unwrap();
        file.persist()
    };
    let early = NewFile::create(&path, false, &Inputs::default()).unwrap();
    fs::write(&path, "mine").unwrap();
    assert_eq!(
        reasons(early.persist().unwrap_err()),
        one("a.wav", Reason::Foreign)
    );
    assert_eq!(
        reasons(attempt(false).unwrap_err()),
        one("a.wav", Reason::Foreign)
    );
    assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    attempt(true).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(names(home.path()), ["a.wav"]);
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    assert_eq!(
        reasons(attempt(true).unwrap_err()),
        one("a.wav", Reason::Folder)
    );
}
