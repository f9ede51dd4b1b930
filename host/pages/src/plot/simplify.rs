//! Leaves out the points of a line that one cannot see are missing
//! (Ramer–Douglas–Peucker, without recursion).

/// The points of the line that a line through
/// the others would miss by more than `tolerance`.
pub fn simplify(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    let Some(end) = points.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[end] = true;
    let mut ranges = vec![(0, end)];
    while let Some((from, to)) = ranges.pop() {
        if let Some(i) = farthest(points, (from, to), tolerance) {
            keep[i] = true;
            ranges.push((from, i));
            ranges.push((i, to));
        }
    }
    points
        .iter()
        .zip(keep)
        .filter_map(|(point, keep)| keep.then_some(*point))
        .collect()
}

/// The point between two others that is farthest from the stretch between them, if that is more than `tolerance`.
// A report's lines pass through here several times: one loop, in squares.
fn farthest(points: &[(f64, f64)], (from, to): (usize, usize), tolerance: f64) -> Option<usize> {
    let (start, end) = (points[from], points[to]);
    let (dx, dy) = (end.0 - start.0, end.1 - start.1);
    let length2 = dx * dx + dy * dy;
    let mut worst = tolerance * tolerance;
    let mut at = None;
    let between = points.get(from + 1..to).unwrap_or_default();
    for (i, point) in (from + 1..).zip(between) {
        let (px, py) = (point.0 - start.0, point.1 - start.1);
        let along = if length2 > 0.0 {
            ((px * dx + py * dy) / length2).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let (x, y) = (px - along * dx, py - along * dy);
        let miss2 = x * x + y * y;
        if miss2 > worst {
            worst = miss2;
            at = Some(i);
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_stay_straight_runs_go() {
        let points = [
            (0.0, 0.0),
            (10.0, 0.0),
            (20.0, 1.0),
            (30.0, 0.0),
            (30.0, 0.0),
            (30.0, 90.0),
            (40.0, 0.0),
        ];
        assert_eq!(
            simplify(&points, 1.5),
            [(0.0, 0.0), (30.0, 0.0), (30.0, 90.0), (40.0, 0.0)]
        );
        assert_eq!(simplify(&[], 1.0), []);
        assert_eq!(simplify(&[(1.0, 2.0)], 1.0), [(1.0, 2.0)]);
    }
}
