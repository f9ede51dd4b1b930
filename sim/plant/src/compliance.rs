//! A spring and a damper between two bodies of the chain: a cuff, or a shell on its
//! seat.
//!
//! ```text
//! torque on the right end = k·(φ_left − φ_right) + b·(Ω_left − Ω_right)
//! ```

use crate::chain::{Body, Chain, Flow, Push, Settled, Step, Verdict};
use crate::energy_balance::{Account, EnergyBalance};

/// Description of a compliance, in words.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// The effect that it belongs to.
    pub effect: &'static str,
    /// The body at its left end.
    pub body: &'static str,
    /// Column of its torque.
    pub column: &'static str,
    /// Advice for the case that the step is long against it.
    pub advice: &'static str,
}

/// A chain that ends in a spring and a damper.
#[derive(Clone)]
pub struct Compliance {
    left: Box<dyn Chain>,
    kind: &'static Kind,
    stiffness: f64,
    damping: f64,
    /// Torque on the right end where both are at one angle, N·m.
    preload_nm: f64,
    /// Inertia of its own at the left end.
    inertia_kg_m2: f64,
    /// The body at the left end.
    inner: Body,
    /// Action on that body but for the spring, as last folded.
    push: Push,
    /// Torque on the right end in the last step.
    torque_nm: f64,
    lost_j: f64,
    /// Inertia that moves rigidly with the right end, kg·m²; infinite where the
    /// motion is prescribed.
    right_kg_m2: f64,
    /// The longest step so far, s.
    longest_s: f64,
}

/// Largest ωh. Above it the swing of one end against the other runs away from the true one: the
/// midpoint rule's frequency is off by (ωh)²/12, and at a damping ratio of a
/// hundredth that adds up to a tenth of a radian before the swing has decayed.
const MOST_RADIANS: f64 = 0.1;

/// Largest bh/J. Above it the damper's decay changes its sign at every step.
const MOST_DECAY: f64 = 2.0;

impl Compliance {
    /// Returns a compliance between the right end of `left`, which gets this inertia, and a body that begins
    /// where that does.
    pub fn new(
        left: Box<dyn Chain>,
        start: Body,
        kind: &'static Kind,
        stiffness: f64,
        damping: f64,
        inertia_kg_m2: f64,
    ) -> Self {
        Self {
            left,
            kind,
            stiffness,
            damping,
            preload_nm: 0.0,
            inertia_kg_m2,
            inner: start,
            push: Push::default(),
            torque_nm: 0.0,
            lost_j: 0.0,
            right_kg_m2: f64::INFINITY,
            longest_s: 0.0,
        }
    }

    /// Returns the compliance with a spring that carries this torque at the start, and is linear about it.
    #[must_use]
    pub fn carrying(self, preload_nm: f64) -> Self {
        Self { preload_nm, ..self }
    }

    /// Inertia that its spring moves at the left end: its own, if it has one.
    fn left_kg_m2(&self) -> f64 {
        if self.inertia_kg_m2 > 0.0 {
            self.inertia_kg_m2
        } else {
            self.left.inertia_kg_m2()
        }
    }

    /// ωh and bh/J of the left end alone against the right one, in the longest step.
    fn rates_per_step(&self) -> (f64, f64) {
        let mobility = 1.0 / self.left_kg_m2() + 1.0 / self.right_kg_m2;
        (
            (self.stiffness * mobility).sqrt() * self.longest_s,
            self.damping * mobility * self.longest_s,
        )
    }

    /// The torque on the right end at mid-step is this plus `slope`·(inner − outer).
    fn spring(&self, step: &Step, outer: &Body) -> (f64, f64) {
        (
            self.stiffness * (self.inner.angle_rad - outer.angle_rad) + self.preload_nm,
            0.5 * self.stiffness * step.length_s + self.damping,
        )
    }

    /// The inner body's mean velocity, from that of the outer one.
    fn inner_mean(&self, step: &Step, outer: &Body, outer_mean: f64) -> f64 {
        let (elastic, slope) = self.spring(step, outer);
        match self.push.held_by_nm {
            Some(_) => 0.0,
            None => {
                (self.push.torque_nm - elastic + slope * outer_mean) / (self.push.slope_nms + slope)
            }
        }
    }

    /// Action of the parts to the left on the inner body.
    fn left_flow(&self, step: &Step, outer: &Body, flow: Flow) -> Flow {
        let mean = self.inner_mean(step, outer, flow.omega_rad_s);
        let own = step.inertial_slope(self.inertia_kg_m2) * (self.inner.omega_rad_s - mean);
        let (elastic, slope) = self.spring(step, outer);
        Flow {
            omega_rad_s: mean,
            torque_nm: elastic + slope * (mean - flow.omega_rad_s) - own,
        }
    }
}

impl Chain for Compliance {
    fn left(&self) -> Option<&dyn Chain> {
        Some(&*self.left)
    }

    fn fold(&mut self, step: &Step, body: &Body) -> Push {
        self.push =
            self.left
                .fold(step, &self.inner)
                .with_inertia(self.inertia_kg_m2, step, &self.inner);
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
        self.left.shaft_mean_rad_s(step, &self.inner, left)
    }

    fn check(&mut self, step: &Step, body: &Body, flow: Flow) -> Verdict {
        let left = self.left_flow(step, body, flow);
        self.left.check(step, &self.inner, left)
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
        let mut next = self.inner.after(step.length_s, left.omega_rad_s);
        let settled = self
            .left
            .settle(step, &self.inner, &mut next, left, ends_at);
        self.inner = next;
        Settled {
            // A compliance gives way: the right end does not move at once.
            struck_rad_s: 0.0,
            ..settled
        }
    }

    fn shaft(&self, _: &Body) -> Body {
        self.left.shaft(&self.inner)
    }

    fn is_rigid(&self) -> bool {
        false
    }

    fn attach(&mut self, right_kg_m2: f64) {
        self.right_kg_m2 = right_kg_m2;
        self.left.attach(self.inertia_kg_m2);
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        self.left.energy(&self.inner, balance);
        let turned = self.inner.angle_rad - body.angle_rad;
        let speed = self.inner.omega_rad_s;
        let Kind { effect, body, .. } = *self.kind;
        if self.inertia_kg_m2 > 0.0 {
            balance.add(
                effect,
                body,
                Account::Stored,
                0.5 * self.inertia_kg_m2 * speed * speed,
            );
        }
        balance.add(
            effect,
            "elastic",
            Account::Stored,
            0.5 * self.stiffness * turned * turned + self.preload_nm * turned,
        );
        balance.add(effect, "damping", Account::Lost, self.lost_j);
    }

    fn columns(&self, names: &mut Vec<&'static str>) {
        self.left.columns(names);
        names.push(self.kind.column);
    }

    fn write(&self, _: &Body, row: &mut Vec<f64>) {
        self.left.write(&self.inner, row);
        // As everywhere in a trace, what opposes growing angle is positive.
        row.push(-self.torque_nm);
    }

    fn warnings(&self, warnings: &mut Vec<String>) {
        self.left.warnings(warnings);
        let (radians, decay) = self.rates_per_step();
        if radians > MOST_RADIANS || decay > MOST_DECAY {
            let Kind { effect, body, .. } = self.kind;
            warnings.push(format!(
                "step long against the {effect}: for a {body} of {:.3e} kg·m² on {:.3} N·m/rad and {:.3} N·m·s/rad ω·h = {radians:.2} \
                 (at most {MOST_RADIANS}) and b·h/J = {decay:.2} (at most {MOST_DECAY}); {}",
                self.left_kg_m2(),
                self.stiffness,
                self.damping,
                self.kind.advice
            ));
        }
    }
}
