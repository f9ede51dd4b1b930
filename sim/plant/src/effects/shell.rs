//! `shell`: the clamshell near the ankle that carries the actuator, on its seat.
//!
//! ```text
//! torque on the shell = r²·(k·(φ_leg − φ_shell) + b·(Ω_leg − Ω_shell))
//! ```
//!
//! | number | default | source |
//! |---|---|---|
//! | mass | 0.25 kg | estimate: two half shells with straps and the actuator's housing |
//! | seat stiffness | 4 N/mm | estimate: cuffs on a leg have 2.1 to 4.5 N/mm |
//! | seat damping | 20 N·s/m | estimate: a third of critical |
//! | lever | 0.3 m | estimate: above the ankle |
//!
//! The seat is linear about the force with which it carries the leg, or the shell, as the
//! run begins.
//!
//! The hand holds the shell, or the bare leg beside it: then the seat is a low-pass at
//! 20 Hz for what the shell does.

use crate::branch::{Branched, Loose};
use crate::chain::{Body, Chain, Push, Step, Weight};
use crate::compliance::{Compliance, Kind};
use crate::effect::{Context, Effect, Given, Need, OnChain, Part, numbers, parameters};
use crate::effects::limb::STANDARD_GRAVITY;
use crate::energy_balance::{Account, EnergyBalance};
use crate::load::{Load, Loaded};
use crepitus_model::parameters::Choice;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "the clamshell near the ankle that carries the actuator, on its compliant seat",
    states: &["shell angle", "shell velocity"],
    parameters: parameters! {
        mass_kg "M" "kg", 0.01..=10.0, 0.25, "mass of the shell, without what moves in it";
        seat_stiffness_n_per_m "k" "N/m", 10.0..=1e6, 4_000.0, "stiffness of its seat on the leg";
        seat_damping_ns_per_m "b" "N·s/m", 0.0..=1e3, 20.0, "damping of its seat on the leg";
        lever_m "r" "m", 0.1..=0.5, 0.3, "distance of the shell from the knee's axis";
    },
    choices: &[Choice {
        key: "hand_on",
        names: &["shell", "leg"],
        default: 0,
        meaning: "what the hand holds: the shell, or the leg beside it",
    }],
    needs: &[Need {
        effect: "limb",
        why: "it is the shank that it sits on",
    }],
    part: Part::Shell(join),
};

const NAME: &str = "shell";

const KIND: Kind = Kind {
    effect: NAME,
    body: "leg",
    column: "seat_torque_nm",
    advice: "choose more substeps, a softer seat or a larger mass_kg",
};

/// Puts the shell on its seat at the right end of `leg`, with what `mount` puts on it.
fn join(
    given: &Given,
    context: &Context,
    leg: Box<dyn Chain>,
    mount: OnChain<'_>,
) -> Box<dyn Chain> {
    let [mass_kg, stiffness, damping, lever_m] = numbers(given);
    let square = lever_m * lever_m;
    let seat = |left: Box<dyn Chain>| -> Box<dyn Chain> {
        let carried_nm = left.weight().map_or(0.0, |of| of(context.start.angle_rad));
        let (k, b) = (stiffness * square, damping * square);
        let seat = Compliance::new(left, context.start, &KIND, k, b, 0.0);
        Box::new(seat.carrying(carried_nm))
    };
    let shell = Shell {
        inertia_kg_m2: mass_kg * square,
        weight: context
            .gravity_rad
            .map(|turned_rad| (mass_kg * STANDARD_GRAVITY * lever_m, turned_rad)),
        lever_m,
        given_j: 0.0,
        acceleration_m_s2: 0.0,
    };
    let is_held = given.choices[0] == 0;
    if is_held {
        return mount(Loaded::on(seat(leg), shell));
    }
    let beside = mount(Loaded::on(Box::new(Loose), shell));
    Box::new(Branched::new(leg, seat(beside)))
}

/// The shell's mass.
#[derive(Clone)]
struct Shell {
    inertia_kg_m2: f64,
    /// N·m where it is horizontal, and the angle to add to φ so that it is a cosine.
    weight: Option<(f64, f64)>,
    lever_m: f64,
    given_j: f64,
    acceleration_m_s2: f64,
}

impl Shell {
    fn weight_nm(&self, angle_rad: f64) -> f64 {
        self.weight
            .map_or(0.0, |(nm, turned_rad)| nm * (angle_rad + turned_rad).cos())
    }
}

impl Load for Shell {
    const NAME: &'static str = NAME;
    const COLUMN: &'static str = "shell_weight_nm";
    const MORE: &'static [&'static str] = &["shell_acceleration_m_s2"];

    fn inertia_kg_m2(&self) -> f64 {
        self.inertia_kg_m2
    }

    fn pull(&self, _: &Step, body: &Body) -> Push {
        Push {
            torque_nm: self.weight_nm(body.angle_rad),
            slope_nms: 0.0,
            held_by_nm: None,
        }
    }

    fn moved(&mut self, step: &Step, next: &Body, mean_rad_s: f64) {
        let from_rad = next.angle_rad - step.length_s * mean_rad_s;
        self.given_j += self.weight_nm(from_rad) * mean_rad_s * step.length_s;
        let gained_rad_s = 2.0 * (next.omega_rad_s - mean_rad_s);
        self.acceleration_m_s2 = self.lever_m * gained_rad_s / step.length_s;
    }

    fn weight(&self) -> Option<Weight> {
        let (nm, turned_rad) = self.weight?;
        Some(Box::new(move |angle| nm * (angle + turned_rad).cos()))
    }

    fn energy(&self, _: &Body, balance: &mut EnergyBalance) {
        balance.add(NAME, "weight", Account::Given, self.given_j);
    }

    fn write_more(&self, _: &Body, row: &mut Vec<f64>) {
        row.push(self.acceleration_m_s2);
    }
}
