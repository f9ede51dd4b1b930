//! `limb`: leg and foot about the knee: inertia, weight, passive moment.
//!
//! ```text
//! J·Ω̇ = weight(φ) + M(φ) − B·Ω + what the chain and the hand do
//! ```
//!
//! φ is the flexion of the knee, 0 in extension; torques that flex are
//! positive. Mass and inertia of leg and foot follow from body mass m and
//! height (Winter, after Dempster): 0.061·m; shank length L = 0.246·height,
//! centre of mass at 0.606·L, radius of gyration about the knee 0.735·L. For
//! 70 kg and 1.75 m: 4.27 kg, 0.428 kg·m², 10.9 N·m horizontal.
//!
//! The posture says where the thigh points, and with it how gravity pulls and
//! how far the hip is bent:
//!
//! | posture | weight | hip |
//! |---|---|---|
//! | `sitting` | m·g·l·cos φ: pulls into flexion, hangs at 90° | 90° |
//! | `standing` | −m·g·l·sin φ | 0° |
//! | `prone` | −m·g·l·cos φ: pulls into extension | 0° |
//! | `supine`, thigh upright | m·g·l·sin φ | 90° |
//!
//! The passive moment of muscles and ligaments is that of Riener and Edrich
//! (1999), in N·m with angles in degrees, ankle at 0:
//!
//! ```text
//! M = e^(1.800 − 0.0460·A − 0.0352·K + 0.0217·H) − e^(−3.971 − 0.0004·A + 0.0495·K − 0.0128·H)
//!     − 4.820 + e^(2.220 − 0.150·K)
//! ```
//!
//! Beyond −20° to 160° it continues as a straight line. Damping is 0.2 N·m·s/rad
//! (0.19 to 0.22, fitted to recorded pendulum tests of healthy people).
//!
//! A step uses the torque's mean over its way by the first three terms about
//! its start, the third with the velocity there: what a step gets wrong in
//! energy is of the fourth order of its length. Sine, cosine and exponentials are computed at an
//! anchor, and near it the torque is a series about that.

mod anchored;
mod passive;

pub use passive::Passive;

use crate::chain::{Body, Push, Step, Weight};
use crate::effect::{Effect, Given, Part, numbers, parameters};
use crate::energy_balance::{Account, EnergyBalance};
use crate::load::{Load, Loaded};
use anchored::{Anchored, Series};
use crepitus_model::parameters::Choice;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "leg and foot: inertia, weight for a posture, passive moment and damping of the knee",
    states: &["leg angle", "leg velocity"],
    parameters: parameters! {
        body_mass_kg "m" "kg", 1.0..=500.0, 70.0, "mass of the whole body, from which that of leg and foot follows";
        height_m "H" "m", 0.3..=3.0, 1.75, "height of the body, from which the length of the shank follows";
        damping_nms_per_rad "B" "N·m·s/rad", 0.0..=100.0, 0.2, "damping of the knee about any angle";
    },
    choices: &[
        Choice {
            key: "posture",
            names: &["sitting", "standing", "prone", "supine"],
            default: 0,
            meaning: "where the thigh points: how gravity pulls, and how far the hip is bent",
        },
        Choice {
            key: "passive",
            names: &["riener-edrich", "none"],
            default: 0,
            meaning: "passive moment of muscles and ligaments",
        },
    ],
    needs: &[],
    part: Part::Link(|given, _, left| {
        let [body_mass_kg, height_m, damping] = numbers(given);
        let shank_m = 0.246 * height_m;
        let mass_kg = 0.061 * body_mass_kg;
        let radius_m = 0.735 * shank_m;
        let pendulum = Pendulum {
            weight_nm: mass_kg * STANDARD_GRAVITY * 0.606 * shank_m,
            turned_rad: posture(given.choices[0]).0.to_radians(),
        };
        let inertia_kg_m2 = mass_kg * radius_m * radius_m;
        match given.choices[1] {
            0 => {
                let passive = Passive::for_hip_deg(posture(given.choices[0]).1);
                let torque = (pendulum, passive);
                Loaded::on(left, Limb::new(inertia_kg_m2, damping, torque))
            }
            _ => Loaded::on(left, Limb::new(inertia_kg_m2, damping, pendulum)),
        }
    }),
};

const NAME: &str = "limb";

/// Standard gravity, m/s².
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// Angle to add to φ so that weight on a leg like `given` is a cosine, rad.
pub fn gravity_rad(given: &Given) -> f64 {
    posture(given.choices[0]).0.to_radians()
}

/// Angle to add to φ so that weight is a cosine, and flexion of the hip, deg.
fn posture(choice: u8) -> (f64, f64) {
    match choice {
        0 => (0.0, 90.0),
        1 => (90.0, 0.0),
        2 => (180.0, 0.0),
        _ => (-90.0, 90.0),
    }
}

/// A torque that depends on the angle alone.
trait AngleTorque: Copy + Send + 'static {
    /// Torque, N·m, its slope, N·m/rad, and its bend, N·m/rad².
    fn expand(&self, angle_rad: f64) -> [f64; 3];
    /// The torque's series about an angle within its range.
    fn series(&self, angle_rad: f64) -> Series;
    /// The energy that it stores, J.
    fn energy(&self, angle_rad: f64, balance: &mut EnergyBalance);
    /// The angles that it is known for, rad.
    fn range_rad(&self) -> (f64, f64);
}

/// The leg's weight.
#[derive(Clone, Copy, Debug)]
struct Pendulum {
    weight_nm: f64,
    turned_rad: f64,
}

impl AngleTorque for Pendulum {
    #[inline]
    fn expand(&self, angle_rad: f64) -> [f64; 3] {
        let (sin, cos) = (angle_rad + self.turned_rad).sin_cos();
        let (torque, slope) = (self.weight_nm * cos, -self.weight_nm * sin);
        [torque, slope, -torque]
    }

    fn series(&self, angle_rad: f64) -> Series {
        let (sin, cos) = (angle_rad + self.turned_rad).sin_cos();
        let mut share = self.weight_nm;
        std::array::from_fn(|k| {
            let derivative = [cos, -sin, -cos, sin][k % 4];
            anchored::term(k, &mut share, 1.0) * derivative
        })
    }

    fn energy(&self, angle_rad: f64, balance: &mut EnergyBalance) {
        let height_j = -self.weight_nm * (angle_rad + self.turned_rad).sin();
        balance.add(NAME, "weight", Account::Stored, height_j);
    }

    fn range_rad(&self) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }
}

impl<A: AngleTorque, B: AngleTorque> AngleTorque for (A, B) {
    #[inline]
    fn expand(&self, angle_rad: f64) -> [f64; 3] {
        let (a, b) = (self.0.expand(angle_rad), self.1.expand(angle_rad));
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
    }

    fn series(&self, angle_rad: f64) -> Series {
        let (a, b) = (self.0.series(angle_rad), self.1.series(angle_rad));
        std::array::from_fn(|k| a[k] + b[k])
    }

    fn energy(&self, angle_rad: f64, balance: &mut EnergyBalance) {
        self.0.energy(angle_rad, balance);
        self.1.energy(angle_rad, balance);
    }

    fn range_rad(&self) -> (f64, f64) {
        let (a, b) = (self.0.range_rad(), self.1.range_rad());
        (a.0.max(b.0), a.1.min(b.1))
    }
}

/// Leg and foot, with what pulls at them.
#[derive(Clone)]
struct Limb<T> {
    inertia_kg_m2: f64,
    damping: f64,
    torque: Anchored<T>,
    lost_j: f64,
    /// The knee has left the range of the published data.
    outside: bool,
}

impl<T: AngleTorque> Limb<T> {
    fn new(inertia_kg_m2: f64, damping: f64, torque: T) -> Self {
        Self {
            inertia_kg_m2,
            damping,
            torque: Anchored::new(torque),
            lost_j: 0.0,
            outside: false,
        }
    }
}

impl<T: AngleTorque> Load for Limb<T> {
    const NAME: &'static str = NAME;
    const COLUMN: &'static str = "limb_torque_nm";

    fn inertia_kg_m2(&self) -> f64 {
        self.inertia_kg_m2
    }

    fn pull(&self, step: &Step, body: &Body) -> Push {
        let [torque, slope, bend] = self.torque.expand(body.angle_rad);
        let way_rad = step.length_s * body.omega_rad_s;
        Push {
            torque_nm: torque + bend * way_rad * way_rad / 6.0,
            slope_nms: self.damping - 0.5 * step.length_s * slope,
            held_by_nm: None,
        }
    }

    fn moved(&mut self, step: &Step, next: &Body, mean_rad_s: f64) {
        self.lost_j += self.damping * mean_rad_s * mean_rad_s * step.length_s;
        let (low, high) = self.torque.range_rad();
        self.outside |= !(low..=high).contains(&next.angle_rad);
    }

    fn weight(&self) -> Option<Weight> {
        let torque = Anchored::new(*self.torque.of());
        Some(Box::new(move |angle| torque.expand(angle)[0]))
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        self.torque.of().energy(body.angle_rad, balance);
        balance.add(NAME, "damping", Account::Lost, self.lost_j);
    }

    fn warnings(&self, warnings: &mut Vec<String>) {
        if self.outside {
            let (low, high) = Passive::RANGE_DEG;
            warnings.push(format!(
                "the knee leaves {low}° to {high}°, beyond which nothing is known of its passive moment: \
                 a straight line goes on from there"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_segment_table_is_that_of_winter() {
        let given = crate::effect::Given::defaults(&EFFECT);
        let [mass, height, _] = numbers(&given);
        let shank: f64 = 0.246 * height;
        assert!((0.061 * mass - 4.27_f64).abs() < 1e-9);
        assert!((0.061 * mass * (0.735 * shank).powi(2) - 0.428_f64).abs() < 1e-3);
        assert!((0.061 * mass * STANDARD_GRAVITY * 0.606 * shank - 10.9_f64).abs() < 0.05);
    }
}
