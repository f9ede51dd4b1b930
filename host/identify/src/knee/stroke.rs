//! Strokes of an examination: motions in one direction, each with the rest that follows.

use super::motion::Motion;
use super::refusal::Refusal;

/// Slowest speed of a motion, rad/s, and smallest angle of a stroke, rad.
const SLOWEST_RAD_S: f64 = 0.05;
const LEAST_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Fewest strokes, and smallest range of all, deg.
const LEAST_STROKES: usize = 6;
const LEAST_RANGE_DEG: f64 = 25.0;

/// A motion in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Time at which it begins, s.
    pub begins_s: f64,
    /// Angle at which it begins, deg.
    pub from_deg: f64,
    /// Angle at which it ends, deg.
    pub to_deg: f64,
    /// Highest speed, deg/s.
    pub peak_deg_s: f64,
}

impl Stroke {
    /// Returns whether the knee was bent.
    pub fn is_flexion(&self) -> bool {
        self.to_deg > self.from_deg
    }
}

/// Returns the strokes, and the sample at which each begins; the block of a stroke ends where the next begins.
pub(crate) fn strokes(motion: &Motion) -> Result<(Vec<Stroke>, Vec<usize>), Refusal> {
    let mut found = Vec::new();
    let mut begins = Vec::new();
    let mut run: Option<(usize, f64)> = None;
    let mut close = |from: usize, to: usize| {
        let (start, end) = (motion.angle_rad[from], motion.angle_rad[to]);
        if (end - start).abs() < LEAST_RAD {
            return;
        }
        let speeds = motion.omega_rad_s[from..=to].iter();
        found.push(Stroke {
            begins_s: motion.time_s[from],
            from_deg: start.to_degrees(),
            to_deg: end.to_degrees(),
            peak_deg_s: speeds
                .fold(0.0, |most, w| f64::max(most, w.abs()))
                .to_degrees(),
        });
        begins.push(from);
    };
    for (i, omega) in motion.omega_rad_s.iter().enumerate() {
        let sense = if omega.abs() < SLOWEST_RAD_S {
            0.0
        } else {
            omega.signum()
        };
        match run {
            Some((from, was)) if sense != was => {
                close(from, i);
                run = (sense != 0.0).then_some((i, sense));
            }
            None if sense != 0.0 => run = Some((i, sense)),
            _ => {}
        }
    }
    if let Some((from, _)) = run {
        close(from, motion.len() - 1);
    }
    let flexions = found.iter().filter(|stroke| stroke.is_flexion()).count();
    if found.len() < LEAST_STROKES || flexions < 2 || found.len() - flexions < 2 {
        return Err(Refusal::FewStrokes {
            strokes: found.len(),
            flexions,
            least: LEAST_STROKES,
        });
    }
    let ends = found
        .iter()
        .flat_map(|stroke| [stroke.from_deg, stroke.to_deg]);
    let (low, high) = ends.fold((f64::MAX, f64::MIN), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    if high - low < LEAST_RANGE_DEG {
        return Err(Refusal::Narrow {
            range_deg: high - low,
            least_deg: LEAST_RANGE_DEG,
        });
    }
    Ok((found, begins))
}

/// Returns the range of samples of each stroke: what precedes the first one belongs to it.
pub(crate) fn blocks(begins: &[usize], len: usize) -> Vec<std::ops::Range<usize>> {
    let starts = std::iter::once(0).chain(begins.iter().skip(1).copied());
    let ends = begins.iter().skip(1).copied().chain([len]);
    starts.zip(ends).map(|(from, to)| from..to).collect()
}
