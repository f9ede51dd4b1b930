//! The imaginary object while it slips: a free oscillator, solved exactly.
//!
//! During a slip the friction torque is the constant s·Tk, so with
//! x = θ − s·Tk/kr the object follows J·ẍ + c·ẋ + kr·x = 0. With a = c/2J and
//! D = ωn² − a² its motion over a time u is linear in (x, v = ẋ):
//!
//! ```text
//! x⁺ = (C + a·S)·x + S·v          C = e^(−a·u)·cos(√D·u)
//! v⁺ = −ωn²·S·x + (C − a·S)·v     S = e^(−a·u)·sin(√D·u)/√D
//! ```
//!
//! (cosh and sinh for D < 0, 1 and u for D = 0.) Both cos √z and sin √z/√z are
//! entire functions of z = D·u², so one pair of short power series covers
//! damping below, at and above critical for the small angles inside a step.
//!
//! The motion depends on time alone, not on the shaft: for a fixed step C and
//! S are constants, and an exact step costs four multiplications. What is kept
//! is the *change* over the step, C − 1: for small steps C itself would round
//! away most of its digits, and an f32 swing would gain or lose energy.

use crate::joint::Parameters;
use crate::joint::divisor::{Divisor, Exact};
use crate::real::Real;

/// The free motion of an object with given J, c, kr.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillator<F> {
    /// ωn, rad/s.
    omega_n: F,
    /// ωn² = kr/J, rad²/s².
    omega_n_squared: F,
    /// a = c/2J, 1/s.
    decay: F,
    /// D = ωn² − a², rad²/s²: negative above critical damping.
    discriminant: F,
    /// √|D|, rad/s.
    root: F,
    /// |4a² − ωn²| + 2a·ωn, rad²/s².
    jerk_factor: F,
}

/// The exact motion over one fixed time, as its change:
/// (x, v) ↦ (x + xx·x + xv·v, v + vx·x + vv·v).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<F> {
    xx: F,
    xv: F,
    vx: F,
    vv: F,
}

/// Largest square of an angle at which eight terms of each series are exact in f64, and
/// four or five in f32.
const SERIES_ANGLE_SQUARED: f64 = 0.3;

impl<F: Real> Oscillator<F> {
    /// Oscillator from kr, J and c.
    pub(crate) fn new<D: Divisor<F>>(stiffness: F, inertia: F, damping: F) -> Self {
        let per_inertia = D::new(inertia);
        let omega_n_squared = per_inertia.of(stiffness);
        let decay = per_inertia.of(F::HALF * damping);
        // (ωn − a)(ωn + a): no cancellation near critical damping.
        let omega_n = omega_n_squared.sqrt();
        let discriminant = (omega_n - decay) * (omega_n + decay);
        let four_a_squared = F::TWO * decay * (F::TWO * decay);
        Self {
            omega_n,
            omega_n_squared,
            decay,
            discriminant,
            root: discriminant.abs().sqrt(),
            jerk_factor: (four_a_squared - omega_n_squared).abs() + F::TWO * decay * omega_n,
        }
    }

    /// Oscillator from parameters; computed in f64 and rounded once.
    pub fn of(parameters: &Parameters) -> Self {
        let exact = Oscillator::<f64>::new::<Exact<f64>>(
            parameters.stiffness_nm_per_rad,
            parameters.inertia_kg_m2,
            parameters.damping_nms_per_rad,
        );
        Self {
            omega_n: F::from_f64(exact.omega_n),
            omega_n_squared: F::from_f64(exact.omega_n_squared),
            decay: F::from_f64(exact.decay),
            discriminant: F::from_f64(exact.discriminant),
            root: F::from_f64(exact.root),
            jerk_factor: F::from_f64(exact.jerk_factor),
        }
    }

    /// ωn, rad/s.
    #[inline]
    pub(crate) fn omega_n(&self) -> F {
        self.omega_n
    }

    /// The motion over `time_s` ≥ 0.
    pub fn transition(&self, time_s: F) -> Transition<F> {
        let (c_less_one, s) = self.cosine_less_one_and_sine(time_s);
        Transition {
            xx: c_less_one + self.decay * s,
            xv: s,
            vx: -(self.omega_n_squared * s),
            vv: c_less_one - self.decay * s,
        }
    }

    /// Returns whether [`Self::transition`] takes its series for this time.
    #[inline]
    pub(crate) fn is_short(&self, time_s: F) -> bool {
        self.discriminant * time_s * time_s <= F::from_f64(SERIES_ANGLE_SQUARED)
    }

    fn is_undamped(&self) -> bool {
        self.decay == F::ZERO && self.discriminant > F::ZERO
    }

    /// The motion over `time_s` ≥ 0 without a branch, if [short](Self::is_short) is told rightly, and
    /// whether it has the bits of [`Self::transition`].
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "the target features of its caller")]
    pub(crate) fn straight_transition<const SHORT: bool>(
        &self,
        time_s: F,
    ) -> (Transition<F>, bool) {
        let (c_less_one, s, is_plain) = if SHORT {
            let z = self.discriminant * time_s * time_s;
            (cosine_of_root_less_one(z), time_s * sine_over_root(z), true)
        } else {
            let (sin, cos, is_plain) = (self.root * time_s).straight_sin_cos();
            (cos - F::ONE, sin / self.root, is_plain)
        };
        let transition = Transition {
            xx: c_less_one + self.decay * s,
            xv: s,
            vx: -(self.omega_n_squared * s),
            vv: c_less_one - self.decay * s,
        };
        (transition, self.is_undamped() & is_plain)
    }

    /// (x, v) after `time_s` ≥ 0: as [`Self::transition`] says, quicker where
    /// there is no damping and the time is short.
    #[inline]
    pub fn moved(&self, x: F, v: F, time_s: F) -> (F, F) {
        let z = self.discriminant * time_s * time_s;
        if self.decay == F::ZERO && z <= F::from_f64(SERIES_ANGLE_SQUARED) {
            let less_one = cosine_of_root_less_one(z);
            let sine = time_s * sine_over_root(z);
            return (
                x + (less_one * x + sine * v),
                v + (-(self.omega_n_squared * sine) * x + less_one * v),
            );
        }
        self.moved_by_any(x, v, time_s)
    }

    #[inline(never)]
    fn moved_by_any(&self, x: F, v: F, time_s: F) -> (F, F) {
        self.transition(time_s).apply(x, v)
    }

    /// The acceleration at (x, v): −ωn²·x − 2a·v, rad/s².
    #[inline]
    pub fn acceleration(&self, x: F, v: F) -> F {
        -(self.omega_n_squared * x) - F::TWO * self.decay * v
    }

    /// A bound of |v| that holds for the whole free motion from (x, v) on:
    /// |v| + ωn|x|, rad/s. It is at least √(v² + ωn²x²), the root of the
    /// object's energy, which free motion never raises.
    #[inline]
    pub fn speed_bound(&self, x: F, v: F) -> F {
        v.abs() + self.omega_n * x.abs()
    }

    /// A bound of |v̈| that holds for the whole free motion from (x, v) on:
    /// |4a² − ωn²| + 2a·ωn times the speed bound, rad/s³.
    #[inline]
    pub fn jerk_bound(&self, x: F, v: F) -> F {
        self.jerk_factor * self.speed_bound(x, v)
    }

    /// Factors of |x| and of the [speed bound](Self::speed_bound) in the [jerk bound](Self::jerk_bound).
    pub(crate) fn bound_factors(&self) -> [F; 2] {
        [self.omega_n, self.jerk_factor]
    }

    /// A bound of |v⃛| that holds for the whole free motion from (x, v) on,
    /// rad/s⁴: v⃛ = −ωn²·v̇ − 2a·v̈, and |v̇| is at most ωn + 2a times the speed
    /// bound.
    pub fn snap_bound(&self, x: F, v: F) -> F {
        let two_a = F::TWO * self.decay;
        self.omega_n_squared * (self.omega_n + two_a) * self.speed_bound(x, v)
            + two_a * self.jerk_bound(x, v)
    }

    /// (C − 1, S) of the module's equations.
    fn cosine_less_one_and_sine(&self, time_s: F) -> (F, F) {
        let z = self.discriminant * time_s * time_s;
        if z.abs() <= F::from_f64(SERIES_ANGLE_SQUARED) {
            let less_one = cosine_of_root_less_one(z);
            let sine = time_s * sine_over_root(z);
            if self.decay > F::ZERO {
                let lost = exp_less_one(-(self.decay * time_s));
                // E·cos − 1 = (E − 1) + E·(cos − 1)
                return (lost + (F::ONE + lost) * less_one, (F::ONE + lost) * sine);
            }
            return (less_one, sine);
        }
        if z > F::ZERO {
            let damped = if self.decay > F::ZERO {
                (-(self.decay * time_s)).exp()
            } else {
                F::ONE
            };
            let (sin, cos) = (self.root * time_s).sin_cos();
            (damped * cos - F::ONE, damped * sin / self.root)
        } else {
            // Two decaying exponentials: cosh and sinh alone would overflow.
            // The slow rate a − √−D is written without cancellation.
            let fast = self.decay + self.root;
            let slow = self.omega_n_squared / fast;
            let e_slow = (-(slow * time_s)).exp();
            let e_fast = (-(fast * time_s)).exp();
            (
                F::HALF * (e_slow + e_fast) - F::ONE,
                F::HALF * (e_slow - e_fast) / self.root,
            )
        }
    }
}

impl<F: Real> Transition<F> {
    /// The change of x by x and by v, and that of v.
    pub(crate) fn factors(&self) -> [F; 4] {
        [self.xx, self.xv, self.vx, self.vv]
    }

    /// The motion with these [factors](Self::factors).
    #[inline]
    pub(crate) fn of([xx, xv, vx, vv]: [F; 4]) -> Self {
        Self { xx, xv, vx, vv }
    }

    /// Moves (x, v).
    #[inline]
    pub fn apply(&self, x: F, v: F) -> (F, F) {
        (
            x + (self.xx * x + self.xv * v),
            v + (self.vx * x + self.vv * v),
        )
    }
}

/// cos √z − 1 = Σ (−z)ᵏ/(2k)! from k = 1 on.
#[inline]
fn cosine_of_root_less_one<F: Real>(z: F) -> F {
    let factor = -(F::HALF * z);
    if F::IS_SINGLE {
        factor * series(z, &[12.0, 30.0, 56.0])
    } else {
        factor * series(z, &[12.0, 30.0, 56.0, 90.0, 132.0, 182.0])
    }
}

/// sin √z/√z = Σ (−z)ᵏ/(2k+1)!.
#[inline]
fn sine_over_root<F: Real>(z: F) -> F {
    if F::IS_SINGLE {
        series(z, &[6.0, 20.0, 42.0, 72.0])
    } else {
        series(z, &[6.0, 20.0, 42.0, 72.0, 110.0, 156.0, 210.0])
    }
}

/// eˣ − 1; by its series where the difference would cancel.
#[inline]
fn exp_less_one<F: Real>(x: F) -> F {
    if x.abs() > F::HALF {
        return x.exp() - F::ONE;
    }
    x * series(
        -x,
        &[
            2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0,
        ],
    )
}

/// 1 − z/r₁·(1 − z/r₂·(1 − …)).
#[inline]
fn series<F: Real, const N: usize>(z: F, ratios: &[f64; N]) -> F {
    ratios.iter().rev().fold(F::ONE, |inner, &ratio| {
        F::ONE - z * F::from_f64(1.0 / ratio) * inner
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::counted::{Counted, operations};

    fn with(damping_ratio: f64) -> (Parameters, Oscillator<f64>) {
        let mut p = Parameters::default();
        p.damping_nms_per_rad = 2.0 * damping_ratio * p.impedance_nms_per_rad();
        (p, Oscillator::of(&p))
    }

    /// Classical Runge-Kutta with very small steps, as an independent check.
    fn integrate(p: &Parameters, time_s: f64, (mut x, mut v): (f64, f64)) -> (f64, f64) {
        let n = 20_000;
        let h = time_s / f64::from(n);
        let f = |x: f64, v: f64| {
            (
                v,
                -(p.stiffness_nm_per_rad * x + p.damping_nms_per_rad * v) / p.inertia_kg_m2,
            )
        };
        for _ in 0..n {
            let (a, b) = f(x, v);
            let (c, d) = f(x + h / 2.0 * a, v + h / 2.0 * b);
            let (e, g) = f(x + h / 2.0 * c, v + h / 2.0 * d);
            let (i, j) = f(x + h * e, v + h * g);
            x += h / 6.0 * (a + 2.0 * c + 2.0 * e + i);
            v += h / 6.0 * (b + 2.0 * d + 2.0 * g + j);
        }
        (x, v)
    }

    #[test]
    fn every_damping_matches_an_independent_integration() {
        for damping_ratio in [0.0, 1e-3, 0.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5, 30.0] {
            let (p, oscillator) = with(damping_ratio);
            for time_s in [1e-5, 1e-3, 0.02, 0.05] {
                let exact = oscillator.transition(time_s).apply(1e-3, 0.7);
                let numeric = integrate(&p, time_s, (1e-3, 0.7));
                assert!(
                    (exact.0 - numeric.0).abs() < 1e-11 && (exact.1 - numeric.1).abs() < 1e-9,
                    "ζ = {damping_ratio}, t = {time_s}: {exact:?} {numeric:?}"
                );
            }
        }
    }

    #[test]
    fn two_half_steps_are_one_step() {
        for damping_ratio in [0.0, 0.02, 1.0, 3.0] {
            let (_, oscillator) = with(damping_ratio);
            for time_s in [1e-4, 4e-3, 0.03] {
                let half = oscillator.transition(time_s / 2.0);
                let (x, v) = half.apply(2e-4, -0.3);
                let (a, b) = (
                    half.apply(x, v),
                    oscillator.transition(time_s).apply(2e-4, -0.3),
                );
                assert!((a.0 - b.0).abs() < 1e-17 && (a.1 - b.1).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn series_and_trigonometry_meet() {
        let (_, o) = with(0.0);
        let (below, above) = (0.547_722 / 200.0, 0.547_723 / 200.0);
        let (a, b) = (o.transition(below), o.transition(above));
        assert!((a.xx - b.xx).abs() < 1e-6 && (a.xv - b.xv).abs() < 1e-8);
        let (s, c) = libm::sincos(below * 200.0);
        assert!((a.xx + 1.0 - c).abs() < 3e-16 && (a.xv * 200.0 - s).abs() < 3e-16);
    }

    /// Transitions by the series, where the short way is as exact, and by sine and cosine.
    #[test]
    fn without_damping_nothing_is_computed_for_it() {
        let [free, damped] = [0.0, 0.02].map(|ratio| Oscillator::<Counted>::of(&with(ratio).0));
        for time_s in [1e-3, 2e-2] {
            let time = Counted::from_f64(time_s);
            let [without, with] = [free, damped].map(|o| operations(|| o.transition(time)).1);
            assert!(without.all() < with.all(), "{time_s}: {without:?} {with:?}");
        }
        let time = Counted::from_f64(1e-3);
        let (x, v) = (Counted::from_f64(1e-3), Counted::from_f64(0.7));
        let (moved, short) = operations(|| free.moved(x, v, time));
        let (by_transition, long) = operations(|| free.transition(time).apply(x, v));
        assert_eq!(moved, by_transition);
        assert!(short.all() < long.all(), "{short:?} {long:?}");
    }

    #[test]
    fn the_bounds_bound() {
        for damping_ratio in [0.0, 0.3, 1.0, 2.0] {
            let (p, o) = with(damping_ratio);
            for (x0, v0) in [(3e-4, -0.2), (1e-3, 0.0), (0.0, 0.2), (1e-3, 0.1)] {
                let bound = o.jerk_bound(x0, v0);
                for i in 0..1000 {
                    let (x, v) = o.transition(f64::from(i) * 5e-5).apply(x0, v0);
                    let a = o.acceleration(x, v);
                    let jerk =
                        -(p.stiffness_nm_per_rad * v + p.damping_nms_per_rad * a) / p.inertia_kg_m2;
                    assert!(jerk.abs() <= bound * (1.0 + 1e-12));
                    let snap = -(p.stiffness_nm_per_rad * a + p.damping_nms_per_rad * jerk)
                        / p.inertia_kg_m2;
                    assert!(snap.abs() <= o.snap_bound(x0, v0) * (1.0 + 1e-12));
                    assert!(v.abs() <= o.speed_bound(x0, v0) * (1.0 + 1e-12));
                }
            }
        }
    }
}
