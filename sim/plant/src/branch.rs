//! Branches that hang on the chain beside its way to the hand.

use crate::chain::{Body, Chain, Flow, Push, Settled, Step, Verdict, Weight};
use crate::energy_balance::EnergyBalance;

/// The left end of a branch: nothing acts there.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loose;

impl Chain for Loose {
    fn fold(&mut self, _: &Step, _: &Body) -> Push {
        Push::default()
    }

    fn settle(&mut self, _: &Step, _: &Body, _: &mut Body, _: Flow, _: Option<f64>) -> Settled {
        Settled::default()
    }
}

/// A chain, and a branch that ends at the same body. What is dry friction or an impact
/// is the main chain's.
#[derive(Clone)]
pub struct Branched {
    main: Box<dyn Chain>,
    branch: Box<dyn Chain>,
    /// The branch's push, as last folded.
    push: Push,
}

impl Branched {
    /// Hangs `branch` on the right end of `main`.
    pub fn new(main: Box<dyn Chain>, branch: Box<dyn Chain>) -> Self {
        Self {
            main,
            branch,
            push: Push::default(),
        }
    }

    /// The solution for the branch, and for the main chain.
    fn flows(&self, flow: Flow) -> (Flow, Flow) {
        let torque_nm = self.push.at(flow.omega_rad_s);
        (
            Flow { torque_nm, ..flow },
            Flow {
                torque_nm: flow.torque_nm - torque_nm,
                ..flow
            },
        )
    }
}

impl Chain for Branched {
    fn left(&self) -> Option<&dyn Chain> {
        Some(&*self.main)
    }

    fn fold(&mut self, step: &Step, body: &Body) -> Push {
        let main = self.main.fold(step, body);
        self.push = self.branch.fold(step, body);
        Push {
            torque_nm: main.torque_nm + self.push.torque_nm,
            slope_nms: main.slope_nms + self.push.slope_nms,
            held_by_nm: main.held_by_nm,
        }
    }

    fn shaft_mean_rad_s(&self, step: &Step, body: &Body, flow: Flow) -> f64 {
        self.main.shaft_mean_rad_s(step, body, self.flows(flow).1)
    }

    fn check(&mut self, step: &Step, body: &Body, flow: Flow) -> Verdict {
        let (branch, main) = self.flows(flow);
        let verdict = self.branch.check(step, body, branch);
        verdict.and(self.main.check(step, body, main))
    }

    fn settle(
        &mut self,
        step: &Step,
        body: &Body,
        next: &mut Body,
        flow: Flow,
        ends_at: Option<f64>,
    ) -> Settled {
        let (branch, main) = self.flows(flow);
        let mut own = *next;
        self.branch.settle(step, body, &mut own, branch, ends_at);
        self.main.settle(step, body, next, main, ends_at)
    }

    fn inertia_kg_m2(&self) -> f64 {
        self.main.inertia_kg_m2() + self.branch.inertia_kg_m2()
    }

    fn attach(&mut self, right_kg_m2: f64) {
        self.branch.attach(right_kg_m2 + self.main.inertia_kg_m2());
        self.main.attach(right_kg_m2 + self.branch.inertia_kg_m2());
    }

    fn jerk(&mut self, body: &Body, change_rad_s: f64) {
        self.main.jerk(body, change_rad_s);
    }

    fn weight(&self) -> Option<Weight> {
        match (self.main.weight(), self.branch.weight()) {
            (Some(main), Some(branch)) => Some(Box::new(move |angle| main(angle) + branch(angle))),
            (main, branch) => main.or(branch),
        }
    }

    fn energy(&self, body: &Body, balance: &mut EnergyBalance) {
        self.main.energy(body, balance);
        self.branch.energy(body, balance);
    }

    fn columns(&self, names: &mut Vec<&'static str>) {
        self.main.columns(names);
        self.branch.columns(names);
    }

    fn write(&self, body: &Body, row: &mut Vec<f64>) {
        self.main.write(body, row);
        self.branch.write(body, row);
    }

    fn coil_current_a(&self) -> Option<f64> {
        let own = self.branch.coil_current_a();
        own.or_else(|| self.main.coil_current_a())
    }

    fn warnings(&self, warnings: &mut Vec<String>) {
        self.main.warnings(warnings);
        self.branch.warnings(warnings);
    }
}
