//! The slow course of a torque, such as the weight of a leg that is moved.

use crepitus_model::Real;

/// A trend of this many times what is left without it hides that.
const HIDES: f64 = 5.0;

/// The slow course of a torque: a parabola through it, if that is most of it.
pub(super) struct Trend {
    pub(super) matters: bool,
    /// Number of ticks: from the first to the last the place goes from −1 to 1.
    ticks: f64,
    /// Shares of 1, of the place u, and of u² less its mean.
    shares: [f64; 3],
    mean_square: f64,
}

impl Trend {
    pub(super) fn of(signal: &[f64]) -> Self {
        let count = f64::from_whole(u64::try_from(signal.len()).unwrap_or(0));
        let mut trend = Self {
            matters: false,
            ticks: count,
            shares: [0.0; 3],
            mean_square: 0.0,
        };
        let places = || (0..signal.len()).map(|i| trend.place(i));
        let mean_square = places().map(|u| u * u).sum::<f64>() / count;
        // On places that are symmetrical the three have nothing in common.
        let basis = [|_, _| 1.0, |u, _| u, |u: f64, mean: f64| u * u - mean];
        let shares = basis.map(|b| {
            let of = || places().map(|u| b(u, mean_square));
            let along: f64 = of().zip(signal).map(|(b, nm)| b * nm).sum();
            let size: f64 = of().map(|b| b * b).sum();
            if size > 0.0 { along / size } else { 0.0 }
        });
        (trend.mean_square, trend.shares) = (mean_square, shares);
        trend.matters = true;
        let square = |nm: f64| nm * nm;
        let slow: f64 = (0..signal.len()).map(|i| square(trend.at(i))).sum();
        let quick: f64 = signal
            .iter()
            .enumerate()
            .map(|(i, nm)| square(nm - trend.at(i)))
            .sum();
        trend.matters = slow > square(HIDES) * quick && slow > 0.0;
        trend
    }

    fn place(&self, tick: usize) -> f64 {
        let tick = f64::from_whole(u64::try_from(tick).unwrap_or(0));
        2.0 * tick / (self.ticks - 1.0) - 1.0
    }

    /// Torque that is taken off at a tick, N·m.
    pub(super) fn at(&self, tick: usize) -> f64 {
        if !self.matters {
            return 0.0;
        }
        let u = self.place(tick);
        let [a, b, c] = self.shares;
        a + b * u + c * (u * u - self.mean_square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weight_is_a_trend_and_a_grating_is_none() {
        let ticks = || (0..1000_u32).map(f64::from);
        let grating = |n: f64| 0.2 + 0.2 * (n * 0.1).sin();
        let alone: Vec<f64> = ticks().map(grating).collect();
        let trend = Trend::of(&alone);
        assert!(!trend.matters && trend.at(500) == 0.0);
        let weight = |n: f64| 10.0 - 3e-3 * n + 2e-6 * n * n;
        let both: Vec<f64> = ticks().map(|n| weight(n) + grating(n)).collect();
        let trend = Trend::of(&both);
        assert!(trend.matters);
        for n in [0, 300, 999] {
            let x = f64::from(u32::try_from(n).unwrap());
            assert!((trend.at(n) - weight(x) - 0.2).abs() < 0.02, "{n}");
        }
        assert!(!Trend::of(&[0.0; 10]).matters);
    }
}
