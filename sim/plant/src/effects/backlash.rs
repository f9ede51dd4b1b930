//! `backlash`: the lost motion of the gear.
//!
//! Rotor and joint touch on one side of a gap, on the other, or not at all:
//!
//! ```text
//! g = φ_rotor − φ_joint,   −β/2 ≤ g ≤ β/2
//! ```
//!
//! In contact they are one body as long as they press; in between the rotor is
//! on its own. When the gap closes the two move on together: a plastic impact,
//! whose energy ½·J₁J₂/(J₁+J₂)·ġ² is lost. The moment is located inside the
//! step. (Gear teeth ring at kilohertz, which neither the cuff nor a hand lets
//! through.)
//!
//! β is 1.0°: average no-load backlash of the GP 32 A.

use crate::chain::{Body, Chain, Flow, Impacts, Push, Settled, Step, Verdict, sense_of};
use crate::effect::{Effect, Need, Part, numbers, parameters};
use crate::energy_balance::{Account, EnergyBalance};
use crepitus_model::Sense;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "the gear's lost motion: at each reversal the rotor first crosses a gap",
    states: &["gap_rad", "gap rate"],
    parameters: parameters! {
        gap_deg "β" "°", 1e-6..=90.0, 1.0, "lost motion between rotor and joint, at the joint";
    },
    choices: &[],
    needs: &[Need {
        effect: "drivetrain",
        why: "what crosses the gap is the rotor's inertia",
    }],
    part: Part::Link(|given, context, left| {
        let [gap_deg] = numbers(given);
        let half_rad = gap_deg.to_radians() / 2.0;
        let omega = context.start.omega_rad_s;
        // A joint that moves drags the rotor along.
        let (contact, gap_rad) = if omega == 0.0 {
            (None, 0.0)
        } else {
            let sense = sense_of(-omega);
            (Some(sense), sense.of_signed(half_rad))
        };
        Box::new(Backlash {
            left,
            half_rad,
            right_kg_m2: 0.0,
            contact,
            gap_rad,
            rotor_rad_s: omega,
            rotor_mean_rad_s: 0.0,
            closed: false,
            found: None,
            lost_j: 0.0,
            impacts: Impacts::default(),
        })
    }),
};

const NAME: &str = "backlash";

/// A gap that is open to this share is closed.
const NEARLY: f64 = 1.0 - 1e-7;

#[derive(Clone)]
struct Backlash {
    left: Box<dyn Chain>,
    half_rad: f64,
    right_kg_m2: f64,
    /// Sense in which the rotor presses on the joint, if they touch.
    contact: Option<Sense>,
    gap_rad: f64,
    /// Velocity of a rotor on its own.
    rotor_rad_s: f64,
    rotor_mean_rad_s: f64,
    /// The gap closed in this step; what would open it at once waits for the
    /// next, or a torque that passes zero would open and close it endlessly.
    closed: bool,
    found: Option<f64>,
    lost_j: f64,
    impacts: Impacts,
}

impl Backlash {
    fn rotor(&self, joint: &Body) -> Body {
        Body {
            angle_rad: joint.angle_rad + self.gap_rad,
            omega_rad_s: match self.contact {
                Some(_) => joint.omega_rad_s,
                None => self.rotor_rad_s,
            },
        }
    }

    /// The solution for a rotor on its own.
    fn alone(&self) -> Flow {
        Flow {
            omega_rad_s: self.rotor_mean_rad_s,
            torque_nm: 0.0,
        }
    }

    /// Instant at which an open gap closes, as a fraction of the step.
    fn closes(&self, step: &Step, rotor: &Body, joint: &Body, joint_mean: f64) -> Option<f64> {
        let mean = self.rotor_mean_rad_s - joint_mean;
        let after = self.gap_rad + step.length_s * mean;
        let sense = sense_of(after);
        if after.abs() < NEARLY * self.half_rad || sense.of_signed(mean) <= 0.0 {
            return None;
        }
        let room = self.half_rad - sense.of_signed(self.gap_rad);
        let start = sense.of_signed(rotor.omega_rad_s - joint.omega_rad_s);
        let bend = sense.of_signed(mean) - start;
        // The gap is a parabola over the step: h·bend·f² + h·start·f = room.
        let root = (start * start + 4.0 * bend * room / step.length_s)
            .max(0.0)
            .sqrt();
        let fraction = if start < 0.0 {
            // First away from that side, then back to it.
            (root - start) / (2.0 * bend)
        } else {
            2.0 * room / (step.length_s * (start + root))
        };
        Some(if fraction.is_finite() {
            fraction.clamp(0.0, 1.0)
        } else {
            0.0
        })
    }

    /// Closes the gap: rotor and joint continue with one velocity. Returns
    /// the impulse on a joint that does not give way.
    fn impact(&mut self, sense: Sense, rotor_rad_s: f64, joint: &mut Body) -> f64 {
        let rotor_kg_m2 = self.left.inertia_kg_m2();
        let slip = rotor_rad_s - joint.omega_rad_s;
        self.gap_rad = sense.of_signed(self.half_rad);
        self.contact = Some(sense);
        self.closed = true;
        if self.right_kg_m2.is_finite() {
            let sum = rotor_kg_m2 + self.right_kg_m2;
            self.lost_j += 0.5 * rotor_kg_m2 * self.right_kg_m2 / sum * slip * slip;
            self.impacts
                .note(rotor_kg_m2 * self.right_kg_m2 / sum * slip);
            joint.omega_rad_s += rotor_kg_m2 / sum * slip;
            0.0
        } else {
            self.lost_j += 0.5 * rotor_kg_m2 * slip * slip;
            self.impacts.note(rotor_kg_m2 * slip);
            rotor_kg_m2 * slip
        }
    }
}

impl Chain for Backlash {
    fn left(&self) -> Option<&dyn Chain> {
        Some(&*self.left)
    }

    fn fold(&mut self, step: &Step, body: &Body) -> Push {
        let rotor = self.rotor(body);
        let push = self.left.fold(step, &rotor);
        if self.contact.is_some() {
            return push;
        }
        self.rotor_mean_rad_s = match push.held_by_nm {
            Some(_) => 0.0,
            None => push.torque_nm / push.slope_nms,
        };
        Push::default()
    }

    fn shaft_mean_rad_s(&self, step: &Step, body: &Body, flow: Flow) -> f64 {
        let rotor = self.rotor(body);
        let flow = match self.contact {
            Some(_) => flow,
            None => self.alone(),
        };
        self.left.shaft_mean_rad_s(step, &rotor, flow)
    }

    fn check(&mut self, step: &Step, body: &Body, flow: Flow) -> Verdict {
        let rotor = self.rotor(body);
        self.found = None;
        if let Some(sense) = self.contact {
            let left = self.left.check(step, &rotor, flow);
            self.closed &= step.cut;
            let pulls = sense.of_signed(flow.torque_nm) < 0.0;
            if left != Verdict::Again && pulls && !self.closed {
                // Teeth cannot pull.
                self.contact = None;
                self.rotor_rad_s = body.omega_rad_s;
                return Verdict::Again;
            }
            return left;
        }
        let alone = self.alone();
        let left = self.left.check(step, &rotor, alone);
        self.found = self.closes(step, &rotor, body, flow.omega_rad_s);
        left.and(self.found.map_or(Verdict::Holds, Verdict::EndsAt))
    }

    fn settle(
        &mut self,
        step: &Step,
        body: &Body,
        next: &mut Body,
        flow: Flow,
        ends_at: Option<f64>,
    ) -> Settled {
        let rotor = self.rotor(body);
        if self.contact.is_some() {
            let settled = self.left.settle(step, &rotor, next, flow, ends_at);
            self.rotor_rad_s = next.omega_rad_s;
            return settled;
        }
        let alone = self.alone();
        let mut rotor_next = rotor.after(step.length_s, self.rotor_mean_rad_s);
        let mut settled = self
            .left
            .settle(step, &rotor, &mut rotor_next, alone, ends_at);
        self.gap_rad += step.length_s * (self.rotor_mean_rad_s - flow.omega_rad_s);
        self.rotor_rad_s = rotor_next.omega_rad_s;
        let closed = ends_at.is_some() && ends_at == self.found;
        if closed || self.gap_rad.abs() > self.half_rad {
            let sense = sense_of(self.gap_rad);
            let before_rad_s = next.omega_rad_s;
            settled.impulse_nms += self.impact(sense, rotor_next.omega_rad_s, next);
            settled.struck_rad_s += next.omega_rad_s - before_rad_s;
        }
        settled
    }

    fn shaft(&self, body: &Body) -> Body {
        self.left.shaft(&self.rotor(body))
    }

    fn is_rigid(&self) -> bool {
        false
    }

    fn inertia_kg_m2(&self) -> f64 {
        match self.contact {
            Some(_) => self.left.inertia_kg_m2(),
            None => 0.0,
        }
    }

    fn attach(&mut self, right_kg_m2: f64) {
        self.right_kg_m2 = right_kg_m2;
        self.left.attach(0.0);
    }

    fn jerk(&mut self, body: &Body, change_rad_s: f64) {
        if self
            .contact
            .is_some_and(|sense| sense.of_signed(change_rad_s) > 0.0)
        {
            self.contact = None;
            self.rotor_rad_s = body.omega_rad_s;
        }
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        self.left.energy(&self.rotor(body), balance);
        balance.add(NAME, "impacts", Account::Lost, self.lost_j);
    }

    fn columns(&self, names: &mut Vec<&'static str>) {
        self.left.columns(names);
        names.push("gap_rad");
    }

    fn write(&self, body: &Body, row: &mut Vec<f64>) {
        self.left.write(&self.rotor(body), row);
        row.push(self.gap_rad);
    }

    fn impacts(&self) -> Option<Impacts> {
        Some(self.impacts)
    }
}
