//! CSV and JSON of one verb have the same names and the same numbers.

mod support;

use serde_json::Value;
use std::fs;
use support::{done, is_row, summary, table};

#[test]
fn effects_are_the_same_in_both() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("study");
    let to = out.display();
    done(&format!(
        "effects fig8-4-cuff --set duration_s=0.2 --out {to}"
    ));
    let (header, rows) = table(&out.join("effects.csv"));
    let summary = summary(&out);
    let objects = summary["rows"].as_array().unwrap();
    assert_eq!(
        (objects.len(), objects[0].as_object().unwrap().len()),
        (rows.len(), header.len())
    );
    for (object, row) in objects.iter().zip(&rows) {
        assert!(is_row(object, &header, row), "{object} {row:?}");
    }
    // It can fail.
    assert!(!is_row(&objects[0], &header, &rows[1]));
}

#[test]
fn cells_of_the_matrix_are_the_same_in_both() {
    let home = tempfile::tempdir().unwrap();
    let out = home.path().join("study");
    let to = out.display();
    done(&format!("stability --case H01 --case H05 --out {to}"));
    let (header, rows) = table(&out.join("cases.csv"));
    for case in summary(&out)["cases"].as_array().unwrap() {
        let narrowest = &case["narrowest"];
        assert_eq!(narrowest.as_object().unwrap().len(), header.len());
        let found = rows.iter().filter(|row| is_row(narrowest, &header, row));
        assert_eq!(found.count(), 1, "{narrowest}");
    }
}

#[test]
fn samples_are_the_same_in_both() {
    let home = tempfile::tempdir().unwrap();
    let stream = "stream --device sim --for 100ms --rate 1000 --arm --zero";
    let file = home.path().join("samples.csv");
    fs::write(&file, done(stream)).unwrap();
    let (header, rows) = table(&file);
    let lines = done(&format!("{stream} --json"));
    assert!(rows.len() >= 80 && rows.len() == lines.lines().count());
    for (line, row) in lines.lines().zip(&rows) {
        let object: Value = serde_json::from_str(line).unwrap();
        assert!(is_row(&object, &header, row), "{line} {row:?}");
    }
}
