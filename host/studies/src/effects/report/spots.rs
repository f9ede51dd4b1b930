//! Names beside the signs of a diagram, each on the side where it covers the
//! least.

use crepitus_pages::plot::{Drawing, Frame};

/// Height of a line, CSS pixels.
const HEIGHT: f64 = 15.0;
/// Distance from a sign to its name.
const AWAY: f64 = 8.5;
/// Half the width of a sign.
const SIGN: f64 = 6.5;

/// A rectangle in CSS pixels.
#[derive(Clone, Copy, Debug)]
struct Spot {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

impl Spot {
    /// Area shared with another.
    fn shared(&self, other: &Self) -> f64 {
        let along = |a: f64, n: f64, b: f64, m: f64| ((a + n).min(b + m) - a.max(b)).max(0.0);
        along(self.left, self.width, other.left, other.width)
            * along(self.top, self.height, other.top, other.height)
    }
}

/// A sign with its name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sign<'n> {
    pub(super) at: (f64, f64),
    pub(super) name: &'n str,
    /// An arrow to the left stands beside it.
    pub(super) arrow: bool,
}

/// Places of the names: for each sign the left end of the middle of its name.
pub(super) fn place(signs: &[Sign<'_>], frame: Frame) -> Vec<(f64, f64)> {
    let Frame {
        left,
        top,
        right,
        bottom,
    } = frame;
    let mut taken: Vec<Spot> = signs
        .iter()
        .map(|sign| {
            let arrow = if sign.arrow { SIGN } else { 0.0 };
            Spot {
                left: sign.at.0 - SIGN - arrow,
                top: sign.at.1 - SIGN,
                width: 2.0 * SIGN + arrow,
                height: 2.0 * SIGN,
            }
        })
        .collect();
    signs
        .iter()
        .map(|sign| {
            let (Sign { name, .. }, (x, y)) = (sign, sign.at);
            let width = Drawing::label_width(name);
            let spot = |left, middle| Spot {
                left,
                top: middle - HEIGHT / 2.0,
                width,
                height: HEIGHT,
            };
            let beside = [x + AWAY, x - AWAY - width];
            let around = [x - width / 2.0, x + SIGN / 2.0, x - width - SIGN / 2.0];
            let rows = [AWAY + HEIGHT / 2.0, -AWAY - HEIGHT / 2.0];
            let further = rows.map(|dy| dy * 2.0);
            let inside = Spot {
                left,
                top,
                width: right - left,
                height: bottom - top,
            };
            let covered = |spot: &Spot| {
                let outside = spot.width * spot.height - spot.shared(&inside);
                // Whole pixels: rounding must not decide.
                let shared: f64 = taken.iter().map(|t| spot.shared(t)).sum();
                (10.0 * outside + shared).round() + 0.0
            };
            let best = beside
                .into_iter()
                .map(|left| spot(left, y))
                .chain(
                    rows.into_iter()
                        .chain(further)
                        .flat_map(|dy| around.map(|left| spot(left, y + dy))),
                )
                .map(|spot| (covered(&spot), spot))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .map_or(spot(x + AWAY, y), |(_, spot)| spot);
            taken.push(best);
            (best.left, best.top + HEIGHT / 2.0)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_beside_their_signs_and_not_on_each_other() {
        let frame = Frame {
            left: 0.0,
            top: 0.0,
            right: 500.0,
            bottom: 250.0,
        };
        let sign = |x, y, name| Sign {
            at: (x, y),
            name,
            arrow: false,
        };
        let alone = place(&[sign(125.0, 125.0, "alone")], frame);
        assert_eq!(alone, [(125.0 + AWAY, 125.0)]);
        // At the right edge there is no room to the right.
        let edge = place(&[sign(497.0, 125.0, "edge")], frame);
        assert!(edge[0].0 < 497.0 - 26.0);
        let near = [
            sign(125.0, 125.0, "first"),
            sign(130.0, 127.0, "second"),
            sign(127.0, 120.0, "third"),
        ];
        let places = place(&near, frame);
        for (i, a) in places.iter().enumerate() {
            for b in &places[i + 1..] {
                assert!((a.1 - b.1).abs() >= HEIGHT || (a.0 - b.0).abs() >= 32.0);
            }
        }
    }
}
