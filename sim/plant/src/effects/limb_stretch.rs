//! `limb-stretch`: a shank that shifts along its length as the knee bends, on an
//! oval cam. **Simulator only: the brace has no actuator along the shank.**
//!
//! Takahashi's oval cam has the semi-axes a, along the shank of a straight knee, and
//! b, of one bent by 90°. It keeps the shank at the distance h from the axis, and a
//! pull F along the shank, away from the knee, does work where h changes:
//!
//! ```text
//! h(φ) = √(a²·cos²φ + b²·sin²φ)
//! T = −F·dh/dφ = F·(a² − b²)·sin φ·cos φ/h        T > 0 opposes growing φ
//! ```
//!
//! The effect stores −F·h and loses nothing. 60 and 48 mm and 20 N are 0.24 N·m at 45°, 12 mm
//! of stretch; they are estimates.
//!
//! The mass that moves along is that of `limb`, at its usual place: of its 0.43 kg·m²
//! the movement itself would be less than 1e-3 kg·m², and the 12 mm change its weight
//! by up to 0.5 N·m.

use crate::chain::{Body, Push, Step, Weight};
use crate::effect::{Effect, Need, Part, numbers, parameters};
use crate::energy_balance::{Account, EnergyBalance};
use crate::load::{Load, Loaded};

const NAME: &str = "limb-stretch";

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "an oval cam that shifts the shank along its length; the brace has no actuator for it, a simulator only",
    states: &[],
    parameters: parameters! {
        pull_n "F" "N", -200.0..=200.0, 20.0, "pull along the shank, away from the knee (estimate)";
        straight_radius_m "a" "m", 5e-3..=0.2, 0.06, "semi-axis of the cam along the shank at 0 deg (estimate)";
        bent_radius_m "b" "m", 5e-3..=0.2, 0.048, "semi-axis of the cam along the shank at 90 deg (estimate)";
    },
    choices: &[],
    needs: &[Need {
        effect: "limb",
        why: "it is the shank that is stretched",
    }],
    part: Part::Link(|given, _, left| {
        let [pull_n, straight_m, bent_m] = numbers(given);
        let (straight, bent) = (straight_m * straight_m, bent_m * bent_m);
        let cam = Cam {
            pull_n,
            mean_m2: f64::midpoint(straight, bent),
            oval_m2: 0.5 * (straight - bent),
        };
        Loaded::on(left, cam)
    }),
};

/// The cam: h² = m + d·cos 2φ.
#[derive(Clone, Copy, Debug)]
struct Cam {
    pull_n: f64,
    /// m, m².
    mean_m2: f64,
    /// d, m².
    oval_m2: f64,
}

impl Cam {
    /// h, m.
    fn distance_m(&self, angle_rad: f64) -> f64 {
        (self.mean_m2 + self.oval_m2 * (2.0 * angle_rad).cos()).sqrt()
    }

    /// Torque on the leg toward growing φ, F·h′, N·m; its slope F·h″, N·m/rad, and
    /// its bend F·h‴, N·m/rad²; from three derivatives of h².
    fn expand(&self, angle_rad: f64) -> [f64; 3] {
        let (sin, cos) = (2.0 * angle_rad).sin_cos();
        let h = (self.mean_m2 + self.oval_m2 * cos).sqrt();
        let first = -self.oval_m2 * sin / h;
        let second = (-2.0 * self.oval_m2 * cos - first * first) / h;
        let third = (4.0 * self.oval_m2 * sin - 3.0 * first * second) / h;
        [first, second, third].map(|derivative| self.pull_n * derivative)
    }
}

impl Load for Cam {
    const NAME: &'static str = NAME;
    const COLUMN: &'static str = "limb_stretch_nm";
    const MORE: &'static [&'static str] = &["limb_stretch_m"];

    fn inertia_kg_m2(&self) -> f64 {
        0.0
    }

    fn pull(&self, step: &Step, body: &Body) -> Push {
        let [torque, slope, bend] = self.expand(body.angle_rad);
        let way_rad = step.length_s * body.omega_rad_s;
        Push {
            torque_nm: torque + bend * way_rad * way_rad / 6.0,
            slope_nms: -0.5 * step.length_s * slope,
            held_by_nm: None,
        }
    }

    fn moved(&mut self, _: &Step, _: &Body, _: f64) {}

    /// A hand that carries the leg carries this, too.
    fn weight(&self) -> Option<Weight> {
        let cam = *self;
        Some(Box::new(move |angle| cam.expand(angle)[0]))
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        let stored_j = -self.pull_n * self.distance_m(body.angle_rad);
        balance.add(NAME, "pull", Account::Stored, stored_j);
    }

    /// h.
    fn write_more(&self, body: &Body, row: &mut Vec<f64>) {
        row.push(self.distance_m(body.angle_rad));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cam(straight_m: f64, bent_m: f64) -> Cam {
        let (straight, bent) = (straight_m * straight_m, bent_m * bent_m);
        Cam {
            pull_n: 20.0,
            mean_m2: f64::midpoint(straight, bent),
            oval_m2: 0.5 * (straight - bent),
        }
    }

    #[test]
    fn the_distance_and_the_torque_are_those_of_the_oval() {
        let (a, b) = (0.06_f64, 0.048_f64);
        let cam = cam(a, b);
        for deg in [-30.0_f64, 0.0, 10.0, 45.0, 90.0, 130.0, 200.0] {
            let (sin, cos) = deg.to_radians().sin_cos();
            let h = (a * a * cos * cos + b * b * sin * sin).sqrt();
            assert!((cam.distance_m(deg.to_radians()) - h).abs() < 1e-16);
            let opposes_nm = 20.0 * (a * a - b * b) * sin * cos / h;
            let found = cam.expand(deg.to_radians())[0];
            assert!((found + opposes_nm).abs() < 1e-15, "{deg}: {found}");
        }
        let at_45 = -cam.expand(45.0_f64.to_radians())[0];
        assert!((at_45 - 0.24).abs() < 0.002, "{at_45}");
    }

    #[test]
    fn slope_and_bend_are_its_derivatives() {
        let cam = cam(0.06, 0.02);
        for n in -40..40 {
            let at = 0.1 * f64::from(n);
            let (low, high, here) = (cam.expand(at - 1e-5), cam.expand(at + 1e-5), cam.expand(at));
            for i in [0, 1] {
                let found = (high[i] - low[i]) / 2e-5;
                assert!((found - here[i + 1]).abs() < 1e-7, "{found} at {at}");
            }
        }
    }
}
