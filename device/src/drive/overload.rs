//! I²t: overload of gear and motor.
//!
//! ```text
//! s += (i² − Ic²)·h, s ≥ 0        fault at s = (Is² − Ic²)·1 s
//! ```
//!
//! Ic is what they bear for ever, Is the gear's short-time torque at a hand that
//! back-drives it. The motor's winding is warm after ten times as long.

use crepitus_model::Real;
use crepitus_protocol::Fault;

/// Largest current for a second, A: 6.5 N·m at the hand.
const SHORT_A: f64 = 1.37;

/// Coefficients.
#[derive(Clone, Copy, Debug)]
pub struct OverloadPlan {
    /// Square of the current that may flow for ever, A².
    continuous_a2: f32,
    /// Sum that is a fault, A² for a tick.
    most: f32,
}

impl OverloadPlan {
    /// Computes the coefficients from the current that may flow for ever, A, and the length of a tick, s.
    #[expect(clippy::cast_possible_truncation, reason = "rounded to f32, once")]
    pub fn new(continuous_a: f64, tick_s: f64) -> Self {
        let continuous_a2 = continuous_a * continuous_a;
        let most_a2s = SHORT_A * SHORT_A - continuous_a2;
        Self {
            continuous_a2: continuous_a2 as f32,
            most: (most_a2s / tick_s) as f32,
        }
    }
}

/// The sum.
#[derive(Clone, Copy, Debug)]
pub struct Overload {
    plan: OverloadPlan,
    sum: f32,
}

impl Overload {
    /// A cold motor.
    pub fn new(plan: &OverloadPlan) -> Self {
        Self {
            plan: *plan,
            sum: 0.0,
        }
    }

    /// Replaces the coefficients; what was summed stays.
    pub fn change(&mut self, plan: &OverloadPlan) {
        self.plan = *plan;
    }

    /// Runs one tick with the current, A; a missing one counts as none.
    pub fn tick(&mut self, current_a: Option<f32>) -> Option<Fault> {
        let current_a = current_a.filter(|a| a.is_finite()).unwrap_or(0.0);
        let change = current_a * current_a - self.plan.continuous_a2;
        // Not beyond, or a broken sensor would be remembered for long.
        self.sum = (self.sum + change).at_least(0.0).at_most(self.plan.most);
        (self.sum >= self.plan.most).then_some(Fault::Overload)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::control::device_limits::MotorSettings;
    use crepitus_model::parameters::{ParameterSpec, Tabled};

    /// A coarse tick, s: 1 s is 200 of them.
    const TICK_S: f64 = 5e-3;

    fn until(continuous_a: f64, currents_a: impl IntoIterator<Item = f32>) -> Option<u32> {
        let mut overload = Overload::new(&OverloadPlan::new(continuous_a, TICK_S));
        (currents_a.into_iter().zip(1_u32..)).find_map(|(a, tick)| {
            overload.tick(Some(a)).map(|fault| {
                assert_eq!(fault, Fault::Overload);
                tick
            })
        })
    }

    fn constant(a: f32) -> impl Iterator<Item = f32> {
        std::iter::repeat_n(a, 4_000)
    }

    #[test]
    fn the_short_time_torque_lasts_a_second() {
        let ticks = until(0.95, constant(-1.37)).unwrap();
        assert!(ticks.abs_diff(200) < 3, "{ticks}");
        assert_eq!(until(0.95, constant(0.95)), None);
        // 1.2 A: 0.974 A²s / 0.5375 A².
        let ticks = until(0.95, constant(1.2)).unwrap();
        assert!(ticks.abs_diff(362) < 5, "{ticks}");
        // 4.5 N·m, the largest torque: what the table of faults says, in ticks of 50 µs.
        let ticks = 100 * until(0.95, constant(1.345)).unwrap();
        let all = crepitus_protocol::fault::FAULTS;
        let spec = all.iter().find(|spec| spec.fault == Fault::Overload);
        let within = spec.unwrap().within_ticks.unwrap();
        assert!((within - 500..within).contains(&ticks), "{ticks}");
    }

    #[test]
    fn pauses_cool() {
        let pulses = |on: usize| (0..6_000).map(move |n| if n % 200 < on { 1.37 } else { 0.0 });
        // As much above as below: 0.974 against 0.9025.
        assert_eq!(until(0.95, pulses(90)), None);
        assert!(until(0.95, pulses(120)).is_some());
    }

    #[test]
    fn a_wrong_current_is_forgotten_at_once() {
        let mut overload = Overload::new(&OverloadPlan::new(0.95, TICK_S));
        for _ in 0..10_000 {
            let _ = overload.tick(Some(100.0));
        }
        assert!(overload.tick(Some(0.0)).is_none());
        assert!((0..20).all(|_| overload.tick(Some(0.95)).is_none()));
    }

    #[test]
    fn a_current_that_is_no_number_counts_as_none() {
        assert_eq!(until(0.95, constant(f32::NAN)), None);
    }

    /// Checks that the gear bears its short-time torque for a second, whatever the motor bears
    /// for ever by its parameters.
    #[test]
    fn no_parameter_switches_it_off() {
        let named = |spec: &&ParameterSpec| spec.key == "continuous_a";
        let spec = MotorSettings::TABLE.iter().find(named).unwrap();
        for n in 0..=100 {
            let continuous_a = spec.min + (spec.max - spec.min) * f64::from(n) / 100.0;
            let ticks = until(continuous_a, constant(1.37)).unwrap();
            assert!(ticks <= 202, "{continuous_a} A: {ticks}");
        }
    }

    /// A commit does not reset the sum.
    #[test]
    fn a_commit_forgets_nothing() {
        let plan = |continuous_a| OverloadPlan::new(continuous_a, TICK_S);
        let mut overload = Overload::new(&plan(0.95));
        for _ in 0..190 {
            assert_eq!(overload.tick(Some(1.37)), None);
        }
        for continuous_a in [0.01, 0.95] {
            overload.change(&plan(continuous_a));
        }
        let more = (1..100).find(|_| overload.tick(Some(1.37)).is_some());
        assert!(more.is_some_and(|ticks| ticks < 15), "{more:?}");
    }
}
