//! Torque on the body at the right end of a chain, and inertia that moves with
//! it: the simplest part, and most effects of a leg are one.

use crate::chain::{Body, Chain, Flow, Push, Settled, Step, Verdict, Weight};
use crate::energy_balance::{Account, EnergyBalance};

/// A torque that depends on the body's motion, and an inertia.
pub trait Load: Clone + Send + 'static {
    /// The effect that it belongs to.
    const NAME: &'static str;
    /// Column of the load: the torque, positive where it opposes growing angle.
    const COLUMN: &'static str;
    /// Further columns, which [`Load::write_more`] fills.
    const MORE: &'static [&'static str] = &[];

    /// Inertia, kg·m².
    fn inertia_kg_m2(&self) -> f64;

    /// The mean torque of a step, without that of the inertia. It does not
    /// hold the body.
    fn pull(&self, step: &Step, body: &Body) -> Push;

    /// A step was made, to `next`, with this mean velocity.
    fn moved(&mut self, step: &Step, next: &Body, mean_rad_s: f64);

    /// Torque of the load on a body at rest, N·m, as a function of the angle, if it
    /// has one: a hand that lifts the leg knows it.
    fn weight(&self) -> Option<Weight> {
        None
    }

    /// Adds stored and dissipated energy to the balance, without the kinetic
    /// energy.
    fn energy(&self, body: &Body, balance: &mut EnergyBalance);

    /// The current of an actuator's coil, A, if it has one.
    fn coil_current_a(&self) -> Option<f64> {
        None
    }

    /// Writes its further columns.
    fn write_more(&self, _: &Body, _: &mut Vec<f64>) {}

    /// Warnings.
    fn warnings(&self, _: &mut Vec<String>) {}
}

/// The chain up to a load.
#[derive(Clone)]
pub struct Loaded<L> {
    left: Box<dyn Chain>,
    load: L,
    /// The load's push, with its inertia, as last folded.
    push: Push,
    /// Torque of the load in the last step, without that of the inertia, N·m; none
    /// before the first.
    mean_nm: Option<f64>,
}

impl<L: Load + 'static> Loaded<L> {
    /// Puts a load on the right end.
    pub fn on(left: Box<dyn Chain>, load: L) -> Box<dyn Chain> {
        Box::new(Self {
            left,
            load,
            push: Push::default(),
            mean_nm: None,
        })
    }
}

impl<L: Load> Loaded<L> {
    /// Action of the parts to the left on the body.
    fn left_flow(&self, flow: Flow) -> Flow {
        Flow {
            torque_nm: flow.torque_nm - self.push.at(flow.omega_rad_s),
            ..flow
        }
    }
}

impl<L: Load> Chain for Loaded<L> {
    fn left(&self) -> Option<&dyn Chain> {
        Some(&*self.left)
    }

    fn fold(&mut self, step: &Step, body: &Body) -> Push {
        let left = self.left.fold(step, body);
        self.push = self
            .load
            .pull(step, body)
            .with_inertia(self.load.inertia_kg_m2(), step, body);
        Push {
            torque_nm: left.torque_nm + self.push.torque_nm,
            slope_nms: left.slope_nms + self.push.slope_nms,
            held_by_nm: left.held_by_nm,
        }
    }

    fn shaft_mean_rad_s(&self, step: &Step, body: &Body, flow: Flow) -> f64 {
        let left = self.left_flow(flow);
        self.left.shaft_mean_rad_s(step, body, left)
    }

    fn check(&mut self, step: &Step, body: &Body, flow: Flow) -> Verdict {
        let left = self.left_flow(flow);
        self.left.check(step, body, left)
    }

    fn settle(
        &mut self,
        step: &Step,
        body: &Body,
        next: &mut Body,
        flow: Flow,
        ends_at: Option<f64>,
    ) -> Settled {
        let w = flow.omega_rad_s;
        let inertial_nm = step.inertial_slope(self.load.inertia_kg_m2()) * (body.omega_rad_s - w);
        self.mean_nm = Some(self.push.at(w) - inertial_nm);
        self.load.moved(step, next, w);
        let left = self.left_flow(flow);
        self.left.settle(step, body, next, left, ends_at)
    }

    fn inertia_kg_m2(&self) -> f64 {
        self.load.inertia_kg_m2() + self.left.inertia_kg_m2()
    }

    fn attach(&mut self, right_kg_m2: f64) {
        self.left.attach(right_kg_m2 + self.load.inertia_kg_m2());
    }

    fn jerk(&mut self, body: &Body, change_rad_s: f64) {
        self.left.jerk(body, change_rad_s);
    }

    fn weight(&self) -> Option<Weight> {
        match (self.left.weight(), self.load.weight()) {
            (Some(left), Some(own)) => Some(Box::new(move |angle| left(angle) + own(angle))),
            (left, own) => left.or(own),
        }
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        self.left.energy(body, balance);
        let inertia = self.load.inertia_kg_m2();
        if inertia > 0.0 {
            let kinetic_j = 0.5 * inertia * body.omega_rad_s * body.omega_rad_s;
            balance.add(L::NAME, "kinetic", Account::Stored, kinetic_j);
        }
        self.load.energy(body, balance);
    }

    fn columns(&self, names: &mut Vec<&'static str>) {
        self.left.columns(names);
        names.push(L::COLUMN);
        names.extend(L::MORE);
    }

    fn write(&self, body: &Body, row: &mut Vec<f64>) {
        self.left.write(body, row);
        let torque_nm = self.mean_nm.unwrap_or_else(|| {
            // Before the first step it is that at rest.
            self.load.weight().map_or(0.0, |own| own(body.angle_rad))
        });
        row.push(-torque_nm);
        self.load.write_more(body, row);
    }

    fn coil_current_a(&self) -> Option<f64> {
        self.load
            .coil_current_a()
            .or_else(|| self.left.coil_current_a())
    }

    fn warnings(&self, warnings: &mut Vec<String>) {
        self.left.warnings(warnings);
        self.load.warnings(warnings);
    }
}
