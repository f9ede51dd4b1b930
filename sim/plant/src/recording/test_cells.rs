//! Problems of single cells and rows.

use super::test_read::{CSV, MOT, assert_refused, read_csv, read_mot};

#[test]
fn cells_that_are_not_numbers() {
    let place = "a.csv, line 3, column \"knee\": ";
    for (cell, expected) in [
        (
            "abc",
            "\"abc\" is not a number; write a number such as 12.4",
        ),
        (
            "\u{2212}3.5",
            "\"\u{2212}3.5\" is not a number; it has U+2212 (minus sign), write -",
        ),
        (
            "1\u{a0}5",
            "\"1\\u{a0}5\" is not a number; it has U+00A0 (no-break space), write a plain space",
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
            "-9999",
            "-9999 deg is no joint angle, at most ±2000 deg is believed; it looks like a mark",
        ),
        (
            "2000.5",
            "2000.5 deg is no joint angle, at most ±2000 deg is believed",
        ),
    ] {
        let text = CSV.replace("1.1,60", &format!("1.1,{cell}"));
        assert_refused(
            read_csv(text.replace('\n', "\r\n")),
            &format!("{place}{expected}"),
        );
    }
    assert_refused(
        read_mot(&MOT.replace("5\t60", "5\t")),
        "a.mot, line 11, column \"knee\": the cell is empty",
    );
    assert_refused(
        read_mot(&MOT.replace("1.1\t5\t60", "\t5\t60")),
        "a.mot, line 11, column \"time\": the cell is empty",
    );
    assert_refused(
        read_mot(&MOT.replace("120", "12,0")),
        "a.mot, line 12, column \"knee\": \"12,0\" is not a number (use a point",
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
