//! `cuff`: the brace on a leg that is not bone.
//!
//! ```text
//! torque on the leg = k·(φ_brace − φ_leg) + b·(Ω_brace − Ω_leg)
//! ```
//!
//! | number | default | source |
//! |---|---|---|
//! | stiffness | 120 N·m/rad | estimate: 3 N/mm of a cuff at 0.2 m; plausible 60 (two in series) to 300 |
//! | damping | 1 N·m·s/rad | estimate, 0.5 to 2 |
//! | brace inertia | 0.01 kg·m² | estimate: 0.25 kg at 0.2 m |
//!
//! With the drivetrain's 0.061 kg·m² on its left it is a low-pass at 7 Hz for
//! what is rendered: crepitus at 31.8 Hz and the tibia's 115 Hz reach the leg
//! through its tail. The brace turns about the knee's axis only; it cannot
//! pull the shank along its length.

use crate::chain::{Body, Chain, Flow, Impacts, Push, Settled, Step, Verdict, Weight};
use crate::effect::{Effect, Part, numbers};
use crate::energy_balance::{Account, EnergyBalance};
use crepitus_model::parameters::ParameterSpec;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "the compliance between brace and leg: straps, padding and soft tissue",
    states: &["brace angle", "brace velocity"],
    parameters: &[
        ParameterSpec {
            key: "stiffness_nm_per_rad",
            symbol: "k",
            unit: "N·m/rad",
            min: 0.1,
            max: 1e6,
            default: 120.0,
            meaning: "stiffness of the cuffs about the knee",
        },
        ParameterSpec {
            key: "damping_nms_per_rad",
            symbol: "b",
            unit: "N·m·s/rad",
            min: 0.0,
            max: 1e3,
            default: 1.0,
            meaning: "damping of the cuffs about the knee",
        },
        ParameterSpec {
            key: "brace_inertia_kg_m2",
            symbol: "J_b",
            unit: "kg·m²",
            min: 1e-5,
            max: 10.0,
            default: 0.01,
            meaning: "inertia of the brace about the knee",
        },
    ],
    choices: &[],
    needs: &[],
    part: Part::Link(|given, context, left| {
        let [stiffness, damping, inertia_kg_m2] = numbers(given);
        Box::new(Cuff {
            left,
            stiffness,
            damping,
            inertia_kg_m2,
            brace: context.start,
            push: Push::default(),
            torque_nm: 0.0,
            lost_j: 0.0,
            leg_kg_m2: f64::INFINITY,
            longest_s: 0.0,
        })
    }),
};

const NAME: &str = "cuff";

struct Cuff {
    left: Box<dyn Chain>,
    stiffness: f64,
    damping: f64,
    inertia_kg_m2: f64,
    brace: Body,
    /// What acts on the brace but for the cuff, as last folded.
    push: Push,
    /// Torque on the leg in the last step.
    torque_nm: f64,
    lost_j: f64,
    /// Inertia that moves rigidly with the leg, kg·m²; infinite where the
    /// motion is prescribed.
    leg_kg_m2: f64,
    /// The longest step so far, s.
    longest_s: f64,
}

/// Above this ωh the swing of brace against leg runs away from the true one: the
/// midpoint rule's frequency is off by (ωh)²/12, and at a damping ratio of a
/// hundredth that adds up to a tenth of a radian before the swing has decayed.
const MOST_RADIANS: f64 = 0.1;

/// Above this bh/J the damper's decay changes its sign at every step.
const MOST_DECAY: f64 = 2.0;

impl Cuff {
    /// ωh and bh/J of the brace alone against the leg, in the longest step.
    fn rates_per_step(&self) -> (f64, f64) {
        let mobility = 1.0 / self.inertia_kg_m2 + 1.0 / self.leg_kg_m2;
        (
            (self.stiffness * mobility).sqrt() * self.longest_s,
            self.damping * mobility * self.longest_s,
        )
    }

    /// The cuff's torque on the leg at mid-step is this plus
    /// `slope`·(brace − leg).
    fn spring(&self, step: &Step, leg: &Body) -> (f64, f64) {
        (
            self.stiffness * (self.brace.angle_rad - leg.angle_rad),
            0.5 * self.stiffness * step.length_s + self.damping,
        )
    }

    /// The brace's mean velocity, from that of the leg.
    fn brace_mean(&self, step: &Step, leg: &Body, leg_mean: f64) -> f64 {
        let (elastic, slope) = self.spring(step, leg);
        match self.push.held_by_nm {
            Some(_) => 0.0,
            None => {
                (self.push.torque_nm - elastic + slope * leg_mean) / (self.push.slope_nms + slope)
            }
        }
    }

    /// Action of the parts to the left on the brace.
    fn left_flow(&self, step: &Step, leg: &Body, flow: Flow) -> Flow {
        let mean = self.brace_mean(step, leg, flow.omega_rad_s);
        let own = step.inertial_slope(self.inertia_kg_m2) * (self.brace.omega_rad_s - mean);
        let (elastic, slope) = self.spring(step, leg);
        Flow {
            omega_rad_s: mean,
            torque_nm: elastic + slope * (mean - flow.omega_rad_s) - own,
        }
    }
}

impl Chain for Cuff {
    fn fold(&mut self, step: &Step, body: &Body) -> Push {
        self.push =
            self.left
                .fold(step, &self.brace)
                .with_inertia(self.inertia_kg_m2, step, &self.brace);
        let (elastic, slope) = self.spring(step, body);
        if self.push.held_by_nm.is_some() {
            return Push {
                torque_nm: elastic,
                slope_nms: slope,
                held_by_nm: None,
            };
        }
        let share = slope / (self.push.slope_nms + slope);
        Push {
            torque_nm: elastic + share * (self.push.torque_nm - elastic),
            slope_nms: share * self.push.slope_nms,
            held_by_nm: None,
        }
    }

    fn shaft_mean_rad_s(&self, step: &Step, body: &Body, flow: Flow) -> f64 {
        let left = self.left_flow(step, body, flow);
        self.left.shaft_mean_rad_s(step, &self.brace, left)
    }

    fn check(&mut self, step: &Step, body: &Body, flow: Flow) -> Verdict {
        let left = self.left_flow(step, body, flow);
        self.left.check(step, &self.brace, left)
    }

    fn settle(
        &mut self,
        step: &Step,
        body: &Body,
        _: &mut Body,
        flow: Flow,
        ends_at: Option<f64>,
    ) -> Settled {
        let left = self.left_flow(step, body, flow);
        let slip = left.omega_rad_s - flow.omega_rad_s;
        let (elastic, slope) = self.spring(step, body);
        self.torque_nm = elastic + slope * slip;
        self.lost_j += self.damping * slip * slip * step.length_s;
        self.longest_s = self.longest_s.max(step.length_s);
        let mut next = self.brace.after(step.length_s, left.omega_rad_s);
        let settled = self
            .left
            .settle(step, &self.brace, &mut next, left, ends_at);
        self.brace = next;
        Settled {
            // The cuff is compliant: the leg does not move at once.
            struck_rad_s: 0.0,
            ..settled
        }
    }

    fn shaft(&self, _: &Body) -> Body {
        self.left.shaft(&self.brace)
    }

    fn is_rigid(&self) -> bool {
        false
    }

    fn inertia_kg_m2(&self) -> f64 {
        0.0
    }

    fn attach(&mut self, right_kg_m2: f64) {
        self.leg_kg_m2 = right_kg_m2;
        self.left.attach(self.inertia_kg_m2);
    }

    fn jerk(&mut self, _: &Body, _: f64) {}

    fn weight(&self) -> Option<Weight> {
        self.left.weight()
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        self.left.energy(&self.brace, balance);
        let turned = self.brace.angle_rad - body.angle_rad;
        let speed = self.brace.omega_rad_s;
        balance.add(
            NAME,
            "brace",
            Account::Stored,
            0.5 * self.inertia_kg_m2 * speed * speed,
        );
        balance.add(
            NAME,
            "elastic",
            Account::Stored,
            0.5 * self.stiffness * turned * turned,
        );
        balance.add(NAME, "damping", Account::Lost, self.lost_j);
    }

    fn columns(&self, names: &mut Vec<&'static str>) {
        self.left.columns(names);
        names.push("cuff_torque_nm");
    }

    fn write(&self, _: &Body, row: &mut Vec<f64>) {
        self.left.write(&self.brace, row);
        // As everywhere in a trace, what opposes growing angle is positive.
        row.push(-self.torque_nm);
    }

    fn impacts(&self) -> Option<Impacts> {
        self.left.impacts()
    }

    fn warnings(&self, warnings: &mut Vec<String>) {
        self.left.warnings(warnings);
        let (radians, decay) = self.rates_per_step();
        if radians > MOST_RADIANS || decay > MOST_DECAY {
            warnings.push(format!(
                "step long against the cuff: for a brace of {} kg·m² on {} N·m/rad and {} N·m·s/rad ω·h = {radians:.2} \
                 (at most {MOST_RADIANS}) and b·h/J = {decay:.2} (at most {MOST_DECAY}); torques at brace and leg are \
                 not those of such a cuff: choose more substeps, a softer cuff or a larger brace_inertia_kg_m2",
                self.inertia_kg_m2, self.stiffness, self.damping
            ));
        }
    }
}
