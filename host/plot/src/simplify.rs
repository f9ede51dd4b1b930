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
        let worst = (from + 1..to)
            .map(|i| (i, distance(points[i], points[from], points[to])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, miss)) = worst
            && miss > tolerance
        {
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

/// Distance of a point from the stretch between two others.
fn distance(point: (f64, f64), from: (f64, f64), to: (f64, f64)) -> f64 {
    let vector = |a: (f64, f64), b: (f64, f64)| (b.0 - a.0, b.1 - a.1);
    let (dx, dy) = vector(from, to);
    let (px, py) = vector(from, point);
    let length2 = dx * dx + dy * dy;
    let along = if length2 > 0.0 {
        ((px * dx + py * dy) / length2).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (px - along * dx).hypot(py - along * dy)
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
