//! Energy that a hand gets back from symptoms.
//!
//! A play returns over any time, d ticks late, at most
//!
//! ```text
//! E ≤ T₀²/2σ + (½ + d)·σ·h·∫Ω² dt
//! ```
//!
//! where T₀ is its torque as that time begins.

use crepitus_model::Real;
use std::collections::VecDeque;

/// Length of the sliding window for the net energy that a hand gets back at once, s.
const NET_S: f64 = 2.0;

/// The hand's account.
pub(super) struct Energy {
    stiffness: f64,
    delay: usize,
    varies: bool,
    /// The torques on their way, the latest first, N·m.
    late_nm: VecDeque<f64>,
    /// Work of the hand, and that with what sampling may generate, J.
    work_j: f64,
    granted_j: f64,
    /// The highest level of it so far, and the most that it has fallen, J.
    peak_j: f64,
    fallen_j: f64,
    largest_nm: f64,
    /// Ticks of the window of the net energy; its candidates for the highest work.
    window: u64,
    tick: u64,
    highest: VecDeque<(u64, f64)>,
    net_j: f64,
}

impl Energy {
    /// The account of springs of this stiffness, N·m/rad, whose torque is late by these ticks, or
    /// by any number up to them if that varies.
    pub(super) fn new(stiffness: f64, (delay, varies): (usize, bool), step_s: f64) -> Self {
        Self {
            stiffness,
            delay,
            varies,
            late_nm: VecDeque::from(vec![0.0; delay + 1]),
            work_j: 0.0,
            granted_j: 0.0,
            peak_j: 0.0,
            fallen_j: 0.0,
            largest_nm: 0.0,
            window: (NET_S / step_s).round().whole(),
            tick: 0,
            highest: VecDeque::from([(0, 0.0)]),
            net_j: 0.0,
        }
    }

    /// A tick with the travel in it, and the torque at its end.
    pub(super) fn tick(&mut self, travel_rad: f64, torque_nm: f64) {
        let late = self.delay_of(self.tick);
        let acting_nm = self.late_nm.get(late).copied().unwrap_or(0.0);
        self.late_nm.pop_back();
        self.late_nm.push_front(torque_nm);
        self.largest_nm = self.largest_nm.max(torque_nm.abs());
        let ticks = 0.5 + f64::from(u32::try_from(self.delay).unwrap_or(u32::MAX));
        self.work_j += acting_nm * travel_rad;
        self.granted_j += ticks * self.stiffness * travel_rad * travel_rad;
        let level_j = self.work_j + self.granted_j;
        self.peak_j = self.peak_j.max(level_j);
        self.fallen_j = self.fallen_j.max(self.peak_j - level_j);
        self.tick += 1;
        while self.highest.back().is_some_and(|(_, j)| *j <= self.work_j) {
            self.highest.pop_back();
        }
        self.highest.push_back((self.tick, self.work_j));
        while self
            .highest
            .front()
            .is_some_and(|(tick, _)| tick + self.window < self.tick)
        {
            self.highest.pop_front();
        }
        if let Some((_, most_j)) = self.highest.front() {
            self.net_j = self.net_j.max(most_j - self.work_j);
        }
    }

    /// Delay of the torque in a tick, in ticks: of an irregular one as irregular as a hash.
    fn delay_of(&self, tick: u64) -> usize {
        if !self.varies {
            return self.delay;
        }
        let mixed = tick.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 33;
        usize::try_from(mixed).unwrap_or_default() % (self.delay + 1)
    }

    /// Largest returned energy, as a share of the energy of the springs at the largest torque.
    pub(super) fn returned(&self) -> f64 {
        let stored_j = self.largest_nm * self.largest_nm / (2.0 * self.stiffness);
        if stored_j > 0.0 {
            self.fallen_j / stored_j
        } else {
            0.0
        }
    }

    /// Largest net energy returned in any two seconds, J.
    pub(super) fn net_returned_j(&self) -> f64 {
        self.net_j
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sampled_spring_returns_what_it_stores_and_what_sampling_makes() {
        for delay in [0, 2] {
            let mut energy = Energy::new(10.0, (delay, false), 1.0);
            let mut angle = 0.0;
            let mut move_by = |energy: &mut Energy, by: f64, ticks: u32| {
                for _ in 0..ticks {
                    angle += by;
                    energy.tick(by, 10.0 * angle);
                }
            };
            move_by(&mut energy, 1e-3, 100);
            move_by(&mut energy, 0.0, 10);
            assert_eq!(energy.returned(), 0.0);
            move_by(&mut energy, -1e-3, 100);
            // A spring without loss: all of it, but for what is on its way at the ends.
            let edge = if delay == 0 { 1e-9 } else { 2e-3 };
            assert!(
                (energy.returned() - 1.0).abs() < edge,
                "{}",
                energy.returned()
            );
        }
    }

    #[test]
    fn the_net_is_that_of_two_seconds() {
        let mut energy = Energy::new(1.0, (0, false), 1.0);
        energy.tick(0.0, 1.0);
        // A joule a second for three seconds, and then as much put in.
        for _ in 0..3 {
            energy.tick(-1.0, 1.0);
        }
        assert_eq!(energy.net_returned_j(), 2.0);
        energy.tick(3.0, 1.0);
        assert_eq!(energy.net_returned_j(), 2.0);
    }
}
