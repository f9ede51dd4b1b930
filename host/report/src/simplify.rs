//! Leaves out the points of a line that one cannot see are missing
//! (Ramer–Douglas–Peucker, without recursion).

/// The points of the line, on the grid of the drawing, that a line through
/// the others would miss by more than `tolerance`.
pub(crate) fn simplify(points: &[(i32, i32)], tolerance: f64) -> Vec<(i32, i32)> {
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

/// Of a point to the stretch between two others.
fn distance(point: (i32, i32), from: (i32, i32), to: (i32, i32)) -> f64 {
    let vector = |a: (i32, i32), b: (i32, i32)| {
        (
            f64::from(b.0) - f64::from(a.0),
            f64::from(b.1) - f64::from(a.1),
        )
    };
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
            (0, 0),
            (10, 0),
            (20, 1),
            (30, 0),
            (30, 0),
            (30, 90),
            (40, 0),
        ];
        assert_eq!(simplify(&points, 1.5), [(0, 0), (30, 0), (30, 90), (40, 0)]);
        assert_eq!(simplify(&[], 1.0), []);
        assert_eq!(simplify(&[(1, 2)], 1.0), [(1, 2)]);
    }
}
