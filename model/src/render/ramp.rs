//! A change of parameters while the joint runs: one commit, then a ramp.
//!
//! A commit is atomic: it stands between two ticks, and from then on the
//! numbers move towards the new ones tick by tick. Torques move linearly,
//! stiffness and inertia by a constant factor a tick. The ramp is as long as
//! it takes for no torque to move by more than the slew limit:
//!
//! ```text
//! n = max(|ΔTk|, |ΔTs|, Ts·ln(kr/kr′)) / (slew·h)
//! ```
//!
//! The last term is for a spring that gets softer under a stick, whose torque
//! falls with it; where it gets stiffer, [`Frozen::adjust`] keeps the torque.
//! What the joint does by itself, a break or a new stick, is no change of
//! parameters and is not slowed down.
//!
//! [`Frozen::adjust`]: crate::Frozen::adjust

use crate::joint::{Given, StepCoefficients};
use crate::real::Real;

/// Ramp from one set of coefficients to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp<F> {
    from: Given<F>,
    to: StepCoefficients<F>,
    /// Length, ticks.
    ticks: u32,
    /// Ticks that have passed; all of them at rest.
    passed: u32,
    /// 1/ticks.
    per_tick: F,
    stiffness_per_tick: F,
    inertia_per_tick: F,
    stiffness_factor: F,
    inertia_factor: F,
}

impl<F: Real> Ramp<F> {
    /// No change under way.
    pub fn at(coefficients: StepCoefficients<F>) -> Self {
        Self {
            from: coefficients.given(),
            to: coefficients,
            ticks: 0,
            passed: 0,
            per_tick: F::ZERO,
            stiffness_per_tick: F::ONE,
            inertia_per_tick: F::ONE,
            stiffness_factor: F::ONE,
            inertia_factor: F::ONE,
        }
    }

    /// Ramp from the active coefficients to `to`, with no torque faster than
    /// `slew_nm_per_s` > 0. Computed in f64, so called outside the tick.
    pub fn new(from: StepCoefficients<F>, to: StepCoefficients<F>, slew_nm_per_s: f64) -> Self {
        let ratio = |a: F, b: F| b.to_f64() / a.to_f64();
        let change = |a: F, b: F| libm::fabs(b.to_f64() - a.to_f64());
        let stiffness = ratio(from.stiffness, to.stiffness);
        let softer_nm = from.static_nm.at_least(to.static_nm).to_f64() * -libm::log(stiffness);
        let largest_nm = change(from.kinetic_nm, to.kinetic_nm)
            .at_least(change(from.static_nm, to.static_nm))
            .at_least(softer_nm);
        let ticks = largest_nm / (slew_nm_per_s * from.step_s.to_f64());
        // A tick rounded to f32 must not make a ramp one tick longer.
        let ticks = libm::ceil(ticks * (1.0 - 1e-6)).at_least(1.0);
        let per_tick = 1.0 / ticks;
        Self {
            from: from.given(),
            to,
            ticks: u32::try_from(ticks.whole()).unwrap_or(u32::MAX),
            passed: 0,
            per_tick: F::from_f64(per_tick),
            stiffness_per_tick: F::from_f64(libm::pow(stiffness, per_tick)),
            inertia_per_tick: F::from_f64(libm::pow(ratio(from.inertia, to.inertia), per_tick)),
            stiffness_factor: F::ONE,
            inertia_factor: F::ONE,
        }
    }

    /// Returns whether numbers still move.
    #[inline]
    pub fn is_settling(&self) -> bool {
        self.passed < self.ticks
    }

    /// The numbers of the next tick, if they are not those of the last one.
    /// The last ones are the new numbers to the bit.
    pub fn advance(&mut self) -> Option<StepCoefficients<F>> {
        if !self.is_settling() {
            return None;
        }
        self.passed = self.passed.saturating_add(1);
        if !self.is_settling() {
            return Some(self.to);
        }
        self.stiffness_factor = self.stiffness_factor * self.stiffness_per_tick;
        self.inertia_factor = self.inertia_factor * self.inertia_per_tick;
        Some(self.from.towards(
            &self.to,
            F::from_whole(u64::from(self.passed)) * self.per_tick,
            self.stiffness_factor,
            self.inertia_factor,
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Parameters;
    use crate::joint::Settings;

    const TICK_S: f64 = 5e-5;
    const SLEW_NM_PER_S: f64 = 100.0;

    fn coefficients(parameters: Parameters) -> StepCoefficients<f32> {
        let settings = Settings {
            parameters,
            ..Settings::default()
        };
        StepCoefficients::new(&settings.validate().unwrap(), TICK_S).unwrap()
    }

    #[test]
    fn nothing_moves_at_rest() {
        let mut ramp = Ramp::at(coefficients(Parameters::default()));
        assert!(!ramp.is_settling());
        assert_eq!(ramp.advance(), None);
    }

    #[test]
    fn torques_keep_the_slew_limit_and_end_at_the_new_numbers() {
        let paper = Parameters::default();
        let fine = Parameters {
            inertia_kg_m2: 1e-3,
            stiffness_nm_per_rad: 300.0,
            kinetic_torque_nm: 0.08,
            static_torque_nm: 0.15,
            ..paper
        };
        let heavy = Parameters {
            inertia_kg_m2: 0.03,
            stiffness_nm_per_rad: 500.0,
            kinetic_torque_nm: 0.6,
            static_torque_nm: 1.1,
            ..paper
        };
        for from in [paper, fine, heavy] {
            for to in [paper, fine, heavy] {
                let (from, to) = (coefficients(from), coefficients(to));
                let mut ramp = Ramp::new(from, to, SLEW_NM_PER_S);
                let (mut now, mut ticks) = (from, 0);
                while let Some(next) = ramp.advance() {
                    // 5 mN·m a tick, and the rounding of the numbers themselves.
                    let most = 5.0e-3 + 1e-6;
                    assert!((next.kinetic_nm - now.kinetic_nm).abs() <= most);
                    assert!((next.static_nm - now.static_nm).abs() <= most);
                    let softer = now.static_angle_rad * (now.stiffness - next.stiffness);
                    assert!(softer <= most, "{softer} at tick {ticks}");
                    assert!(next.kinetic_nm <= next.static_nm);
                    assert!(next.restart_nm.abs() <= next.static_nm);
                    (now, ticks) = (next, ticks + 1);
                }
                assert_eq!(now, to);
                assert!(!ramp.is_settling());
            }
        }
    }

    #[test]
    fn a_ramp_is_as_long_as_its_largest_change() {
        let base = Parameters::default();
        let ticks = |parameters| {
            let mut ramp = Ramp::new(coefficients(base), coefficients(parameters), SLEW_NM_PER_S);
            let mut ticks = 0;
            while ramp.advance().is_some() {
                ticks += 1;
            }
            ticks
        };
        // 0.6 N·m at 5 mN·m a tick.
        let strong = Parameters {
            static_torque_nm: 1.0,
            ..base
        };
        assert_eq!(ticks(strong), 120);
        let kinetic = Parameters {
            kinetic_torque_nm: 0.1,
            ..base
        };
        assert_eq!(ticks(kinetic), 20);
        // 0.4·ln(40) N·m at 5 mN·m a tick.
        let soft = Parameters {
            stiffness_nm_per_rad: 10.0,
            ..base
        };
        assert_eq!(ticks(soft), 296);
        let heavy = Parameters {
            inertia_kg_m2: 0.02,
            ..base
        };
        assert_eq!(ticks(heavy), 1);
        let stiff = Parameters {
            stiffness_nm_per_rad: 16e3,
            ..base
        };
        assert_eq!(ticks(stiff), 1);
    }

    #[test]
    fn half_way_is_half_way() {
        let to = Parameters {
            stiffness_nm_per_rad: 100.0,
            inertia_kg_m2: 0.04,
            kinetic_torque_nm: 0.3,
            ..Parameters::default()
        };
        let mut ramp = Ramp::new(
            coefficients(Parameters::default()),
            coefficients(to),
            SLEW_NM_PER_S,
        );
        // 0.4·ln 4/5e-3 = 110.9 ticks.
        let mut half = None;
        for _ in 0..56 {
            half = ramp.advance();
        }
        let half = half.unwrap();
        assert!((half.kinetic_nm - 0.250_450).abs() < 1e-5);
        assert!((half.stiffness - 198.755).abs() < 0.01);
        assert!((half.inertia - 0.020_125).abs() < 1e-6);
        assert_eq!(half.static_nm, 0.4);
    }
}
