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
//! Beyond −20° to 160° it goes on as a straight line. Damping is 0.2 N·m·s/rad
//! (0.19 to 0.22, fitted to recorded pendulum tests of healthy people).
//!
//! A step uses the torque's mean over its way by the first three terms about
//! its start, the third with the velocity there: what a step gets wrong in
//! energy is of the fourth order of its length.

use crate::chain::{Body, Chain, Flow, Push, Settled, Step, Verdict};
use crate::effect::{ChoiceSpec, Effect, Part, numbers};
use crate::ledger::{Account, Ledger};
use crepitus_model::parameters::ParameterSpec;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "leg and foot: inertia, weight for a posture, passive moment and damping of the knee",
    states: &["leg angle", "leg velocity"],
    parameters: &[
        ParameterSpec {
            key: "body_mass_kg",
            symbol: "m",
            unit: "kg",
            min: 1.0,
            max: 500.0,
            default: 70.0,
            meaning: "mass of the whole body, from which that of leg and foot follows",
        },
        ParameterSpec {
            key: "height_m",
            symbol: "H",
            unit: "m",
            min: 0.3,
            max: 3.0,
            default: 1.75,
            meaning: "height of the body, from which the length of the shank follows",
        },
        ParameterSpec {
            key: "damping_nms_per_rad",
            symbol: "B",
            unit: "N·m·s/rad",
            min: 0.0,
            max: 100.0,
            default: 0.2,
            meaning: "damping of the knee about any angle",
        },
    ],
    choices: &[
        ChoiceSpec {
            key: "posture",
            names: &["sitting", "standing", "prone", "supine"],
            meaning: "where the thigh points: how gravity pulls, and how far the hip is bent",
        },
        ChoiceSpec {
            key: "passive",
            names: &["riener-edrich", "none"],
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
        let own = Own {
            inertia_kg_m2: mass_kg * radius_m * radius_m,
            damping,
            lost_j: 0.0,
            outside: false,
            pull: Push::default(),
            mean_nm: 0.0,
        };
        match given.choices[1] {
            0 => Box::new(Limb {
                left,
                own,
                torque: (pendulum, Passive::for_hip_deg(posture(given.choices[0]).1)),
            }),
            _ => Box::new(Limb {
                left,
                own,
                torque: pendulum,
            }),
        }
    }),
};

const NAME: &str = "limb";

/// m/s².
const STANDARD_GRAVITY: f64 = 9.806_65;

/// Angle to add to φ so that weight is a cosine, and flexion of the hip, deg.
fn posture(choice: usize) -> (f64, f64) {
    match choice {
        0 => (0.0, 90.0),
        1 => (90.0, 0.0),
        2 => (180.0, 0.0),
        _ => (-90.0, 90.0),
    }
}

/// A torque that depends on the angle alone.
trait AngleTorque: Copy + 'static {
    /// Torque, N·m, its slope, N·m/rad, and its bend, N·m/rad².
    fn expand(&self, angle_rad: f64) -> [f64; 3];
    /// The energy that it stores, J.
    fn book(&self, angle_rad: f64, ledger: &mut Ledger);
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

    fn book(&self, angle_rad: f64, ledger: &mut Ledger) {
        let height_j = -self.weight_nm * (angle_rad + self.turned_rad).sin();
        ledger.book(NAME, "weight", Account::Stored, height_j);
    }

    fn range_rad(&self) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }
}

/// The passive moment.
#[derive(Clone, Copy, Debug)]
pub struct Passive {
    /// N·m at 0°, and growth per degree, of the three exponentials.
    terms: [(f64, f64); 3],
}

impl Passive {
    /// Riener's and Edrich's constant term, N·m.
    const CONSTANT_NM: f64 = -4.820;
    /// Where it ends, deg.
    const RANGE_DEG: (f64, f64) = (-20.0, 160.0);

    /// For a hip bent by so much, and the ankle at 0°.
    pub fn for_hip_deg(hip_deg: f64) -> Self {
        Self {
            terms: [
                ((1.800 + 0.0217 * hip_deg).exp(), -0.0352),
                (-(-3.971 - 0.0128 * hip_deg).exp(), 0.0495),
                (2.220_f64.exp(), -0.150),
            ],
        }
    }

    /// The moment, N·m, at a flexion of the knee.
    pub fn moment_nm(&self, angle_rad: f64) -> f64 {
        self.expand(angle_rad)[0]
    }

    /// The energy that it stores, J, against that at 0°.
    pub fn stored_j(&self, angle_rad: f64) -> f64 {
        let (low, high) = Self::RANGE_DEG;
        let within_rad = angle_rad.clamp(low.to_radians(), high.to_radians());
        let deg = within_rad.to_degrees();
        let mut stored = -Self::CONSTANT_NM * within_rad;
        for (at_zero, growth) in self.terms {
            stored -= at_zero * (growth * deg).exp_m1() / growth.to_degrees();
        }
        let [moment, slope, _] = self.expand(within_rad);
        let beyond = angle_rad - within_rad;
        stored - moment * beyond - 0.5 * slope * beyond * beyond
    }
}

impl AngleTorque for Passive {
    #[inline]
    fn expand(&self, angle_rad: f64) -> [f64; 3] {
        let (low, high) = Self::RANGE_DEG;
        let deg = angle_rad.to_degrees();
        let within = deg.clamp(low, high);
        let (mut moment, mut slope, mut bend) = (Self::CONSTANT_NM, 0.0, 0.0);
        for (at_zero, growth) in self.terms {
            let term = at_zero * (growth * within).exp();
            moment += term;
            slope += growth * term;
            bend += growth * growth * term;
        }
        let per_rad = 1.0_f64.to_degrees();
        let beyond = deg - within;
        [
            moment + slope * beyond,
            slope * per_rad,
            if beyond == 0.0 {
                bend * per_rad * per_rad
            } else {
                0.0
            },
        ]
    }

    fn book(&self, angle_rad: f64, ledger: &mut Ledger) {
        ledger.book(NAME, "passive", Account::Stored, self.stored_j(angle_rad));
    }

    fn range_rad(&self) -> (f64, f64) {
        let (low, high) = Self::RANGE_DEG;
        (low.to_radians(), high.to_radians())
    }
}

impl<A: AngleTorque, B: AngleTorque> AngleTorque for (A, B) {
    #[inline]
    fn expand(&self, angle_rad: f64) -> [f64; 3] {
        let (a, b) = (self.0.expand(angle_rad), self.1.expand(angle_rad));
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
    }

    fn book(&self, angle_rad: f64, ledger: &mut Ledger) {
        self.0.book(angle_rad, ledger);
        self.1.book(angle_rad, ledger);
    }

    fn range_rad(&self) -> (f64, f64) {
        let (a, b) = (self.0.range_rad(), self.1.range_rad());
        (a.0.max(b.0), a.1.min(b.1))
    }
}

/// What a limb has whatever pulls at it.
struct Own {
    inertia_kg_m2: f64,
    damping: f64,
    lost_j: f64,
    /// The knee has been where nothing is known of it.
    outside: bool,
    /// What weight, passive moment and damping do, as last folded.
    pull: Push,
    /// Their torque in the last step.
    mean_nm: f64,
}

struct Limb<T> {
    left: Box<dyn Chain>,
    own: Own,
    torque: T,
}

impl<T: AngleTorque> Limb<T> {
    /// What weight, passive moment and damping do in a step.
    fn pull(&self, step: &Step, body: &Body) -> Push {
        let [torque, slope, bend] = self.torque.expand(body.angle_rad);
        let way_rad = step.length_s * body.omega_rad_s;
        Push {
            torque_nm: torque + bend * way_rad * way_rad / 6.0,
            slope_nms: self.own.damping - 0.5 * step.length_s * slope,
            held_by_nm: None,
        }
    }

    fn left_flow(&self, step: &Step, body: &Body, flow: Flow) -> Flow {
        let own = self
            .own
            .pull
            .with_inertia(self.own.inertia_kg_m2, step, body);
        Flow {
            torque_nm: flow.torque_nm - own.at(flow.omega_rad_s),
            ..flow
        }
    }
}

impl<T: AngleTorque> Chain for Limb<T> {
    fn fold(&mut self, step: &Step, body: &Body) -> Push {
        let left = self.left.fold(step, body);
        self.own.pull = self.pull(step, body);
        let own = self
            .own
            .pull
            .with_inertia(self.own.inertia_kg_m2, step, body);
        Push {
            torque_nm: left.torque_nm + own.torque_nm,
            slope_nms: left.slope_nms + own.slope_nms,
            held_by_nm: left.held_by_nm,
        }
    }

    fn check(&mut self, step: &Step, body: &Body, flow: Flow) -> Verdict {
        let left = self.left_flow(step, body, flow);
        self.left.check(step, body, left)
    }

    fn settle(
        &mut self,
        step: &Step,
        body: &Body,
        next: &mut Body,
        flow: Flow,
        ends_at: Option<f64>,
    ) -> Settled {
        let w = flow.omega_rad_s;
        self.own.mean_nm = self.own.pull.at(w);
        self.own.lost_j += self.own.damping * w * w * step.length_s;
        let (low, high) = self.torque.range_rad();
        self.own.outside |= !(low..=high).contains(&next.angle_rad);
        let left = self.left_flow(step, body, flow);
        self.left.settle(step, body, next, left, ends_at)
    }

    fn shaft(&self, body: &Body) -> Body {
        self.left.shaft(body)
    }

    fn is_rigid(&self) -> bool {
        self.left.is_rigid()
    }

    fn inertia_kg_m2(&self) -> f64 {
        self.own.inertia_kg_m2 + self.left.inertia_kg_m2()
    }

    fn attach(&mut self, right_kg_m2: f64) {
        self.left.attach(right_kg_m2 + self.own.inertia_kg_m2);
    }

    fn jerk(&mut self, body: &Body, change_rad_s: f64) {
        self.left.jerk(body, change_rad_s);
    }

    fn weight(&self) -> Option<Box<dyn Fn(f64) -> f64>> {
        let torque = self.torque;
        match self.left.weight() {
            None => Some(Box::new(move |angle| torque.expand(angle)[0])),
            Some(left) => Some(Box::new(move |angle| {
                left(angle) + torque.expand(angle)[0]
            })),
        }
    }

    fn book(&self, body: &Body, ledger: &mut Ledger) {
        self.left.book(body, ledger);
        let speed = body.omega_rad_s;
        ledger.book(
            NAME,
            "kinetic",
            Account::Stored,
            0.5 * self.own.inertia_kg_m2 * speed * speed,
        );
        self.torque.book(body.angle_rad, ledger);
        ledger.book(NAME, "damping", Account::Lost, self.own.lost_j);
    }

    fn columns(&self, names: &mut Vec<&'static str>) {
        self.left.columns(names);
        names.push("limb_torque_nm");
    }

    fn write(&self, body: &Body, row: &mut Vec<f64>) {
        self.left.write(body, row);
        // As everywhere in a trace, what opposes growing angle is positive.
        row.push(-self.own.mean_nm);
    }

    fn warnings(&self, warnings: &mut Vec<String>) {
        self.left.warnings(warnings);
        if self.own.outside {
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

    /// The table of the domain report: hip, and the moment at seven flexions.
    #[test]
    fn the_passive_moment_is_that_of_riener_and_edrich() {
        const KNEE_DEG: [f64; 8] = [0.0, 10.0, 20.0, 40.0, 60.0, 90.0, 120.0, 140.0];
        for (hip, moments) in [
            (0.0, [10.4, 1.5, -1.4, -3.5, -4.5, -6.2, -11.9, -24.1]),
            (30.0, [16.0, 5.4, 1.3, -2.1, -3.7, -5.4, -9.5, -17.9]),
            (90.0, [47.0, 27.2, 16.7, 5.6, 0.2, -3.5, -6.5, -10.6]),
        ] {
            let passive = Passive::for_hip_deg(hip);
            for (knee, moment) in KNEE_DEG.into_iter().zip(moments) {
                let found = passive.moment_nm(knee.to_radians());
                assert!((found - moment).abs() < 0.051, "{found} at {knee}, hip {hip}");
            }
        }
        for (hip, zero) in [(0.0_f64, 13.9_f64), (30.0, 25.8), (90.0, 61.2)] {
            let passive = Passive::for_hip_deg(hip);
            let at = |deg: f64| passive.moment_nm(deg.to_radians());
            assert!(at(zero - 0.1) > 0.0 && at(zero + 0.1) < 0.0, "hip {hip}");
        }
    }

    #[test]
    fn what_the_passive_moment_stores_is_its_integral() {
        let passive = Passive::for_hip_deg(30.0);
        let mut integral = 0.0;
        let (from, to, n) = (-0.8_f64, 3.2_f64, 40_000);
        let h = (to - from) / f64::from(n);
        for i in 0..n {
            let at = from + (f64::from(i) + 0.5) * h;
            integral -= h * passive.moment_nm(at);
            let (low, high) = (at - 1e-6, at + 1e-6);
            let (low, high, [_, slope, bend]) =
                (passive.expand(low), passive.expand(high), passive.expand(at));
            let differs = |i: usize, known: f64| {
                let found = (high[i] - low[i]) / 2e-6;
                (found - known).abs() > 1e-3 * (1.0 + known.abs())
            };
            assert!(!differs(0, slope) && !differs(1, bend), "at {at}");
        }
        let stored = passive.stored_j(to) - passive.stored_j(from);
        assert!((stored - integral).abs() < 1e-5 * integral.abs(), "{stored} {integral}");
        assert_eq!(passive.stored_j(0.0), 0.0);
    }

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
