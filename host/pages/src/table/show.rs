//! Numbers for people: rounded, a dash where they are not known.

/// Format of a column's numbers for people.
pub type Show = fn(f64) -> String;

/// A number that is not known.
pub const UNKNOWN: &str = "–";

/// A number with this many decimals.
pub fn fixed<const DECIMALS: usize>(x: f64) -> String {
    scaled::<1, DECIMALS>(x)
}

/// Multiplied, for a smaller unit, with this many decimals.
pub fn scaled<const FACTOR: u32, const DECIMALS: usize>(x: f64) -> String {
    if x.is_nan() {
        UNKNOWN.to_owned()
    } else {
        format!("{:.DECIMALS$}", f64::from(FACTOR) * x)
    }
}

/// A torque in N·m as mN·m, with its significant digits.
pub fn milli(nm: f64) -> String {
    match 1e3 * nm {
        x if x.is_nan() => UNKNOWN.to_owned(),
        0.0 => "0".to_owned(),
        x if x < 0.0095 => format!("{x:.0e}"),
        x if x < 10.0 => format!("{x:.2}"),
        x if x < 1000.0 => format!("{x:.1}"),
        x => format!("{x:.0}"),
    }
}

/// A number with two digits and a power of ten: `4.1e-5`.
pub fn scientific(x: f64) -> String {
    if x.is_nan() {
        UNKNOWN.to_owned()
    } else if x == 0.0 {
        "0".to_owned()
    } else {
        format!("{x:.1e}")
    }
}

/// A time in s as µs, without the digits that rounding added: `50 µs`.
pub fn microseconds(s: f64) -> String {
    let text = format!("{:.6}", 1e6 * s);
    format!("{} µs", text.trim_end_matches('0').trim_end_matches('.'))
}

/// A whole number with its sign; zero has none.
pub fn signed(x: f64) -> String {
    if x == 0.0 {
        "0".to_owned()
    } else {
        format!("{x:+.0}")
    }
}

/// A digit or sign of an exponent, raised.
pub const fn superscript(c: char) -> char {
    match c {
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' => '⁰',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        '-' | '\u{2212}' => '⁻',
        c => c,
    }
}
