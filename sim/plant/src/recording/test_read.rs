//! The forms of files that are read, and what is wrong or odd about whole files: text written to a
//! temporary file.

use super::{
    AngleUnit, Angles, MAX_BYTES, Quantity, RecordingError, Samples, Source, TimeUnit, read,
    read_from,
};
use std::fs;

/// Reads `text` as a file of that name; the error is shown without the folder.
pub(super) fn read_unit(
    name: &str,
    text: impl AsRef<[u8]>,
    unit: impl Into<Option<AngleUnit>>,
) -> Result<Samples, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    let angles = Quantity::Angles(Angles::of(unit.into()));
    read(&Source::new(&path, "time", "knee", angles)).map_err(|error| {
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
    let warnings = result.unwrap().warnings;
    assert!(
        matches!(warnings.as_slice(), [only] if only.contains(expected)),
        "\n   found: {warnings:?}\nexpected: {expected}"
    );
}

pub(super) const CSV: &str = "time,knee\n1.0,0\n1.1,60\n1.2,120\n1.3,-30\n";
pub(super) const MOT: &str = "Coordinates\nversion=1\nnRows=4\nnColumns=3\ninDegrees=yes\n\nUnits are S.I. units\n\
                   endheader\ntime\thip\tknee\n 1.0\t 5\t 0\n 1.1\t5\t60\n 1.2\t5\t120\n 1.3\t5\t-30\n";

#[track_caller]
fn assert_good(result: Result<Samples, String>) {
    let samples = result.unwrap();
    let near = |found: &[f64], expected: [f64; 4]| {
        found.len() == 4
            && found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-10)
    };
    let third = std::f64::consts::FRAC_PI_3;
    assert!(
        near(&samples.time_s, [0.0, 0.1, 0.2, 0.3]),
        "{:?}",
        samples.time_s
    );
    assert!(near(
        &samples.angle_rad,
        [0.0, third, 2.0 * third, -0.5 * third]
    ));
    assert_eq!(samples.time_s[0], 0.0);
    assert_eq!(samples.warnings, Vec::<String>::new());
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
    assert_good(read_mot(&MOT.replace("1.1\t5\t60", "1.1  5  60")));
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
        .replace("120", "1")
        .replace("60", "2")
        .replace("-30", "-0.3");
    read_unit("a.mot", text, AngleUnit::Rad).unwrap();
}

#[test]
fn files_that_cannot_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.csv");
    let mut source = Source::new(&missing, "t", "a", Quantity::Number);
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
        "a.csv, line 1, column \"knee\": the name is used twice, for columns 2 and 4; rename one, or name it by its position, \
         \"#2\" or \"#4\"",
    );
    assert_good(read_csv(
        CSV.replace("time,knee", "time,knee,x,x")
            .replace(".1,60", ".1,60,0,0")
            .replace("1.0,0", "1.0,0,0,0")
            .replace("120", "120,0,0")
            .replace("-30", "-30,0,0"),
    ));
    let many: Vec<String> = (0..60).map(|i| format!("c{i}")).collect();
    let error = read_csv(many.join(",")).unwrap_err();
    assert!(error.ends_with("\"c9\" and 50 more"), "{error}");
    let path = std::path::Path::new("a.csv");
    let source = Source::new(path, "knee", "knee", Quantity::Number);
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

/// Checks a file, and what is said of how it was read.
#[track_caller]
fn assert_read_as(result: Result<Samples, String>, expected: &[&str]) {
    let mut samples = result.unwrap();
    let read_as = std::mem::take(&mut samples.read_as);
    assert_eq!(read_as.len(), expected.len(), "{read_as:?}");
    for (found, expected) in read_as.iter().zip(expected) {
        assert!(found.contains(expected), "{found}: {expected}");
    }
    assert_good(Ok(samples));
}

#[test]
fn files_of_laboratories_are_read_and_what_was_assumed_is_said() {
    let german = CSV.replace(',', ";").replace('.', ",");
    assert_read_as(read_csv(CSV.replace(',', ";")), &["semicolons"]);
    assert_read_as(read_csv(&german), &["semicolons", "decimal commas"]);
    assert_read_as(
        read_csv(german.replace(';', "\t")),
        &["tabs", "decimal commas"],
    );
    assert_read_as(read_csv(CSV.replace('\n', "\r")), &[]);
    assert_read_as(read_csv(format!("a,b\n\n{CSV}")), &["line 3"]);
    let with_units = CSV.replace("knee\n", "knee\ns,deg\n");
    assert_read_as(
        read_unit("a.csv", &with_units, None),
        &["line 2", "angles are in deg"],
    );
    assert_read_as(
        read_unit("a.mot.txt", MOT, None),
        &["in deg, as the header (inDegrees=yes) says"],
    );
    assert_read_as(read_mot(CSV), &[]);
    let wide: Vec<u8> = CSV.encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_read_as(read_csv(wide), &["UTF-16LE"]);
    assert_read_as(
        read_csv([b"Pr\xfcfer,\n", CSV.as_bytes()].concat()),
        &["line 2", "windows-1252"],
    );
    // Units of time: named, or those of the row.
    let ms = "time,knee\n1000,0\n1100,60\n1200,120\n1300,-30\n";
    let row = ms.replace("knee\n", "knee\nmSec,Degrees\n");
    assert_read_as(read_csv(&row), &["line 2", "times are in ms"]);
    assert_read_as(read_timed(ms, TimeUnit::Milliseconds), &[]);
    // From 30 s on.
    let min = "time,knee\n0.5,0\n0.50166666666667,60\n0.50333333333333,120\n0.505,-30\n";
    let row = min.replace("knee\n", "knee\nmin,deg\n");
    assert_read_as(read_csv(&row), &["line 2", "times are in min"]);
    assert_read_as(read_timed(min, TimeUnit::Minutes), &[]);
    let clock =
        "time,knee\n23:59:59.9,0\n00:00:00.0,60\n2026-01-02T00:00:00.1,120\n00:00:00.2Z,-30\n";
    assert_read_as(read_timed(clock, TimeUnit::Clock), &[]);
    assert_refused(
        read_csv(clock),
        "a.csv, line 2, column \"time\": \"23:59:59.9\" is not a number; if it is a time of day, write \
         time_unit = \"clock\"",
    );
    assert_refused(
        read_timed(CSV, TimeUnit::Clock),
        "a.csv, line 2, column \"time\": \"1.0\" is not a time of day",
    );
}

fn read_timed(text: &str, time_unit: TimeUnit) -> Result<Samples, String> {
    let source = Source {
        time_unit: Some(time_unit),
        ..Source::new(
            std::path::Path::new("a.csv"),
            "time",
            "knee",
            Quantity::Angles(Angles::of(Some(AngleUnit::Deg))),
        )
    };
    read_from(&source, text.as_bytes()).map_err(|error| error.to_string())
}

#[test]
fn a_clock_goes_on_over_every_midnight() {
    let text = "time,knee\n18:00:00,0\n04:00:00,60\n14:00:00,120\n00:00:00,90\n10:00:00,30\n";
    let samples = read_timed(text, TimeUnit::Clock).unwrap();
    let hours: Vec<f64> = samples.time_s.iter().map(|t| t / 3600.0).collect();
    assert_eq!(hours, [0.0, 10.0, 20.0, 30.0, 40.0]);
}

#[test]
fn short_gaps_are_bridged_where_that_is_asked_for() {
    let text = "time,knee\n0,1\n0.1,2\n0.2,\n0.3,NaN\n0.4,5\n0.5,6\n";
    let read = |text: &str, max_gap_s| {
        let source = Source {
            max_gap_s,
            ..Source::new(
                std::path::Path::new("a.csv"),
                "#1",
                "knee",
                Quantity::Angles(Angles::of(Some(AngleUnit::Deg))),
            )
        };
        read_from(&source, text.as_bytes()).map_err(|error| error.to_string())
    };
    let samples = read(text, 0.35).unwrap();
    assert_eq!(samples.time_s, [0.0, 0.1, 0.4, 0.5]);
    assert_eq!(
        samples.read_as,
        ["samples missing and bridged (max_gap_s): 2"]
    );
    assert_refused(
        read(text, 0.25),
        "a.csv, line 4, column \"knee\": no numbers for 0.300 s, at most max_gap_s = 0.25 s",
    );
    for text in [text, "time,knee\n0,1\n1,2\n2,2\n3,3\n4,"] {
        let error = read(text, 0.0).unwrap_err();
        assert!(error.contains("the cell is empty; fill the gap"), "{error}");
    }
    // Nothing is known beyond an end.
    for text in [
        "time,knee\n0,\n1,2\n2,3\n3,4\n4,5",
        "time,knee\n0,1\n1,2\n2,2\n3,3\n4,",
    ] {
        let error = read(text, 9.0).unwrap_err();
        assert!(error.contains("the cell is empty"), "{error}");
    }
}

#[test]
fn a_row_that_repeats_the_one_before_is_left_out() {
    let doubled = format!("{CSV}1.3,-30\n1.3,-30\n");
    let samples = read_csv(&doubled).unwrap();
    assert_eq!(samples.time_s.len(), 4);
    assert_warned(
        Ok(samples),
        "a.csv, line 6: the row repeats the one before it, time and value; left out (2 such rows)",
    );
    let mot = format!("{}1.3\t5\t-30\n", MOT.replace("nRows=4", "nRows=5"));
    assert_warned(read_mot(&mot), "a.mot, line 14: the row repeats");
    assert_refused(
        read_csv(format!("{CSV}1.3,-29\n")),
        "a.csv, line 6, column \"time\": time stands still at 1.3 s",
    );
}
