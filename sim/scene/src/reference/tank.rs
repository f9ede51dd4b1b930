//! The tank of the symptoms that give energy, as a continuous law.
//!
//! ```text
//! dE/dt = R + σ(E)·p(t)        E(0) = C,  E ≤ C
//! σ(E)  = 2E/C within 0 … 1    p = Ω·Σ T of clonus and of a reflex
//! ```
//!
//! C and R are the device's capacity and refill; what is shown is σ·T. The device's tank takes
//! this once a tick, and of the torques that may have been acting the one that costs most.
//!
//! The law is integrated by the classical Runge-Kutta method in steps of 20 µs, which end where a
//! piece of the motion does: within 1e-6 of C against ten times shorter ones.

use crepitus_model::render::effects::{TANK_J, TANK_REFILL_W};

/// The longest step, s.
pub(super) const STEP_S: f64 = 2e-5;

/// The tank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tank {
    level_j: f64,
}

impl Tank {
    /// A full one.
    pub(super) const FULL: Self = Self { level_j: TANK_J };

    /// σ, the share that is paid.
    pub(super) fn share(self) -> f64 {
        share(self.level_j)
    }

    /// Integrates over a step with p at its start, in its middle and at its end, W.
    pub(super) fn advance(&mut self, step_s: f64, [start_w, middle_w, end_w]: [f64; 3]) {
        let rate = |level_j: f64, power_w: f64| TANK_REFILL_W + share(level_j) * power_w;
        let level_j = self.level_j;
        let first = rate(level_j, start_w);
        let second = rate(level_j + 0.5 * step_s * first, middle_w);
        let third = rate(level_j + 0.5 * step_s * second, middle_w);
        let last = rate(level_j + step_s * third, end_w);
        let mean = (first + 2.0 * (second + third) + last) / 6.0;
        self.level_j = (level_j + step_s * mean).min(TANK_J);
    }
}

fn share(level_j: f64) -> f64 {
    (2.0 * level_j / TANK_J).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tank from which `power_w` has been asked for in steps of `step_s`.
    fn after(power_w: f64, steps: u32, step_s: f64) -> Tank {
        let mut tank = Tank::FULL;
        for _ in 0..steps {
            tank.advance(step_s, [power_w; 3]);
        }
        tank
    }

    #[test]
    fn it_falls_to_half_in_a_line_and_from_there_on_by_an_exponential() {
        // 0.1 J at 1 W less the refill, then towards E = C/2·R/1 W with a rate of 2/C·1 W.
        let line_s = 0.1 / 0.96;
        let tank = after(-1.0, 10_000, 0.05 / 10_000.0);
        assert!((tank.level_j - (0.2 - 0.96 * 0.05)).abs() < 1e-12);
        assert_eq!(tank.share(), 1.0);
        let steps = 40_000;
        let tank = after(-1.0, steps, 0.3 / f64::from(steps));
        let end_j = 0.1 * TANK_REFILL_W;
        let expected_j = end_j + (0.1 - end_j) * f64::exp(-10.0 * (0.3 - line_s));
        assert!((tank.level_j - expected_j).abs() < 1e-8, "{tank:?}");
    }

    #[test]
    fn a_full_one_takes_no_more_and_an_empty_one_refills() {
        assert_eq!(after(3.0, 100, 0.01), Tank::FULL);
        let mut tank = Tank { level_j: 0.0 };
        tank.advance(1.0, [0.0; 3]);
        assert_eq!(tank.level_j, TANK_REFILL_W);
        assert!((tank.share() - 0.4).abs() < 1e-12);
    }
}
