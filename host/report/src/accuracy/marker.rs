//! The signs on curves. All are outlines, so that all can be hollow or filled.

use std::fmt::Write as _;

/// See the module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Marker {
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
    pub(crate) const ALL: [Self; 9] = [
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

    /// The path of an SVG element around a point, in grid lines: about nine
    /// CSS pixels wide.
    pub(crate) fn path(self, (x, y): (i32, i32)) -> String {
        let corners: &[(i32, i32)] = match self {
            Self::Circle => {
                return format!("M{} {y}a17 17 0 1 0 34 0a17 17 0 1 0 -34 0z", x - 17);
            }
            Self::Square => &[(-15, -15), (15, -15), (15, 15), (-15, 15)],
            Self::Triangle => &[(0, -21), (20, 14), (-20, 14)],
            Self::TriangleDown => &[(0, 21), (20, -14), (-20, -14)],
            Self::Diamond => &[(0, -22), (22, 0), (0, 22), (-22, 0)],
            Self::Hourglass => &[(-17, -17), (17, -17), (-17, 17), (17, 17)],
            Self::Plus => &[
                (-6, -20),
                (6, -20),
                (6, -6),
                (20, -6),
                (20, 6),
                (6, 6),
                (6, 20),
                (-6, 20),
                (-6, 6),
                (-20, 6),
                (-20, -6),
                (-6, -6),
            ],
            Self::Cross => &[
                (-19, -11),
                (-11, -19),
                (0, -8),
                (11, -19),
                (19, -11),
                (8, 0),
                (19, 11),
                (11, 19),
                (0, 8),
                (-11, 19),
                (-19, 11),
                (-8, 0),
            ],
            Self::Star => &[
                (0, -23),
                (6, -8),
                (22, -7),
                (9, 3),
                (14, 19),
                (0, 10),
                (-14, 19),
                (-9, 3),
                (-22, -7),
                (-6, -8),
            ],
        };
        let mut path = String::new();
        for (i, (dx, dy)) in corners.iter().enumerate() {
            let command = if i == 0 { 'M' } else { 'L' };
            // Writing to a String cannot fail.
            let _ = write!(path, "{command}{} {}", x + dx, y + dy);
        }
        path.push('z');
        path
    }
}
