//! The leg of a page: leg and foot about the knee, with the hand's arm while it is held.
//!
//! ```text
//! J·Ω̇ = hand + swing − resistance of the knee − B·Ω       held; swing = clamp(J·Ω̇_hand, ±limit)
//! J·Ω̇ = W·cos φ − resistance − B·Ω                        let go, sitting: it hangs at 90°
//! ```
//!
//! A person who moves a leg knows its weight and its inertia, and lifts and swings it accordingly, as the plant's
//! guiding hand does: the lag of a leg is what resists it.
//!
//! The numbers are those of the plant's `limb` at its defaults, of a person of 70 kg and 1.75 m; the ends are
//! the stops of a brace. Muscles and ligaments have no moment of their own here: what resists is what the
//! knee renders.

use crate::hand::{Hand, HandPath};
use crepitus_model::Real;
use crepitus_model::control::device_limits::RangeSettings;
use crepitus_protocol::TICK_S;

/// Inertia of leg and foot about the knee, kg·m².
pub const LIMB_KG_M2: f64 = 0.4275;

/// Torque of the weight on a leg that is held out, N·m.
pub const WEIGHT_NM: f64 = 10.92;

/// Damping of a healthy knee, N·m·s/rad.
pub const DAMPING_NMS_PER_RAD: f64 = 0.2;

/// A leg between two stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    angle_rad: f64,
    omega_rad_s: f64,
    /// Stops in extension and in flexion.
    stops_rad: [f64; 2],
}

impl Leg {
    /// A leg at rest, straight, in a brace with this range of motion: its stops are a fade beyond.
    pub fn straight(range: &RangeSettings) -> Self {
        Self {
            angle_rad: 0.0,
            omega_rad_s: 0.0,
            stops_rad: [
                (range.least_deg - range.fade_deg).to_radians(),
                (range.most_deg + range.fade_deg).to_radians(),
            ],
        }
    }

    /// One tick, with the resistance of the knee, N·m. The hand that holds the leg, if one does, moves on.
    pub fn step(&mut self, resistance_nm: f64, hand: Option<&mut HandPath>) {
        let (moved_nm, inertia_kg_m2) = match hand {
            Some(hand) => self.held(hand),
            None => (WEIGHT_NM * Real::sin_cos(self.angle_rad).1, LIMB_KG_M2),
        };
        let torque_nm = moved_nm - resistance_nm - DAMPING_NMS_PER_RAD * self.omega_rad_s;
        let before_rad_s = self.omega_rad_s;
        self.omega_rad_s += TICK_S * torque_nm / inertia_kg_m2;
        self.angle_rad += 0.5 * TICK_S * (before_rad_s + self.omega_rad_s);
        let [least_rad, most_rad] = self.stops_rad;
        if self.angle_rad < least_rad {
            (self.angle_rad, self.omega_rad_s) = (least_rad, self.omega_rad_s.at_least(0.0));
        } else if self.angle_rad > most_rad {
            (self.angle_rad, self.omega_rad_s) = (most_rad, self.omega_rad_s.at_most(0.0));
        }
    }

    /// Torque of a hand that moves on, N·m, and the inertia of leg and arm, kg·m².
    fn held(&self, hand: &mut HandPath) -> (f64, f64) {
        let law = Hand::default();
        let before = hand.state();
        let now = hand.advance(TICK_S);
        let pull_nm = law.torque_nm(
            now.angle_rad - self.angle_rad,
            now.omega_rad_s - self.omega_rad_s,
        );
        let inertia_kg_m2 = LIMB_KG_M2 + law.inertia_kg_m2;
        let swing_rad_s2 = (now.omega_rad_s - before.omega_rad_s) / TICK_S;
        let swing_nm = (inertia_kg_m2 * swing_rad_s2).within(law.limit_nm);
        (pull_nm + swing_nm, inertia_kg_m2)
    }

    /// Flexion of the knee, rad.
    pub fn angle_rad(&self) -> f64 {
        self.angle_rad
    }

    /// Velocity, rad/s.
    pub fn omega_rad_s(&self) -> f64 {
        self.omega_rad_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::HandState;

    fn leg() -> Leg {
        Leg::straight(&RangeSettings::default())
    }

    fn hand() -> HandPath {
        HandPath::taking(HandState::default())
    }

    #[test]
    fn a_hand_at_rest_lags_by_what_resists() {
        for resistance_nm in [0.0, 3.0, -4.5] {
            let (mut leg, mut hand) = (leg(), hand());
            hand.aim(0.5);
            for _ in 0..80_000 {
                leg.step(resistance_nm, Some(&mut hand));
            }
            let lag_rad = hand.state().angle_rad - leg.angle_rad();
            let expected_rad = resistance_nm / Hand::default().stiffness_nm_per_rad;
            assert!((lag_rad - expected_rad).abs() < 1e-9, "{lag_rad}");
            assert!(leg.omega_rad_s().abs() < 1e-9);
        }
    }

    #[test]
    fn a_leg_that_is_let_go_swings_to_90_degrees_and_gains_no_energy() {
        let mut leg = leg();
        let energy_j = |leg: &Leg| {
            0.5 * LIMB_KG_M2 * leg.omega_rad_s * leg.omega_rad_s - WEIGHT_NM * leg.angle_rad.sin()
        };
        let mut before_j = energy_j(&leg);
        let mut farthest_rad = 0.0_f64;
        for _ in 0..600_000 {
            leg.step(0.0, None);
            assert!(energy_j(&leg) <= before_j + 1e-9);
            before_j = energy_j(&leg);
            farthest_rad = farthest_rad.max(leg.angle_rad);
        }
        assert!(farthest_rad > 2.0, "it swings beyond: {farthest_rad}");
        let off_deg = leg.angle_rad.to_degrees() - 90.0;
        assert!(off_deg.abs() < 0.2, "{off_deg}");
    }

    #[test]
    fn stops_end_every_motion() {
        for target_rad in [-2.0, 4.0] {
            let (mut leg, mut hand) = (leg(), hand());
            hand.aim(target_rad);
            for _ in 0..40_000 {
                leg.step(0.0, Some(&mut hand));
                let deg = leg.angle_rad.to_degrees();
                assert!((-10.0 - 1e-9..=130.0 + 1e-9).contains(&deg), "{deg}");
            }
            assert_eq!(leg.omega_rad_s, 0.0);
        }
    }

    /// A path at its largest speed, thrown and turned: a brace would not let go.
    #[test]
    fn a_thrown_leg_is_no_faster_than_a_brace_allows() {
        let (mut leg, mut hand) = (leg(), hand());
        let mut fastest_deg_s = 0.0_f64;
        for stroke in 0..8 {
            hand.aim(if stroke % 2 == 0 { 2.1 } else { 0.0 });
            for _ in 0..10_000 {
                leg.step(0.0, Some(&mut hand));
                fastest_deg_s = fastest_deg_s.max(leg.omega_rad_s.to_degrees().abs());
            }
        }
        assert!((250.0..328.0).contains(&fastest_deg_s), "{fastest_deg_s}");
    }
}
