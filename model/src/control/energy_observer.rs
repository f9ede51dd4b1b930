//! Energy that rendered torque has returned to the hand, against its bound.
//!
//! A torque that is computed at the end of a tick acts d ticks later, and is
//! held until the next one: with the travel Δφ of each tick, the hand puts in
//! W = Σ T·Δφ. Over any stretch of time that begins with a sample it may get
//! back what the spring held at its beginning and what sampling gives away:
//!
//! ```text
//! E ≤ Ts²/2kr + kr·h·∫(½·n + d)·Ω² dt
//! ```
//!
//! n is the time between two samples in ticks: 1, and N + 1 where N samples in
//! between are missing.
//!
//! [`EnergyObserver::share`] is the most that was ever taken of the first
//! term, the second being granted as it accrues: the bound holds while it is
//! at most 1. (∫Ω²dt over a tick is taken as Δφ²/h, which is never more.)
//!
//! A motor's current loop delays the torque by
//! [`lag_ticks`](crate::control::current_loop::CurrentLoopSettings::lag_ticks) on
//! average, which need not be whole: see [`EnergyObserver::behind_a_lag`].

use crate::joint::StepCoefficients;
use crate::real::Real;

/// The longest delay that is observed, ticks.
pub const MOST_DELAY_TICKS: usize = 2;

/// Observes the energy at one joint whose torque acts with a delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyObserver<F> {
    stored_j: F,
    stiffness: F,
    /// d, ticks.
    lag_ticks: F,
    /// Torques on their way, the next to act last.
    on_the_way_nm: [F; MOST_DELAY_TICKS + 1],
    delay_ticks: usize,
    work_j: F,
    /// Work plus what sampling may have given away until the last sample.
    level_j: F,
    /// Ticks since the last sample.
    unseen_ticks: F,
    /// Work of these ticks, J.
    unseen_work_j: F,
    /// Σ Δφ² of these ticks, rad².
    unseen_squares: F,
    highest_j: F,
    deepest_j: F,
}

impl<F: Real> EnergyObserver<F> {
    /// Observer for a joint with these numbers whose torque acts `delay_ticks` late, at
    /// most [`MOST_DELAY_TICKS`].
    pub fn new(coefficients: &StepCoefficients<F>, delay_ticks: usize) -> Self {
        let delay_ticks = delay_ticks.min(MOST_DELAY_TICKS);
        let lag_ticks = (0..delay_ticks).fold(F::ZERO, |sum, _| sum + F::ONE);
        Self {
            delay_ticks,
            ..Self::behind_a_lag(coefficients, lag_ticks)
        }
    }

    /// Observer for a joint with these numbers whose torque acts `lag_ticks` late on
    /// average; the work of what acts is given to [`Self::acted`].
    pub fn behind_a_lag(coefficients: &StepCoefficients<F>, lag_ticks: F) -> Self {
        Self {
            stored_j: F::HALF * coefficients.static_nm * coefficients.static_angle_rad,
            stiffness: coefficients.stiffness,
            lag_ticks,
            on_the_way_nm: [F::ZERO; MOST_DELAY_TICKS + 1],
            delay_ticks: 0,
            work_j: F::ZERO,
            level_j: F::ZERO,
            unseen_ticks: F::ZERO,
            unseen_work_j: F::ZERO,
            unseen_squares: F::ZERO,
            highest_j: F::ZERO,
            deepest_j: F::ZERO,
        }
    }

    /// The shaft has moved by `delta_phi_rad` in a tick, at whose end it was
    /// sampled and the torque to show became `torque_nm`.
    pub fn tick(&mut self, delta_phi_rad: F, torque_nm: F) {
        self.delayed(delta_phi_rad, torque_nm, true);
    }

    /// [`Self::tick`] without a sample at the end of the tick.
    pub fn tick_unseen(&mut self, delta_phi_rad: F, torque_nm: F) {
        self.delayed(delta_phi_rad, torque_nm, false);
    }

    fn delayed(&mut self, delta_phi_rad: F, torque_nm: F, is_seen: bool) {
        let acting = self.on_the_way_nm.get(self.delay_ticks);
        let work = acting.copied().unwrap_or(F::ZERO) * delta_phi_rad;
        self.acted(delta_phi_rad, work, is_seen);
        self.on_the_way_nm.rotate_right(1);
        if let Some(first) = self.on_the_way_nm.first_mut() {
            *first = torque_nm;
        }
    }

    /// The shaft has moved by `delta_phi_rad` in a tick, in which the hand put
    /// `work_j` in; whether it was sampled at the end of the tick.
    pub fn acted(&mut self, delta_phi_rad: F, work_j: F, is_seen: bool) {
        self.work_j += work_j;
        self.unseen_work_j += work_j;
        self.unseen_squares += delta_phi_rad * delta_phi_rad;
        self.unseen_ticks += F::ONE;
        let granted = (F::HALF * self.unseen_ticks + self.lag_ticks) * self.stiffness;
        let level_j = self.level_j + (self.unseen_work_j + granted * self.unseen_squares);
        self.deepest_j = self.deepest_j.at_least(self.highest_j - level_j);
        if is_seen {
            self.level_j = level_j;
            self.highest_j = self.highest_j.at_least(level_j);
            self.unseen_ticks = F::ZERO;
            self.unseen_work_j = F::ZERO;
            self.unseen_squares = F::ZERO;
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
        EnergyObserver::new(
            &StepCoefficients::new(&settings, 5e-5).unwrap(),
            delay_ticks,
        )
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
    fn a_spring_that_is_sampled_once_in_n_ticks_is_granted_n_times_as_much() {
        // Down the spring in sticks of n ticks, held over each: the excess of a
        // stretch of travel x is ½·kr·x², which is just what is granted.
        for n in [1_u32, 4, 25] {
            let mut hand = observer(0);
            let step = 1e-3 / f64::from(20 * n);
            for held in 0..20 {
                let torque = 0.4 * f64::from(20 - held) / 20.0;
                for tick in 1..=n {
                    hand.acted(-step, -step * torque, tick == n);
                }
            }
            assert!((hand.share() - 1.0).abs() < 1e-9, "{n}: {}", hand.share());
        }
    }

    #[test]
    fn a_lag_is_granted_as_a_delay_is() {
        let settings = Settings::default().validate().unwrap();
        let coefficients = StepCoefficients::new(&settings, 5e-5).unwrap();
        let mut delayed = observer(1);
        let mut lagging = EnergyObserver::<f64>::behind_a_lag(&coefficients, 1.0);
        for (n, torque) in [0.4, 0.3, 0.1, -0.2, -0.1].into_iter().enumerate() {
            let travel = if n.is_multiple_of(2) { -2e-4 } else { -1e-4 };
            let before = delayed.work_j();
            delayed.tick(travel, torque);
            lagging.acted(travel, delayed.work_j() - before, true);
        }
        assert!(delayed.share() > 0.1);
        assert!((delayed.share() - lagging.share()).abs() < 1e-12);
    }

    #[test]
    fn a_tick_without_a_sample_begins_no_stretch() {
        let mut hand = observer(0);
        hand.tick(0.0, 100.0);
        // In and out again before the next sample: not a stretch of its own.
        hand.tick_unseen(1e-4, 100.0);
        hand.tick(-1e-4, 0.0);
        assert_eq!(hand.share(), 0.0);
        assert!(hand.work_j().abs() < 1e-18);
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
