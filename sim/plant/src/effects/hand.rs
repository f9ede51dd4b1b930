//! `hand`: the trainee's arm, which drives the leg toward the motion.
//!
//! The scene's motion is what the trainee intends; the arm is a mass on a
//! spring and a damper toward it, at a lever from the knee's axis:
//!
//! ```text
//! M·r²·Ω̇ = K·r²·(φ_intended − φ) + B·r²·(Ω_intended − Ω) + weight of the leg − what the leg does
//! ```
//!
//! | number | default | source |
//! |---|---|---|
//! | mass, damping, stiffness | 0.554 kg, 6.45 N·s/m, 135 N/m | endpoint impedance of an arm, one trial (Sci. Rep. srep18004, fig. 3) |
//! | lever | 0.35 m | estimate: a hand near the ankle |
//!
//! That is an arm for slow motion. What vibrates meets the hand alone, so with another
//! `grip` a palm sits on the leg (or the shell), and the arm pulls it by the tissue
//! between them, linear about the force that lifts the leg:
//!
//! | grip | palm | stiffness | damping | source |
//! |---|---|---|---|---|
//! | `light` | 0.1 kg | 300 N/m | 10 N·s/m | estimate |
//! | `firm` | 0.2 kg | 600 N/m | 20 N·s/m | estimate |
//! | `whole-arm` | 0.5 kg | 3000 N/m | 60 N·s/m | estimate |
//!
//! A person who lifts a leg knows its weight: if the scene has a `limb`, the hand adds
//! the torque that holds it at the intended angle, so the leg does not sag.

mod grip;

use crate::boundary::{Boundary, MotionStep, Stretch};
use crate::chain::{Body, Flow, Push, Settled, Weight};
use crate::effect::{Effect, Part, numbers, parameters};
use crate::energy_balance::{Account, EnergyBalance};
use crepitus_model::parameters::Choice;
use grip::{Grip, Palm};
use std::cell::Cell;

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "the trainee's arm: the motion becomes what it intends, and the leg does what comes of it",
    states: &["leg angle", "leg velocity"],
    parameters: parameters! {
        mass_kg "M" "kg", 1e-3..=100.0, 0.554, "mass of the arm at the hand";
        damping_ns_per_m "B" "N·s/m", 0.0..=1e4, 6.45, "damping of the arm at the hand";
        stiffness_n_per_m "K" "N/m", 0.0..=1e6, 135.0, "stiffness of the arm at the hand";
        lever_m "r" "m", 0.01..=2.0, 0.35, "distance of the hand from the knee's axis";
        palm_factor "q" "1", 0.1..=10.0, 1.0, "the numbers of the grip's palm times this";
    },
    choices: &[Choice {
        key: "grip",
        names: &["arm", "light", "firm", "whole-arm"],
        default: 0,
        meaning: "the hand between leg and arm: none, for slow motion; or as it is for 10 to 500 Hz",
    }],
    needs: &[],
    part: Part::Boundary(|given, context, chain| {
        let [mass, damping, stiffness, lever, palm_factor] = numbers(given);
        let square = lever * lever;
        let arm = Arm {
            inertia_kg_m2: mass * square,
            damping: damping * square,
            stiffness: stiffness * square,
            motion: MotionStep {
                length_s: 1.0,
                from: context.start,
                to: context.start,
            },
            intended: context.start,
            felt_nms: 0.0,
            struck_nms: 0.0,
            given_j: 0.0,
            lost_j: 0.0,
        };
        let lift = Lift {
            weight: chain.weight(),
            given_j: 0.0,
        };
        let hand = Hand {
            arm,
            lift,
            known: Cell::new(None),
        };
        match Palm::of(given.choices[0], lever, palm_factor) {
            None => Box::new(hand),
            Some(palm) => Box::new(Grip::new(hand, palm)),
        }
    }),
};

const NAME: &str = "hand";

/// The arm's impedance.
#[derive(Clone)]
struct Arm {
    inertia_kg_m2: f64,
    damping: f64,
    stiffness: f64,
    motion: MotionStep,
    intended: Body,
    felt_nms: f64,
    struck_nms: f64,
    given_j: f64,
    lost_j: f64,
}

/// Compensation of the leg's weight by a hand, if there is a leg.
#[derive(Clone)]
struct Lift {
    weight: Option<Weight>,
    given_j: f64,
}

impl Lift {
    /// Torque that holds the leg at an angle, N·m.
    fn torque_nm(&self, angle_rad: f64) -> f64 {
        self.weight
            .as_ref()
            .map_or(0.0, |weight| -weight(angle_rad))
    }
}

#[derive(Clone)]
struct Hand {
    arm: Arm,
    lift: Lift,
    /// The intent in the stretch looked at last, between these fractions of the step: a stretch
    /// that is solved is settled, too, and the weight of a leg takes trigonometry.
    known: Cell<Option<(f64, f64, Intent)>>,
}

/// The arm in one stretch: mean of the intended angle, of the intended
/// velocity, and the torque that lifts the leg.
#[derive(Clone, Copy)]
struct Intent {
    angle_rad: f64,
    omega_rad_s: f64,
    lift_nm: f64,
}

impl Hand {
    fn intent(&self, stretch: &Stretch) -> Intent {
        if let Some((from, to, intent)) = self.known.get()
            && (from, to) == (stretch.from, stretch.to)
        {
            return intent;
        }
        let intent = self.found_intent(stretch);
        self.known.set(Some((stretch.from, stretch.to, intent)));
        intent
    }

    fn found_intent(&self, stretch: &Stretch) -> Intent {
        let motion = &self.arm.motion;
        let (a, b) = (motion.angle_rad(stretch.from), motion.angle_rad(stretch.to));
        let angle_rad = f64::midpoint(a, b);
        Intent {
            angle_rad,
            omega_rad_s: (b - a) / stretch.length_s,
            lift_nm: self.lift.torque_nm(angle_rad),
        }
    }
}

impl Boundary for Hand {
    fn begin(&mut self, motion: &MotionStep) {
        self.arm.motion = *motion;
        self.arm.intended = motion.to;
        self.known.set(None);
    }

    fn solve(&mut self, stretch: &Stretch, body: &Body, push: Push) -> Flow {
        let arm = &self.arm;
        let intent = self.intent(stretch);
        let inertial = 2.0 * arm.inertia_kg_m2 / stretch.length_s;
        let torque = inertial * body.omega_rad_s
            + arm.stiffness * (intent.angle_rad - body.angle_rad)
            + arm.damping * intent.omega_rad_s
            + intent.lift_nm;
        let slope = inertial + 0.5 * arm.stiffness * stretch.length_s + arm.damping;
        push.meets(torque, slope)
    }

    fn settle(
        &mut self,
        stretch: &Stretch,
        body: &mut Body,
        next: Body,
        flow: Flow,
        settled: &Settled,
        _: f64,
    ) {
        let intent = self.intent(stretch);
        let (h, w) = (stretch.length_s, flow.omega_rad_s);
        let arm = &mut self.arm;
        let behind = intent.angle_rad - body.angle_rad - 0.5 * h * w;
        let slip = intent.omega_rad_s - w;
        let pull = arm.stiffness * behind + arm.damping * slip;
        arm.given_j += pull * intent.omega_rad_s * h;
        arm.lost_j += arm.damping * slip * slip * h;
        // With the jump of an impact, which the mean of the step has not.
        arm.felt_nms +=
            (pull + intent.lift_nm) * h - arm.inertia_kg_m2 * (next.omega_rad_s - body.omega_rad_s);
        arm.struck_nms -= arm.inertia_kg_m2 * settled.struck_rad_s;
        self.lift.given_j += intent.lift_nm * w * h;
        *body = next;
    }

    fn felt_nms(&self) -> f64 {
        self.arm.felt_nms
    }

    fn struck_nms(&self) -> f64 {
        self.arm.struck_nms
    }

    fn inertia_kg_m2(&self) -> f64 {
        self.arm.inertia_kg_m2
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        let arm = &self.arm;
        let behind = arm.intended.angle_rad - body.angle_rad;
        let speed = body.omega_rad_s;
        balance.add(NAME, "work", Account::Given, arm.given_j);
        if self.lift.weight.is_some() {
            balance.add(NAME, "lifting", Account::Given, self.lift.given_j);
        }
        balance.add(
            NAME,
            "arm",
            Account::Stored,
            0.5 * arm.inertia_kg_m2 * speed * speed,
        );
        balance.add(
            NAME,
            "elastic",
            Account::Stored,
            0.5 * arm.stiffness * behind * behind,
        );
        balance.add(NAME, "damping", Account::Lost, arm.lost_j);
    }

    fn columns(&self) -> &'static [&'static str] {
        &["intended_angle_rad"]
    }

    fn write(&self, row: &mut Vec<f64>) {
        row.push(self.arm.intended.angle_rad);
    }
}
