//! Choice of the beginning of a swing.

use crepitus_plant::swing::STEP_S;

/// Criterion for the beginning of a swing. After the release the cuffs may still ring and the teeth
/// be apart, so the criterion with the smallest residual is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Passing {
    /// Point of the most even velocity.
    Even,
    /// Point of the largest velocity.
    Fastest,
    /// Latest point before the shaft slows down.
    Late,
}

impl Passing {
    pub(crate) const ALL: [Self; 3] = [Self::Even, Self::Fastest, Self::Late];
}

/// Returns the step between a release and the first turning point at which a swing begins, and the
/// velocity there, rad/s, which is at least half of the largest one.
pub(crate) fn passes(
    passing: Passing,
    angles: &[f64],
    released: usize,
    first: usize,
) -> Option<(usize, f64)> {
    /// Window of a velocity estimate, in steps, and the stride from one to the next.
    const BEFORE: usize = 60;
    const AFTER: usize = 120;
    const APART: usize = 10;
    let speed = |at: usize| {
        let (from, to) = (at - APART, at + APART);
        (angles[to] - angles[from]) / ((to - from) as f64 * STEP_S)
    };
    let places =
        || (released.max(BEFORE)..first.min(angles.len().saturating_sub(AFTER))).step_by(5);
    let fastest = places().map(|at| speed(at).abs()).fold(0.0, f64::max);
    let uneven = |at: usize| {
        // What a parabola through both ends and the middle leaves.
        let span = &angles[at - BEFORE..at + AFTER];
        let (a, b, c) = (span[0], span[span.len() / 2], span[span.len() - 1]);
        let half = (span.len() / 2) as f64;
        let squares = span.iter().enumerate().map(|(i, angle)| {
            let x = i as f64 / half - 1.0;
            let parabola = b + 0.5 * (c - a) * x + 0.5 * (a + c - 2.0 * b) * x * x;
            (angle - parabola).powi(2)
        });
        squares.sum::<f64>()
    };
    let mut fast = places().filter(|at| speed(*at).abs() >= 0.5 * fastest);
    let at = match passing {
        Passing::Even => fast.min_by(|a, b| uneven(*a).total_cmp(&uneven(*b))),
        Passing::Fastest => fast.find(|at| speed(*at).abs() >= fastest),
        Passing::Late => fast.next_back(),
    };
    at.map(|at| (at, speed(at)))
}
