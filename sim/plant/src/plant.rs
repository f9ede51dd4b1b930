//! A plant: actuator, chain and boundary, stepped together.

use crate::actuator::{Actuator, Commanded};
use crate::boundary::{Boundary, MotionStep, Released, Stretch};
use crate::chain::{Body, Chain, Flow, Impacts, Step, Verdict};
use crate::energy_balance::EnergyBalance;

pub use crate::coil::Coil;

/// Ends of modes that are located within one step. What would follow is
/// carried to the step's end in the mode then active.
const ENDS_PER_STEP: u32 = 8;

/// Maximum number of folds of a step until its modes hold. A chain has
/// at most a friction and a contact, with three modes each.
const CHANGES_PER_FOLD: u32 = 6;

/// Maximum number of searches for an end on a stretch that is cut about there.
const LOOKS_PER_END: u32 = 8;

/// The shortest part of a step that an end of a mode can cut off.
const SHORTEST: f64 = 1e-6;

/// A coupled plant. Its parts are those that a scene lists: in boxes, or of types that are
/// known where it is [composed](crate::assembly::compose), and then a tick has nothing of
/// the parts that there are not.
#[derive(Clone)]
pub struct Plant<A = Box<dyn Commanded>, C = Box<dyn Chain>, B = Box<dyn Boundary>> {
    actuator: A,
    chain: C,
    boundary: B,
    /// The body at the right end of the chain.
    body: Body,
    /// Bridge of the actuator on the shell.
    coil: Coil,
    start: EnergyBalance,
}

/// A stretch solved.
#[derive(Clone, Copy)]
struct Solution {
    step: Step,
    flow: Flow,
}

impl<A: Commanded, C: Chain, B: Boundary> Plant<A, C, B> {
    /// Starts a tick with the torque setpoint of the device, N·m, and the voltage that
    /// it commanded for the coil in the tick before, V.
    #[inline]
    pub fn command(&mut self, torque_nm: f64, coil_v: f64) {
        self.actuator.command(torque_nm);
        self.coil = Coil::Driven(coil_v);
    }
}

impl<A: Actuator> Plant<A> {
    /// Releases the right end: from now on nobody holds it. What the hand was given and stored
    /// is no longer in the balance.
    pub fn release(&mut self) {
        self.hold_by(|_| Box::new(Released));
    }

    /// Lets another boundary hold the right end from now on, where it is, made for this chain. The balance
    /// starts again.
    pub fn hold_by(&mut self, make: impl FnOnce(&dyn Chain) -> Box<dyn Boundary>) {
        self.boundary = make(self.chain.as_ref());
        self.chain.attach(self.boundary.inertia_kg_m2());
        self.start = self.booked();
    }
}

impl<A: Actuator, C: Chain, B: Boundary> Plant<A, C, B> {
    /// Couples the parts; the right end begins at `start`.
    pub fn new(actuator: A, mut chain: C, boundary: B, start: Body) -> Self {
        chain.attach(boundary.inertia_kg_m2());
        let mut plant = Self {
            actuator,
            chain,
            boundary,
            body: start,
            coil: Coil::Open,
            start: EnergyBalance::default(),
        };
        plant.start = plant.booked();
        plant
    }

    /// The actuator.
    pub fn actuator(&self) -> &A {
        &self.actuator
    }

    /// The actuator, for commands between two steps.
    pub fn actuator_mut(&mut self) -> &mut A {
        &mut self.actuator
    }

    /// Sets the torque of a hand that [pushes](crate::boundary::Pushed), N·m, positive toward growing angle.
    pub fn push(&mut self, torque_nm: f64) {
        self.boundary.push(torque_nm);
    }

    /// Switches the bridge of the coil.
    pub fn set_coil(&mut self, coil: Coil) {
        self.coil = coil;
    }

    /// Lets the motion's velocity jump to `omega_rad_s` between two steps.
    pub fn jump(&mut self, omega_rad_s: f64) {
        self.boundary
            .jump(omega_rad_s, &mut self.body, &mut self.chain);
    }

    /// One step, in which the scene's motion goes like this.
    #[inline]
    pub fn advance(&mut self, motion: &MotionStep) {
        self.boundary.begin(motion);
        let whole = Stretch {
            from: 0.0,
            to: 1.0,
            length_s: motion.length_s,
        };
        let (solution, end) = self.look(&whole);
        if end.is_none() {
            self.go(&whole, &solution, None);
        } else {
            self.advance_by_ends(motion, (solution, end));
        }
    }

    /// A step in which a mode ends: `found` is the first look at all of it.
    #[cold]
    fn advance_by_ends(&mut self, motion: &MotionStep, found: (Solution, Option<f64>)) {
        let mut found = Some(found);
        let mut from = 0.0;
        for ends in 0..=ENDS_PER_STEP {
            let stretch = |to: f64| Stretch {
                from,
                to,
                length_s: (to - from) * motion.length_s,
            };
            let rest = stretch(1.0);
            let found = found.take().unwrap_or_else(|| self.look(&rest));
            let (part, solution, end) = if ends < ENDS_PER_STEP {
                self.first_end(from, found, stretch)
            } else {
                (rest, found.0, None)
            };
            self.go(&part, &solution, end);
            if part.to >= 1.0 {
                return;
            }
            from = part.to;
        }
    }

    /// The rest of a step up to the first end of a mode, if there is one: of what was found in a
    /// look at all of it.
    ///
    /// Found on a stretch that goes beyond it, an end is a little elsewhere on
    /// the stretch up to it, and so may be the modes: it is looked for again.
    fn first_end(
        &mut self,
        from: f64,
        (mut solution, mut end): (Solution, Option<f64>),
        stretch: impl Fn(f64) -> Stretch,
    ) -> (Stretch, Solution, Option<f64>) {
        let mut part = stretch(1.0);
        // Up to here there was none.
        let mut none = from;
        for _ in 0..LOOKS_PER_END {
            let Some(fraction) = end else {
                return (part, solution, None);
            };
            let mut to = from + fraction.max(SHORTEST) * (part.to - from);
            if to <= none {
                to = f64::midpoint(none, part.to).min(2.0 * none - from);
            }
            if part.to - to < SHORTEST {
                return (part, solution, end);
            }
            let shorter = stretch(to);
            match self.look(&shorter) {
                (_, None) => {
                    none = to;
                    (solution, end) = self.look(&part);
                }
                (found, ends) => (part, solution, end) = (shorter, found, ends),
            }
        }
        if none > from {
            part = stretch(none);
            (solution, end) = self.look(&part);
        }
        (part, solution, end)
    }

    /// Brings the modes in order, solves the stretch in them, and finds the
    /// first mode that ends within.
    #[inline]
    fn look(&mut self, stretch: &Stretch) -> (Solution, Option<f64>) {
        let solution = self.solve(stretch);
        match self.check(&solution) {
            Verdict::Holds => (solution, None),
            Verdict::EndsAt(fraction) => (solution, Some(fraction)),
            Verdict::Again => self.look_again(stretch),
        }
    }

    /// Looks at a stretch after a mode has changed.
    #[cold]
    fn look_again(&mut self, stretch: &Stretch) -> (Solution, Option<f64>) {
        for _ in 2..CHANGES_PER_FOLD {
            let solution = self.solve(stretch);
            match self.check(&solution) {
                Verdict::Holds => return (solution, None),
                Verdict::EndsAt(fraction) => return (solution, Some(fraction)),
                Verdict::Again => {}
            }
        }
        (self.solve(stretch), None)
    }

    #[inline]
    fn check(&mut self, Solution { step, flow }: &Solution) -> Verdict {
        let shaft = || self.chain.shaft_mean_rad_s(step, &self.body, *flow);
        let own = self.actuator.check(step, shaft);
        if own == Verdict::Again {
            // The chain would look at what will not be.
            return own;
        }
        own.and(self.chain.check(step, &self.body, *flow))
    }

    #[inline]
    fn solve(&mut self, stretch: &Stretch) -> Solution {
        let step = Step {
            length_s: stretch.length_s,
            drive: self.actuator.fold(stretch.length_s),
            load_nm: self.actuator.load_nm(),
            coil: self.coil,
            cut: stretch.from > 0.0,
        };
        let push = self.chain.fold(&step, &self.body);
        let flow = self.boundary.solve(stretch, &self.body, push);
        Solution { step, flow }
    }

    /// Goes through a stretch.
    #[inline]
    fn go(&mut self, stretch: &Stretch, Solution { step, flow }: &Solution, ends_at: Option<f64>) {
        let mut next = self.body.after(stretch.length_s, flow.omega_rad_s);
        let settled = self
            .chain
            .settle(step, &self.body, &mut next, *flow, ends_at);
        let rigid = self.chain.inertia_kg_m2();
        self.boundary
            .settle(stretch, &mut self.body, next, *flow, &settled, rigid);
        self.actuator.settle(stretch.length_s, settled.shaft_rad_s);
    }

    /// The motor's shaft, referred to the joint: where the encoder sits and
    /// the torque is rendered.
    #[inline]
    pub fn shaft(&self) -> Body {
        self.chain.shaft(&self.body)
    }

    /// The right end of the chain: the leg, where the hand is.
    #[inline]
    pub fn leg(&self) -> Body {
        self.body
    }

    /// Impulse that the hand has felt so far, N·m·s; see
    /// [`Boundary::felt_nms`].
    #[inline]
    pub fn felt_nms(&self) -> f64 {
        self.boundary.felt_nms()
    }

    /// The part of that which came in impacts, N·m·s.
    #[inline]
    pub fn struck_nms(&self) -> f64 {
        self.boundary.struck_nms()
    }

    /// The impacts so far; none if no part of it can have any.
    pub fn impacts(&self) -> Option<Impacts> {
        self.chain.impacts()
    }

    /// The current of the coil of the actuator on the shell, A, if there is one.
    pub fn coil_current_a(&self) -> Option<f64> {
        self.chain.coil_current_a()
    }

    /// Work that the actuator has taken out of the mechanics so far, J.
    pub fn absorbed_j(&self) -> f64 {
        self.actuator.absorbed_j()
    }

    /// The energy balance since the start.
    pub fn balance(&self) -> EnergyBalance {
        self.booked().since(&self.start)
    }

    fn booked(&self) -> EnergyBalance {
        let mut balance = EnergyBalance::default();
        self.boundary.energy(&self.body, &mut balance);
        self.actuator.energy(&mut balance);
        self.chain.energy(&self.body, &mut balance);
        balance
    }

    /// Names of the columns that its parts have in a trace.
    pub fn columns(&self) -> Vec<&'static str> {
        let mut names = self.actuator.columns().to_vec();
        self.chain.columns(&mut names);
        if !self.chain.is_rigid() {
            names.extend(["leg_angle_rad", "leg_omega_rad_s"]);
        }
        names.extend(self.boundary.columns());
        names
    }

    /// Writes them.
    pub fn write(&self, row: &mut Vec<f64>) {
        self.actuator.write(row);
        self.chain.write(&self.body, row);
        if !self.chain.is_rigid() {
            row.extend([self.body.angle_rad, self.body.omega_rad_s]);
        }
        self.boundary.write(row);
    }

    /// Warnings.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        self.chain.warnings(&mut warnings);
        warnings
    }
}
