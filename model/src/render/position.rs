//! Place of the joint, for symptoms that depend on its angle.
//!
//! An angle is a whole number of encoder counts and a rest. A difference of two
//! is then exact to a count's rounding however far the joint is from its zero:
//! nothing drifts, and a counter that wraps does no harm. A joint that is seen
//! without an encoder has fine counts of its own, [`Sensing::IDEAL`].

use crate::control::encoder::EncoderSettings;
use crate::joint::ShaftStep;
use crate::real::Real;
use crate::render::input_check::{Checked, Gap};

/// An angle of the joint from its zero; positive in flexion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Position<F> {
    /// Whole counts; wraps.
    pub count: i32,
    /// Rest of the angle beyond them, rad.
    pub rest_rad: F,
}

impl<F: Real> Position<F> {
    /// A whole number of counts.
    #[inline]
    pub fn at(count: i32) -> Self {
        Self {
            count,
            rest_rad: F::ZERO,
        }
    }

    /// Distance beyond `other`, rad.
    #[inline]
    pub fn beyond(&self, other: &Self, rad_per_count: F) -> F {
        F::from_count(self.count.wrapping_sub(other.count)) * rad_per_count
            + (self.rest_rad - other.rest_rad)
    }

    /// Moved by this angle.
    #[inline]
    #[must_use]
    pub fn moved(&self, rad: F) -> Self {
        Self {
            count: self.count,
            rest_rad: self.rest_rad + rad,
        }
    }
}

/// Resolution, flicker and velocity lag with which a device sees its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensing {
    /// Angle of a count, rad.
    pub rad_per_count: f64,
    /// Largest flicker of the angle of a joint at rest, rad.
    pub flicker_rad: f64,
    /// Lag of the velocity, s.
    pub velocity_lag_s: f64,
}

impl Sensing {
    /// The true angle and velocity. Its counts are a power of two, so that angles
    /// are split without rounding.
    pub const IDEAL: Self = Self {
        rad_per_count: 1.0 / 1_048_576.0,
        flicker_rad: 0.0,
        velocity_lag_s: 0.0,
    };

    /// Sensing through an encoder and its estimate of the velocity.
    pub fn of_encoder(settings: &EncoderSettings) -> Self {
        let rad_per_count = settings.rad_per_count();
        Self {
            rad_per_count,
            // As for the turn-back guard: a count more or less is noise.
            flicker_rad: 2.0 * rad_per_count,
            // Both poles of the observer.
            velocity_lag_s: 2.0 / (core::f64::consts::TAU * settings.velocity_bandwidth_hz),
        }
    }

    /// The position of an angle. Its counts are rounded toward zero, and so those of
    /// the mirrored angle are mirrored.
    #[inline]
    pub fn position<F: Real>(&self, angle_rad: f64) -> Position<F> {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a cast from float truncates and saturates"
        )]
        let count = (angle_rad / self.rad_per_count) as i32;
        Position {
            count,
            rest_rad: F::from_f64(angle_rad - f64::from(count) * self.rad_per_count),
        }
    }
}

/// Scale of the angle, and half a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scale<F> {
    /// Angle of a count, rad.
    pub rad_per_count: F,
    /// Half a tick, s.
    pub half_step_s: F,
}

impl<F: Real> Scale<F> {
    /// Scale for ticks of `step_s`.
    pub fn new(sensing: &Sensing, step_s: f64) -> Self {
        Self {
            rad_per_count: F::from_f64(sensing.rad_per_count),
            half_step_s: F::from_f64(0.5 * step_s),
        }
    }
}

/// The most ticks of a travel; a longer gap counts as that long.
pub const MOST_TICKS: u32 = 32;

/// The joint's motion since it was seen last: over its time the velocity changes
/// linearly,
///
/// ```text
/// φ(f) = φ₀ + Δφ·f − b·f·(1 − f)       b = (Ω₁ − Ω₀)·h/2       f from 0 to 1
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel<F> {
    /// Place at its end.
    pub to: Position<F>,
    /// Δφ, rad.
    pub delta_rad: F,
    /// Ω₀, rad/s.
    pub omega_start_rad_s: F,
    /// Ω₁, rad/s.
    pub omega_end_rad_s: F,
    /// b, rad.
    pub bend_rad: F,
    /// Time of the travel in ticks: more than one after a gap, at most [`MOST_TICKS`].
    pub ticks: u32,
    /// Time of the travel in ticks, as a number.
    pub length: F,
    /// Angle of a count, rad.
    pub rad_per_count: F,
}

impl<F: Real> Travel<F> {
    /// Travel that a checked sample gives; `None` without a sample.
    #[inline]
    pub fn of(input: &Checked<F>, to: &Position<F>, scale: &Scale<F>) -> Option<Self> {
        match input {
            Checked::Step(shaft) => Some(Self::over(shaft, to, scale, 1)),
            Checked::CatchUp(gap) | Checked::Resume(gap) => Some(Self::over_gap(gap, to, scale)),
            Checked::Missing(_) => None,
        }
    }

    /// The travel, if its numbers are those that a joint can have.
    #[inline]
    pub fn plausible(input: &Checked<F>, to: &Position<F>, scale: &Scale<F>) -> Option<Self> {
        Self::of(input, to, scale).filter(Self::is_plausible)
    }

    #[inline]
    fn over(shaft: &ShaftStep<F>, to: &Position<F>, scale: &Scale<F>, ticks: u32) -> Self {
        Self {
            to: *to,
            delta_rad: shaft.delta_phi_rad,
            omega_start_rad_s: shaft.omega_start_rad_s,
            omega_end_rad_s: shaft.omega_end_rad_s,
            bend_rad: (shaft.omega_end_rad_s - shaft.omega_start_rad_s) * scale.half_step_s,
            ticks,
            length: F::ONE,
            rad_per_count: scale.rad_per_count,
        }
    }

    #[cold]
    fn over_gap(gap: &Gap<F>, to: &Position<F>, scale: &Scale<F>) -> Self {
        let ticks = gap.missed.saturating_add(1).min(MOST_TICKS);
        let shaft = ShaftStep {
            omega_start_rad_s: gap.omega_rad_s,
            ..gap.shaft
        };
        let mut travel = Self::over(&shaft, to, scale, ticks);
        travel.length = F::from_whole(u64::from(ticks));
        travel.bend_rad = travel.bend_rad * travel.length;
        travel
    }

    /// Returns whether it is numbers that a joint can have: a bare law has no check of its
    /// input before it. A NaN passes no comparison.
    #[inline]
    pub fn is_plausible(&self) -> bool {
        let all = self.delta_rad.abs()
            + self.omega_start_rad_s.abs()
            + self.omega_end_rad_s.abs()
            + self.to.rest_rad.abs();
        all < F::from_f64(1e9)
    }

    /// Returns what a decay leaves of `x` after all its ticks, in each of which it loses this
    /// share. What is lost is small: of what is left f32 keeps too few digits, and a
    /// decay of a second would be off by some 1e-4.
    #[inline]
    pub fn decayed(&self, x: F, lost: F) -> F {
        if self.ticks == 1 {
            x - x * lost
        } else {
            self.decayed_over_gap(x, lost)
        }
    }

    #[cold]
    fn decayed_over_gap(&self, x: F, lost: F) -> F {
        (0..self.ticks).fold(x, |left, _| left - left * lost)
    }

    /// The exponent of a decay at `rate` a tick from one share of the time to another.
    #[inline]
    pub fn exponent(&self, rate: F, from: F, to: F) -> F {
        rate * self.length * (to - from)
    }

    /// Place of the joint after this share of the time.
    #[inline]
    pub fn place(&self, fraction: F) -> Position<F> {
        let left = F::ONE - fraction;
        self.to
            .moved(-left * (self.delta_rad + self.bend_rad * fraction))
    }

    /// Velocity after this share of the time, rad/s.
    #[inline]
    pub fn omega_rad_s(&self, fraction: F) -> F {
        self.omega_start_rad_s + (self.omega_end_rad_s - self.omega_start_rad_s) * fraction
    }

    /// Distance of the end beyond `place`, rad.
    #[inline]
    pub fn end_beyond(&self, place: &Position<F>) -> F {
        self.to.beyond(place, self.rad_per_count)
    }

    /// The share of the time after which the joint has come to `place`: one that
    /// lies between beginning and end.
    pub fn reaches(&self, place: &Position<F>) -> F {
        let far_rad = self.delta_rad - self.end_beyond(place);
        if self.delta_rad < F::ZERO {
            rise(self.bend_rad - self.delta_rad, -self.bend_rad, -far_rad)
        } else {
            rise(self.delta_rad - self.bend_rad, self.bend_rad, far_rad)
        }
    }
}

/// The share f of a tick, 0 to 1, at which a quantity that begins `missing` ≥ 0
/// below its threshold and rises by `slope`·f + `bend`·f² has reached it.
pub fn rise<F: Real>(slope: F, bend: F, missing: F) -> F {
    let four = F::from_f64(4.0);
    let square = slope * slope + four * bend * missing;
    let sum = slope + square.at_least(F::ZERO).sqrt();
    if sum > F::ZERO {
        (F::TWO * missing / sum).at_least(F::ZERO).at_most(F::ONE)
    } else {
        // No rise: the threshold is met as the tick ends.
        F::ONE
    }
}

/// e to the power of `x` ≤ 0, which is far below 1 in a tick and may be 1 in a gap: to 1e-9 of a
/// tick, to 5e-4 of a gap over one time constant.
#[inline]
pub fn decay<F: Real>(x: F) -> F {
    let third = F::from_f64(1.0 / 3.0);
    let quarter = F::HALF * F::HALF * x;
    let root = F::ONE + quarter * (F::ONE + F::HALF * quarter * (F::ONE + third * quarter));
    let square = root * root;
    square * square
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::control::encoder::EncoderReader;

    #[test]
    fn an_angle_is_split_and_its_differences_are_exact() {
        for sensing in [
            Sensing::IDEAL,
            Sensing::of_encoder(&EncoderSettings::default()),
        ] {
            for (a, b) in [(2.1, -0.3), (1e-9, 0.0), (-700.0, 700.0)] {
                let (at, from) = (sensing.position::<f64>(a), sensing.position::<f64>(b));
                assert!(at.rest_rad.abs() < sensing.rad_per_count);
                let mirrored = sensing.position::<f64>(-a);
                assert_eq!(
                    (mirrored.count, mirrored.rest_rad),
                    (-at.count, -at.rest_rad)
                );
                let beyond = at.beyond(&from, sensing.rad_per_count);
                assert!((beyond - (a - b)).abs() < 2e-13, "{beyond} {}", a - b);
                let single = |x| sensing.position::<f32>(x);
                let count_rad = f32::from_f64(sensing.rad_per_count);
                let near = single(a + 1e-3).beyond(&single(a), count_rad);
                assert!((f64::from(near) - 1e-3).abs() < 2e-10, "{near}");
            }
        }
        let wrapped = Position::<f64>::at(i32::MIN).beyond(&Position::at(i32::MAX), 0.5);
        assert_eq!(wrapped, 0.5);
    }

    #[test]
    fn the_velocity_is_as_late_as_that_of_the_encoder() {
        let (settings, step_s, acceleration) = (EncoderSettings::default(), 5e-5, 50.0);
        let mut reader = EncoderReader::<f64>::new(&settings, step_s, 0, 0.0).unwrap();
        let mut late_s = 0.0;
        for tick in 1..=4000 {
            let time_s = f64::from(tick) * step_s;
            let angle_rad = 0.5 * acceleration * time_s * time_s;
            #[expect(clippy::cast_possible_truncation, reason = "a revolution or less")]
            reader.read((angle_rad / settings.rad_per_count()) as i32);
            if tick > 3000 {
                late_s += (acceleration * time_s - reader.omega_rad_s()) / acceleration / 1000.0;
            }
        }
        let expected_s = Sensing::of_encoder(&settings).velocity_lag_s;
        assert!(
            (late_s - expected_s).abs() < step_s,
            "{late_s} {expected_s}"
        );
    }

    /// Travel from 1 rad with Δφ = (Ω₀ + Ω₁)·h/2.
    pub(crate) fn travel(from_rad_s: f64, to_rad_s: f64) -> Travel<f64> {
        let scale = Scale::new(&Sensing::IDEAL, 5e-5);
        let delta = (from_rad_s + to_rad_s) * scale.half_step_s;
        let shaft = ShaftStep {
            delta_phi_rad: delta,
            omega_start_rad_s: from_rad_s,
            omega_end_rad_s: to_rad_s,
        };
        let to = Sensing::IDEAL.position(1.0 + delta);
        Travel::of(&Checked::Step(shaft), &to, &scale).unwrap()
    }

    #[test]
    fn a_place_on_the_way_is_reached_when_it_is() {
        for (from, to) in [(1.0, 1.0), (1.0, 4.0), (0.0, 3.0), (-1.0, 3.0), (3.0, 0.0)] {
            for sign in [1.0, -1.0] {
                let travel = travel(sign * from, sign * to);
                for fraction in [0.6, 0.7, 0.9, 1.0] {
                    let place = travel.place(fraction);
                    let found = travel.reaches(&place);
                    assert!((found - fraction).abs() < 1e-6, "{found} {fraction}");
                }
                let begin = travel.place(0.0);
                assert!((travel.end_beyond(&begin) - travel.delta_rad).abs() < 1e-18);
            }
        }
        assert_eq!(travel(1.0, 2.0).omega_rad_s(0.25), 1.25);
    }

    #[test]
    fn a_gap_is_one_travel_of_several_ticks() {
        let shaft = ShaftStep {
            delta_phi_rad: 3e-4,
            omega_start_rad_s: 7.0,
            omega_end_rad_s: 3.0,
        };
        let gap = Gap {
            shaft,
            missed: 2,
            omega_rad_s: 1.0,
        };
        let scale = Scale::<f64>::new(&Sensing::IDEAL, 5e-5);
        let to = Sensing::IDEAL.position(0.5);
        for input in [Checked::CatchUp(gap), Checked::Resume(gap)] {
            let travel = Travel::of(&input, &to, &scale).unwrap();
            assert_eq!((travel.ticks, travel.omega_start_rad_s), (3, 1.0));
            assert!((travel.bend_rad - 2.0 * 3.0 * 2.5e-5).abs() < 1e-18);
            assert_eq!(travel.decayed(8.0, 0.5), 1.0);
        }
        assert_eq!(Travel::of(&Checked::Missing(1), &to, &scale), None);
    }

    /// Decay of the longest torque, over all of the longest release, in f32.
    #[test]
    fn a_long_decay_keeps_its_digits() {
        let scale = Scale::<f32>::new(&Sensing::IDEAL, 5e-5);
        let step = Checked::Step(ShaftStep::default());
        let travel = Travel::of(&step, &Sensing::IDEAL.position(0.5), &scale).unwrap();
        for release_s in [0.01, 0.06, 0.25, 0.5, 1.0] {
            let rate = -5e-5 / release_s;
            let lost = f32::from_f64(-libm::expm1(rate));
            let mut nm = 4.5_f32;
            for n in 1..=40_000_u32 {
                nm = travel.decayed(nm, lost);
                let exact_nm = 4.5 * libm::exp(rate * f64::from(n));
                let error_nm = (f64::from(nm) - exact_nm).abs();
                assert!(error_nm <= 1e-5, "{release_s} s, tick {n}: {error_nm}");
            }
        }
    }

    #[test]
    fn what_no_joint_can_have_is_no_travel() {
        const MOST: f64 = 1e9;
        let scale = Scale::<f64>::new(&Sensing::IDEAL, 5e-5);
        let of = |delta_rad: f64, start_rad_s: f64, end_rad_s: f64, rest_rad: f64| {
            let shaft = ShaftStep {
                delta_phi_rad: delta_rad,
                omega_start_rad_s: start_rad_s,
                omega_end_rad_s: end_rad_s,
            };
            let to = Position { count: 1, rest_rad };
            Travel::plausible(&Checked::Step(shaft), &to, &scale)
        };
        for sign in [1.0, -1.0] {
            for place in 0..4 {
                let with = |x: f64| {
                    let mut numbers = [0.0; 4];
                    numbers[place] = sign * x;
                    let [delta, start, end, rest] = numbers;
                    of(delta, start, end, rest)
                };
                assert!(with(0.99 * MOST).is_some(), "{place}");
                for no_number in [MOST, f64::INFINITY, f64::NAN] {
                    assert_eq!(with(no_number), None, "{place}");
                }
            }
            // Together they are too much, and none makes up for another.
            let part = 0.3 * sign * MOST;
            assert_eq!(of(part, part, -part, -part), None);
        }
    }

    #[test]
    fn a_rise_is_found_and_always_a_share_of_the_tick() {
        assert_eq!(rise(2.0, 0.0, 1.0), 0.5);
        assert!((rise(1.0, 1.0, 0.75) - 0.5).abs() < 1e-15);
        // A motion that turns before: never later than the end.
        assert_eq!(rise(0.0, 0.0, 1.0), 1.0);
        assert_eq!(rise(0.0, 0.0, 0.0), 1.0);
        assert_eq!(rise(-1.0, 0.0, 1.0), 1.0);
        assert_eq!(rise(1.0, -9.0, 1.0), 1.0);
        assert_eq!(rise(1.0, 0.0, -1.0), 0.0);
    }
}
