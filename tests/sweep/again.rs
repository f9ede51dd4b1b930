//! A sweep that is repeated from its folder alone.

use crate::support::{names, stderr};
use crate::{GRID, TS, column, done, refused, sweep};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn same_table(home: &Path, one: &str, other: &str, file: &str) {
    let read = |folder: &str| fs::read(home.join(folder).join(file)).unwrap();
    assert!(read(one) == read(other), "{one} and {other}");
}

/// The folder alone, in another place.
fn moved(home: &Path, from: &str, files: &[&str]) -> tempfile::TempDir {
    let other = tempfile::tempdir().unwrap();
    for file in files {
        fs::copy(home.join(from).join(file), other.path().join(file)).unwrap();
    }
    other
}

#[test]
fn a_sweep_is_repeated_from_its_folder_to_the_byte() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    for (design, format, file) in [
        (GRID.to_owned(), "csv", "sweep.csv"),
        (
            format!(
                "everything --as-device --latin 6 --seed 18446744073709551615 --vary {TS}=0.3:0.31:log --set duration_s=0.1"
            ),
            "parquet",
            "sweep.parquet",
        ),
        (
            format!(
                "low-speed --sobol 8 --vary {TS}=2:4 --vary solver.kind=exact,exact-events --set duration_s=0.1"
            ),
            "csv",
            "sweep.csv",
        ),
    ] {
        done(home, &format!("{design} --out s --force --format {format}"));
        let elsewhere = moved(home, "s", &["sweep.json"]);
        let folder = elsewhere.path().display();
        done(
            home,
            &format!("--again {folder} --out t --force --threads 1"),
        );
        same_table(home, "s", "t", file);
        // What is there already is told from a repetition.
        let told = done(home, &format!("--again {folder} --out t"));
        assert!(told.contains("complete already"), "{told}");
    }
    // By default beside it, and once more from there.
    done(home, "--again s/");
    done(home, "--again s-again");
    same_table(home, "s", "s-again-again", "sweep.csv");
}

#[test]
fn the_folder_says_what_it_is_a_sweep_of() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    done(home, &format!("{GRID} --out s --format csv"));
    let about: Value =
        serde_json::from_str(&fs::read_to_string(home.join("s/sweep.json")).unwrap()).unwrap();
    assert_eq!(about["crepitus_version"], env!("CARGO_PKG_VERSION"));
    assert!(about["scene_toml"].as_str().unwrap().contains("[motion]"));
    assert!(
        about["scene_as_run"]
            .as_str()
            .unwrap()
            .contains("duration_s = 0.5")
    );
    assert_eq!(about["overrides"]["set"][0][0], "duration_s");
    assert_eq!(about["design"]["kind"], "grid");
    assert_eq!(about["design"]["vary"][0]["path"], TS);
    assert_eq!(about["design"]["vary"][0]["values"], "1.6:4.0:lin5");
    assert!(about.get("crepitus_commit").is_some());
}

#[test]
fn points_of_another_program_are_in_the_folder() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    fs::write(
        home.join("points.csv"),
        format!("{TS};solver.kind\n2,5;exact\n3,5;exact-events\n"),
    )
    .unwrap();
    done(
        home,
        "low-speed --points points.csv --out s --format csv --set duration_s=0.1",
    );
    fs::remove_file(home.join("points.csv")).unwrap();
    done(home, "--again s --out t");
    same_table(home, "s", "t", "sweep.csv");
    fs::write(
        home.join("s/points.csv"),
        format!("{TS},solver.kind\n2.5,exact\n3.6,exact\n"),
    )
    .unwrap();
    let text = refused(home, "--again s --out u", 2);
    assert!(text.contains("points.csv was changed"), "{text}");
    // Somebody's own file of this name stays.
    fs::write(home.join("p.csv"), format!("{TS}\n2.5\n")).unwrap();
    fs::create_dir(home.join("w")).unwrap();
    fs::write(home.join("w/points.csv"), "mine").unwrap();
    let arguments = "low-speed --points p.csv --out w --format csv --set duration_s=0.1";
    refused(home, arguments, 2);
    done(
        home,
        &format!("low-speed --vary {TS}=2.5,3 --out w --format csv"),
    );
    assert_eq!(
        fs::read_to_string(home.join("w/points.csv")).unwrap(),
        "mine"
    );
}

#[test]
fn a_recording_is_found_where_it_was_or_beside_and_has_to_be_the_same() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    let rows = (0..40).map(|i| format!("{},{}\n", f64::from(i) * 0.05, 10.0 + f64::from(i)));
    let knee = "t_s,angle_deg\n".to_owned() + &rows.collect::<String>();
    fs::create_dir(home.join("in")).unwrap();
    fs::write(home.join("in/knee.csv"), &knee).unwrap();
    fs::write(
        home.join("in/mine.toml"),
        "version = 1\nduration_s = 1.5\n[motion]\nkind = \"recording\"\nfile = \"knee.csv\"\n\
         time_column = \"t_s\"\nangle_column = \"angle_deg\"\nunit = \"deg\"\n\
         [solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n[effects.crepitus]\npreset = \"coarse\"\n",
    )
    .unwrap();
    done(
        home,
        "in/mine.toml --vary effects.crepitus.preset=coarse,fine --out s --format csv",
    );
    // Another working directory, and no scene file.
    fs::remove_file(home.join("in/mine.toml")).unwrap();
    let other = moved(home, "s", &["sweep.json"]);
    done(other.path(), "--again . --out t");
    assert!(
        fs::read(other.path().join("t/sweep.csv")).unwrap()
            == fs::read(home.join("s/sweep.csv")).unwrap()
    );
    // Gone, and put beside.
    fs::remove_file(home.join("in/knee.csv")).unwrap();
    let text = refused(other.path(), "--again . --out u", 2);
    assert!(text.contains("knee.csv: put it into this folder"), "{text}");
    fs::write(other.path().join("knee.csv"), &knee).unwrap();
    done(other.path(), "--again . --out u");
    assert!(
        fs::read(other.path().join("u/sweep.csv")).unwrap()
            == fs::read(home.join("s/sweep.csv")).unwrap()
    );
    // Another recording of this name.
    fs::write(
        other.path().join("knee.csv"),
        knee.replace("10,", "11,").replace(",12\n", ",13\n"),
    )
    .unwrap();
    let text = refused(other.path(), "--again . --out v", 2);
    assert!(text.contains("knee.csv has changed since"), "{text}");
    assert!(!other.path().join("v").exists());
}

#[test]
fn another_program_is_named_and_another_table_is_an_error() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    done(home, &format!("{GRID} --out s --format csv"));
    let json = home.join("s/sweep.json");
    let text = fs::read_to_string(&json).unwrap();
    let about: Value = serde_json::from_str(&text).unwrap();
    let sha256 = about["table"]["sha256"].as_str().unwrap();
    fs::write(&json, text.replace(sha256, &"0".repeat(64))).unwrap();
    let text_of = refused(home, "--again s --out t", 1);
    assert!(text_of.contains("differs from the table of s"), "{text_of}");
    let older = text.replace(
        concat!("\"crepitus_version\": \"", env!("CARGO_PKG_VERSION")),
        "\"crepitus_version\": \"0.0.1",
    );
    fs::write(&json, older).unwrap();
    let output = sweep(home, "--again s --out u").output().unwrap();
    assert!(
        stderr(&output).contains("of crepitus 0.0.1"),
        "{}",
        stderr(&output)
    );
    // Changed by hand.
    fs::write(&json, text.replace("1.6:4.0:lin5", "1.6:4.1:lin5")).unwrap();
    assert!(refused(home, "--again s --out v", 2).contains("was changed"));
    for (arguments, word) in [
        ("--again nowhere", "sweep.json is missing"),
        ("--again .", "sweep.json is missing"),
        ("--again s --set duration_s=1", "cannot be used with"),
        ("low-speed --again s", "cannot be used with"),
    ] {
        let text = refused(home, arguments, 2);
        assert!(text.contains(word), "{arguments}: {text}");
    }
    assert_eq!(names(home), ["s", "t", "u"]);
}

#[test]
fn a_preset_whose_numbers_were_changed_is_none() {
    let home = tempfile::tempdir().unwrap();
    let home = home.path();
    done(
        home,
        &format!("preset-coarse --vary {TS}=0.4,0.35 --out s --format csv --set duration_s=0.1"),
    );
    let (header, rows) = crate::support::table(&home.join("s/sweep.csv"));
    assert_eq!(column(&header, &rows, "preset"), ["coarse", ""]);
}
