//! Numbers for people: a true minus sign, thin spaces between thousands, no
//! digits that mean nothing.

use crate::table::show::superscript;

/// `value` with this many decimals.
pub fn fixed(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = digits.split_once('.').unwrap_or((&digits, ""));
    let mut text = String::new();
    // No minus before a rounded zero.
    if value < 0.0 && digits.bytes().any(|b| (b'1'..=b'9').contains(&b)) {
        text.push('\u{2212}');
    }
    for (i, digit) in whole.chars().enumerate() {
        let left = whole.len() - i;
        if i > 0 && whole.len() > 4 && left.is_multiple_of(3) {
            text.push('\u{202F}');
        }
        text.push(digit);
    }
    if !fraction.is_empty() {
        text.push('.');
        text.push_str(fraction);
    }
    text
}

/// `value` rounded to three significant digits.
pub fn rounded(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor();
    // Between 0 and 12 by the clamp.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let decimals = (2.0 - exponent).clamp(0.0, 12.0) as usize;
    let text = fixed(value, decimals);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A power of ten, from any value nearest to it: 10⁻⁶.
pub fn power(value: f64) -> String {
    let exponent = fixed(value.abs().log10().round(), 0);
    let raised: String = exponent.chars().map(superscript).collect();
    format!("10{raised}")
}

/// `value` with two significant digits and a power of ten: 2.7·10⁻⁷.
pub fn scientific(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = format!("{value:.1e}");
    let (mantissa, exponent) = digits.split_once('e').unwrap_or((&digits, "0"));
    let raised: String = exponent.chars().map(superscript).collect();
    let mantissa = mantissa.replace('-', "\u{2212}");
    match exponent {
        "0" => mantissa,
        _ => format!("{mantissa}·10{raised}"),
    }
}

/// A time, s, in the unit that suits it: 50 µs.
pub fn duration(seconds: f64) -> String {
    // A value just below one of a unit counts as one.
    let size = seconds.abs() * (1.0 + 1e-9);
    let (scale, unit) = match size {
        s if s >= 1.0 => (1.0, "s"),
        s if s >= 1e-3 => (1e3, "ms"),
        s if s >= 1e-6 => (1e6, "µs"),
        _ => (1e9, "ns"),
    };
    format!("{} {unit}", rounded(seconds * scale))
}

/// A count.
pub fn count(value: u64) -> String {
    fixed(value as f64, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(fixed(0.1 + 0.2, 1), "0.3");
        assert_eq!(fixed(-0.04, 1), "0.0");
        assert_eq!(fixed(-12_345.5, 1), "−12\u{202F}345.5");
        assert_eq!(rounded(31.7449), "31.7");
        assert_eq!(rounded(0.200_000_001), "0.2");
        assert_eq!(rounded(123_456.0), "123\u{202F}456");
        assert_eq!(rounded(f64::NAN), "–");
        assert_eq!(count(7), "7");
        assert_eq!(power(1e-15), "10⁻¹⁵");
        assert_eq!(scientific(2.74e-7), "2.7·10⁻⁷");
        assert_eq!(scientific(9.99), "1.0·10¹");
        assert_eq!(scientific(-3.0), "−3.0");
        assert_eq!(duration(5e-5), "50 µs");
        assert_eq!(duration(1e-3), "1 ms");
        assert_eq!(duration(5e-7), "500 ns");
    }
}
