//! Problems of single cells and rows, and of the unit.

use super::test_read::{CSV, MOT, assert_refused, assert_warned, read_csv, read_mot, read_unit};
use super::{AngleUnit, Source, Warning, read};
use std::fs;

#[test]
fn cells_that_are_not_numbers() {
    let place = "a.csv, line 3, column \"knee\": ";
    for (cell, expected) in [
        (
            "abc",
            "\"abc\" is not a number; write a number such as 12.4",
        ),
        (
            "\"12,4\"",
            "\"12,4\" is not a number (use a point as the decimal sign)",
        ),
        ("1.#IND", "\"1.#IND\" is not a number"),
        ("a\u{7}b", "\"a\\u{7}b\" is not a number"),
        (
            "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaa",
            "\"aaaaaaaaaaaaaaaaaaaaaaaa…\" is not a number",
        ),
        ("", "the cell is empty"),
        ("NaN", "\"NaN\" is not a finite number"),
        ("-inf", "\"-inf\" is not a finite number"),
        ("1e400", "\"1e400\" is not a finite number"),
        (
            "2000.5",
            "2000.5 deg is no joint angle, at most ±2000 deg is believed",
        ),
    ] {
        let text = CSV.replace("1.1,90", &format!("1.1,{cell}"));
        assert_refused(
            read_csv(text.replace('\n', "\r\n")),
            &format!("{place}{expected}"),
        );
    }
    assert_refused(
        read_mot(&MOT.replace("5\t90", "5\t")),
        "a.mot, line 11: the row has 2 cells, the names are 3",
    );
    assert_refused(
        read_mot(&MOT.replace("1.1\t5\t90", "\t5\t90")),
        "a.mot, line 11, column \"time\": the cell is empty",
    );
    assert_refused(
        read_mot(&MOT.replace("180", "18,0")),
        "a.mot, line 12, column \"knee\": \"18,0\" is not a number (use a point",
    );
}

#[test]
fn times_that_do_not_go_forward() {
    assert_refused(
        read_csv(CSV.replace("1.2,", "0.9,")),
        "a.csv, line 4, column \"time\": time goes back from 1.1 s to 0.9 s",
    );
    assert_refused(
        read_csv(CSV.replace("1.2,", "1.1,")),
        "a.csv, line 4, column \"time\": time stands still at 1.1 s",
    );
    assert_refused(
        read_csv(CSV.replace("1.2,", "1.7e12,")),
        "a.csv, line 4, column \"time\": 1700000000000 is no time in seconds",
    );
}

#[test]
fn rows_of_the_wrong_width() {
    assert_refused(
        read_csv(CSV.replace("1.3,-90\n", "1.3")),
        "a.csv, line 5: the file ends inside this row, with 1 of 2 cells",
    );
    assert_refused(
        read_csv(CSV.replace("1.1,90", "1.1")),
        "a.csv, line 3: the row has 1 cells, the names are 2",
    );
    assert_refused(
        read_csv(CSV.replace("1.1,90", "1,1,9,0")),
        "a.csv, line 3: the row has 4 cells, the names are 2",
    );
    assert_refused(
        read_mot(&MOT.replace("5\t-90\n", "5")),
        "a.mot, line 13: the file ends inside this row, with 2 of 3 cells",
    );
}

#[test]
fn the_unit_is_checked_against_the_file() {
    assert_refused(
        read_unit("a.mot", MOT, AngleUnit::Rad),
        "a.mot, line 5: the header says inDegrees=yes, so the angles are in deg; \
         write unit = \"deg\"",
    );
    assert_refused(
        read_mot(&MOT.replace("=yes", " = No")),
        "a.mot, line 5: the header says inDegrees=No, so the angles are in rad",
    );
    assert_refused(
        read_unit("a.csv", CSV, AngleUnit::Rad),
        "a.csv, line 3, column \"knee\": 90 rad is no joint angle, at most ±35 rad is believed; \
         check the column, and write unit = \"deg\" if it is in degrees",
    );
    assert_warned(
        read_csv("time,knee\n0,0\n1,0.5\n2,1.25\n3,0.5\n"),
        "a.csv, column \"knee\": no angle is beyond ±1.250 deg; if the file is in radians",
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    fs::write(&path, CSV.replace("knee", "knee_rad")).unwrap();
    let unit = AngleUnit::Deg;
    let source = Source {
        path: &path,
        time_column: "time",
        angle_column: "knee_rad",
        unit: Some(unit),
    };
    let warnings = read(&source).unwrap().warnings;
    assert!(
        matches!(warnings.as_slice(), [Warning::UnitInName { .. }]),
        "{warnings:?}"
    );
}
