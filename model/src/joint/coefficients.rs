//! Coefficients of a step, computed from [`Settings`] outside the tick.

use crate::joint::LONGEST_STEP_S;
use crate::joint::divisor::{Divisor, Exact, Reciprocal};
use crate::joint::oscillator::Oscillator;
use crate::joint::ticks::Ticks;
use crate::joint::{Restart, Settings, SettingsError, Validated};
use crate::real::Real;

/// Coefficients of settings for one step length.
///
/// Everything is computed in f64 and rounded once, so an f32 joint starts
/// from the nearest values and its period does not drift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepCoefficients<F> {
    /// Step length h, s.
    pub step_s: F,
    /// 1/h, 1/s.
    pub per_step: F,
    /// kr, N·m/rad.
    pub stiffness: F,
    /// J, kg·m².
    pub inertia: F,
    /// c, N·m·s/rad.
    pub damping: F,
    /// Tk, N·m.
    pub kinetic_nm: F,
    /// Ts, N·m.
    pub static_nm: F,
    /// Torque with which a frozen stick begins: 2Tk − Ts, or Tk, N·m.
    pub restart_nm: F,
    /// Tk/kr, rad: the angle about which the object swings in a slip.
    pub kinetic_angle_rad: F,
    /// Ts/kr, rad: the angle at which a stick breaks.
    pub static_angle_rad: F,
    /// Angle at which a frozen slip ends, rad.
    pub restart_angle_rad: F,
    /// Ts − Tk, N·m.
    pub drop_nm: F,
    /// √(J·kr), N·m·s/rad.
    pub impedance: F,
    /// 2/(ωn·h): ticks per half radian, doubled as eq. (10) needs it.
    pub ticks_per_half_radian: F,
    /// 2π/(ωn·h): one free period of the object.
    pub period: Ticks<F>,
    /// Free motion of the object in a slip.
    pub oscillator: Oscillator<F>,
}

/// The numbers that all others of an [`StepCoefficients`] follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Given<F> {
    step_s: F,
    stiffness: F,
    inertia: F,
    damping: F,
    kinetic_nm: F,
    static_nm: F,
    restart_nm: F,
}

impl<F: Real> Given<F> {
    /// The numbers on the way from these to `next`: friction torques and
    /// damping move linearly, stiffness and inertia by the factors given.
    ///
    /// Both ends valid, every point between is: Tk ≤ Ts and |2Tk − Ts| ≤ Ts
    /// hold along a line. In F, so cheap enough for a tick.
    pub(crate) fn towards(
        &self,
        next: &StepCoefficients<F>,
        fraction: F,
        stiffness_factor: F,
        inertia_factor: F,
    ) -> StepCoefficients<F> {
        let between = |a: F, b: F| a + (b - a) * fraction;
        let static_nm = between(self.static_nm, next.static_nm);
        Self {
            step_s: self.step_s,
            stiffness: self.stiffness * stiffness_factor,
            inertia: self.inertia * inertia_factor,
            damping: between(self.damping, next.damping),
            // Rounding must not lift it above.
            kinetic_nm: between(self.kinetic_nm, next.kinetic_nm).at_most(static_nm),
            static_nm,
            restart_nm: between(self.restart_nm, next.restart_nm),
        }
        .coefficients::<Reciprocal<F>>(next.per_step)
    }

    fn coefficients<D: Divisor<F>>(self, per_step: F) -> StepCoefficients<F> {
        let Self {
            step_s,
            stiffness,
            inertia,
            damping,
            kinetic_nm,
            static_nm,
            restart_nm,
        } = self;
        let oscillator = Oscillator::new::<D>(stiffness, inertia, damping);
        let per_stiffness = D::new(stiffness);
        let per_radians = D::new(oscillator.omega_n() * step_s);
        StepCoefficients {
            step_s,
            per_step,
            stiffness,
            inertia,
            damping,
            kinetic_nm,
            static_nm,
            restart_nm,
            kinetic_angle_rad: per_stiffness.of(kinetic_nm),
            static_angle_rad: per_stiffness.of(static_nm),
            restart_angle_rad: per_stiffness.of(restart_nm),
            drop_nm: static_nm - kinetic_nm,
            impedance: if D::IS_EXACT {
                (inertia * stiffness).sqrt()
            } else {
                inertia * oscillator.omega_n()
            },
            ticks_per_half_radian: per_radians.of(F::TWO),
            period: Ticks::new(per_radians.of(F::from_f64(core::f64::consts::TAU))),
            oscillator,
        }
    }
}

impl<F: Real> StepCoefficients<F> {
    /// The numbers for a step of `step_s`.
    ///
    /// # Errors
    /// [`SettingsError::Step`] if the step is not positive, or above
    /// [`LONGEST_STEP_S`].
    pub fn new(settings: &Validated<Settings>, step_s: f64) -> Result<Self, SettingsError> {
        if !(step_s > 0.0 && step_s <= LONGEST_STEP_S) {
            return Err(SettingsError::Step { step_s });
        }
        let p = &settings.parameters;
        let exact = Given {
            step_s,
            stiffness: p.stiffness_nm_per_rad,
            inertia: p.inertia_kg_m2,
            damping: p.damping_nms_per_rad,
            kinetic_nm: p.kinetic_torque_nm,
            static_nm: p.static_torque_nm,
            restart_nm: match settings.restart {
                Restart::Elastic => p.restart_torque_nm(),
                Restart::FromKinetic => p.kinetic_torque_nm,
            },
        }
        .coefficients::<Exact<f64>>(1.0 / step_s);
        let f = F::from_f64;
        Ok(Self {
            step_s: f(exact.step_s),
            per_step: f(exact.per_step),
            stiffness: f(exact.stiffness),
            inertia: f(exact.inertia),
            damping: f(exact.damping),
            kinetic_nm: f(exact.kinetic_nm),
            static_nm: f(exact.static_nm),
            restart_nm: f(exact.restart_nm),
            kinetic_angle_rad: f(exact.kinetic_angle_rad),
            static_angle_rad: f(exact.static_angle_rad),
            restart_angle_rad: f(exact.restart_angle_rad),
            drop_nm: f(exact.drop_nm),
            impedance: f(exact.impedance),
            ticks_per_half_radian: f(exact.ticks_per_half_radian),
            period: Ticks::from_f64(exact.period.value()),
            oscillator: Oscillator::of(p),
        })
    }

    /// The numbers that all others follow from.
    pub(crate) fn given(&self) -> Given<F> {
        Given {
            step_s: self.step_s,
            stiffness: self.stiffness,
            inertia: self.inertia,
            damping: self.damping,
            kinetic_nm: self.kinetic_nm,
            static_nm: self.static_nm,
            restart_nm: self.restart_nm,
        }
    }

    /// Duration of a frozen slip that begins while the shaft moves with
    /// `relative_rad_s` = s·Ω(t₀), eqs. (10)–(11):
    /// ωn·t = 2(π − atan2(Ts − Tk, max(0, s·Ω(t₀))·√(J·kr))).
    pub fn slip_time(&self, relative_rad_s: F) -> Ticks<F> {
        let lag = self
            .drop_nm
            .atan2(F::ZERO.at_least(relative_rad_s) * self.impedance);
        self.period
            .less(Ticks::new(lag * self.ticks_per_half_radian))
    }

    /// Ts = Tk, as far as numbers tell: at a steady speed nothing ever sticks,
    /// the velocities only touch once a period.
    #[inline]
    pub fn touches(&self) -> bool {
        self.drop_nm <= F::LIMIT_SLACK * self.static_nm
    }

    /// Tolerance beyond the limit within which a torque counts as at it, N·m.
    ///
    /// Velocities are rounded by a share ε of Ω. They meet with the relative
    /// acceleration (Ts − Tk)/J, so the match is known to ε·Ω·J/(Ts − Tk), in
    /// which the spring moves by ε·(√(J·kr)·Ω)²/(Ts − Tk); where they only
    /// touch, the slack of a touch is the larger one and enough.
    #[inline]
    pub fn limit_slack_nm(&self, omega_rad_s: F) -> F {
        let swing_nm = self.impedance * omega_rad_s;
        let slack_nm = F::LIMIT_SLACK * (self.static_nm + swing_nm * swing_nm / self.drop_nm);
        // (0/0, at rest with Ts = Tk, passes no comparison.)
        self.touch_slack_nm(omega_rad_s).at_most(slack_nm)
    }

    /// Tolerance of the limit where velocities touch, N·m: a
    /// touch is known to the root of the rounding of the velocities only, and
    /// √(J·kr)·Ω is the torque that corresponds to a velocity.
    #[inline]
    pub fn touch_slack_nm(&self, omega_rad_s: F) -> F {
        F::TOUCH_SLACK * (self.static_nm + self.impedance * omega_rad_s.abs())
    }

    /// Returns whether a shaft that moves by `delta_phi_rad` in a step goes further than a
    /// whole stick lasts,
    /// 2(Ts − Tk)/kr: sticks may then begin and end within one step, and a
    /// solver that looks only at its ends does not see them.
    #[inline]
    pub fn outlasts_a_stick(&self, delta_phi_rad: F) -> bool {
        delta_phi_rad.abs() * self.stiffness > F::TWO * self.drop_nm && !self.touches()
    }

    /// `torque_nm` held within ±Ts.
    #[inline]
    pub fn limited(&self, torque_nm: F) -> F {
        torque_nm.within(self.static_nm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::{Convention, Parameters};

    fn coefficients<F: Real>() -> StepCoefficients<F> {
        StepCoefficients::new(&Settings::default().validate().unwrap(), 5e-5).unwrap()
    }

    #[test]
    fn slip_time_is_the_closed_form() {
        // ωn·t = π + 2·atan(Ω√(J·kr)/(Ts − Tk)), the other way to write it.
        for omega in [0.01_f64, 0.1, 1.0, 5.0] {
            let expected = (core::f64::consts::PI + 2.0 * libm::atan(omega * 2.0 / 0.2)) / 200.0;
            let double = coefficients::<f64>().slip_time(omega).value() * 5e-5;
            assert!((double - expected).abs() < 1e-17, "{omega}");
            let span = coefficients::<f32>().slip_time(F32::from_f64(omega));
            #[expect(clippy::cast_precision_loss, reason = "small numbers")]
            let single = (span.whole as f64 + f64::from(span.fraction)) * 5e-5;
            assert!(
                (single - expected).abs() < 4e-9,
                "{omega}: {single} {expected}"
            );
        }
    }

    type F32 = f32;

    /// Half way of a ramp, by reciprocals, is what settings there give by division.
    fn is_consistent_on_the_way<F: Real>(most_off: f64) {
        let from = Parameters {
            damping_nms_per_rad: 0.1,
            ..Parameters::default()
        };
        let (softer, heavier) = (0.7_f64, 1.9_f64);
        let at = |share: f64| {
            let between = |a: f64, b: f64| a + (b - a) * share;
            let scale = |factor: f64| if share > 0.0 { factor } else { 1.0 };
            let parameters = Parameters {
                inertia_kg_m2: from.inertia_kg_m2 * scale(heavier),
                stiffness_nm_per_rad: from.stiffness_nm_per_rad * scale(softer),
                damping_nms_per_rad: between(0.1, 0.4),
                static_torque_nm: between(from.static_torque_nm, 3.0),
                kinetic_torque_nm: between(from.kinetic_torque_nm, 2.0),
            };
            let settings = Settings {
                parameters,
                convention: Convention::Physical,
                ..Settings::default()
            };
            let settings = settings.validate().unwrap();
            StepCoefficients::<F>::new(&settings, 5e-5).unwrap()
        };
        let f = F::from_f64;
        let made = at(0.0)
            .given()
            .towards(&at(1.0), f(0.25), f(softer), f(heavier));
        let expected = at(0.25);
        let off = |name: &str, made: F, expected: F| {
            let off = ((made - expected) / expected).abs();
            assert!(off <= f(most_off), "{name}: {made:?} {expected:?}");
        };
        off("step_s", made.step_s, expected.step_s);
        off("per_step", made.per_step, expected.per_step);
        off("stiffness", made.stiffness, expected.stiffness);
        off("inertia", made.inertia, expected.inertia);
        off("damping", made.damping, expected.damping);
        off("kinetic_nm", made.kinetic_nm, expected.kinetic_nm);
        off("static_nm", made.static_nm, expected.static_nm);
        off("restart_nm", made.restart_nm, expected.restart_nm);
        off(
            "kinetic_angle_rad",
            made.kinetic_angle_rad,
            expected.kinetic_angle_rad,
        );
        off(
            "static_angle_rad",
            made.static_angle_rad,
            expected.static_angle_rad,
        );
        off(
            "restart_angle_rad",
            made.restart_angle_rad,
            expected.restart_angle_rad,
        );
        off("drop_nm", made.drop_nm, expected.drop_nm);
        off("impedance", made.impedance, expected.impedance);
        off(
            "ticks_per_half_radian",
            made.ticks_per_half_radian,
            expected.ticks_per_half_radian,
        );
        let ticks = |t: &Ticks<F>| F::from_whole(t.whole) + t.fraction;
        off("period", ticks(&made.period), ticks(&expected.period));
        for time_s in [5e-5, 1e-3, 0.02] {
            let (x, v) = made.oscillator.moved(f(0.1), f(-2.0), f(time_s));
            let (expected_x, expected_v) = expected.oscillator.moved(f(0.1), f(-2.0), f(time_s));
            off("x", x, expected_x);
            off("v", v, expected_v);
        }
    }

    #[test]
    fn on_the_way_to_other_settings_all_numbers_are_those_of_the_settings_there() {
        is_consistent_on_the_way::<f64>(4e-14);
        is_consistent_on_the_way::<f32>(2e-5);
    }

    #[test]
    fn a_slip_against_the_shaft_lasts_half_a_period() {
        let half_period = core::f64::consts::PI / 200.0 / 5e-5;
        let span = coefficients::<f64>().slip_time(-3.0).value();
        assert!((span - half_period).abs() < 1e-9);
    }

    #[test]
    fn steps_that_are_no_step_are_refused() {
        let settings = Settings::default().validate().unwrap();
        for step_s in [0.0, -1e-3, f64::NAN, f64::INFINITY, 1.1] {
            assert!(StepCoefficients::<f32>::new(&settings, step_s).is_err());
        }
    }

    #[test]
    fn slacks_follow_the_swing_of_the_spring() {
        let a = coefficients::<f64>();
        // √(J·kr) = 2, Ts = 0.4, Ts − Tk = 0.2.
        assert!((a.touch_slack_nm(-3.0) - 1e-6 * 6.4).abs() < 1e-18);
        assert!((a.limit_slack_nm(3.0) - 1e-9 * (0.4 + 36.0 / 0.2)).abs() < 1e-20);
        assert!(!a.touches());
        // Where velocities only touch, the slack of a touch is enough.
        let mut settings = Settings::default();
        settings.parameters.kinetic_torque_nm = 0.4 * (1.0 - 1e-10);
        let a = StepCoefficients::<f64>::new(&settings.validate().unwrap(), 5e-5).unwrap();
        assert_eq!(a.limit_slack_nm(3.0), a.touch_slack_nm(3.0));
        assert!(a.touches());
        settings.parameters.kinetic_torque_nm = 0.4 * (1.0 - 1e-8);
        let a = StepCoefficients::<f64>::new(&settings.validate().unwrap(), 5e-5).unwrap();
        assert!(!a.touches());
    }

    #[test]
    fn a_step_outlasts_a_stick_beyond_its_travel() {
        let a = coefficients::<f64>();
        assert!(!a.outlasts_a_stick(0.999e-3));
        assert!(a.outlasts_a_stick(1.001e-3));
        assert!(a.outlasts_a_stick(-1.001e-3));
        // With Ts = Tk there is no stick to outlast.
        let mut settings = Settings::default();
        settings.parameters.kinetic_torque_nm = 0.4;
        let a = StepCoefficients::<f64>::new(&settings.validate().unwrap(), 5e-5).unwrap();
        assert!(!a.outlasts_a_stick(1.0));
    }

    #[test]
    fn equal_is_a_matter_of_proportion() {
        // One object in units a thousand times larger or smaller.
        for ts in [1e-4, 0.4, 1e3] {
            for (gap, touches) in [(1e-10, true), (1e-8, false)] {
                let mut settings = Settings::default();
                settings.parameters.static_torque_nm = ts;
                settings.parameters.kinetic_torque_nm = ts * (1.0 - gap);
                let a = StepCoefficients::<f64>::new(&settings.validate().unwrap(), 5e-5).unwrap();
                assert_eq!(a.touches(), touches, "{ts} {gap}");
            }
        }
    }

    #[test]
    fn a_step_as_long_as_a_stick_does_not_outlast_it() {
        // 2(Ts − Tk)/kr = 2^−9 rad, to the bit.
        let mut settings = Settings::default();
        settings.parameters.stiffness_nm_per_rad = 512.0;
        settings.parameters.static_torque_nm = 0.75;
        settings.parameters.kinetic_torque_nm = 0.25;
        let a = StepCoefficients::<f32>::new(&settings.validate().unwrap(), 5e-5).unwrap();
        assert!(!a.outlasts_a_stick(1.0 / 512.0));
        assert!(a.outlasts_a_stick(1.000_001 / 512.0));
    }
}
