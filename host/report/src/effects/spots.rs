//! Names beside the signs of a diagram, each on the side where it covers the
//! least.

/// Room for a letter, and height of a line, grid lines.
const LETTER: i32 = 27;
const HEIGHT: i32 = 60;
/// From a sign to its name.
const AWAY: i32 = 34;
/// Half the width of a sign.
const SIGN: i32 = 26;

/// A rectangle in grid lines.
#[derive(Clone, Copy, Debug)]
struct Spot {
    left: i32,
    top: i32,
    width: i32,
    height: i32,
}

impl Spot {
    /// Area shared with another.
    fn shared(&self, other: &Self) -> i64 {
        let along =
            |a: i32, n: i32, b: i32, m: i32| i64::from(((a + n).min(b + m) - a.max(b)).max(0));
        along(self.left, self.width, other.left, other.width)
            * along(self.top, self.height, other.top, other.height)
    }
}

/// A sign with its name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sign<'n> {
    pub(super) at: (i32, i32),
    pub(super) name: &'n str,
    /// An arrow to the left stands beside it.
    pub(super) arrow: bool,
}

/// For each sign the left end of the middle of its name. The frame is left,
/// top, right, bottom.
pub(super) fn place(signs: &[Sign<'_>], frame: (i32, i32, i32, i32)) -> Vec<(i32, i32)> {
    let (left, top, right, bottom) = frame;
    let mut taken: Vec<Spot> = signs
        .iter()
        .map(|sign| {
            let arrow = if sign.arrow { SIGN } else { 0 };
            Spot {
                left: sign.at.0 - SIGN - arrow,
                top: sign.at.1 - SIGN,
                width: 2 * SIGN + arrow,
                height: 2 * SIGN,
            }
        })
        .collect();
    signs
        .iter()
        .map(|sign| {
            let (Sign { name, .. }, (x, y)) = (sign, sign.at);
            let width = name.chars().fold(0, |n, _| n + LETTER);
            let spot = |left, middle| Spot {
                left,
                top: middle - HEIGHT / 2,
                width,
                height: HEIGHT,
            };
            let beside = [x + AWAY, x - AWAY - width];
            let around = [x - width / 2, x + SIGN / 2, x - width - SIGN / 2];
            let rows = [AWAY + HEIGHT / 2, -AWAY - HEIGHT / 2];
            let further = rows.map(|dy| dy * 2);
            let best = beside
                .into_iter()
                .map(|left| spot(left, y))
                .chain(
                    rows.into_iter()
                        .chain(further)
                        .flat_map(|dy| around.map(|left| spot(left, y + dy))),
                )
                .min_by_key(|spot| {
                    let inside = Spot {
                        left,
                        top,
                        width: right - left,
                        height: bottom - top,
                    };
                    let outside =
                        i64::from(spot.width) * i64::from(spot.height) - spot.shared(&inside);
                    10 * outside + taken.iter().map(|t| spot.shared(t)).sum::<i64>()
                })
                .unwrap_or(spot(x + AWAY, y));
            taken.push(best);
            (best.left, best.top + HEIGHT / 2)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_beside_their_signs_and_not_on_each_other() {
        let frame = (0, 0, 2000, 1000);
        let sign = |x, y, name| Sign {
            at: (x, y),
            name,
            arrow: false,
        };
        let alone = place(&[sign(500, 500, "alone")], frame);
        assert_eq!(alone, [(500 + AWAY, 500)]);
        // At the right edge there is no room to the right.
        let edge = place(&[sign(1990, 500, "edge")], frame);
        assert!(edge[0].0 < 1990 - 4 * LETTER);
        let near = [
            sign(500, 500, "first"),
            sign(520, 510, "second"),
            sign(510, 480, "third"),
        ];
        let places = place(&near, frame);
        for (i, a) in places.iter().enumerate() {
            for b in &places[i + 1..] {
                assert!((a.1 - b.1).abs() >= HEIGHT || (a.0 - b.0).abs() >= 5 * LETTER);
            }
        }
    }
}
