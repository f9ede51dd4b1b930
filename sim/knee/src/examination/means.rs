//! Means of the angle over 20 ms, and what they say of speed and jerk.
//!
//! An encoder's counts can be differentiated once and no more. Of a mean, a count is as small a part
//! as the counts that pass in its time: its third difference is the jerk of a hand, up to some hertz.

/// Time of a mean, s.
pub(super) const MEAN_S: f64 = 0.02;

/// The last means.
#[derive(Clone, Debug, Default)]
pub(super) struct Means {
    /// The mean at hand; none before the first sample.
    open: Option<Open>,
    /// Oldest first.
    last_rad: [f64; 4],
    /// Means since the last pause.
    count: u32,
}

/// A mean that is not over.
#[derive(Clone, Copy, Debug)]
struct Open {
    end_s: f64,
    /// ∫φ dt since its beginning, rad·s.
    integral: f64,
    /// Time and angle of the last sample, s and rad.
    last: (f64, f64),
}

/// Movement that a mean shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    /// Time at which the mean was over, s.
    pub(super) time_s: f64,
    /// Angle then, rad.
    pub(super) angle_rad: f64,
    /// Speed since the mean before, rad/s; 0 of the first.
    pub(super) speed_rad_s: f64,
    /// Angle, and the square of the jerk that lasted there, rad and rad²/s⁵.
    pub(super) jerk: Option<(f64, f64)>,
}

impl Means {
    /// Forgets what was before a pause.
    pub(super) fn restart(&mut self) {
        self.open = None;
        self.count = 0;
    }

    /// Takes the next sample, less than a mean after the last; returns what a mean says that is over.
    pub(super) fn take(&mut self, time_s: f64, angle_rad: f64) -> Option<Motion> {
        let Some(open) = &mut self.open else {
            self.open = Some(Open {
                end_s: time_s + MEAN_S,
                integral: 0.0,
                last: (time_s, angle_rad),
            });
            return None;
        };
        let (last_s, last_rad) = open.last;
        open.last = (time_s, angle_rad);
        if time_s < open.end_s {
            open.integral += 0.5 * (last_rad + angle_rad) * (time_s - last_s);
            return None;
        }
        let share = (open.end_s - last_s) / (time_s - last_s);
        let end_rad = last_rad + share * (angle_rad - last_rad);
        let ended = open.integral + 0.5 * (last_rad + end_rad) * (open.end_s - last_s);
        open.integral = 0.5 * (end_rad + angle_rad) * (time_s - open.end_s);
        open.end_s += MEAN_S;
        let [_, a, b, c] = self.last_rad;
        let d = ended / MEAN_S;
        self.last_rad = [a, b, c, d];
        self.count = self.count.saturating_add(1);
        let travel_rad = if self.count > 1 { d - c } else { 0.0 };
        Some(Motion {
            time_s,
            angle_rad,
            speed_rad_s: travel_rad / MEAN_S,
            jerk: (self.count > 3).then(|| jerk_of(self.last_rad)),
        })
    }
}

/// Angle and square of the jerk in the middle of four means.
fn jerk_of([a, b, c, d]: [f64; 4]) -> (f64, f64) {
    let jerk = (d - 3.0 * c + 3.0 * b - a) / (MEAN_S * MEAN_S * MEAN_S);
    (0.5 * (b + c), jerk * jerk * MEAN_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_and_jerk_of_a_cubic_are_exact() {
        let mut means = Means::default();
        let (mut speeds, mut jerks) = (0, 0);
        for tick in 0..4_000 {
            let t = f64::from(tick) * 5e-5;
            let Some(motion) = means.take(t, 0.5 * t + 2.0 * t * t * t) else {
                continue;
            };
            if means.count > 1 {
                // Between the middles of two means.
                let at_s = motion.time_s - MEAN_S;
                let expected = 0.5 + 6.0 * at_s * at_s;
                assert!((motion.speed_rad_s - expected).abs() < 1e-3);
                speeds += 1;
            }
            if let Some((angle_rad, squared)) = motion.jerk {
                assert!((squared - 144.0 * MEAN_S).abs() < 1e-2, "{squared}");
                let at_s = motion.time_s - 2.0 * MEAN_S;
                let expected = 0.5 * at_s + 2.0 * at_s * at_s * at_s;
                assert!((angle_rad - expected).abs() < 2e-3);
                jerks += 1;
            }
        }
        assert_eq!((speeds, jerks), (8, 6));
    }

    /// A slow stroke behind counts of 36 µrad, whose jerk is some rad/s³.
    #[test]
    fn counts_are_no_jerk() {
        let mut means = Means::default();
        let count_rad = 3.567e-5;
        let mut most = 0.0_f64;
        for tick in 0..40_000 {
            let angle_rad = 0.4 * f64::from(tick) * 5e-5;
            let counted_rad = libm::floor(angle_rad / count_rad) * count_rad;
            let jerk = means.take(f64::from(tick) * 5e-5, counted_rad);
            if let Some((_, squared)) = jerk.and_then(|motion| motion.jerk) {
                most = most.max(libm::sqrt(squared / MEAN_S));
            }
        }
        assert!(most > 0.0 && most < 1.0, "{most} rad/s³");
    }
}
