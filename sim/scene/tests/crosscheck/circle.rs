//! Sine, cosine and arc tangent by their Taylor series.
//!
//! ```text
//! sin y = y − y³/3! + …      cos y = 1 − y²/2! + …
//! atan2(b, a) = y₀ + atan2(b·cos y₀ − a·sin y₀, a·cos y₀ + b·sin y₀)
//! ```
//! An f64 arc tangent y₀ is only the start of the second line, whose last
//! angle is so small that three terms of its series hold 31 digits.

use crate::double_double::Dd;

/// Terms of the series: 1.6⁴⁰/40! is below 10⁻³⁹.
const TERMS: u32 = 40;

/// (sin y, cos y) for |y| ≤ π/2.
fn sin_cos(y: Dd) -> (Dd, Dd) {
    let (mut sin, mut cos, mut term) = (Dd::ZERO, Dd::ONE, Dd::ONE);
    for k in 1..=TERMS {
        term = term * y / Dd::new(f64::from(k));
        let signed = if k % 4 < 2 { term } else { -term };
        if k % 2 == 1 {
            sin += signed;
        } else {
            cos += signed;
        }
    }
    (sin, cos)
}

/// (sin 2πx, cos 2πx), after whole quarter turns are taken away exactly.
pub fn sin_cos_turns(x: Dd) -> (Dd, Dd) {
    let whole = x - Dd::new(x.to_f64().round());
    let quarters = (4.0 * whole.to_f64()).round();
    let rest = whole - Dd::new(quarters / 4.0);
    let (sin, cos) = sin_cos((Dd::PI * rest).scaled(2.0));
    if quarters == 0.0 {
        (sin, cos)
    } else if quarters == 1.0 {
        (cos, -sin)
    } else if quarters == -1.0 {
        (-cos, sin)
    } else {
        (-sin, -cos)
    }
}

/// atan2(b, a) for a ≥ 0, b ≥ 0; 0 where both are 0.
pub fn atan2(b: Dd, a: Dd) -> Dd {
    let start = b.to_f64().atan2(a.to_f64());
    let (sin, cos) = sin_cos(Dd::new(start));
    let (across, along) = (b * cos - a * sin, a * cos + b * sin);
    if along.to_f64() == 0.0 {
        return Dd::new(start);
    }
    let z = across / along;
    Dd::new(start) + z - z * z * z / Dd::new(3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_angles() {
        let near = |x: Dd, y: Dd| (x - y).abs().to_f64() < 2e-31;
        let half = Dd::new(0.5);
        let (sin, cos) = sin_cos_turns(Dd::ONE / Dd::new(12.0));
        assert!(near(sin, half) && near(cos * cos, Dd::new(0.75)));
        let (sin, cos) = sin_cos_turns(Dd::new(1e6 + 0.125));
        assert!(near(sin * sin, half) && near(sin, cos));
        for (turns, expected) in [(0.25, (1.0, 0.0)), (-0.25, (-1.0, 0.0)), (0.5, (0.0, -1.0))] {
            let (sin, cos) = sin_cos_turns(Dd::new(turns));
            assert_eq!((sin.to_f64(), cos.to_f64()), expected);
        }
        assert!(near(atan2(Dd::ONE, Dd::ONE).scaled(4.0), Dd::PI));
        assert!(near(atan2(Dd::ONE, Dd::ZERO).scaled(2.0), Dd::PI));
        assert!(near(atan2(Dd::ONE, Dd::new(3.0).sqrt()) * 6.0, Dd::PI));
        assert_eq!(atan2(Dd::ZERO, Dd::ZERO), Dd::ZERO);
    }
}
