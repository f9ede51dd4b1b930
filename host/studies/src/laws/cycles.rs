//! Cycles of stick and slip, counted in a torque.
//!
//! Whatever a law is, it grates if its torque loads and falls again and again. A cycle is counted
//! where |T|, on its way up, passes Tk + Δ/4 after having been below Tk − Δ/4, with Δ = Ts − Tk.
//! The torque of our joint rises through both in every stick; its time there is read between two steps
//! along a straight line, so that counting does not depend on how an event falls between them.

use crepitus_model::Parameters;

/// Counts the cycles of one sense.
#[derive(Clone, Copy, Debug)]
struct OneSense {
    is_below: bool,
}

/// Counts cycles of both senses.
#[derive(Clone, Copy, Debug)]
pub struct Cycles {
    low_nm: f64,
    high_nm: f64,
    senses: [OneSense; 2],
    last: (f64, f64),
}

impl Cycles {
    /// A counter for this joint, from time 0 and without torque.
    pub fn of(joint: &Parameters) -> Self {
        let drop_nm = joint.static_torque_nm - joint.kinetic_torque_nm;
        Self {
            low_nm: joint.kinetic_torque_nm - 0.25 * drop_nm,
            high_nm: joint.kinetic_torque_nm + 0.25 * drop_nm,
            senses: [OneSense { is_below: true }; 2],
            last: (0.0, 0.0),
        }
    }

    /// Takes the torque at a time; returns the time at which a cycle was counted since the last
    /// one, s.
    pub fn see(&mut self, time_s: f64, torque_nm: f64) -> Option<f64> {
        let (last_s, last_nm) = self.last;
        self.last = (time_s, torque_nm);
        let mut counted_s = None;
        for (sense, sign) in self.senses.iter_mut().zip([1.0, -1.0]) {
            let (from_nm, to_nm) = (sign * last_nm, sign * torque_nm);
            if to_nm < self.low_nm {
                sense.is_below = true;
            } else if to_nm >= self.high_nm && sense.is_below {
                sense.is_below = false;
                let share = (self.high_nm - from_nm) / (to_nm - from_nm);
                counted_s = Some(last_s + share.clamp(0.0, 1.0) * (time_s - last_s));
            }
        }
        counted_s
    }
}

/// Mean frequency of cycles by their first and last.
#[derive(Clone, Copy, Debug, Default)]
pub struct Frequency {
    count: u32,
    first_s: f64,
    last_s: f64,
}

impl Frequency {
    /// Adds the time of a cycle, s.
    pub fn add(&mut self, time_s: f64) {
        if self.count == 0 {
            self.first_s = time_s;
        }
        self.last_s = time_s;
        self.count += 1;
    }

    /// Number of cycles.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Hz; 0 with fewer than two cycles.
    pub fn hz(&self) -> f64 {
        if self.count < 2 {
            return 0.0;
        }
        f64::from(self.count - 1) / (self.last_s - self.first_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_are_timed_between_their_steps_and_noise_counts_once() {
        let joint = Parameters::default();
        let mut cycles = Cycles::of(&joint);
        let mut frequency = Frequency::default();
        // From 0 to 0.4 N·m in 40 ms, again and again, sampled every 3 ms: high is 0.25.
        for n in 1..1000_u32 {
            let time_s = 3e-3 * f64::from(n);
            if let Some(at_s) = cycles.see(time_s, 10.0 * (time_s % 0.04)) {
                frequency.add(at_s);
            }
        }
        assert_eq!(frequency.count(), 75);
        assert!((frequency.hz() - 25.0).abs() < 1e-9, "{}", frequency.hz());
        let mut cycles = Cycles::of(&joint);
        let torques = [
            0.1, 0.26, 0.24, 0.26, 0.16, 0.3, 0.14, 0.3, -0.3, -0.1, -0.3,
        ];
        let counted = torques.iter().zip(1_u32..);
        let counted = counted.filter_map(|(t, n)| cycles.see(f64::from(n), *t));
        assert_eq!(counted.count(), 4);
    }
}
