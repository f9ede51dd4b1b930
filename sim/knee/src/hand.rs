//! A hand that a person moves by pointer, touch or keys.
//!
//! A spring and a damper pull the leg to where the hand wants to be, so that resistance is seen as lag:
//!
//! ```text
//! torque = k·(φ_hand − φ) + b·(Ω_hand − Ω)      within ±limit
//! ```
//!
//! | number | value | source |
//! |---|---|---|
//! | stiffness k | 60 N·m/rad: 490 N/m at a lever of 0.35 m | estimate: an arm that pulls; the plant's has 135 N/m |
//! | damping b | 10 N·m·s/rad | nearly critical for the leg of 70 kg and 1.75 m with an arm |
//! | limit | 40 N·m: 114 N at that lever | estimate |
//!
//! A display gives a target 30 to 120 times a second, never evenly. [`HandPath`] makes a path of it for a
//! device of 20 kHz: the target at a limited speed, then two equal lags, which are one critically damped
//! follower. Each is a weighted mean of what came before, so the path never leaves the range of its
//! targets, overshoots none that stays, and is never faster than the limit; its velocity has no jumps.

use crepitus_model::Real;
use crepitus_protocol::TICK_S;

/// Impedance of a hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// Stiffness k, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Damping b, N·m·s/rad.
    pub damping_nms_per_rad: f64,
    /// Largest torque, N·m.
    pub limit_nm: f64,
}

impl Hand {
    /// The hand that a person moves.
    pub const GUIDED: Self = Self {
        stiffness_nm_per_rad: 60.0,
        damping_nms_per_rad: 10.0,
        limit_nm: 40.0,
    };

    /// Torque on a leg that is `behind_rad` behind the hand and `slower_rad_s` slower, N·m; positive
    /// flexes the knee.
    pub fn torque_nm(&self, behind_rad: f64, slower_rad_s: f64) -> f64 {
        (self.stiffness_nm_per_rad * behind_rad + self.damping_nms_per_rad * slower_rad_s)
            .within(self.limit_nm)
    }
}

/// Largest speed of a path, rad/s: 258 deg/s. A leg that is thrown gets a fifth faster, and a brace
/// disarms from 328 deg/s on.
pub const FASTEST_RAD_S: f64 = 4.5;

/// Rate of each of the two lags, 1/s: at constant speed a path is 40 ms late.
const FOLLOW_PER_S: f64 = 50.0;

/// Share of a difference that a lag makes up for in a tick.
const SHARE: f64 = FOLLOW_PER_S * TICK_S;

/// Path of a hand, tick by tick, from targets that come now and then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandPath {
    /// Latest target.
    target_rad: f64,
    /// The target at a limited speed.
    led_rad: f64,
    /// Output of the first lag.
    lagged_rad: f64,
    angle_rad: f64,
    omega_rad_s: f64,
}

impl HandPath {
    /// A hand at rest.
    pub fn at(angle_rad: f64) -> Self {
        Self {
            target_rad: angle_rad,
            led_rad: angle_rad,
            lagged_rad: angle_rad,
            angle_rad,
            omega_rad_s: 0.0,
        }
    }

    /// Sets where the hand wants to be from now on. Ignores what is no number.
    pub fn turn_to(&mut self, target_rad: f64) {
        if target_rad.is_finite() {
            self.target_rad = target_rad;
        }
    }

    /// One tick.
    pub fn advance(&mut self) {
        self.led_rad += (self.target_rad - self.led_rad).within(FASTEST_RAD_S * TICK_S);
        self.lagged_rad += SHARE * (self.led_rad - self.lagged_rad);
        self.omega_rad_s = FOLLOW_PER_S * (self.lagged_rad - self.angle_rad);
        self.angle_rad += TICK_S * self.omega_rad_s;
    }

    /// Angle of the hand, rad.
    pub fn angle_rad(&self) -> f64 {
        self.angle_rad
    }

    /// Velocity of the hand, rad/s.
    pub fn omega_rad_s(&self) -> f64 {
        self.omega_rad_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hand_pulls_the_leg_after_it_as_hard_as_it_can() {
        let hand = Hand::GUIDED;
        assert_eq!(hand.torque_nm(0.0, 0.0), 0.0);
        assert_eq!(hand.torque_nm(0.125, 0.0), 7.5);
        assert_eq!(hand.torque_nm(0.125, -1.0), -2.5);
        assert_eq!(hand.torque_nm(2.0, 0.0), hand.limit_nm);
        assert_eq!(hand.torque_nm(-1.0, -5.0), -hand.limit_nm);
    }

    /// Random targets at random times, as fast as no display and as slow as no display.
    #[test]
    fn a_path_keeps_to_its_targets_and_to_its_speed_without_a_jump() {
        let mut rng = fastrand::Rng::with_seed(55);
        // Both lags change at most as fast as their input.
        let most_change = 2.0 * FOLLOW_PER_S * FASTEST_RAD_S * TICK_S;
        let rounding = 1e-9;
        let mut fastest = 0.0_f64;
        for _ in 0..20 {
            let mut path = HandPath::at(0.3);
            let (mut low, mut high) = (0.3_f64, 0.3_f64);
            for _ in 0..60 {
                let target = rng.f64() * 2.4 - 0.2;
                (low, high) = (low.min(target), high.max(target));
                path.turn_to(target);
                for _ in 0..rng.u32(20..900) {
                    let before = path;
                    path.advance();
                    let inside = low - rounding..=high + rounding;
                    assert!(inside.contains(&path.angle_rad), "{path:?}");
                    let change = (path.omega_rad_s - before.omega_rad_s).abs();
                    assert!(change <= most_change + rounding, "{change}");
                    let moved = (path.angle_rad - before.angle_rad) / TICK_S;
                    assert!((moved - path.omega_rad_s).abs() < 1e-6);
                    fastest = fastest.max(path.omega_rad_s.abs());
                }
            }
        }
        // It comes close to the limit, and never beyond.
        let range = 0.9 * FASTEST_RAD_S..=FASTEST_RAD_S + rounding;
        assert!(range.contains(&fastest), "{fastest}");
    }

    #[test]
    fn a_step_is_followed_without_overshoot_and_reached() {
        for target in [1.0, -0.4, 2.2] {
            let mut path = HandPath::at(0.0);
            path.turn_to(target);
            let mut before = 0.0;
            for _ in 0..20_000 {
                path.advance();
                let share = path.angle_rad / target;
                assert!(share >= before - 1e-12 && share <= 1.0 + 1e-12, "{share}");
                before = share;
            }
            assert!((path.angle_rad - target).abs() < 1e-9);
            assert!(path.omega_rad_s.abs() < 1e-9);
        }
    }

    /// Targets 60 and 30 times a second, of a pointer at 2 rad/s.
    #[test]
    fn a_display_is_made_smooth_and_40_ms_late() {
        for (ticks, ripple) in [(333, 0.035), (667, 0.12)] {
            let mut path = HandPath::at(0.0);
            let mut tick = 0.0;
            let mut late_s = 0.0;
            for frame in 0..80 {
                path.turn_to(2.0 * tick * TICK_S);
                for _ in 0..ticks {
                    path.advance();
                    tick += 1.0;
                    if frame >= 40 {
                        let off = path.omega_rad_s / 2.0 - 1.0;
                        assert!(off.abs() < ripple, "{off}");
                        late_s += tick * TICK_S - path.angle_rad / 2.0;
                    }
                }
            }
            let frame_s = f64::from(ticks) * TICK_S;
            let mean_s = late_s / f64::from(40 * ticks);
            // On average a target is half a frame old, and is led to at the largest speed.
            let expected_s = 0.04 + frame_s * (0.5 + 0.5 * 2.0 / FASTEST_RAD_S);
            assert!((mean_s - expected_s).abs() < 2e-3, "{mean_s}");
        }
    }

    #[test]
    fn what_is_no_number_is_no_target() {
        let mut path = HandPath::at(0.5);
        for target in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            path.turn_to(target);
            path.advance();
        }
        assert_eq!((path.angle_rad(), path.omega_rad_s()), (0.5, 0.0));
    }
}
