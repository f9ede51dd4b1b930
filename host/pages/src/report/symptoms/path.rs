//! Torque over the knee's angle, stroke by stroke, in bounded memory.
//!
//! Straight parts need only their ends. Where what is left is too much to draw
//! stroke by stroke, the range is kept that the torque covers at each angle, for
//! either direction.

use crate::plot::{Point, simplify};
use crate::report::hysteresis::{Hysteresis, Range};

/// Differences too small to be seen: rad and N·m.
const UNSEEN: (f64, f64) = (2e-3, 5e-3);

/// A movement in one direction: (rad, N·m).
#[derive(Clone, Debug)]
pub(crate) struct Stroke {
    pub(crate) is_flexing: bool,
    pub(crate) points: Vec<Point>,
}

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    strokes: Vec<Stroke>,
    stored: usize,
    is_full: bool,
    /// The next point begins a stroke of its own.
    is_broken: bool,
    is_flexing: bool,
    ranges: Hysteresis,
}

impl Path {
    pub(crate) const CAPACITY: usize = 6000;

    pub(crate) fn new() -> Self {
        Self {
            strokes: Vec::new(),
            stored: 0,
            is_full: false,
            is_broken: true,
            is_flexing: true,
            ranges: Hysteresis::new(),
        }
    }

    /// Rows are missing before the next one.
    pub(crate) fn gap(&mut self) {
        self.is_broken = true;
        self.ranges.gap();
    }

    pub(crate) fn push(&mut self, angle_rad: f64, omega_rad_s: f64, nm: f64) {
        if !(angle_rad.is_finite() && nm.is_finite()) {
            return;
        }
        self.ranges.row(angle_rad, omega_rad_s, nm);
        if self.is_full {
            return;
        }
        // At rest the last direction continues.
        let is_flexing = if omega_rad_s == 0.0 || omega_rad_s.is_nan() {
            self.is_flexing
        } else {
            omega_rad_s > 0.0
        };
        let point = Point::new(angle_rad, nm);
        let last = self.strokes.last().and_then(|stroke| stroke.points.last());
        match last.copied() {
            Some(last) if !self.is_broken => {
                if near(last, point) {
                    return;
                }
                if is_flexing != self.is_flexing {
                    self.begin(is_flexing, last);
                }
                self.append(point);
            }
            _ => self.begin(is_flexing, point),
        }
        self.is_flexing = is_flexing;
        self.is_broken = false;
        if self.stored > Self::CAPACITY {
            self.thin();
        }
    }

    fn begin(&mut self, is_flexing: bool, point: Point) {
        self.strokes.push(Stroke {
            is_flexing,
            points: Vec::new(),
        });
        self.append(point);
    }

    fn append(&mut self, point: Point) {
        if let Some(stroke) = self.strokes.last_mut() {
            stroke.points.push(point);
            self.stored += 1;
        }
    }

    /// Keeps what can be seen; if that is still much, none.
    fn thin(&mut self) {
        self.stored = 0;
        for stroke in &mut self.strokes {
            let units = |p: &Point| (p.x / UNSEEN.0, p.y / UNSEEN.1);
            let path: Vec<_> = stroke.points.iter().map(units).collect();
            let kept = simplify(&path, 1.0);
            stroke.points = kept
                .into_iter()
                .map(|(x, y)| Point::new(UNSEEN.0 * x, UNSEEN.1 * y))
                .collect();
            self.stored += stroke.points.len();
        }
        if self.stored > Self::CAPACITY / 2 {
            self.is_full = true;
            self.strokes = Vec::new();
            self.stored = 0;
        }
    }

    /// The strokes; `None` if there are too many.
    pub(crate) fn strokes(&self) -> Option<&[Stroke]> {
        (!self.is_full).then_some(&*self.strokes)
    }

    /// The ranges of torque over angle, in flexion and in extension: where there are
    /// too many strokes.
    pub(crate) fn ranges(&self) -> [Vec<Range>; 2] {
        self.ranges.ranges(0.0)
    }

    #[cfg(test)]
    pub(crate) fn stored(&self) -> usize {
        self.stored.max(self.strokes.len()) + self.ranges.stored()
    }
}

/// Returns whether two points are one on any chart.
fn near(a: Point, b: Point) -> bool {
    (a.x - b.x).abs() < 0.1 * UNSEEN.0 && (a.y - b.y).abs() < 0.1 * UNSEEN.1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_of_straight_lines_are_kept_however_many() {
        let mut path = Path::new();
        for i in 0..1_000_000_u32 {
            // A triangle of angle, and a torque that turns over within 0.1 rad.
            let turn = f64::from(i % 10_000) / 5000.0;
            let (angle, omega) = if turn < 1.0 {
                (turn, 1.0)
            } else {
                (2.0 - turn, -1.0)
            };
            let back = if omega > 0.0 { angle } else { 1.0 - angle };
            path.push(angle, omega, omega * (10.0 * back - 1.0).min(1.0));
        }
        let strokes = path.strokes().expect("lines");
        assert_eq!(strokes.len(), 200);
        assert!(path.stored() <= Path::CAPACITY + 2002, "{}", path.stored());
        for (n, stroke) in strokes.iter().enumerate() {
            assert_eq!(stroke.is_flexing, n % 2 == 0);
            let end = stroke.points.last().expect("points");
            let expected = if stroke.is_flexing { 1.0 } else { -1.0 };
            assert!((end.y - expected).abs() < UNSEEN.1, "{n}: {end:?}");
        }
    }

    #[test]
    fn noise_without_end_becomes_a_range() {
        let mut path = Path::new();
        let mut random = fastrand::Rng::with_seed(1);
        for i in 0..200_000_u32 {
            let turn = f64::from(i) * 1e-3;
            path.push(turn.sin(), turn.cos(), random.f64());
        }
        assert!(path.strokes().is_none());
        assert!(path.stored() <= 2002);
        let [flexing, extending] = path.ranges();
        assert!(flexing.len() > 30 && extending.len() > 30);
        assert!(flexing.iter().all(|r| r.low < 0.2 && r.high > 0.8));
    }

    #[test]
    fn a_gap_is_no_line() {
        let mut path = Path::new();
        path.push(0.0, 1.0, 0.0);
        path.push(0.1, 1.0, 1.0);
        path.gap();
        path.push(0.9, 1.0, 1.0);
        path.push(0.8, -1.0, 0.5);
        let ends: Vec<_> = path
            .strokes()
            .expect("few")
            .iter()
            .map(|s| s.points.len())
            .collect();
        assert_eq!(ends, [2, 1, 2]);
    }
}
