//! The hand between leg and arm, for what vibrates.
//!
//! ```text
//! arm ─ k, b ─ palm, rigid with what it holds
//! ```
//!
//! The palm is a mass on the right end of the chain. The arm keeps its own mass,
//! spring and damper toward the intended motion; what lifts the leg acts on the palm,
//! as the tissue is linear about that force.

use super::{Hand, NAME};
use crate::boundary::{Boundary, MotionStep, Stretch};
use crate::chain::{Body, Flow, Push, Settled};
use crate::energy_balance::{Account, EnergyBalance};

/// A palm and its tissue.
#[derive(Clone, Copy, Debug)]
pub(super) struct Palm {
    lever_m: f64,
    inertia_kg_m2: f64,
    stiffness: f64,
    damping: f64,
}

impl Palm {
    /// Palm of a grip, by its number, at this lever; none for the arm alone.
    /// Its numbers are `factor` times those of the table.
    pub(super) fn of(grip: u8, lever_m: f64, factor: f64) -> Option<Self> {
        let (kg, n_per_m, ns_per_m) = match grip {
            0 => return None,
            1 => (0.1, 300.0, 10.0),
            2 => (0.2, 600.0, 20.0),
            _ => (0.5, 3_000.0, 60.0),
        };
        let square = factor * lever_m * lever_m;
        Some(Self {
            lever_m,
            inertia_kg_m2: kg * square,
            stiffness: n_per_m * square,
            damping: ns_per_m * square,
        })
    }
}

/// A hand that grips what it holds.
#[derive(Clone)]
pub(super) struct Grip {
    hand: Hand,
    palm: Palm,
    /// The arm behind it.
    arm: Body,
    lost_j: f64,
    acceleration_m_s2: f64,
}

/// One stretch of it: what acts on the palm at mean velocity w is
/// `torque_nm − slope_nms·w`, without its inertia.
struct Solved {
    torque_nm: f64,
    slope_nms: f64,
    /// The arm's mean velocity at w = 0, rad/s, and its share of w.
    arm_rad_s: f64,
    share: f64,
    lift_nm: f64,
}

impl Grip {
    pub(super) fn new(hand: Hand, palm: Palm) -> Self {
        Self {
            arm: hand.arm.intended,
            hand,
            palm,
            lost_j: 0.0,
            acceleration_m_s2: 0.0,
        }
    }

    fn solved(&self, stretch: &Stretch, body: &Body) -> Solved {
        let h = stretch.length_s;
        let (arm, palm) = (&self.hand.arm, &self.palm);
        let intent = self.hand.intent(stretch);
        let inertial = 2.0 * arm.inertia_kg_m2 / h;
        let tissue = 0.5 * palm.stiffness * h + palm.damping;
        let pressed = palm.stiffness * (body.angle_rad - self.arm.angle_rad);
        let pull = inertial * self.arm.omega_rad_s
            + arm.stiffness * (intent.angle_rad - self.arm.angle_rad)
            + arm.damping * intent.omega_rad_s
            + pressed;
        let slope = inertial + 0.5 * arm.stiffness * h + arm.damping + tissue;
        let share = tissue / slope;
        Solved {
            torque_nm: intent.lift_nm - pressed + share * pull,
            slope_nms: tissue * (1.0 - share),
            arm_rad_s: pull / slope,
            share,
            lift_nm: intent.lift_nm,
        }
    }
}

impl Boundary for Grip {
    fn begin(&mut self, motion: &MotionStep) {
        self.hand.begin(motion);
    }

    fn solve(&mut self, stretch: &Stretch, body: &Body, push: Push) -> Flow {
        let solved = self.solved(stretch, body);
        let inertial = 2.0 * self.palm.inertia_kg_m2 / stretch.length_s;
        let torque = inertial * body.omega_rad_s + solved.torque_nm;
        let slope = inertial + solved.slope_nms;
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
        let solved = self.solved(stretch, body);
        let intent = self.hand.intent(stretch);
        let (h, w) = (stretch.length_s, flow.omega_rad_s);
        let arm_rad_s = solved.arm_rad_s + solved.share * w;
        let palm = self.palm;
        let arm = &mut self.hand.arm;
        let behind = intent.angle_rad - self.arm.angle_rad - 0.5 * h * arm_rad_s;
        let slip = intent.omega_rad_s - arm_rad_s;
        let pull = arm.stiffness * behind + arm.damping * slip;
        arm.given_j += pull * intent.omega_rad_s * h;
        arm.lost_j += arm.damping * slip * slip * h;
        self.lost_j += palm.damping * (w - arm_rad_s) * (w - arm_rad_s) * h;
        let gained_rad_s = next.omega_rad_s - body.omega_rad_s;
        let on_palm_nm = solved.torque_nm - solved.slope_nms * w;
        arm.felt_nms += on_palm_nm * h - palm.inertia_kg_m2 * gained_rad_s;
        arm.struck_nms -= palm.inertia_kg_m2 * settled.struck_rad_s;
        self.acceleration_m_s2 = palm.lever_m * gained_rad_s / h;
        self.arm = self.arm.after(h, arm_rad_s);
        self.hand.lift.given_j += solved.lift_nm * w * h;
        *body = next;
    }

    fn felt_nms(&self) -> f64 {
        self.hand.felt_nms()
    }

    fn struck_nms(&self) -> f64 {
        self.hand.struck_nms()
    }

    fn inertia_kg_m2(&self) -> f64 {
        self.palm.inertia_kg_m2
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        self.hand.energy(&self.arm, balance);
        let pressed_rad = body.angle_rad - self.arm.angle_rad;
        let speed = body.omega_rad_s;
        for (what, account, joule) in [
            (
                "palm",
                Account::Stored,
                0.5 * self.palm.inertia_kg_m2 * speed * speed,
            ),
            (
                "tissue",
                Account::Stored,
                0.5 * self.palm.stiffness * pressed_rad * pressed_rad,
            ),
            ("tissue damping", Account::Lost, self.lost_j),
        ] {
            balance.add(NAME, what, account, joule);
        }
    }

    fn columns(&self) -> &'static [&'static str] {
        &[
            "intended_angle_rad",
            "arm_angle_rad",
            "hand_acceleration_m_s2",
        ]
    }

    fn write(&self, row: &mut Vec<f64>) {
        self.hand.write(row);
        row.extend([self.arm.angle_rad, self.acceleration_m_s2]);
    }
}
