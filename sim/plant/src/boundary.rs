//! Boundary that holds the right end of the chain: the scene's motion, a hand that
//! follows it or pushes, or nobody.

use crate::boxed::cloned_in_boxes;
use crate::chain::{Body, Chain, Flow, Push, Settled};
use crate::energy_balance::{Account, EnergyBalance};

/// The scene's motion over one step of the plant, from its value just after
/// the step's start to that just before its end.
#[derive(Clone, Copy, Debug)]
pub struct MotionStep {
    /// Length, s.
    pub length_s: f64,
    /// Angle and velocity at the start.
    pub from: Body,
    /// Angle and velocity at the end.
    pub to: Body,
}

impl MotionStep {
    /// The angle after `fraction` of the step, rad: a parabola that begins
    /// with the motion's velocity and ends at its angle.
    #[inline]
    pub fn angle_rad(&self, fraction: f64) -> f64 {
        let mean = (self.to.angle_rad - self.from.angle_rad) / self.length_s;
        let v = self.from.omega_rad_s;
        self.from.angle_rad + self.length_s * fraction * (v + fraction * (mean - v))
    }
}

/// The stretch of a step that is being solved, as fractions of it.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// Start, as a fraction of the step.
    pub from: f64,
    /// End, as a fraction of the step.
    pub to: f64,
    /// Length of the stretch, s.
    pub length_s: f64,
}

cloned_in_boxes!(Boundary, BoxedBoundary);

/// Holds the right end.
pub trait Boundary: Send + BoxedBoundary {
    /// The motion's velocity jumps, and takes along what it can of the chain.
    fn jump(&mut self, _: f64, _: &mut Body, _: &mut dyn Chain) {}

    /// A step begins.
    fn begin(&mut self, _: &MotionStep) {}

    /// Sets the torque of a hand that [pushes](Pushed) from now on, N·m, positive toward growing angle; nothing to
    /// others.
    fn push(&mut self, _torque_nm: f64) {}

    /// The mean velocity of the right end and the torque on the boundary, for
    /// a chain that pushes like this.
    fn solve(&mut self, stretch: &Stretch, body: &Body, push: Push) -> Flow;

    /// Makes the step: `next` is what the chain has made of the body, `cut`
    /// whether the step continues after this stretch.
    fn settle(
        &mut self,
        stretch: &Stretch,
        body: &mut Body,
        next: Body,
        flow: Flow,
        settled: &Settled,
        rigid_kg_m2: f64,
    );

    /// Impulse felt so far, N·m·s: the mean torque that a force sensor
    /// between leg and hand shows is what it grows by, over the time.
    /// Positive opposes growing angle.
    fn felt_nms(&self) -> f64 {
        0.0
    }

    /// The part of that which came in impacts, N·m·s: at once, so that no torque
    /// can be said of it.
    fn struck_nms(&self) -> f64 {
        0.0
    }

    /// Inertia that it adds to the right end, kg·m².
    fn inertia_kg_m2(&self) -> f64 {
        0.0
    }

    /// Adds supplied, stored and dissipated energy to the balance.
    fn energy(&self, _: &Body, _: &mut EnergyBalance) {}

    /// Names of the columns in a trace.
    fn columns(&self) -> &'static [&'static str] {
        &[]
    }

    /// Writes them.
    fn write(&self, _: &mut Vec<f64>) {}
}

impl Boundary for Box<dyn Boundary> {
    fn jump(&mut self, omega_rad_s: f64, body: &mut Body, chain: &mut dyn Chain) {
        self.as_mut().jump(omega_rad_s, body, chain);
    }

    #[inline]
    fn begin(&mut self, motion: &MotionStep) {
        self.as_mut().begin(motion);
    }

    fn push(&mut self, torque_nm: f64) {
        self.as_mut().push(torque_nm);
    }

    #[inline]
    fn solve(&mut self, stretch: &Stretch, body: &Body, push: Push) -> Flow {
        self.as_mut().solve(stretch, body, push)
    }

    #[inline]
    fn settle(
        &mut self,
        stretch: &Stretch,
        body: &mut Body,
        next: Body,
        flow: Flow,
        settled: &Settled,
        rigid_kg_m2: f64,
    ) {
        self.as_mut()
            .settle(stretch, body, next, flow, settled, rigid_kg_m2);
    }

    #[inline]
    fn felt_nms(&self) -> f64 {
        self.as_ref().felt_nms()
    }

    #[inline]
    fn struck_nms(&self) -> f64 {
        self.as_ref().struck_nms()
    }

    fn inertia_kg_m2(&self) -> f64 {
        self.as_ref().inertia_kg_m2()
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        self.as_ref().energy(body, balance);
    }

    fn columns(&self) -> &'static [&'static str] {
        self.as_ref().columns()
    }

    fn write(&self, row: &mut Vec<f64>) {
        self.as_ref().write(row);
    }
}

/// The right end has the prescribed motion, whatever torque that takes.
#[derive(Clone, Copy, Debug)]
pub struct Prescribed {
    motion: MotionStep,
    felt_nms: f64,
    struck_nms: f64,
    work_j: f64,
}

impl Prescribed {
    /// A motion that begins at `start`.
    pub fn new(start: Body) -> Self {
        Self {
            motion: MotionStep {
                length_s: 1.0,
                from: start,
                to: start,
            },
            felt_nms: 0.0,
            struck_nms: 0.0,
            work_j: 0.0,
        }
    }

    /// Sets the motion's velocity for all parts that are rigid with it.
    #[inline]
    fn carry(&mut self, body: &mut Body, omega_rad_s: f64, rigid_kg_m2: f64) {
        let impulse = rigid_kg_m2 * (omega_rad_s - body.omega_rad_s);
        self.felt_nms += impulse;
        self.work_j += impulse * f64::midpoint(omega_rad_s, body.omega_rad_s);
        body.omega_rad_s = omega_rad_s;
    }
}

impl Boundary for Prescribed {
    fn jump(&mut self, omega_rad_s: f64, body: &mut Body, chain: &mut dyn Chain) {
        chain.jerk(body, omega_rad_s - body.omega_rad_s);
        self.carry(body, omega_rad_s, chain.inertia_kg_m2());
    }

    #[inline]
    fn begin(&mut self, motion: &MotionStep) {
        self.motion = *motion;
    }

    #[inline]
    fn solve(&mut self, stretch: &Stretch, _: &Body, push: Push) -> Flow {
        let travel = self.motion.angle_rad(stretch.to) - self.motion.angle_rad(stretch.from);
        let omega_rad_s = travel / stretch.length_s;
        let mut torque_nm = push.at(omega_rad_s);
        if let Some(limit) = push.held_by_nm {
            // At rest the friction carries as much as it can, the hand the rest. A device that
            // diverges makes the limit no number, of which `clamp` panics.
            torque_nm -= torque_nm.max(-limit).min(limit);
        }
        Flow {
            omega_rad_s,
            torque_nm,
        }
    }

    #[inline]
    fn settle(
        &mut self,
        stretch: &Stretch,
        body: &mut Body,
        next: Body,
        flow: Flow,
        settled: &Settled,
        rigid_kg_m2: f64,
    ) {
        self.felt_nms -= flow.torque_nm * stretch.length_s + settled.impulse_nms;
        self.struck_nms -= settled.impulse_nms;
        self.work_j -= flow.torque_nm * stretch.length_s * flow.omega_rad_s
            + settled.impulse_nms * next.omega_rad_s;
        *body = next;
        if stretch.to >= 1.0 {
            if rigid_kg_m2 == 0.0 {
                // Nothing takes an impulse.
                body.omega_rad_s = self.motion.to.omega_rad_s;
            } else {
                self.carry(body, self.motion.to.omega_rad_s, rigid_kg_m2);
            }
            body.angle_rad = self.motion.to.angle_rad;
        }
    }

    #[inline]
    fn felt_nms(&self) -> f64 {
        self.felt_nms
    }

    #[inline]
    fn struck_nms(&self) -> f64 {
        self.struck_nms
    }

    fn inertia_kg_m2(&self) -> f64 {
        f64::INFINITY
    }

    fn energy(&self, _: &Body, balance: &mut EnergyBalance) {
        balance.add("motion", "work", Account::Given, self.work_j);
    }
}

/// Boundary without a holder: the right end swings freely.
#[derive(Clone, Copy, Debug, Default)]
pub struct Released;

impl Boundary for Released {
    fn solve(&mut self, _: &Stretch, _: &Body, push: Push) -> Flow {
        Flow {
            omega_rad_s: match push.held_by_nm {
                Some(_) => 0.0,
                None => push.torque_nm / push.slope_nms,
            },
            torque_nm: 0.0,
        }
    }

    fn settle(&mut self, _: &Stretch, body: &mut Body, next: Body, _: Flow, _: &Settled, _: f64) {
        *body = next;
    }
}

/// Boundary of a torque: a hand that pushes the right end, and has no mass of its own.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pushed {
    torque_nm: f64,
    felt_nms: f64,
    work_j: f64,
}

impl Boundary for Pushed {
    fn push(&mut self, torque_nm: f64) {
        self.torque_nm = torque_nm;
    }

    fn solve(&mut self, _: &Stretch, _: &Body, push: Push) -> Flow {
        push.meets(self.torque_nm, 0.0)
    }

    fn settle(
        &mut self,
        stretch: &Stretch,
        body: &mut Body,
        next: Body,
        flow: Flow,
        _: &Settled,
        _: f64,
    ) {
        let impulse_nms = self.torque_nm * stretch.length_s;
        self.felt_nms += impulse_nms;
        self.work_j += impulse_nms * flow.omega_rad_s;
        *body = next;
    }

    fn felt_nms(&self) -> f64 {
        self.felt_nms
    }

    fn energy(&self, _: &Body, balance: &mut EnergyBalance) {
        balance.add("hand", "work", Account::Given, self.work_j);
    }
}
