//! `drivetrain`: the rotor's inertia behind the gear, and the gear's losses.
//!
//! ```text
//! J·Ω̇ = push of the actuator − F·sgn Ω + what the chain does,   F = friction + loss·|T|
//! ```
//!
//! | number | default | source |
//! |---|---|---|
//! | inertia | 0.051 kg·m² | 68.1 g·cm² (RE35) + 0.7 g·cm² (gear), times 86² |
//! | friction | 0.5 N·m | the paper, II.C, at the joint |
//! | load loss | 0.3 | gear efficiency 0.70 (GP 32 A): of the torque T that goes through it |
//!
//! The friction is dry and set-valued: at rest it carries what it must, up to
//! ±F. Where the velocity passes zero is located inside the step. The load is
//! the actuator's torque as the step begins; that of the rotor's own inertia
//! is not counted in.

use crate::chain::{Body, Chain, Flow, Push, Settled, Step, Verdict, sense_of};
use crate::effect::{Effect, Given, Part, numbers, parameters};
use crate::energy_balance::{Account, EnergyBalance};
use crepitus_model::Sense;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "the rotor's inertia behind the gear, dry friction of the gear and its loss under load",
    states: &["friction phase"],
    parameters: parameters! {
        inertia_kg_m2 "J_r" "kg·m²", 1e-6..=10.0, 0.051, "inertia of the rotor, referred to the joint: times the square of the gear ratio";
        friction_nm "F" "N·m", 0.0..=100.0, 0.5, "dry friction of motor and gear, at the joint";
        load_loss "μ" "1", 0.0..=1.0, 0.3, "share of the torque through the gear that is lost in it";
    },
    choices: &[],
    needs: &[],
    part: Part::Link(|given, _, left| Box::new(Drivetrain::new(given, left))),
};

const NAME: &str = "drivetrain";

/// A gear with the rotor behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// Inertia of the rotor, kg·m².
    pub inertia_kg_m2: f64,
    /// Dry friction of motor and gear, N·m.
    pub friction_nm: f64,
    /// Share of the torque through the gear that is lost in it.
    pub load_loss: f64,
}

impl Gear {
    /// Dry friction under this torque through the gear, N·m: at rest the most that it carries.
    #[inline]
    pub fn limit_nm(&self, load_nm: f64) -> f64 {
        self.friction_nm + self.load_loss * load_nm.abs()
    }
}

/// Share of itself below which a falling speed counts as zero.
const NEARLY: f64 = 1e-5;

/// Whether the friction holds the rotor.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    Held,
    Sliding(Sense),
}

/// A chain that ends in a gear with the rotor behind it.
#[derive(Clone)]
pub(crate) struct Drivetrain<L> {
    left: L,
    gear: Gear,
    mode: Mode,
    /// Instant in the step at which the last check saw the rotor stop.
    found: Option<f64>,
    /// Friction torque of the last step; positive opposes growing angle.
    shown_nm: f64,
    lost_j: f64,
}

impl<L: Chain> Drivetrain<L> {
    /// Returns the gear with these numbers, behind `left`.
    pub(crate) fn new(given: &Given, left: L) -> Self {
        let [inertia_kg_m2, friction_nm, load_loss] = numbers(given);
        Self {
            left,
            gear: Gear {
                inertia_kg_m2,
                friction_nm,
                load_loss,
            },
            mode: Mode::Held,
            found: None,
            shown_nm: 0.0,
            lost_j: 0.0,
        }
    }

    fn limit_nm(&self, step: &Step) -> f64 {
        self.gear.limit_nm(step.load_nm)
    }

    /// Torque of the rotor's inertia, N·m.
    fn inertial_nm(&self, step: &Step, body: &Body, w: f64) -> f64 {
        step.inertial_slope(self.gear.inertia_kg_m2) * (body.omega_rad_s - w)
    }

    /// The friction on the rotor that the solution contains, N·m.
    fn friction_of(&self, step: &Step, body: &Body, flow: Flow) -> f64 {
        match self.mode {
            Mode::Sliding(sense) => -sense.of_signed(self.limit_nm(step)),
            Mode::Held => {
                flow.torque_nm
                    - step.drive.at(flow.omega_rad_s)
                    - self.inertial_nm(step, body, flow.omega_rad_s)
            }
        }
    }

    /// Action of the parts to the left on the rotor.
    fn left_flow(&self, step: &Step, body: &Body, flow: Flow) -> Flow {
        let own =
            self.inertial_nm(step, body, flow.omega_rad_s) + self.friction_of(step, body, flow);
        Flow {
            torque_nm: flow.torque_nm - own,
            ..flow
        }
    }

    fn judge(&self, step: &Step, body: &Body, flow: Flow) -> Result<Option<f64>, Mode> {
        let (v, w) = (body.omega_rad_s, flow.omega_rad_s);
        let moving = if v == 0.0 { w } else { v };
        match self.mode {
            Mode::Held => {
                if moving != 0.0 {
                    return Err(Mode::Sliding(sense_of(moving)));
                }
                let friction = self.friction_of(step, body, flow);
                if friction.abs() > self.limit_nm(step) * (1.0 + 1e-12) {
                    // The shaft slips against the friction that holding would need.
                    return Err(Mode::Sliding(sense_of(-friction)));
                }
                Ok(None)
            }
            Mode::Sliding(sense) => {
                let (v, end) = (sense.of_signed(v), sense.of_signed(2.0 * w - v));
                if v > 0.0 {
                    // Without friction nothing changes.
                    let stops = end <= NEARLY * v && self.limit_nm(step) > 0.0;
                    Ok(stops.then(|| (v / (v - end)).min(1.0)))
                } else if v < 0.0 {
                    Err(Mode::Sliding(sense.opposite()))
                } else if sense.of_signed(w) > 0.0 {
                    Ok(None)
                } else {
                    Err(Mode::Held)
                }
            }
        }
    }
}

impl<L: Chain + Clone + 'static> Chain for Drivetrain<L> {
    fn left(&self) -> Option<&dyn Chain> {
        Some(&self.left)
    }

    fn fold(&mut self, step: &Step, body: &Body) -> Push {
        let mut push = self
            .left
            .fold(step, body)
            .with_inertia(self.gear.inertia_kg_m2, step, body);
        match self.mode {
            Mode::Held => push.held_by_nm = Some(self.limit_nm(step)),
            Mode::Sliding(sense) => push.torque_nm -= sense.of_signed(self.limit_nm(step)),
        }
        push
    }

    fn check(&mut self, step: &Step, body: &Body, flow: Flow) -> Verdict {
        let own = match self.judge(step, body, flow) {
            Ok(found) => {
                self.found = found;
                found.map_or(Verdict::Holds, Verdict::EndsAt)
            }
            Err(mode) => {
                self.mode = mode;
                return Verdict::Again;
            }
        };
        let left = self.left_flow(step, body, flow);
        own.and(self.left.check(step, body, left))
    }

    fn settle(
        &mut self,
        step: &Step,
        body: &Body,
        next: &mut Body,
        flow: Flow,
        ends_at: Option<f64>,
    ) -> Settled {
        self.shown_nm = -self.friction_of(step, body, flow);
        if let Mode::Sliding(sense) = self.mode {
            self.lost_j += self.limit_nm(step) * step.length_s * sense.of_signed(flow.omega_rad_s);
        }
        let left = self.left_flow(step, body, flow);
        let settled = self.left.settle(step, body, next, left, ends_at);
        if ends_at.is_some() && ends_at == self.found {
            next.omega_rad_s = 0.0;
            self.mode = Mode::Held;
        }
        settled
    }

    fn inertia_kg_m2(&self) -> f64 {
        self.gear.inertia_kg_m2 + self.left.inertia_kg_m2()
    }

    fn attach(&mut self, right_kg_m2: f64) {
        self.left.attach(right_kg_m2 + self.gear.inertia_kg_m2);
    }

    fn jerk(&mut self, body: &Body, change_rad_s: f64) {
        self.left.jerk(body, change_rad_s);
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        self.left.energy(body, balance);
        let kinetic_j = 0.5 * self.gear.inertia_kg_m2 * body.omega_rad_s * body.omega_rad_s;
        balance.add(NAME, "rotor", Account::Stored, kinetic_j);
        balance.add(NAME, "friction", Account::Lost, self.lost_j);
    }

    fn columns(&self, names: &mut Vec<&'static str>) {
        self.left.columns(names);
        names.push("gear_friction_nm");
    }

    fn write(&self, body: &Body, row: &mut Vec<f64>) {
        self.left.write(body, row);
        row.push(self.shown_nm);
    }
}
