//! The hand of a person who moves a leg on a screen.
//!
//! ```text
//! pointer, keys ── targets, 30 to 120 a second ──> HandPath ── φ_hand, Ω_hand ──> Hand ── torque ──> leg
//! ```
//!
//! **[Law](Hand)**: a spring and a damper from the leg to the hand, up to a limit.
//!
//! ```text
//! torque = clamp(k·(φ_hand − φ) + b·(Ω_hand − Ω), ±limit)
//! ```
//!
//! So a resistance shows as a lag of the leg: 1 N·m as 1.4°.
//!
//! | number | value | source |
//! |---|---|---|
//! | k | 40 N·m/rad | estimate: 327 N/m at 0.35 m, as a light grip; stiffer, one would not see the lag |
//! | b | 9 N·m·s/rad | estimate: a leg with hand and brace, 0.57 kg·m², does not ring |
//! | limit | 25 N·m | estimate: 71 N at 0.35 m, one arm; several times what a brace renders |
//! | inertia | 0.0679 kg·m² | the plant's arm: 0.554 kg at 0.35 m (Sci. Rep. srep18004, fig. 3) |
//!
//! **[Path](HandPath)**: each target is approached within a thirtieth of a second, at one speed and at most at
//! [`MOST_RAD_S`]; two equal lags round the corners. Behind a target that moves steadily the distance is then
//! the same whenever the next one comes, so the path is as steady: an uneven rate of a display does not
//! show. From a display that is slower, the path learns the longest time between two targets and approaches
//! them within that, up to [`LONGEST_APPROACH_S`]: a busy computer shows the leg later, but does not jerk it.
//! A longer pause is one of the hand. A path is always a mean of earlier targets, so it never goes beyond them.

/// Highest speed of a path, rad/s: 275 °/s. A leg that catches up is up to a seventh faster, and a device
/// lets go at 328 °/s.
pub const MOST_RAD_S: f64 = 4.8;

/// Time in which a target is approached, s: the interval of the slowest usual display.
pub const APPROACH_S: f64 = 1.0 / 30.0;

/// Longest such time, s: of a display that draws five pictures a second.
pub const LONGEST_APPROACH_S: f64 = 0.2;

/// Share of a learned time that is kept from target to target: half after 70 of them.
const KEPT: f64 = 0.99;

/// Time constant of each of the two lags, s.
pub const CORNER_S: f64 = 6e-3;

/// Law of a hand that holds a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hand {
    /// Stiffness k about the knee, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Damping b about the knee, N·m·s/rad.
    pub damping_nms_per_rad: f64,
    /// Largest torque of spring and damper, N·m.
    pub limit_nm: f64,
    /// Inertia of the arm, which moves with the leg, kg·m².
    pub inertia_kg_m2: f64,
}

impl Default for Hand {
    fn default() -> Self {
        Self {
            stiffness_nm_per_rad: 40.0,
            damping_nms_per_rad: 9.0,
            limit_nm: 25.0,
            inertia_kg_m2: 0.0679,
        }
    }
}

impl Hand {
    /// Torque on a leg that is behind the hand by this angle, rad, and by this speed, rad/s: N·m, in
    /// the direction of growing angle.
    pub fn torque_nm(&self, behind_rad: f64, slower_rad_s: f64) -> f64 {
        let torque_nm =
            self.stiffness_nm_per_rad * behind_rad + self.damping_nms_per_rad * slower_rad_s;
        torque_nm.max(-self.limit_nm).min(self.limit_nm)
    }
}

/// Angle and speed of a hand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandState {
    /// Angle, rad.
    pub angle_rad: f64,
    /// Speed, rad/s: the mean one of the last step.
    pub omega_rad_s: f64,
}

/// Path of a hand along the targets that a display sends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandPath {
    target_rad: f64,
    /// Time in which a target is approached, and since the last target, s.
    approach_s: f64,
    since_s: f64,
    /// Point that goes straight to the target, and its speed.
    goal_rad: f64,
    goal_rad_s: f64,
    /// The goal behind one lag, and behind both.
    first_rad: f64,
    angle_rad: f64,
}

impl HandPath {
    /// A hand that takes a leg here, at the speed that the leg has, and holds it.
    pub fn taking(leg: HandState) -> Self {
        let first_rad = leg.angle_rad + CORNER_S * leg.omega_rad_s;
        Self {
            target_rad: first_rad,
            approach_s: APPROACH_S,
            since_s: f64::INFINITY,
            goal_rad: first_rad,
            goal_rad_s: 0.0,
            first_rad,
            angle_rad: leg.angle_rad,
        }
    }

    /// Sets the angle to which the hand goes from now on, rad. One that is no number is ignored.
    pub fn aim(&mut self, target_rad: f64) {
        if !target_rad.is_finite() {
            return;
        }
        self.target_rad = target_rad;
        if self.since_s <= LONGEST_APPROACH_S {
            let kept_s = APPROACH_S.max(KEPT * self.approach_s);
            self.approach_s = kept_s.max(self.since_s);
        }
        self.since_s = 0.0;
        let speed = (target_rad - self.goal_rad) / self.approach_s;
        self.goal_rad_s = speed.clamp(-MOST_RAD_S, MOST_RAD_S);
    }

    /// Goes on for a step of `step_s`, s.
    pub fn advance(&mut self, step_s: f64) -> HandState {
        self.since_s += step_s;
        let left_rad = self.target_rad - self.goal_rad;
        let stride_rad = self.goal_rad_s * step_s;
        self.goal_rad = if stride_rad.abs() < left_rad.abs() {
            self.goal_rad + stride_rad
        } else {
            self.target_rad
        };
        let share = step_s / (CORNER_S + step_s);
        self.first_rad += share * (self.goal_rad - self.first_rad);
        self.angle_rad += share * (self.first_rad - self.angle_rad);
        self.state()
    }

    /// Angle and speed now.
    pub fn state(&self) -> HandState {
        HandState {
            angle_rad: self.angle_rad,
            omega_rad_s: (self.first_rad - self.angle_rad) / CORNER_S,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;
    use std::ops::RangeInclusive;

    const TICK_S: f64 = 5e-5;
    /// Ticks between two pictures at 120 and at 30 Hz.
    const FEWEST: u32 = 167;
    const MOST: u32 = 666;

    fn at(angle_rad: f64) -> HandPath {
        HandPath::taking(HandState {
            angle_rad,
            omega_rad_s: 0.0,
        })
    }

    #[test]
    fn the_law_is_a_spring_and_a_damper_up_to_a_limit() {
        let hand = Hand::default();
        assert_eq!(hand.torque_nm(0.1, 0.0), 4.0);
        assert_eq!(hand.torque_nm(0.1, -0.5), -0.5);
        assert_eq!(hand.torque_nm(3.0, 0.0), 25.0);
        assert_eq!(hand.torque_nm(0.0, -3.0), -25.0);
        // 1 N·m is 1.4° of lag.
        let lag_deg = (1.0 / hand.stiffness_nm_per_rad).to_degrees();
        assert!((lag_deg - 1.4).abs() < 0.05, "{lag_deg}");
    }

    #[test]
    fn a_hand_without_a_target_stays() {
        let mut path = at(0.7);
        for _ in 0..100 {
            assert_eq!(path.advance(TICK_S).angle_rad, 0.7);
        }
        path.aim(f64::NAN);
        path.aim(f64::INFINITY);
        assert_eq!(path.advance(TICK_S).angle_rad, 0.7);
    }

    #[test]
    fn a_step_is_gone_without_overshoot_at_the_highest_speed() {
        let mut path = at(0.2);
        path.aim(1.4);
        let (mut before, mut fastest) = (path.state(), 0.0_f64);
        for _ in 0..20_000 {
            let now = path.advance(TICK_S);
            assert!(now.omega_rad_s >= 0.0 && now.angle_rad <= 1.4, "{now:?}");
            assert!(now.angle_rad >= before.angle_rad);
            fastest = fastest.max(now.omega_rad_s);
            before = now;
        }
        assert!((before.angle_rad - 1.4).abs() < 1e-9, "{before:?}");
        assert!((fastest / MOST_RAD_S - 1.0).abs() < 1e-9, "{fastest}");
    }

    #[test]
    fn whatever_is_aimed_at_angle_and_speed_are_continuous_and_bounded() {
        let mut rng = Rng::with_seed(7);
        let mut path = at(0.0);
        let (mut before, mut low, mut high) = (path.state(), 0.0_f64, 0.0_f64);
        for _ in 0..400 {
            let target = 4.0 * rng.f64() - 2.0;
            (low, high) = (low.min(target), high.max(target));
            path.aim(target);
            for _ in 0..rng.u32(1..2_000) {
                let now = path.advance(TICK_S);
                let moved = now.angle_rad - before.angle_rad - TICK_S * now.omega_rad_s;
                assert!(moved.abs() < 1e-12, "{moved}");
                assert!(now.omega_rad_s.abs() <= MOST_RAD_S * (1.0 + 1e-9));
                // Both lags are fed with speeds up to the highest.
                let change = (now.omega_rad_s - before.omega_rad_s).abs();
                let most = 2.0 * MOST_RAD_S * TICK_S / CORNER_S;
                assert!(change <= most * (1.0 + 1e-9), "{change}");
                let within = low - 1e-12..=high + 1e-12;
                assert!(within.contains(&now.angle_rad), "{now:?}");
                before = now;
            }
        }
    }

    /// Lets a path follow a pointer of steady speed from 0 rad; returns the time that has passed, s.
    fn follow(path: &mut HandPath, rng: &mut Rng, speed: f64, ticks: u32) -> f64 {
        let (mut tick, mut next) = (0_u32, 0_u32);
        while tick < ticks {
            if tick == next {
                path.aim(speed * f64::from(tick) * TICK_S);
                next += rng.u32(FEWEST..=MOST);
            }
            path.advance(TICK_S);
            tick += 1;
        }
        f64::from(tick) * TICK_S
    }

    #[test]
    fn an_uneven_rate_of_30_to_120_pictures_a_second_does_not_show() {
        let mut rng = Rng::with_seed(11);
        for speed in [0.3, 1.0, -4.0] {
            let mut path = at(0.0);
            let mut time_s = follow(&mut path, &mut rng, speed, 30_000);
            let mut next = 0;
            for tick in 0..20_000 {
                if tick == next {
                    path.aim(speed * time_s);
                    next += rng.u32(FEWEST..=MOST);
                }
                let now = path.advance(TICK_S);
                time_s += TICK_S;
                let off = now.omega_rad_s / speed - 1.0;
                assert!(off.abs() < 1e-6, "{off} after {time_s} s");
                let lag_s = time_s - now.angle_rad / speed;
                let known = APPROACH_S + 2.0 * CORNER_S;
                assert!((lag_s - known).abs() < 1e-4, "{lag_s}");
            }
        }
    }

    /// Largest ratio of the path's speed to that of a steady pointer, of which a busy page sends a target every so many
    /// ticks.
    fn haste(rng: &mut Rng, gaps: RangeInclusive<u32>, speed: f64) -> f64 {
        let mut path = at(0.0);
        let (mut next, mut fastest) = (0, 0.0_f64);
        for tick in 0..60_000 {
            if tick == next {
                path.aim(speed * f64::from(tick) * TICK_S);
                next += rng.u32(gaps.clone());
            }
            let now = path.advance(TICK_S);
            // It learns for a second.
            if tick > 20_000 {
                fastest = fastest.max(now.omega_rad_s / speed);
            }
        }
        fastest
    }

    #[test]
    fn a_busy_page_makes_the_hand_late_and_no_faster() {
        let mut rng = Rng::with_seed(5);
        // 20 to 60 targets a second, and 6 to 30.
        for (gaps, most) in [(333..=1_000, 1.05), (666..=3_333, 1.15)] {
            let ratio = haste(&mut rng, gaps.clone(), 2.0);
            assert!(ratio < most, "{gaps:?}: {ratio}");
        }
    }

    #[test]
    fn a_pause_of_the_hand_is_none_of_the_page() {
        let mut path = at(0.0);
        for target in 1..40 {
            path.aim(0.1 * f64::from(target % 2));
            for _ in 0..12_000 {
                path.advance(TICK_S);
            }
        }
        assert_eq!(path.approach_s, APPROACH_S);
    }

    #[test]
    fn after_half_a_second_without_a_target_the_hand_stands_still_and_goes_on_smoothly() {
        let mut path = at(0.0);
        follow(&mut path, &mut Rng::with_seed(3), 2.0, 10_000);
        let last_rad = path.target_rad;
        let mut before = path.state();
        for _ in 0..10_000 {
            let now = path.advance(TICK_S);
            assert!(now.omega_rad_s >= -1e-9 && now.angle_rad <= last_rad + 1e-9);
            before = now;
        }
        assert!((before.angle_rad - last_rad).abs() < 1e-9);
        assert!(before.omega_rad_s.abs() < 1e-9);
        path.aim(last_rad + 1.0);
        for _ in 0..10_000 {
            let now = path.advance(TICK_S);
            assert!((now.omega_rad_s - before.omega_rad_s).abs() < 0.081);
            assert!((-1e-9..=MOST_RAD_S + 1e-9).contains(&now.omega_rad_s));
            before = now;
        }
        assert!((before.angle_rad - last_rad - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_leg_in_motion_is_taken_with_its_speed() {
        let leg = HandState {
            angle_rad: 0.5,
            omega_rad_s: -2.0,
        };
        let mut path = HandPath::taking(leg);
        let begun = path.state();
        assert!((begun.angle_rad - 0.5).abs() < 1e-12);
        assert!((begun.omega_rad_s + 2.0).abs() < 1e-9);
        for _ in 0..4_000 {
            path.advance(TICK_S);
        }
        // 12 mrad further: both lags have run out.
        assert!((path.state().angle_rad - 0.488).abs() < 1e-9);
    }
}
