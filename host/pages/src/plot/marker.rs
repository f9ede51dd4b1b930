//! The signs on curves. All are outlines, so that all can be hollow or filled.

use crate::plot::path::path;

/// See the module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    Cross,
    Plus,
    TriangleDown,
    Hourglass,
    Star,
}

impl Marker {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Circle,
        Self::Square,
        Self::Triangle,
        Self::Diamond,
        Self::Cross,
        Self::Plus,
        Self::TriangleDown,
        Self::Hourglass,
        Self::Star,
    ];

    /// The path of an SVG element around a point: about nine pixels wide.
    pub(crate) fn path(self, (x, y): (f64, f64)) -> String {
        // Tenths of a pixel.
        let corners: &[(i8, i8)] = match self {
            Self::Circle => {
                let left = path(&[(x - 4.3, y)]);
                return left + "a4.3 4.3 0 1 0 8.6 0a4.3 4.3 0 1 0 -8.6 0z";
            }
            Self::Square => &[(-38, -38), (38, -38), (38, 38), (-38, 38)],
            Self::Triangle => &[(0, -53), (50, 35), (-50, 35)],
            Self::TriangleDown => &[(0, 53), (50, -35), (-50, -35)],
            Self::Diamond => &[(0, -55), (55, 0), (0, 55), (-55, 0)],
            Self::Hourglass => &[(-43, -43), (43, -43), (-43, 43), (43, 43)],
            Self::Plus => &[
                (-15, -50),
                (15, -50),
                (15, -15),
                (50, -15),
                (50, 15),
                (15, 15),
                (15, 50),
                (-15, 50),
                (-15, 15),
                (-50, 15),
                (-50, -15),
                (-15, -15),
            ],
            Self::Cross => &[
                (-48, -28),
                (-28, -48),
                (0, -20),
                (28, -48),
                (48, -28),
                (20, 0),
                (48, 28),
                (28, 48),
                (0, 20),
                (-28, 48),
                (-48, 28),
                (-20, 0),
            ],
            Self::Star => &[
                (0, -58),
                (15, -20),
                (55, -18),
                (23, 8),
                (35, 48),
                (0, 25),
                (-35, 48),
                (-23, 8),
                (-55, -18),
                (-15, -20),
            ],
        };
        let at = |(dx, dy): &(i8, i8)| (x + 0.1 * f64::from(*dx), y + 0.1 * f64::from(*dy));
        path(&corners.iter().map(at).collect::<Vec<_>>()) + "z"
    }
}
