//! The hand's books: how much energy rendered torque has given back.
//!
//! A torque that is computed at the end of a tick acts d ticks later, and is
//! held for one tick: with the travel Δφ of each tick, the hand puts in
//! W = Σ T·Δφ. Over any stretch of time it may get back what the spring held
//! at its beginning and what sampling gives away:
//!
//! ```text
//! E ≤ Ts²/2kr + (½ + d)·kr·h·∫Ω² dt
//! ```
//!
//! [`EnergyObserver::share`] is the most that was ever taken of the first
//! term, the second being granted as it accrues: the bound holds while it is
//! at most 1. (∫Ω²dt over a tick is taken as Δφ²/h, which is never more.)

use crate::active::Active;
use crate::real::Real;

/// The longest delay that is observed, ticks.
pub const MOST_DELAY_TICKS: usize = 2;

/// Observes the energy at one joint whose torque acts with a delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyObserver<F> {
    stored_j: F,
    /// (½ + d)·kr, N·m/rad.
    granted: F,
    /// Torques on their way, the next to act last.
    on_the_way_nm: [F; MOST_DELAY_TICKS + 1],
    delay_ticks: usize,
    work_j: F,
    /// Work plus what sampling may have given away so far.
    level_j: F,
    highest_j: F,
    deepest_j: F,
}

impl<F: Real> EnergyObserver<F> {
    /// For a joint with these numbers whose torque acts `delay_ticks` late, at
    /// most [`MOST_DELAY_TICKS`].
    pub fn new(active: &Active<F>, delay_ticks: usize) -> Self {
        let delay_ticks = delay_ticks.min(MOST_DELAY_TICKS);
        let delay = (0..delay_ticks).fold(F::ZERO, |sum, _| sum + F::ONE);
        Self {
            stored_j: F::HALF * active.static_nm * active.static_angle_rad,
            granted: (F::HALF + delay) * active.stiffness,
            on_the_way_nm: [F::ZERO; MOST_DELAY_TICKS + 1],
            delay_ticks,
            work_j: F::ZERO,
            level_j: F::ZERO,
            highest_j: F::ZERO,
            deepest_j: F::ZERO,
        }
    }

    /// The shaft has moved by `delta_phi_rad` in a tick, at whose end the
    /// torque to show became `torque_nm`.
    pub fn tick(&mut self, delta_phi_rad: F, torque_nm: F) {
        let acting = self.on_the_way_nm.get(self.delay_ticks);
        let work = acting.copied().unwrap_or(F::ZERO) * delta_phi_rad;
        self.work_j += work;
        self.level_j += work + self.granted * delta_phi_rad * delta_phi_rad;
        self.highest_j = self.highest_j.at_least(self.level_j);
        self.deepest_j = self.deepest_j.at_least(self.highest_j - self.level_j);
        self.on_the_way_nm.rotate_right(1);
        if let Some(first) = self.on_the_way_nm.first_mut() {
            *first = torque_nm;
        }
    }

    /// The work that the hand has put in so far, J.
    pub fn work_j(&self) -> F {
        self.work_j
    }

    /// The most energy returned over any stretch so far beyond what sampling
    /// gives away, as a share of Ts²/2kr: at most 1 within the bound.
    pub fn share(&self) -> F {
        self.deepest_j / self.stored_j
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Settings;

    fn observer(delay_ticks: usize) -> EnergyObserver<f64> {
        let settings = Settings::default().validate().unwrap();
        EnergyObserver::new(&Active::new(&settings, 5e-5).unwrap(), delay_ticks)
    }

    #[test]
    fn a_torque_acts_after_its_delay_for_one_tick() {
        for delay in 0..=MOST_DELAY_TICKS {
            let mut hand = observer(delay);
            hand.tick(0.0, 3.0);
            for tick in 0..4 {
                assert_eq!(hand.work_j(), if tick <= delay { 0.0 } else { 6.0 });
                hand.tick(2.0, 0.0);
            }
        }
        assert_eq!(observer(9), observer(2));
    }

    #[test]
    fn a_wound_spring_gives_back_what_it_holds_and_sampling_its_grant() {
        // Down the spring from Ts in tiny steps: Ts²/2kr, and half a step's
        // excess each, which is just what is granted.
        for steps in [10, 1000] {
            let mut hand = observer(0);
            let step = 1e-3 / f64::from(steps);
            for i in 0..=steps {
                let torque = 0.4 * f64::from(steps - i) / f64::from(steps);
                hand.tick(if i == 0 { 0.0 } else { -step }, torque);
            }
            assert!((hand.share() - 1.0).abs() < 1e-9, "{}", hand.share());
            let returned = -hand.work_j();
            let excess = 0.5 * 400.0 * step * step * f64::from(steps);
            assert!((returned - 2e-4 - excess).abs() < 1e-12);
        }
    }

    #[test]
    fn it_is_the_worst_stretch_that_counts() {
        let mut hand = observer(0);
        // 10 mJ in, 0.1 mJ back, 10 mJ in.
        for (delta_phi, torque) in [(0.0, 100.0), (1e-4, -1.0), (1e-4, 100.0), (1e-4, 0.0)] {
            hand.tick(delta_phi, torque);
        }
        // Less what sampling may give away, 2 µJ.
        assert!((hand.share() - (1e-4 - 2e-6) / 2e-4).abs() < 1e-12);
    }
}
