use super::*;

const HEADER: &str = "What: two is missing\n# A comment.\nNoticed-by: -p small --lib -- two\n";

const DIFF: &str = "
diff --git a/small/a.rs b/small/a.rs
index 123..456 100644
--- a/small/a.rs
+++ b/small/a.rs
@@ -1,3 +1,2 @@
 one

-two
--- a/small/b.rs
+++ b/small/b.rs
@@ -1 +1,2 @@ fn b()
 b
+c
";

fn parse(text: &str) -> Result<Fault, PatchError> {
    Fault::parse(Path::new("tools/faults/small/two.patch"), text)
}

fn with_sources(a: &str) -> tempfile::TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir(root.path().join("small")).unwrap();
    fs::write(root.path().join("small/a.rs"), a).unwrap();
    fs::write(root.path().join("small/b.rs"), "b\n").unwrap();
    root
}

#[test]
fn a_patch_changes_files_where_its_lines_stand_once() {
    let fault = parse(&(HEADER.to_owned() + DIFF)).unwrap();
    assert_eq!((fault.area.as_str(), fault.name.as_str()), ("small", "two"));
    assert_eq!(fault.noticed_by.as_deref(), Some("-p small --lib -- two"));
    let files: Vec<&str> = fault.changed_files().collect();
    assert_eq!(files, ["small/a.rs", "small/b.rs"]);
    // The second one has other numbers of lines.
    for (was, now) in [
        ("one\n\ntwo\nthree\n", "one\n\nthree\n"),
        ("zero\n0\none\n\ntwo\n", "zero\n0\none\n\n"),
    ] {
        let root = with_sources(was);
        let changes = fault.apply(root.path()).unwrap();
        let change = &changes[Path::new("small/a.rs")];
        assert_eq!((change.was.as_str(), change.now.as_str()), (was, now));
        assert_eq!(changes[Path::new("small/b.rs")].now, "b\nc\n");
    }
    for (source, times) in [("one\n\n2\n", 0), ("one\n\ntwo\none\n\ntwo\n", 2)] {
        let root = with_sources(source);
        let error = fault.apply(root.path()).unwrap_err();
        assert!(matches!(error, PatchError::Place { found, hunk: 1, .. } if found == times));
        let text = error.to_string();
        for name in ["two.patch", "small/a.rs"] {
            assert!(text.contains(name), "{text}");
        }
    }
    let error = fault.apply(Path::new("/nowhere")).unwrap_err();
    assert!(error.to_string().contains("small/a.rs"), "{error}");
}

#[test]
fn a_result_is_that_of_the_patch_as_it_is() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("tools/faults/small/two.patch");
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let image = "What: a\nUnseen: c\nProgram: comms\nImage: 80 -> 81\n";
    for text in [image, &(HEADER.to_owned() + DIFF)] {
        fs::write(&path, text).unwrap();
        let mut fault = parse(text).unwrap();
        assert_eq!(fault.result, None);
        let noticed = Outcome::Noticed("small: two".to_owned());
        for outcome in [Outcome::NotNoticed, noticed] {
            fault.result = Some(outcome);
            fault.record(root.path()).unwrap();
            let recorded = fs::read_to_string(&path).unwrap();
            assert_eq!(parse(&recorded).unwrap().result, fault.result);
        }
    }
    let recorded = fs::read_to_string(&path).unwrap();
    for (was, now, is_kept) in [
        ("two is missing", "one is missing", true),
        ("--lib", "--test laws", false),
        ("+c", "+d", false),
    ] {
        let result = parse(&recorded.replace(was, now)).unwrap().result;
        assert_eq!(result.is_some(), is_kept, "{now}");
    }
    // Edited while it was tried.
    let fault = parse(&recorded).unwrap();
    let edited = recorded.replace("+c", "+d");
    fs::write(&path, &edited).unwrap();
    fault.record(root.path()).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), edited);
}

#[test]
fn lines_that_are_no_part_of_a_hunk_are_an_error() {
    let root = with_sources("one\n\ntwo\nthree\n");
    let lost = " two\n@@ -4 +4 @@\n-three\n+3\n";
    let diff = "\n--- a/small/a.rs\n+++ b/small/a.rs\n@@ -1 +1 @@\n-one\n+1\n";
    let fault = parse(&format!("{HEADER}{diff}{lost}")).unwrap();
    assert!(fault.apply(root.path()).is_err());
}

#[test]
fn a_header_that_lacks_something_is_an_error() {
    for header in [
        "Noticed-by: -p small\n",
        "What: nothing notices it\n",
        "What: a\nWhat: b\nUnseen: c\n",
        "What:\nUnseen: c\n",
        "What: a\nUnseen: c\nWhy: d\n",
        "What: a\nUnseen: c\nProgram: panel\n",
        "What: a\nUnseen: c\nImage: 80 -> 81\n",
        "What: a\nUnseen: c\nProgram: drive\nImage: 80\n",
    ] {
        assert!(parse(&(header.to_owned() + DIFF)).is_err(), "{header}");
    }
    assert!(parse("What: a\nUnseen: c\n").is_err(), "no diff");
    let image = "What: a\nUnseen: c\nProgram: comms\nImage: 80 -> 81\n";
    let fault = parse(image).unwrap();
    assert_eq!(fault.program, Some(Program::Comms));
    assert!(fault.apply(Path::new("/nowhere")).unwrap().is_empty());
    assert!(fault.edit_image(&mut [0x80]).is_ok());
    assert!(fault.edit_image(&mut [0x82]).is_err());
}
