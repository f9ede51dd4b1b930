//! The mechanics between motor and hand: a chain of bodies, one effect a part.
//!
//! ```text
//! actuator ─> shaft ─ drivetrain ─ backlash ─ cuff ─ limb ─> boundary
//!              └──────────── chain, left to right ───────┘
//! ```
//!
//! Each step is the implicit midpoint rule: with w the mean velocity of a body
//! over a step of length h,
//!
//! ```text
//! 2J/h·(w − v) = torque at mid-step,   v ← 2w − v,   φ ← φ + h·w
//! ```
//!
//! The rule is stable for any stiffness and damps nothing of its own: kinetic and
//! elastic energy change by exactly the work of the torques that it used, so
//! what an effect stores and loses is known to rounding. (Implicit Euler would
//! be as stable, and add damping ωn·h/2: see the book on what that does to a
//! grating joint.)
//!
//! What stands left of a point of the chain acts on what stands right of it
//! with a torque that is affine in the mean velocity there, a − b·w. So each
//! part *folds* what is left of it into two numbers, the boundary at the right
//! end solves one equation, and the parts *settle* with the answer. Parts that
//! a scene leaves out are not in the chain.
//!
//! Dry friction and contact switch between smooth modes. A part looks at each
//! solution with [`Chain::check`]: a mode that does not hold is changed and the
//! step folded again; an end of a mode inside the step is located there, the
//! step cut in two.

use crate::boxed::cloned_in_boxes;
use crate::coil::Coil;
use crate::energy_balance::EnergyBalance;
use crepitus_model::Sense;

/// A body of the chain, all referred to the joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// Angle, rad.
    pub angle_rad: f64,
    /// Velocity, rad/s.
    pub omega_rad_s: f64,
}

impl Body {
    /// The body after a step of `length_s` with mean velocity `mean_rad_s`.
    #[inline]
    #[must_use]
    pub fn after(&self, length_s: f64, mean_rad_s: f64) -> Self {
        Self {
            angle_rad: self.angle_rad + length_s * mean_rad_s,
            omega_rad_s: 2.0 * mean_rad_s - self.omega_rad_s,
        }
    }
}

/// A mean torque over a step as a function of the mean velocity w of the body
/// that it acts on: `torque_nm − slope_nms·w`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// Torque at w = 0, N·m, in the direction of growing angle.
    pub torque_nm: f64,
    /// Rate at which it falls with w, N·m·s/rad.
    pub slope_nms: f64,
    /// The body is held by dry friction of up to this torque, N·m; the other
    /// numbers leave that friction out.
    pub held_by_nm: Option<f64>,
}

impl Push {
    /// The torque at mean velocity `w`, N·m.
    #[inline]
    pub fn at(&self, w: f64) -> f64 {
        self.torque_nm - self.slope_nms * w
    }

    /// The solution at a body on which `torque_nm − slope_nms·w` acts, too.
    #[inline]
    pub fn meets(&self, torque_nm: f64, slope_nms: f64) -> Flow {
        let omega_rad_s = match self.held_by_nm {
            Some(_) => 0.0,
            None => (self.torque_nm + torque_nm) / (self.slope_nms + slope_nms),
        };
        Flow {
            omega_rad_s,
            torque_nm: slope_nms * omega_rad_s - torque_nm,
        }
    }

    /// This push and the inertia of `inertia_kg_m2` on the same body.
    #[inline]
    #[must_use]
    pub fn with_inertia(mut self, inertia_kg_m2: f64, step: &Step, body: &Body) -> Self {
        let slope = step.inertial_slope(inertia_kg_m2);
        self.torque_nm += slope * body.omega_rad_s;
        self.slope_nms += slope;
        self
    }
}

/// Data of a step that all parts know.
#[derive(Clone, Copy, Debug, Default)]
pub struct Step {
    /// Length, s.
    pub length_s: f64,
    /// Action of the actuator on the shaft.
    pub drive: Push,
    /// Torque that goes through the gear, N·m.
    pub load_nm: f64,
    /// Bridge of the actuator on the shell.
    pub coil: Coil,
    /// The step continues from an end of a mode.
    pub cut: bool,
}

impl Step {
    /// 2J/h, N·m·s/rad.
    #[inline]
    pub fn inertial_slope(&self, inertia_kg_m2: f64) -> f64 {
        2.0 * inertia_kg_m2 / self.length_s
    }
}

/// The solution of a step at one point of the chain.
#[derive(Clone, Copy, Debug)]
pub struct Flow {
    /// Mean velocity of the body, rad/s.
    pub omega_rad_s: f64,
    /// Mean torque of the left side on the right side of the point, N·m.
    pub torque_nm: f64,
}

/// A part's verdict on a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The solution holds.
    Holds,
    /// A mode did not hold and is another now: fold again.
    Again,
    /// A mode ends after this fraction of the step.
    EndsAt(f64),
}

impl Verdict {
    /// The more urgent of two: what changes a mode, or ends earlier.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Again, _) | (_, Self::Again) => Self::Again,
            (Self::EndsAt(a), Self::EndsAt(b)) => Self::EndsAt(a.min(b)),
            (Self::Holds, other) => other,
            (this, Self::Holds) => this,
        }
    }
}

/// Result of a settled step for the parts further right.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settled {
    /// Mean velocity of the motor's shaft, rad/s.
    pub shaft_rad_s: f64,
    /// Impulse of an impact on a body whose velocity is prescribed, N·m·s.
    pub impulse_nms: f64,
    /// Change of a free body's velocity in an impact, rad/s.
    pub struck_rad_s: f64,
}

/// The impacts of a run. Each takes no time: it has an impulse, and no torque
/// that would not depend on the step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impacts {
    /// Number of impacts.
    pub count: u64,
    /// The largest impulse between the two that met, N·m·s.
    pub largest_nms: f64,
    /// The sum of their magnitudes, N·m·s.
    pub sum_nms: f64,
}

impl Impacts {
    /// Notes an impact of this impulse, N·m·s.
    pub fn note(&mut self, impulse_nms: f64) {
        let size = impulse_nms.abs();
        self.count += 1;
        self.largest_nms = self.largest_nms.max(size);
        self.sum_nms += size;
    }
}

/// The sense of a number that is not zero.
pub(crate) fn sense_of(x: f64) -> Sense {
    Sense::of(x).unwrap_or(Sense::Positive)
}

/// A torque as a function of an angle, N·m and rad.
pub trait Torque: Fn(f64) -> f64 + Send + BoxedTorque {}

impl<T: Fn(f64) -> f64 + Send + Clone + 'static> Torque for T {}

cloned_in_boxes!(Torque, BoxedTorque);
cloned_in_boxes!(Chain, BoxedChain);

/// Weight of what hangs on a chain.
pub type Weight = Box<dyn Torque>;

/// The chain up to one of its parts. `body` is the body at its right end; a
/// part that separates bodies owns the one left of it.
pub trait Chain: Send + BoxedChain {
    /// The chain left of this part; none left of an end.
    fn left(&self) -> Option<&dyn Chain> {
        None
    }

    /// Action of this part and all to its left on the parts to its right.
    fn fold(&mut self, step: &Step, body: &Body) -> Push;

    /// Mean velocity of the motor's shaft in a solution, rad/s.
    fn shaft_mean_rad_s(&self, step: &Step, body: &Body, flow: Flow) -> f64 {
        let own = flow.omega_rad_s;
        self.left()
            .map_or(own, |left| left.shaft_mean_rad_s(step, body, flow))
    }

    /// Looks at a solution; see [`Verdict`].
    fn check(&mut self, _: &Step, _: &Body, _: Flow) -> Verdict {
        Verdict::Holds
    }

    /// Makes the step. `next` is the body after it, and may be changed by an
    /// impact or a stop; `ends_at` is the verdict that the step was cut for.
    fn settle(
        &mut self,
        step: &Step,
        body: &Body,
        next: &mut Body,
        flow: Flow,
        ends_at: Option<f64>,
    ) -> Settled;

    /// The motor's shaft.
    fn shaft(&self, body: &Body) -> Body {
        self.left().map_or(*body, |left| left.shaft(body))
    }

    /// Returns whether shaft and right end are one body, always.
    fn is_rigid(&self) -> bool {
        self.left().is_none_or(Chain::is_rigid)
    }

    /// Inertia that moves rigidly with the right end now, kg·m².
    fn inertia_kg_m2(&self) -> f64 {
        0.0
    }

    /// Receives once, before the first step, the inertia right of this part that
    /// moves rigidly with it; infinite where the motion is prescribed.
    fn attach(&mut self, _: f64) {}

    /// Receives a sudden change of the right end's velocity before it happens: what cannot
    /// be pulled stays behind.
    fn jerk(&mut self, _: &Body, _: f64) {}

    /// The torque that the chain's own weight and the like exert on its right
    /// end at rest, as a function of the angle; `None` without such a part.
    fn weight(&self) -> Option<Weight> {
        self.left()?.weight()
    }

    /// Accounting what each part stores now and has lost so far.
    fn energy(&self, _: &Body, _: &mut EnergyBalance) {}

    /// Names of the columns in a trace.
    fn columns(&self, _: &mut Vec<&'static str>) {}

    /// Writes them.
    fn write(&self, _: &Body, _: &mut Vec<f64>) {}

    /// The impacts so far, if a part of the chain can have any.
    fn impacts(&self) -> Option<Impacts> {
        self.left()?.impacts()
    }

    /// The current of the actuator's coil, A, if a part of the chain has one.
    fn coil_current_a(&self) -> Option<f64> {
        self.left()?.coil_current_a()
    }

    /// Warnings.
    fn warnings(&self, warnings: &mut Vec<String>) {
        if let Some(left) = self.left() {
            left.warnings(warnings);
        }
    }
}

impl Chain for Box<dyn Chain> {
    #[inline]
    fn left(&self) -> Option<&dyn Chain> {
        self.as_ref().left()
    }

    #[inline]
    fn fold(&mut self, step: &Step, body: &Body) -> Push {
        self.as_mut().fold(step, body)
    }

    #[inline]
    fn shaft_mean_rad_s(&self, step: &Step, body: &Body, flow: Flow) -> f64 {
        self.as_ref().shaft_mean_rad_s(step, body, flow)
    }

    #[inline]
    fn check(&mut self, step: &Step, body: &Body, flow: Flow) -> Verdict {
        self.as_mut().check(step, body, flow)
    }

    #[inline]
    fn settle(
        &mut self,
        step: &Step,
        body: &Body,
        next: &mut Body,
        flow: Flow,
        ends_at: Option<f64>,
    ) -> Settled {
        self.as_mut().settle(step, body, next, flow, ends_at)
    }

    #[inline]
    fn shaft(&self, body: &Body) -> Body {
        self.as_ref().shaft(body)
    }

    fn is_rigid(&self) -> bool {
        self.as_ref().is_rigid()
    }

    #[inline]
    fn inertia_kg_m2(&self) -> f64 {
        self.as_ref().inertia_kg_m2()
    }

    fn attach(&mut self, right_kg_m2: f64) {
        self.as_mut().attach(right_kg_m2);
    }

    fn jerk(&mut self, body: &Body, change_rad_s: f64) {
        self.as_mut().jerk(body, change_rad_s);
    }

    fn weight(&self) -> Option<Weight> {
        self.as_ref().weight()
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        self.as_ref().energy(body, balance);
    }

    fn columns(&self, names: &mut Vec<&'static str>) {
        self.as_ref().columns(names);
    }

    fn write(&self, body: &Body, row: &mut Vec<f64>) {
        self.as_ref().write(body, row);
    }

    fn impacts(&self) -> Option<Impacts> {
        self.as_ref().impacts()
    }

    fn coil_current_a(&self) -> Option<f64> {
        self.as_ref().coil_current_a()
    }

    fn warnings(&self, warnings: &mut Vec<String>) {
        self.as_ref().warnings(warnings);
    }
}

/// The left end: the motor's shaft, on which the actuator acts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shaft;

impl Chain for Shaft {
    #[inline]
    fn fold(&mut self, step: &Step, _: &Body) -> Push {
        step.drive
    }

    #[inline]
    fn settle(&mut self, _: &Step, _: &Body, _: &mut Body, flow: Flow, _: Option<f64>) -> Settled {
        Settled {
            shaft_rad_s: flow.omega_rad_s,
            ..Settled::default()
        }
    }
}
