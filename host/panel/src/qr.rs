//! QR codes of links, for the cameras of phones: as a picture of the page, and as text of a terminal.

use qrcodegen::{QrCode, QrCodeEcc};
use serde_json::{Value, json};
use std::fmt::Write;

/// Light modules around a code, by its standard.
const QUIET: i32 = 4;

/// The code of a link, with its margin.
struct Modules {
    code: QrCode,
    size: i32,
}

impl Modules {
    /// The code of a link; `None` if it is too long for any.
    fn of(link: &str) -> Option<Self> {
        let code = QrCode::encode_text(link, QrCodeEcc::Medium).ok()?;
        let size = code.size() + 2 * QUIET;
        Some(Self { code, size })
    }

    /// Returns whether a module is dark; beyond the code none is.
    fn is_dark(&self, x: i32, y: i32) -> bool {
        self.code.get_module(x - QUIET, y - QUIET)
    }
}

/// Size in modules, and the dark ones as the path of an SVG.
pub(crate) fn picture(link: &str) -> Option<Value> {
    let modules = Modules::of(link)?;
    let mut path = String::new();
    for y in 0..modules.size {
        let mut x = 0;
        while x < modules.size {
            let dark = (x..modules.size).take_while(|x| modules.is_dark(*x, y));
            let run = dark.fold(0, |run, _| run + 1);
            if run > 0 {
                // Writing to a string does not fail.
                let _ = write!(path, "M{x} {y}h{run}v1h-{run}z");
            }
            x += run + 1;
        }
    }
    Some(json!({ "size": modules.size, "path": path }))
}

/// Two rows of modules a line: light ones in the colour of the text, dark ones in that of the ground.
pub(crate) fn text(link: &str) -> Option<String> {
    let modules = Modules::of(link)?;
    let mut text = String::new();
    for y in (0..modules.size).step_by(2) {
        text.extend((0..modules.size).map(|x| {
            // Below the last row of an odd number there is none.
            let is_lower_light = y + 1 < modules.size && !modules.is_dark(x, y + 1);
            match (!modules.is_dark(x, y), is_lower_light) {
                (true, true) => '█',
                (true, false) => '▀',
                (false, true) => '▄',
                (false, false) => ' ',
            }
        }));
        text.push('\n');
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINK: &str = "https://192.168.1.20:43567/student.html#0123456789abcdef0123456789abcdef";

    /// Rows of modules of a text, dark ones true.
    fn rows(text: &str) -> Vec<Vec<bool>> {
        let half = |line: &str, lights: [char; 2]| -> Vec<_> {
            line.chars().map(|c| !lights.contains(&c)).collect()
        };
        let lines = text.lines();
        let rows = lines.flat_map(|line| [half(line, ['█', '▀']), half(line, ['█', '▄'])]);
        rows.collect()
    }

    #[test]
    fn a_code_has_a_margin_and_three_finders() {
        let mut rows = rows(&text(LINK).unwrap());
        let size = rows[0].len();
        // Version 5 of the standard: 37 modules, and four around them.
        assert_eq!(size, 45);
        assert!(rows.pop().unwrap().iter().all(|dark| *dark), "no row of it");
        assert_eq!(rows.len(), size);
        let far = size - 4 - 7;
        for (left, top) in [(4, 4), (far, 4), (4, far)] {
            for y in 0..7_usize {
                for x in 0..7_usize {
                    let ring = x.abs_diff(3).max(y.abs_diff(3));
                    let dark = rows[top + y][left + x];
                    assert_eq!(dark, ring != 2, "{left} {top}: {x} {y}");
                }
            }
        }
        let is_light = |row: &Vec<bool>| row.iter().all(|dark| !dark);
        assert!(rows[..4].iter().chain(&rows[size - 4..]).all(is_light));
    }

    #[test]
    fn picture_and_text_are_the_same_code() {
        let rows = rows(&text(LINK).unwrap());
        let picture = picture(LINK).unwrap();
        assert_eq!(picture["size"], 45);
        let mut drawn = vec![vec![false; 45]; 45];
        for run in picture["path"].as_str().unwrap().split_terminator('z') {
            let numbers: Vec<usize> = run
                .split(|c: char| !c.is_ascii_digit())
                .filter_map(|number| number.parse().ok())
                .collect();
            let [x, y, length, 1, back] = numbers[..] else {
                panic!("{run}");
            };
            assert_eq!(length, back);
            drawn[y][x..x + length].fill(true);
        }
        assert_eq!(drawn, rows[..45]);
    }

    #[test]
    fn a_link_that_no_code_holds_has_none() {
        let long = "x".repeat(4_000);
        assert!(picture(&long).is_none() && text(&long).is_none());
    }
}
