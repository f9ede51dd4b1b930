//! Tables in the forms that programs write, and files that are none.

use super::*;

/// Names, rows, and what was assumed.
type Read = (Vec<String>, Vec<Vec<String>>, Vec<String>);

fn read(bytes: &[u8], wanted: &[&str]) -> Result<Read, String> {
    let text = |error: TableError| error.to_string();
    let mut table = Table::open(bytes, Names::Holding(wanted)).map_err(text)?;
    let names = table.names().to_vec();
    let mut rows = Vec::new();
    while table.advance().map_err(text)?.is_some() {
        rows.push((0..names.len()).map(|at| table.value(at)).collect());
    }
    Ok((names, rows, table.assumptions()))
}

/// Checks that a text is the table of `time`, `knee` with the rows 0, 30 and 0.1, 31.5.
#[track_caller]
fn assert_table(bytes: &[u8], assumptions: &[&str]) {
    let (names, rows, found) = read(bytes, &["time", "knee"]).unwrap();
    assert_eq!(names, ["time", "knee"]);
    assert_eq!(rows, [["0", "30"], ["0.1", "31.5"]]);
    assert_eq!(found.len(), assumptions.len(), "{found:?}");
    for (found, expected) in found.iter().zip(assumptions) {
        assert!(found.contains(expected), "{found}: {expected}");
    }
}

const CSV: &str = "time,knee\n0,30\n0.1,31.5\n";

#[test]
fn line_ends_marks_and_padding_say_nothing() {
    for text in [
        CSV.to_owned(),
        CSV.replace('\n', "\r\n"),
        CSV.replace('\n', "\r"),
        CSV.replace('\n', "\n\n"),
        format!("\u{feff}{CSV}"),
        CSV.replace('\n', ",,\n"),
        CSV.replace("time,knee", "time,knee,,"),
        CSV.replace("time", "\"time\"").replace("30", "\"30\""),
    ] {
        assert_table(text.as_bytes(), &[]);
    }
}

/// The first 8,192 bytes are a buffer: with one of the shifts it ends between CR and LF.
#[test]
fn a_cr_lf_that_two_buffers_share_ends_one_line() {
    for shift in 0..6 {
        let names = format!("time,knee{}\r\n", " ".repeat(shift));
        let text = names + &"0,30\r\n".repeat(2_000) + "1\r\n";
        let error = read(text.as_bytes(), &["time", "knee"]).unwrap_err();
        assert!(error.starts_with("line 2002: "), "shift {shift}: {error}");
    }
}

#[test]
fn separators_and_decimal_commas_are_recognised() {
    let german = CSV.replace(',', ";").replace('.', ",");
    let of_tab = CSV.replace(',', "\t");
    assert_table(CSV.replace(',', ";").as_bytes(), &["semicolons"]);
    assert_table(of_tab.as_bytes(), &["tabs"]);
    assert_table(of_tab.replace('.', ",").as_bytes(), &["tabs"]);
    assert_table(german.as_bytes(), &["semicolons"]);
    assert_table(
        format!("sep=;\n{german}").as_bytes(),
        &["line 2", "semicolons"],
    );
    assert_table(CSV.replace(',', "   ").as_bytes(), &["blanks"]);
    let mut table = Table::open(german.as_bytes(), Names::FirstLine).unwrap();
    while table.advance().unwrap().is_some() {
        table.number(0).unwrap();
    }
    assert!(
        table
            .assumptions()
            .contains(&"numbers have decimal commas".to_owned())
    );
}

#[test]
fn lines_around_the_table_are_left_out() {
    let preamble = format!("Device,Knee bench 3\nOperator,\"M. M\n\n{CSV}");
    assert_table(preamble.as_bytes(), &["line 4"]);
    assert_table(format!("# a, b\n# c\n{CSV}").as_bytes(), &["line 3"]);
    assert_table(format!("# {CSV}").as_bytes(), &[]);
    assert_table(
        CSV.replace("0.1", "# 1,2\n%\n0.1").as_bytes(),
        &["lines of comment left out: 2"],
    );
    assert_table(
        format!("{CSV},\n,\n").as_bytes(),
        &["without a value left out: 2"],
    );
    assert_table(
        CSV.replace("knee\n", "knee\ns,[deg]\n").as_bytes(),
        &["line 2 has the units"],
    );
    let table = Table::open(
        "a  b\nmSec  Degrees\n1 2\n".as_bytes(),
        Names::Holding(&["a"]),
    )
    .unwrap();
    assert_eq!(table.unit(0).as_deref(), Some("msec"));
    assert_eq!(table.unit(1).as_deref(), Some("degrees"));
}

#[test]
fn encodings_are_recognised() {
    let wide = |text: &str, mark: bool, little: bool| -> Vec<u8> {
        let mark = mark.then_some(0xfeff_u16);
        let units = mark.into_iter().chain(text.encode_utf16());
        let bytes = |unit: u16| {
            if little {
                unit.to_le_bytes()
            } else {
                unit.to_be_bytes()
            }
        };
        units.flat_map(bytes).collect()
    };
    let long: String = CSV.to_owned() + &"0.1,31.5\n".repeat(20_000);
    for (mark, little, name) in [
        (true, true, "UTF-16LE"),
        (true, false, "UTF-16BE"),
        (false, true, "UTF-16LE"),
        (false, false, "UTF-16BE"),
    ] {
        assert_table(&wide(CSV, mark, little), &[name]);
        let (_, rows, _) = read(&wide(&long, mark, little), &["time"]).unwrap();
        assert_eq!(rows.len(), 20_002);
    }
    let latin = [b"Pr\xfcfer,M\xfcller\n", CSV.as_bytes()].concat();
    assert_table(&latin, &["line 2", "windows-1252"]);
    let (names, ..) = read(b"time,Beugung Knie (\xb0)\n0,1\n", &["time"]).unwrap();
    assert_eq!(names, ["time", "Beugung Knie (°)"]);
}

#[test]
fn opensim_is_read_as_programs_and_spreadsheets_write_it() {
    let mot = format!(
        "Coordinates\nnRows=2\nnColumns=2\ninDegrees=yes\n  endheader \n{}",
        CSV.replace(',', "\t")
    );
    assert_table(mot.as_bytes(), &[]);
    assert_table(mot.replace('\n', "\r").as_bytes(), &[]);
    assert_table(
        mot.replace("time\t", "time\t\t").as_bytes(),
        &["one or more tabs, the rows by tabs"],
    );
    assert_table(
        mot.replace("time\t", "time  ").as_bytes(),
        &["blanks, the rows by tabs"],
    );
    assert_table(mot.replace('\t', "  ").as_bytes(), &[]);
    let saved = mot
        .replace('\t', ",")
        .replace("  endheader ", "\"endheader\",,");
    assert_table(saved.as_bytes(), &["commas"]);
    let table = Table::open(saved.as_bytes(), Names::Holding(&["time"])).unwrap();
    let header = table.header().unwrap();
    assert_eq!(header.title, Some((1, "Coordinates".to_owned())));
    assert_eq!((header.rows, header.columns), (Some((2, 2)), Some((3, 2))));
    assert_eq!(
        header.in_degrees,
        Some((4, "inDegrees=yes".to_owned(), true))
    );
}

#[test]
fn an_open_quote_is_an_error_where_it_opened() {
    for (text, part) in [
        ("time,knee,x\n0,1,\"fine\n1,2,fine\n", "line 2: a quote"),
        (
            "time,knee,x\n0,1,a\n1,2,\"fine\n2,3,\"fine\"\n",
            "line 3: a quote",
        ),
        ("time,knee,x\n0,1,\"a\"b\n", "line 2: text follows"),
    ] {
        let error = read(text.as_bytes(), &["time", "knee"]).unwrap_err();
        assert!(error.starts_with(part), "{error}");
    }
    // A name may span lines, as spreadsheets write it.
    let (names, rows, _) = read(b"time,\"knee\n(deg)\"\n0,1\n", &["time"]).unwrap();
    assert_eq!(names, ["time", "knee (deg)"]);
    assert_eq!(rows.len(), 1);
}

#[test]
fn what_is_no_table_is_said_with_a_way_out() {
    for (bytes, part) in [
        (&b"\x1f\x8b\x08"[..], "gunzip"),
        (
            b"PK\x03\x04....[Content_Types].xml",
            "save the sheet as CSV",
        ),
        (b"PK\x03\x04....a.csv", "zip archive"),
        (b"\xd0\xcf\x11\xe0\xa1", "save the sheet"),
        (
            b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n",
            "git lfs pull",
        ),
        (b"../../.git/annex/objects/a/b/MD5-s1--2", "git annex get"),
        (b"/annex/objects/MD5-s1--2\n", "git annex get"),
        (b"\n<!DOCTYPE html>\n<html>", "web page"),
        (b"<?xml version=\"1.0\"?>\n<OpenSimDocument>", "XML"),
        (b"PathFileType\t4\t(X/Y/Z)\ta.trc\n", "inverse kinematics"),
        (
            b"DataRate=100\nDataType=Quaternion\nversion=3\nendheader\ntime\ta\n",
            "quaternions",
        ),
        (b"DataType=Vec3\nendheader\ntime\ta\n", "vectors"),
        (b"MATLAB 5.0 MAT-file, Platform", "writetable"),
        (b"a,b\n\0\x01\x02,\x03\n", "binary"),
        (b"{\"a\": [1]}", "JSON"),
        (b"", "is empty"),
        (b"\n \n", "is empty"),
        (b"x\nendheader\n", "line 2: nothing follows"),
    ] {
        let error = read(bytes, &["time", "knee"]).unwrap_err();
        assert!(error.contains(part), "{error}: {part}");
    }
}
