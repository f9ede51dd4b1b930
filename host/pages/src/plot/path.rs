//! Paths of SVG elements.

use std::fmt::Write as _;

/// A path through points, to a tenth of a pixel, relative after the first.
pub(crate) fn path(points: &[(f64, f64)]) -> String {
    let mut path = String::new();
    let mut last = (0, 0);
    for (i, (x, y)) in points.iter().enumerate() {
        // Far less than 2^53, and saturating.
        #[allow(clippy::cast_possible_truncation)]
        let at = ((x * 10.0).round() as i64, (y * 10.0).round() as i64);
        let command = match i {
            0 => "M",
            1 => "l",
            _ => " ",
        };
        path.push_str(command);
        tenths(&mut path, at.0 - last.0);
        path.push(' ');
        tenths(&mut path, at.1 - last.1);
        last = at;
    }
    path
}

fn tenths(out: &mut String, tenths: i64) {
    let sign = if tenths < 0 { "-" } else { "" };
    let (whole, rest) = (tenths.unsigned_abs() / 10, tenths.unsigned_abs() % 10);
    // Writing to a String cannot fail.
    let _ = match (whole, rest) {
        (_, 0) => write!(out, "{sign}{whole}"),
        (0, _) => write!(out, "{sign}.{rest}"),
        _ => write!(out, "{sign}{whole}.{rest}"),
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_relative_and_does_not_drift() {
        let points: Vec<(f64, f64)> = (0..1000).map(|i| (0.333 * f64::from(i), -1.0)).collect();
        let path = path(&points);
        assert!(path.starts_with("M0 -1l.3 0 .4 0 .3 0"), "{path}");
        let sum: f64 = path[6..]
            .split(' ')
            .step_by(2)
            .map(|dx| dx.parse::<f64>().unwrap())
            .sum();
        assert!((sum - 332.7).abs() < 0.06, "{sum}");
    }
}
