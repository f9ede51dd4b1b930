//! Boundary of a hand that a person guides on a screen.
//!
//! ```text
//! M·Ω̇ = clamp(k·(φ_guided − φ) + b·(Ω_guided − Ω), ±limit) + lift − what the leg does
//! lift = clamp((M + J)·Ω̇_guided, ±limit) − weight(φ)
//! ```
//!
//! The motion of a step is where the hand is guided to. A person who moves a leg knows its weight and
//! its inertia J, and lifts and swings it accordingly. So a healthy leg goes along, and the lag of a leg is
//! what resists it.
//!
//! What is beyond the limit yields, as a slip in series with spring and damper. The spring then stores
//! ∫clamp(k·x, ±limit) dx, and the rest, (clamp(k·x + b·ẋ) − clamp(k·x))·ẋ, is lost: never less
//! than zero, as a clamp does not fall where what is in it grows. So a hand that is held still gives
//! nothing.

use crate::boundary::{Boundary, MotionStep, Stretch};
use crate::chain::{Body, Chain, Flow, Push, Settled, Weight};
use crate::energy_balance::{Account, EnergyBalance};

/// Numbers of a guided hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandNumbers {
    /// Inertia M of the arm, which moves with the leg, kg·m².
    pub inertia_kg_m2: f64,
    /// Stiffness k, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Damping b, N·m·s/rad.
    pub damping_nms_per_rad: f64,
    /// Largest torque of spring and damper, and of what swings the leg, N·m.
    pub limit_nm: f64,
}

impl HandNumbers {
    fn limited_nm(&self, torque_nm: f64) -> f64 {
        torque_nm.max(-self.limit_nm).min(self.limit_nm)
    }

    /// Torque of the spring alone, N·m.
    fn spring_nm(&self, behind_rad: f64) -> f64 {
        self.limited_nm(self.stiffness_nm_per_rad * behind_rad)
    }

    /// Energy that the spring stores, J.
    fn stored_j(&self, behind_rad: f64) -> f64 {
        let elastic_rad = self.spring_nm(behind_rad).abs() / self.stiffness_nm_per_rad;
        let yielded_rad = behind_rad.abs() - elastic_rad;
        0.5 * self.stiffness_nm_per_rad * elastic_rad * elastic_rad + self.limit_nm * yielded_rad
    }

    /// Mean torque of the spring between two angles, N·m.
    fn mean_spring_nm(&self, from_rad: f64, to_rad: f64) -> f64 {
        let ends_nm = [from_rad, to_rad].map(|behind_rad| self.spring_nm(behind_rad));
        let yields = ends_nm.map(|end_nm| end_nm.abs() >= self.limit_nm);
        if yields[0] == yields[1] {
            return f64::midpoint(ends_nm[0], ends_nm[1]);
        }
        (self.stored_j(to_rad) - self.stored_j(from_rad)) / (to_rad - from_rad)
    }
}

/// A hand that is guided.
#[derive(Clone)]
pub struct GuidingHand {
    numbers: HandNumbers,
    /// Weight of the leg, if it has any, and its inertia.
    weight: Option<Weight>,
    leg_kg_m2: f64,
    motion: MotionStep,
    guided: Body,
    felt_nms: f64,
    struck_nms: f64,
    given_j: f64,
    lift_j: f64,
    lost_j: f64,
}

/// The hand in one stretch.
struct Intent {
    /// Mean angle and velocity.
    angle_rad: f64,
    omega_rad_s: f64,
    lift_nm: f64,
    /// Torque of spring and damper at mean velocity w of the leg: `pull_nm − slope_nms·w`, up to the limit.
    pull_nm: f64,
    slope_nms: f64,
}

impl GuidingHand {
    /// A hand that is guided to `guided`, at the right end of this chain.
    pub fn new(numbers: HandNumbers, guided: Body, chain: &dyn Chain) -> Self {
        Self {
            numbers,
            weight: chain.weight(),
            leg_kg_m2: chain.inertia_kg_m2(),
            motion: MotionStep {
                length_s: 1.0,
                from: guided,
                to: guided,
            },
            guided,
            felt_nms: 0.0,
            struck_nms: 0.0,
            given_j: 0.0,
            lift_j: 0.0,
            lost_j: 0.0,
        }
    }

    fn intent(&self, stretch: &Stretch, body: &Body) -> Intent {
        let (numbers, motion, h) = (&self.numbers, &self.motion, stretch.length_s);
        let (a, b) = (motion.angle_rad(stretch.from), motion.angle_rad(stretch.to));
        let angle_rad = f64::midpoint(a, b);
        let omega_rad_s = (b - a) / h;
        let swing = (motion.to.omega_rad_s - motion.from.omega_rad_s) / motion.length_s;
        let swing_nm = numbers.limited_nm((numbers.inertia_kg_m2 + self.leg_kg_m2) * swing);
        // Where the leg is in the middle of the stretch, but for what it accelerates in it.
        let leg_rad = body.angle_rad + 0.5 * h * body.omega_rad_s;
        let weight_nm = self.weight.as_ref().map_or(0.0, |weight| weight(leg_rad));
        Intent {
            angle_rad,
            omega_rad_s,
            lift_nm: swing_nm - weight_nm,
            pull_nm: numbers.stiffness_nm_per_rad * (angle_rad - body.angle_rad)
                + numbers.damping_nms_per_rad * omega_rad_s,
            slope_nms: 0.5 * h * numbers.stiffness_nm_per_rad + numbers.damping_nms_per_rad,
        }
    }
}

impl Boundary for GuidingHand {
    fn begin(&mut self, motion: &MotionStep) {
        self.motion = *motion;
        self.guided = motion.to;
    }

    fn solve(&mut self, stretch: &Stretch, body: &Body, push: Push) -> Flow {
        let intent = self.intent(stretch, body);
        let inertial = 2.0 * self.numbers.inertia_kg_m2 / stretch.length_s;
        let given_nm = inertial * body.omega_rad_s + intent.lift_nm;
        let flow = push.meets(given_nm + intent.pull_nm, inertial + intent.slope_nms);
        let pull_nm = intent.pull_nm - intent.slope_nms * flow.omega_rad_s;
        let limited_nm = self.numbers.limited_nm(pull_nm);
        if pull_nm == limited_nm {
            flow
        } else {
            push.meets(given_nm + limited_nm, inertial)
        }
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
        let intent = self.intent(stretch, body);
        let (h, w) = (stretch.length_s, flow.omega_rad_s);
        let numbers = self.numbers;
        let pull_nm = numbers.limited_nm(intent.pull_nm - intent.slope_nms * w);
        let slip_rad = h * (intent.omega_rad_s - w);
        // Behind the hand in the middle of the stretch, and at both ends.
        let behind_rad = intent.angle_rad - body.angle_rad - 0.5 * h * w;
        let ends_rad = [behind_rad - 0.5 * slip_rad, behind_rad + 0.5 * slip_rad];
        let spring_nm = numbers.mean_spring_nm(ends_rad[0], ends_rad[1]);
        self.given_j += pull_nm * intent.omega_rad_s * h;
        self.lift_j += intent.lift_nm * w * h;
        self.lost_j += (pull_nm - spring_nm) * slip_rad;
        // With the jump of an impact, which the mean of the step has not.
        let gained_rad_s = next.omega_rad_s - body.omega_rad_s;
        self.felt_nms += (pull_nm + intent.lift_nm) * h - numbers.inertia_kg_m2 * gained_rad_s;
        self.struck_nms -= numbers.inertia_kg_m2 * settled.struck_rad_s;
        *body = next;
    }

    fn felt_nms(&self) -> f64 {
        self.felt_nms
    }

    fn struck_nms(&self) -> f64 {
        self.struck_nms
    }

    fn inertia_kg_m2(&self) -> f64 {
        self.numbers.inertia_kg_m2
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        let speed = body.omega_rad_s;
        let arm_j = 0.5 * self.numbers.inertia_kg_m2 * speed * speed;
        let behind_rad = self.guided.angle_rad - body.angle_rad;
        let elastic_j = self.numbers.stored_j(behind_rad);
        for (what, account, joule) in [
            ("work", Account::Given, self.given_j),
            ("lifting", Account::Given, self.lift_j),
            ("arm", Account::Stored, arm_j),
            ("elastic", Account::Stored, elastic_j),
            ("damping", Account::Lost, self.lost_j),
        ] {
            balance.add(NAME, what, account, joule);
        }
    }
}

const NAME: &str = "guiding-hand";
