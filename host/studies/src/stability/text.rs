//! Numbers in the catalogue's texts.

use std::fmt;

/// A number with the fewest digits: `0.5`, `1e-12`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain(pub f64);

impl fmt::Display for Plain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let x = self.0;
        if x == 0.0 || (1e-3..1e5).contains(&x.abs()) {
            write!(f, "{x}")
        } else {
            write!(f, "{x:e}")
        }
    }
}

/// A duration in a suitable unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Time(pub f64);

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = self.0;
        let (value, unit) = if s >= 3600.0 {
            (s / 3600.0, "h")
        } else if s >= 1.0 || s == 0.0 {
            (s, "s")
        } else if s >= 1e-3 {
            (s * 1e3, "ms")
        } else {
            (s * 1e6, "µs")
        };
        // Nine decimals drop the rounding of the conversion.
        let rounded = (value * 1e9).round() / 1e9;
        write!(f, "{rounded} {unit}")
    }
}

/// Knots: the time of each, and the value just before and just after it, or one if they are equal.
pub(crate) struct Knots<'a>(pub(crate) &'a [(f64, f64, f64)]);

impl fmt::Display for Knots<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, &(time_s, left, right)) in self.0.iter().enumerate() {
            let comma = if i == 0 { "" } else { "," };
            write!(f, "{comma} {}: {}", Plain(time_s), Plain(left))?;
            if left != right {
                write!(f, "|{}", Plain(right))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_times_are_short() {
        assert_eq!(Plain(0.5).to_string(), "0.5");
        assert_eq!(Plain(1e-12).to_string(), "1e-12");
        assert_eq!(Plain(-1e6).to_string(), "-1e6");
        assert_eq!(Time(5e-5).to_string(), "50 µs");
        assert_eq!(Time(86_400.0).to_string(), "24 h");
        assert_eq!(Time(0.02).to_string(), "20 ms");
    }
}
