//! The forms of files that are read, and what is wrong or odd about whole files: text written to a
//! temporary file.

use super::{AngleUnit, MAX_BYTES, RecordingError, Samples, Source, Warning, read};
use std::fs;

/// Reads `text` as a file of that name; the error is shown without the folder.
pub(super) fn read_unit(
    name: &str,
    text: impl AsRef<[u8]>,
    unit: AngleUnit,
) -> Result<Samples, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    read(&Source {
        path: &path,
        time_column: "time",
        angle_column: "knee",
        unit: Some(unit),
    })
    .map_err(|error| {
        error
            .to_string()
            .replace(&format!("{}/", folder.path().display()), "")
    })
}

pub(super) fn read_csv(text: impl AsRef<[u8]>) -> Result<Samples, String> {
    read_unit("a.csv", text, AngleUnit::Deg)
}

pub(super) fn read_mot(text: &str) -> Result<Samples, String> {
    read_unit("a.mot", text, AngleUnit::Deg)
}

#[track_caller]
pub(super) fn assert_refused(result: Result<Samples, String>, expected: &str) {
    let error = result.unwrap_err();
    assert!(
        error.starts_with(expected),
        "\n   found: {error}\nexpected: {expected}"
    );
}

#[track_caller]
pub(super) fn assert_warned(result: Result<Samples, String>, expected: &str) {
    let warnings: Vec<String> = result
        .unwrap()
        .warnings
        .iter()
        .map(Warning::to_string)
        .collect();
    assert!(
        matches!(warnings.as_slice(), [only] if only.contains(expected)),
        "\n   found: {warnings:?}\nexpected: {expected}"
    );
}

pub(super) const CSV: &str = "time,knee\n1.0,0\n1.1,90\n1.2,180\n1.3,-90\n";
pub(super) const MOT: &str = "Coordinates\nversion=1\nnRows=4\nnColumns=3\ninDegrees=yes\n\nUnits are S.I. units\n\
                   endheader\ntime\thip\tknee\n 1.0\t 5\t 0\n 1.1\t5\t90\n 1.2\t5\t180\n 1.3\t5\t-90\n";

#[track_caller]
fn assert_good(result: Result<Samples, String>) {
    let samples = result.unwrap();
    let near = |found: &[f64], expected: [f64; 4]| {
        found.len() == 4
            && found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-12)
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    assert!(
        near(&samples.time_s, [0.0, 0.1, 0.2, 0.3]),
        "{:?}",
        samples.time_s
    );
    assert!(near(
        &samples.angle_rad,
        [0.0, quarter, 2.0 * quarter, -quarter]
    ));
    assert_eq!(samples.time_s[0], 0.0);
    assert_eq!(samples.warnings, []);
}

#[test]
fn csv_is_read_in_the_forms_programs_write() {
    assert_good(read_csv(CSV));
    assert_good(read_csv(CSV.trim_end()));
    assert_good(read_csv(CSV.replace('\n', "\r\n")));
    assert_good(read_csv(CSV.replace(',', " ,  ")));
    assert_good(read_csv(format!("\u{feff}{CSV}")));
    assert_good(read_csv(format!("\n{}\n \r\n", CSV.replace('\n', "\n\n"))));
    assert_good(read_csv(
        CSV.replace("time,", "\"time\",").replace("180", "\"180\""),
    ));
    assert_good(read_csv(
        "hip,knee,time\n9,0,1\n9,90,1.1\n9,180,1.2\nx,-90,1.3",
    ));
}

#[test]
fn opensim_is_read_in_the_forms_programs_write() {
    assert_good(read_mot(MOT));
    assert_good(read_mot(MOT.trim_end()));
    assert_good(read_mot(&MOT.replace('\n', "\r\n")));
    assert_good(read_mot(&MOT.replace('\n', "\t\t\n")));
    assert_good(read_mot(&MOT.replace('\t', "  ")));
    assert_good(read_mot(&MOT.replace("inDegrees=yes\n", "")));
    assert_good(read_mot(
        &MOT.replace("nRows=", "datarows ")
            .replace("nColumns=", "datacolumns "),
    ));
    assert_good(read_mot(&MOT.replace("1.1\t5\t90", "1.1  5  90")));
    assert_good(read_unit("a.STO", MOT, AngleUnit::Deg));
}

#[test]
fn radians_are_taken_as_they_are() {
    let samples = read_unit(
        "a.csv",
        "time,knee\n0,0\n1,0.5\n2,1\n3,1.5\n",
        AngleUnit::Rad,
    )
    .unwrap();
    assert_eq!(samples.angle_rad, [0.0, 0.5, 1.0, 1.5]);
    let text = MOT
        .replace("yes", "no")
        .replace("180", "1")
        .replace("90", "2");
    read_unit("a.mot", text, AngleUnit::Rad).unwrap();
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.csv");
    let mut source = Source {
        path: &missing,
        time_column: "t",
        angle_column: "a",
        unit: Some(AngleUnit::Deg),
    };
    let error = read(&source).unwrap_err();
    assert!(matches!(error, RecordingError::Unreadable { .. }));
    assert!(
        error
            .to_string()
            .ends_with("; check the path and the permissions")
    );

    source.path = folder.path();
    assert!(matches!(
        read(&source),
        Err(RecordingError::NotAFile { .. })
    ));

    let huge = folder.path().join("huge.csv");
    fs::File::create(&huge)
        .unwrap()
        .set_len(MAX_BYTES + 1)
        .unwrap();
    source.path = &huge;
    assert!(matches!(
        read(&source),
        Err(RecordingError::TooLarge { .. })
    ));
}

#[test]
fn files_without_a_table() {
    assert_refused(read_csv(""), "a.csv: is empty");
    assert_refused(read_csv("\n \n"), "a.csv: is empty");
    assert_refused(read_mot(""), "a.mot: is empty");
    assert_refused(
        read_csv("time,knee\n"),
        "a.csv, line 1: has column names but no rows",
    );
    assert_refused(
        read_csv("\n\ntime,knee"),
        "a.csv, line 3: has column names but no rows",
    );
    assert_refused(
        read_csv("time,knee\n0,1\n"),
        "a.csv, line 2: the rows end after 1, at least 4 are needed",
    );
    assert_refused(
        read_csv(b"time,knee\n0,1\n0.1,\xff\n"),
        "a.csv, line 3: is not UTF-8 text",
    );
    assert_refused(
        read_csv(b"\xff\xfet\0i\0m\0e\0\n\0".as_slice()),
        "a.csv, line 1: is not UTF-8 text",
    );
    let latin = [b"M\xfcller\n".as_slice(), MOT.as_bytes()].concat();
    assert_refused(
        read_unit("a.mot", latin, AngleUnit::Deg),
        "a.mot, line 1: is not UTF-8 text",
    );
    assert_refused(read_mot(CSV), "a.mot: no line \"endheader\"");
    assert_refused(
        read_mot("x\nendheader\n"),
        "a.mot, line 2: nothing follows \"endheader\"",
    );
    assert_refused(
        read_mot("x\nendheader\ntime knee\n"),
        "a.mot, line 3: has column names but no rows",
    );
}

#[test]
fn columns_that_are_not_there_or_not_clear() {
    assert_refused(
        read_csv("time,Knee_angle\n0,1\n"),
        "a.csv, line 1, column \"knee\": there is no such column (angle_column); did you mean \
         \"Knee_angle\"?; the file has \"time\", \"Knee_angle\"",
    );
    assert_refused(
        read_csv("t,knee\n0,1\n"),
        "a.csv, line 1, column \"time\": there is no such column (time_column); the file has \"t\"",
    );
    assert_refused(
        read_csv("0.0,18.5\n0.1,18.6\n"),
        "a.csv, line 1, column \"time\": there is no such column (time_column); the first line must",
    );
    assert_refused(
        read_mot("x\nendheader\ntime\thip\n"),
        "a.mot, line 3, column \"knee\": there is no such column (angle_column); the file has",
    );
    assert_refused(
        read_csv("time,knee,hip,knee\n0,1,2,3\n"),
        "a.csv, line 1, column \"knee\": the name is used twice, for columns 2 and 4",
    );
    assert_good(read_csv(
        CSV.replace("time,knee", "time,knee,x,x")
            .replace(".1,90", ".1,90,0,0")
            .replace("1.0,0", "1.0,0,0,0")
            .replace("180", "180,0,0")
            .replace("-90", "-90,0,0"),
    ));
    assert_refused(
        read_csv(CSV.replace(',', ";")),
        "a.csv, line 1: the cells are separated by ';'",
    );
    let path = std::path::Path::new("a.csv");
    let source = Source {
        path,
        time_column: "knee",
        angle_column: "knee",
        unit: Some(AngleUnit::Deg),
    };
    assert_eq!(
        read(&source).unwrap_err().to_string(),
        "a.csv, column \"knee\": time_column and angle_column are the same; name two columns"
    );
}

#[test]
fn a_header_that_does_not_fit_and_gaps_are_warnings() {
    assert_warned(
        read_mot(&MOT.replace("nRows=4", "nRows=5")),
        "a.mot, line 3: the header declares 5 rows, the file has 4",
    );
    assert_warned(
        read_mot(&MOT.replace("nRows=4", "nRows=3")),
        "a.mot, line 3: the header declares 3 rows, the file has 4",
    );
    assert_warned(
        read_mot(&MOT.replace("nColumns=3", "nColumns=4")),
        "a.mot, line 4: the header declares 4 columns, the line of names has 3",
    );
    assert_warned(
        read_csv(format!("{CSV}2.0,5\n2.1,5\n3.5,6\n3.6,7")),
        "a.csv, column \"time\": no samples between 2.100 s and 3.500 s, where 0.100 s is usual \
         (2 such gaps, this is the longest)",
    );
}
