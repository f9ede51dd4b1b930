//! Plausibility of angles: units, range, speed, marks, wraps, dropouts and titles.

use super::test_read::{MOT, assert_refused, read_csv, read_mot, read_unit};
use super::{AngleUnit, Angles, Quantity, Samples, Source, read_from};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

/// A gait-like table of 80 Hz, from `1/factor` of degrees.
fn rows(factor: f64) -> Vec<f64> {
    let angle = |i: u32| 30.0 + 25.0 * (TAU * f64::from(i) / 80.0).sin();
    (0..=80).map(|i| angle(i) / factor).collect()
}

fn csv(rows: &[f64]) -> String {
    let lines = rows.iter().enumerate();
    lines.fold("time,knee\n".to_owned(), |mut text, (i, angle)| {
        let _ = writeln!(
            text,
            "{},{angle}",
            f64::from(u32::try_from(i).unwrap()) / 80.0
        );
        text
    })
}

fn opensim(title: &str, in_degrees: &str, rows: &[f64]) -> String {
    let table = csv(rows).replace(',', "\t");
    format!(
        "{title}\nnRows={}\ninDegrees={in_degrees}\nendheader\n{table}",
        rows.len()
    )
}

fn warnings(result: Result<Samples, String>) -> Vec<String> {
    result.unwrap().warnings
}

#[track_caller]
fn assert_one(found: &[String], part: &str) {
    assert!(
        matches!(found, [only] if only.contains(part)),
        "{found:?}: {part}"
    );
}

/// Every pair of header and unit leads somewhere, and what a refusal says to write is accepted.
#[test]
fn the_unit_that_is_named_counts_and_no_advice_leads_in_a_circle() {
    use AngleUnit::{Deg, Rad};
    let degrees = rows(1.0);
    let radians = rows(1_f64.to_degrees());
    for (header, numbers, right, wrong) in [
        ("yes", &degrees, Deg, Rad),
        ("no", &degrees, Deg, Rad),
        ("yes", &radians, Rad, Deg),
        ("no", &radians, Rad, Deg),
    ] {
        let text = opensim("Coordinates", header, numbers);
        let samples = read_unit("a.sto", &text, right).unwrap();
        let largest = samples.angle_rad.iter().copied().fold(0.0, f64::max);
        assert!(
            (largest.to_degrees() - 55.0).abs() < 1e-9,
            "{header} {right}"
        );
        assert_eq!(samples.unit, Some(right));
        let contradicts = (header == "yes") != (right == Deg);
        let found = warnings(Ok(samples));
        assert_eq!(found.len(), usize::from(contradicts), "{found:?}");
        if contradicts {
            assert!(
                found[0].starts_with("a.sto")
                    || found[0].contains("line 3: the header (inDegrees=")
            );
            assert!(found[0].contains(&format!("taken as {right}")), "{found:?}");
        }
        // The other unit is refused with the right one, or taken with a word.
        match read_unit("a.sto", &text, wrong) {
            Err(error) => assert!(
                error.contains(&format!("write unit = \"{right}\"")),
                "{error}"
            ),
            Ok(samples) => assert!(!samples.warnings.is_empty()),
        }
        // Without a unit the header counts, and is doubted where the numbers speak against it.
        let is_right = (header == "yes") == (right == Deg);
        match read_unit("a.sto", &text, None) {
            Ok(samples) => assert_eq!(samples.warnings.is_empty(), is_right, "{header} {right}"),
            Err(error) => {
                assert!(!is_right, "{error}");
                assert!(
                    error.contains(&format!("write unit = \"{right}\"")),
                    "{error}"
                );
            }
        }
    }
    assert_one(
        &warnings(read_unit("a.sto", opensim("x", "yes", &radians), Deg)),
        "no angle is beyond ±0.960 deg; if the file is in radians, write unit = \"rad\"",
    );
    // Small degrees under `inDegrees=no`: a knee at 1351°.
    let small = rows(2.5);
    let found = warnings(read_unit("a.sto", opensim("x", "no", &small), None));
    assert!(
        found[0].contains("if the file is in degrees, write unit = \"deg\""),
        "{found:?}"
    );
    assert_eq!(
        warnings(read_unit("a.sto", opensim("x", "no", &small), Deg)).len(),
        1
    );
}

#[test]
fn a_file_without_a_unit_is_asked_for_one() {
    let text = csv(&rows(1.0));
    assert_refused(
        read_unit("a.csv", &text, None),
        "a.csv, column \"knee\": the file does not say the unit of the angles; write unit = \"deg\"",
    );
    let named = text.replace("knee", "knee_deg");
    let read = |text: &str, unit| {
        let angles = Quantity::Angles(Angles::of(unit));
        let source = Source::new(Path::new("a.csv"), "time", "knee_deg", angles);
        read_from(&source, text.as_bytes()).map_err(|error| error.to_string())
    };
    assert_eq!(read(&named, None).unwrap().unit, Some(AngleUnit::Deg));
    let radians = csv(&rows(1_f64.to_degrees())).replace("knee", "knee_deg");
    assert_one(
        &warnings(read(&radians, Some(AngleUnit::Rad))),
        "the name does not look like the chosen unit",
    );
}

/// A header that comes first still does not beat both the person and the numbers.
#[test]
fn an_overlay_yields_to_the_header_unless_the_numbers_speak_against_it() {
    use AngleUnit::{Deg, Rad};
    let (degrees, radians) = (rows(1.0), rows(1_f64.to_degrees()));
    for (header, numbers, named, taken) in [
        ("yes", &degrees, Rad, Deg),
        ("yes", &radians, Rad, Rad),
        ("no", &degrees, Deg, Deg),
        ("no", &radians, Deg, Rad),
        ("yes", &degrees, Deg, Deg),
    ] {
        let angles = Angles {
            yields_to_header: true,
            ..Angles::of(Some(named))
        };
        let source = Source::new(Path::new("a.sto"), "time", "knee", Quantity::Angles(angles));
        let samples = read_from(&source, opensim("x", header, numbers).as_bytes()).unwrap();
        assert_eq!(samples.unit, Some(taken), "{header} {named}");
        assert_eq!(
            samples.warnings.is_empty(),
            (header == "yes") == (named == Deg)
        );
    }
}

#[test]
fn angles_and_speeds_that_no_joint_has_are_warned_about_with_their_line() {
    let plain = rows(1.0);
    assert_eq!(warnings(read_csv(csv(&plain))), [""; 0]);
    let with = |index: usize, angle: f64| {
        let mut rows = plain.clone();
        rows[index] = angle;
        warnings(read_csv(csv(&rows)))
    };
    let shifted: Vec<f64> = plain.iter().map(|angle| angle + 400.0).collect();
    assert_one(
        &warnings(read_csv(csv(&shifted))),
        "line 22, column \"knee\": the joint would be at 455.0 deg, where -30 to 180 deg is usual (81 samples",
    );
    assert_one(
        &with(40, 0.0),
        "line 42, column \"knee\": the angle drops to exactly 0",
    );
    assert_one(
        &with(0, 0.0),
        "line 3, column \"knee\": the angle changes by 2557 deg/s",
    );
    assert_one(
        &with(40, 999.0),
        "line 42, column \"knee\": 999 looks like a mark of a missing sample",
    );
    let fast = with(40, 100.0);
    assert_one(
        &fast,
        "line 43, column \"knee\": the angle changes by -5757 deg/s",
    );
    assert!(fast[0].contains("(2 such steps"), "{fast:?}");
    let wrapped: Vec<f64> = plain.iter().map(|angle| (angle + 320.0) % 360.0).collect();
    let found = warnings(read_csv(csv(&wrapped)));
    assert!(
        found
            .iter()
            .any(|text| text.contains("it wraps; unwrap the column")),
        "{found:?}"
    );
    assert!(
        !found.iter().any(|text| text.contains("deg/s")),
        "{found:?}"
    );
    // A motion through zero is no dropout, one that rests there neither.
    let through: Vec<f64> = (0..80).map(|i| f64::from(i - 30).abs()).collect();
    assert_eq!(warnings(read_csv(csv(&through))), [""; 0]);
    assert_eq!(warnings(read_csv(csv(&[0.0; 20]))), [""; 0]);
}

/// The check is of the joint's angle, not of the number in the file.
#[test]
fn sign_and_offset_count_in_the_check() {
    let negative: Vec<f64> = rows(1.0).iter().map(|angle| -angle - 5.0).collect();
    let read = |factor, offset_deg| {
        let angles = Angles {
            factor,
            offset_deg,
            ..Angles::of(Some(AngleUnit::Deg))
        };
        let source = Source::new(Path::new("a.csv"), "time", "knee", Quantity::Angles(angles));
        let text = csv(&negative);
        warnings(read_from(&source, text.as_bytes()).map_err(|error| error.to_string()))
    };
    assert_one(
        &read(1.0, 0.0),
        "where the file counts flexion as negative, write sign = -1",
    );
    assert_eq!(read(-1.0, 0.0), [""; 0]);
    assert_eq!(read(1.0, 90.0), [""; 0]);
    assert!(read(-100.0, 0.0).iter().any(|text| text.contains("deg/s")));
}

#[test]
fn titles_of_tables_without_angles_are_refused() {
    for title in [
        "Speeds",
        "Accelerations",
        "Controls",
        "PositionErrors",
        "subject01_walk_pErr",
        "walk_controls",
        "Inverse Dynamics Generalized Forces",
        "Actuation_power",
    ] {
        let text = opensim(title, "yes", &rows(1.0));
        let error = read_mot(&text).unwrap_err();
        assert!(
            error.starts_with("a.mot, line 1: the title of the table is"),
            "{error}"
        );
        // Of a column that is no angle it says nothing.
        let source = Source::new(Path::new("a.mot"), "time", "knee", Quantity::Number);
        read_from(&source, text.as_bytes()).unwrap();
    }
    for title in [
        "Coordinates",
        "Results",
        "normal_speed_walk",
        "C:\\ForceControl\\walk.mot",
        "ModelStates",
        "x",
    ] {
        read_mot(&opensim(title, "yes", &rows(1.0))).unwrap();
    }
    let text = MOT.replace("knee", "knee/speed");
    let angles = Quantity::Angles(Angles::of(Some(AngleUnit::Deg)));
    let source = Source::new(Path::new("a.mot"), "time", "knee/speed", angles);
    let found = warnings(read_from(&source, text.as_bytes()).map_err(|error| error.to_string()));
    assert_one(
        &found,
        "line 9, column \"knee/speed\": the name is not that of an angle",
    );
}
