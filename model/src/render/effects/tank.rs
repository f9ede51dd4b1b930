//! A tank of energy from which torque that is no passive spring's is paid.
//!
//! Every tick takes the hand's work with that torque into account: of the torques
//! that may have been acting, the one that gave the most. The tank refills at a
//! fixed power up to its capacity, and below half of it the output fades in
//! proportion. Hence, over any time t and for any motion,
//!
//! ```text
//! energy returned ≤ capacity + refill·t
//! ```
//!
//! while no tick takes more than is in it; what is overdrawn is paid back before
//! the next output.

use crate::control::energy_observer::MOST_DELAY_TICKS;
use crate::real::Real;

/// A tank of energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tank<F> {
    capacity_j: F,
    refill_j: F,
    /// Share of the output, per joule: reaches 1 at half the capacity.
    share_per_j: F,
    pub(super) level_j: F,
    /// The last output torques, the latest first.
    pub(super) given_nm: [F; MOST_DELAY_TICKS + 1],
    delay_ticks: usize,
    /// Something is missing, or was given that could take from it.
    is_in_use: bool,
}

impl<F: Real> Tank<F> {
    /// A full tank. A torque acts in the tick after the one that returned it, or up
    /// to `delay_ticks` later, at most [`MOST_DELAY_TICKS`]. (Half a tick late is 1.)
    pub fn new(capacity_j: f64, refill_w: f64, step_s: f64, delay_ticks: usize) -> Self {
        Self {
            capacity_j: F::from_f64(capacity_j),
            refill_j: F::from_f64(refill_w * step_s),
            share_per_j: F::from_f64(2.0 / capacity_j),
            level_j: F::from_f64(capacity_j),
            given_nm: [F::ZERO; MOST_DELAY_TICKS + 1],
            delay_ticks: delay_ticks.min(MOST_DELAY_TICKS),
            is_in_use: false,
        }
    }

    /// Accounts for a tick in which the shaft has moved so far. A travel that is NaN or
    /// infinite counts as zero and refills nothing.
    #[inline]
    pub fn account(&mut self, delta_phi_rad: F) {
        if delta_phi_rad.is_finite() {
            let work_j = self.least_work_j(delta_phi_rad);
            self.level_j = (self.level_j + work_j + self.refill_j)
                .at_most(self.capacity_j)
                // Only an implausibly fast shaft overdraws; bounded.
                .at_least(-self.capacity_j);
        }
    }

    /// The share of an output that is paid now.
    #[inline]
    pub fn share(&self) -> F {
        (self.level_j * self.share_per_j)
            .at_most(F::ONE)
            .at_least(F::ZERO)
    }

    /// Notes the torque that is given from now on, N·m.
    #[inline]
    pub fn give(&mut self, torque_nm: F) {
        let [last, before, _] = self.given_nm;
        self.given_nm = [torque_nm, last, before];
    }

    /// Forgets what was given, for disarming.
    pub fn forget(&mut self) {
        self.given_nm = [F::ZERO; MOST_DELAY_TICKS + 1];
    }

    /// Energy in the tank, J.
    pub fn level_j(&self) -> F {
        self.level_j
    }

    /// The share that is paid of what shares the tank; accounts for a tick first,
    /// unless there is nothing to account for.
    #[inline]
    pub fn open(&mut self, delta_phi_rad: F) -> F {
        if self.is_in_use {
            self.account(delta_phi_rad);
            self.share()
        } else {
            F::ONE
        }
    }

    /// Notes what all that shares it is given, N·m.
    #[inline]
    pub fn close(&mut self, torque_nm: F) {
        if self.is_in_use || torque_nm != F::ZERO {
            self.give(torque_nm);
            self.is_in_use =
                self.level_j != self.capacity_j || self.given_nm != [F::ZERO; MOST_DELAY_TICKS + 1];
        }
    }

    /// The least work that the hand has put in by this travel, J: with the
    /// worst for it of the torques that may have been acting.
    fn least_work_j(&self, delta_phi_rad: F) -> F {
        let mut acting = self
            .given_nm
            .iter()
            .take(self.delay_ticks.saturating_add(1));
        let first = acting.next().map_or(F::ZERO, |t| *t * delta_phi_rad);
        acting.fold(first, |least, t| least.at_most(*t * delta_phi_rad))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK_S: f64 = 5e-5;

    /// 0.2 J and 0.04 W; a torque acts in the tick after it or the next.
    fn tank() -> Tank<f64> {
        Tank::new(0.2, 0.04, TICK_S, 1)
    }

    #[test]
    fn what_a_torque_gives_the_hand_is_taken_and_what_the_hand_gives_fills_it() {
        let mut tank = tank();
        tank.give(2.0);
        tank.account(-0.05);
        assert!((tank.level_j() - (0.1 + 0.04 * TICK_S)).abs() < 1e-15);
        assert_eq!(tank.share(), 1.0);
        tank.account(0.02);
        // The one before gave nothing, which is the least.
        assert!((tank.level_j() - (0.1 + 2.0 * 0.04 * TICK_S)).abs() < 1e-15);
        tank.give(2.0);
        tank.account(0.02);
        assert!((tank.level_j() - (0.14 + 3.0 * 0.04 * TICK_S)).abs() < 1e-15);
        for no_travel in [f64::NAN, f64::INFINITY] {
            let before = tank;
            tank.account(no_travel);
            assert_eq!(tank, before);
        }
        tank.account(1e9);
        assert_eq!(tank.level_j(), 0.2);
    }

    #[test]
    fn what_is_overdrawn_is_paid_back_first() {
        let mut tank = tank();
        tank.give(2.0);
        tank.account(-1e9);
        assert_eq!((tank.level_j(), tank.share()), (-0.2, 0.0));
        tank.forget();
        // 0.2 J at 0.04 W, and nothing for 5 s.
        for _ in 0..99_900 {
            tank.account(-1e9);
            assert_eq!(tank.share(), 0.0);
        }
        for _ in 0..200 {
            tank.account(0.0);
        }
        assert!(tank.share() > 0.0);
    }

    #[test]
    fn what_was_forgotten_takes_nothing() {
        let mut tank = tank();
        tank.give(3.0);
        tank.give(3.0);
        tank.forget();
        tank.account(-0.05);
        assert_eq!(tank.level_j(), 0.2);
    }

    #[test]
    fn a_tank_that_lacks_something_is_accounted_for_until_it_is_full() {
        let mut tank = tank();
        assert_eq!(tank.open(-1.0), 1.0);
        tank.close(2.0);
        let low = tank.open(-0.075);
        assert!((low - 0.5).abs() < 1e-4, "{low}");
        // Nothing is given any more.
        for n in 1..5_000 {
            tank.close(0.0);
            let share = tank.open(0.0);
            assert!(
                (share - low - f64::from(n) * 0.4 * TICK_S).abs() < 1e-9,
                "{share}"
            );
        }
        let mut ticks = 5_000;
        while tank.level_j() < 0.2 {
            tank.close(0.0);
            tank.open(0.0);
            ticks += 1;
        }
        // 0.15 J at 0.04 W.
        assert!((74_990..75_010).contains(&ticks), "{ticks}");
        tank.close(0.0);
        let full = tank;
        assert_eq!(tank.open(-1.0), 1.0);
        assert_eq!(tank, full, "it costs nothing");
    }
}
