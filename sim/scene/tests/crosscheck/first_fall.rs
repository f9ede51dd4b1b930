//! The first zero of a series that begins above zero.
//!
//! From the left, interval by interval. With m and r the middle and half the
//! width of [a, b], and B a bound of |p‴| on it,
//!
//! ```text
//! p  ≥ p(m) − |p′(m)|·r − (|p″(m)| + B·r)·r²/2      above 0: no zero in [a, b]
//! |p′ − p′(m)| ≤ (|p″(m)| + B·r)·r                  p′ of one sign: the ends decide
//! |p″ − p″(m)| ≤ B·r                                p″ of one sign: the ends and the least value decide
//! ```
//! and where none of the three speaks, the interval is halved. So a zero is
//! passed over only where the polynomial with its remainder cannot be zero,
//! and one that is found is the only one in its interval. The enclosures are
//! computed in f64 with a margin for its rounding; the values that decide are
//! computed with 31 digits and count as zero within [`Series::doubt`].

use crate::double_double::Dd;
use crate::series::{MOST, Series, number};

/// Rounding of an f64 Horner sum of at most 36 terms, relative to Σ|cₖ|.
const F64_ROUNDING: f64 = 1.5e-14;
/// Rounding of a sum with 31 digits, with a margin for the rounding of coefficients
/// that come from many steps.
const DD_ROUNDING: f64 = 3.2e-27;
/// The smallest interval that is looked at.
const NARROWEST: f64 = 1e-15;

/// First fall of a series above zero, if there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fall {
    /// The series stays above zero up to σ = 1.
    Never,
    /// The series falls through zero.
    At(Root),
    /// The series reaches zero, as far as 31 digits tell, and rises again.
    Touch(Dd),
    /// The least interval could not be decided.
    Unclear(f64),
}

/// A simple zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Place of the zero, σ.
    pub at: Dd,
    /// The derivative by σ there.
    pub slope: f64,
    /// Largest distance of the zero from `at`, in σ: the doubt of the value over
    /// the slope.
    pub half_width: f64,
}

impl Series {
    /// The size below which a value cannot be distinguished from zero.
    pub fn doubt(&self) -> f64 {
        self.error + DD_ROUNDING * self.size()
    }
}

/// f64 values of a polynomial and its derivatives over an interval.
struct Enclosure {
    value: f64,
    slope: f64,
    curvature: f64,
    /// Σ|cₖ|bᵏ and the same of three derivatives.
    sizes: [f64; 4],
}

impl Enclosure {
    fn new(c: &[f64], middle: f64, end: f64) -> Self {
        let (mut value, mut slope, mut curvature) = (0.0, 0.0, 0.0);
        let mut sizes = [0.0; 4];
        for (k, &c) in c.iter().enumerate().rev() {
            let k1 = number(k);
            let (k2, k3) = (k1 * (k1 - 1.0), k1 * (k1 - 1.0) * (k1 - 2.0));
            value = value * middle + c;
            sizes[0] = sizes[0] * end + c.abs();
            if k >= 1 {
                slope = slope * middle + k1 * c;
                sizes[1] = sizes[1] * end + k1 * c.abs();
            }
            if k >= 2 {
                curvature = curvature * middle + k2 * c;
                sizes[2] = sizes[2] * end + k2 * c.abs();
            }
            if k >= 3 {
                sizes[3] = sizes[3] * end + k3 * c.abs();
            }
        }
        Self {
            value,
            slope,
            curvature,
            sizes,
        }
    }
}

/// The first fall of `p` to zero on (0, 1]. At 0 it is taken to be above
/// zero; where it is not, it falls at 0.
pub fn first_fall(p: &Series) -> Fall {
    let mut c = [0.0; MOST];
    for (plain, c) in c.iter_mut().zip(p.coefficients()) {
        *plain = c.to_f64();
    }
    let c = &c[..p.coefficients().len()];
    let doubt = p.doubt();
    if p.value(Dd::ZERO) <= Dd::ZERO {
        return Fall::At(root_at(p, Dd::ZERO, doubt));
    }
    let (mut a, mut width) = (0.0, 1.0);
    while a < 1.0 {
        let b = a + width;
        match look(p, c, doubt, a, b) {
            Look::Free => {
                a = b;
                width = (2.0 * width).min(1.0 - a);
            }
            Look::Found(fall) => return fall,
            Look::Halve if width < NARROWEST => return Fall::Unclear(a),
            Look::Halve => width /= 2.0,
        }
    }
    Fall::Never
}

/// Finding in an interval.
enum Look {
    Free,
    Found(Fall),
    Halve,
}

/// Decides [a, b], at whose left end p is above zero.
fn look(p: &Series, c: &[f64], doubt: f64, a: f64, b: f64) -> Look {
    let r = 0.5 * (b - a);
    let e = Enclosure::new(c, a + r, b);
    let rounding = |n: usize| F64_ROUNDING * e.sizes[n];
    let bend = e.curvature.abs() + rounding(2) + e.sizes[3] * r;
    let drop = (e.slope.abs() + rounding(1)) * r + 0.5 * bend * r * r;
    if e.value - drop - rounding(0) - p.error > 0.0 {
        return Look::Free;
    }
    let falls = |to: f64| {
        let (to, from) = (Dd::new(to), Dd::new(a));
        if p.value(to).to_f64() > doubt {
            Look::Free
        } else {
            Look::Found(Fall::At(polish(p, from, to, doubt)))
        }
    };
    if e.slope.abs() - rounding(1) - bend * r > 0.0 {
        return if e.slope > 0.0 { Look::Free } else { falls(b) };
    }
    if e.curvature.abs() - rounding(2) - e.sizes[3] * r > 0.0 {
        if e.curvature < 0.0 {
            return falls(b);
        }
        if p.slope(Dd::new(a)) >= Dd::ZERO {
            return Look::Free;
        }
        if p.slope(Dd::new(b)) <= Dd::ZERO {
            return falls(b);
        }
        let least = least(p, Dd::new(a), Dd::new(b));
        let value = p.value(least).to_f64();
        return if value > doubt {
            Look::Free
        } else if value < -doubt {
            Look::Found(Fall::At(polish(p, Dd::new(a), least, doubt)))
        } else {
            Look::Found(Fall::Touch(least))
        };
    }
    Look::Halve
}

/// The zero between `low`, where p is above zero, and `high`, where it is not.
fn polish(p: &Series, low: Dd, high: Dd, doubt: f64) -> Root {
    root_at(p, zero(p, low, high), doubt)
}

fn root_at(p: &Series, at: Dd, doubt: f64) -> Root {
    let slope = p.slope(at).to_f64();
    Root {
        at,
        slope,
        half_width: (doubt / slope.abs()).min(1.0),
    }
}

/// Place between `low`, where the slope is negative, and `high` at which the slope is zero.
fn least(p: &Series, low: Dd, high: Dd) -> Dd {
    zero(&p.derivative(-Dd::ONE, 0.0), low, high)
}

/// The zero between `low`, where f is above zero, and `high`, where it is not,
/// by Newton's method that bisects where it would leave the bracket.
fn zero(f: &Series, mut low: Dd, mut high: Dd) -> Dd {
    let mut at = (low + high).scaled(0.5);
    for _ in 0..200 {
        let value = f.value(at);
        if value > Dd::ZERO {
            low = at;
        } else {
            high = at;
        }
        let step = value / f.slope(at);
        let next = at - step;
        let inside = next > low && next < high;
        if inside && step.to_f64().abs() <= 1e-29 || value == Dd::ZERO {
            break;
        }
        at = if inside {
            next
        } else {
            (low + high).scaled(0.5)
        };
        if (high - low).to_f64() <= 1e-30 {
            break;
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(c: &[f64]) -> Series {
        Series::of(&c.iter().map(|&c| Dd::new(c)).collect::<Vec<_>>(), 0.0)
    }

    /// Π (σ − z), times `sign`.
    fn with_zeros(zeros: &[f64], sign: f64) -> Series {
        let mut c = vec![Dd::new(sign)];
        for &z in zeros {
            let mut next = vec![Dd::ZERO; c.len() + 1];
            for (k, &c) in c.iter().enumerate() {
                next[k + 1] += c;
                next[k] = next[k] - c * z;
            }
            c = next;
        }
        Series::of(&c, 0.0)
    }

    #[test]
    fn the_first_of_many_zeros() {
        let mut rng = fastrand::Rng::with_seed(2);
        for _ in 0..5000 {
            let mut zeros: Vec<f64> = (0..rng.usize(1..8)).map(|_| rng.f64() * 1.4).collect();
            if rng.bool() {
                // Two that are hard to tell apart.
                zeros.push(zeros[0] * (1.0 + 1e-9 * rng.f64()));
            }
            zeros.sort_by(f64::total_cmp);
            let sign = if zeros.len().is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
            match (first_fall(&with_zeros(&zeros, sign)), zeros[0] <= 1.0) {
                (Fall::At(root), true) => {
                    let error = (root.at.to_f64() - zeros[0]).abs();
                    assert!(error <= 1e-15 + root.half_width, "{zeros:?} {root:?}");
                }
                (Fall::Touch(at), true) => {
                    assert!(zeros[1] - zeros[0] < 1e-8, "{zeros:?}");
                    assert!((at.to_f64() - zeros[0]).abs() < 1e-8);
                }
                (found, inside) => assert!(!inside && found == Fall::Never, "{zeros:?} {found:?}"),
            }
        }
    }

    #[test]
    fn a_double_zero_is_a_touch_and_a_near_miss_is_none() {
        let at = |found| match found {
            Fall::Touch(at) => at.to_f64(),
            other => panic!("{other:?}"),
        };
        let double = with_zeros(&[0.3, 0.3], 1.0);
        assert!((at(first_fall(&double)) - 0.3).abs() < 1e-14);
        assert_eq!(first_fall(&double.plus(Dd::new(1e-24))), Fall::Never);
        let Fall::At(root) = first_fall(&double.plus(Dd::new(-1e-24))) else {
            panic!("a crossing");
        };
        assert!((root.at.to_f64() - (0.3 - 1e-12)).abs() < 1e-15);
    }

    #[test]
    fn what_begins_at_zero_falls_at_once() {
        assert!(matches!(first_fall(&series(&[0.0, 1.0])), Fall::At(root) if root.at == Dd::ZERO));
        assert_eq!(first_fall(&series(&[1.0])), Fall::Never);
        let Fall::At(root) = first_fall(&series(&[1.0, -1.0])) else {
            panic!("it ends at zero");
        };
        assert!((root.at - Dd::ONE).abs().to_f64() < 1e-29);
    }
}
