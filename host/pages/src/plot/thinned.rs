//! A line of any length in bounded memory that still looks the same.
//!
//! Neighbouring points share a bin that keeps its first, lowest, highest and
//! last point. When the bins run out, neighbours merge and every bin from
//! then on covers twice as many points. With more bins than pixels the drawn
//! line does not differ from the line through all points.

/// A point in the units of the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Coordinate to the right.
    pub x: f64,
    /// Position, upwards.
    pub y: f64,
}

impl Point {
    /// Creates a point from its coordinates.
    pub fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }
}

#[derive(Clone, Copy, Debug)]
struct Bin {
    first: Point,
    low: Point,
    high: Point,
    last: Point,
    count: u64,
}

impl Bin {
    fn of(point: Point) -> Self {
        Self {
            first: point,
            low: point,
            high: point,
            last: point,
            count: 1,
        }
    }

    fn append(&mut self, later: &Self) {
        if later.low.y < self.low.y {
            self.low = later.low;
        }
        if later.high.y > self.high.y {
            self.high = later.high;
        }
        self.last = later.last;
        self.count += later.count;
    }
}

/// See the module.
#[derive(Clone, Debug)]
pub struct Thinned {
    bins: Vec<Bin>,
    capacity: usize,
    per_bin: u64,
}

impl Thinned {
    /// A line with this many bins.
    pub fn new(capacity: usize) -> Self {
        Self {
            bins: Vec::new(),
            // Even, so that bins pair up without a rest.
            capacity: capacity.max(2) / 2 * 2,
            per_bin: 1,
        }
    }

    /// Appends a point; one that is not finite is left out.
    pub fn push(&mut self, x: f64, y: f64) {
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        let bin = Bin::of(Point { x, y });
        match self.bins.last_mut() {
            Some(last) if last.count < self.per_bin => last.append(&bin),
            _ => {
                if self.bins.len() == self.capacity {
                    self.halve();
                }
                self.bins.push(bin);
            }
        }
    }

    fn halve(&mut self) {
        self.bins = self
            .bins
            .chunks(2)
            .filter_map(|pair| {
                let (first, rest) = pair.split_first()?;
                let mut bin = *first;
                for later in rest {
                    bin.append(later);
                }
                Some(bin)
            })
            .collect();
        self.per_bin *= 2;
    }

    /// Returns whether nothing was appended.
    pub fn is_empty(&self) -> bool {
        self.bins.is_empty()
    }

    /// The points of the line, in order: at most four a bin.
    pub fn points(&self) -> Vec<Point> {
        let mut points = Vec::with_capacity(self.bins.len() * 2);
        for bin in &self.bins {
            let (a, b) = if bin.low.x <= bin.high.x {
                (bin.low, bin.high)
            } else {
                (bin.high, bin.low)
            };
            for point in [bin.first, a, b, bin.last] {
                if points.last() != Some(&point) {
                    points.push(point);
                }
            }
        }
        points
    }

    /// Number of stored bins.
    pub fn stored(&self) -> usize {
        self.bins.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_extremes_and_ends_in_bounded_memory() {
        let mut line = Thinned::new(100);
        for i in 0..100_000_u32 {
            let spike = match i {
                12_345 => 9.0,
                77_777 => -9.0,
                _ => (f64::from(i) * 0.01).sin(),
            };
            line.push(f64::from(i), spike);
        }
        assert!(line.stored() <= 100);
        let points = line.points();
        assert!(points.contains(&Point::new(12_345.0, 9.0)));
        assert!(points.contains(&Point::new(77_777.0, -9.0)));
        assert_eq!(points.first().map(|p| p.x), Some(0.0));
        assert_eq!(points.last().map(|p| p.x), Some(99_999.0));
        assert!(points.windows(2).all(|w| w[0].x <= w[1].x));
    }

    #[test]
    fn short_lines_are_kept_point_by_point() {
        let mut line = Thinned::new(100);
        line.push(0.0, 1.0);
        line.push(f64::NAN, 1.0);
        line.push(1.0, f64::INFINITY);
        line.push(1.0, 0.0);
        line.push(1.0, 5.0);
        assert_eq!(
            line.points(),
            [
                Point::new(0.0, 1.0),
                Point::new(1.0, 0.0),
                Point::new(1.0, 5.0)
            ]
        );
    }
}
