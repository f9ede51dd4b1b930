//! The hand of a person in place of the scene's motion.
//!
//! ```text
//!  scene's motion ── aim ──> the hand has the leg ── release ──> way back ──> scene's motion, from its start
//! ```
//!
//! Between two ticks another boundary holds the leg, at the angle and the velocity that it has: nothing
//! jumps but what the hand pulls with.

use super::lead_in::LeadIn;
use super::{HandInput, Leg, TICK_S};
use crepitus_knee::{Hand, HandPath, HandState};
use crepitus_plant::Motion;
use crepitus_plant::boundary::MotionStep;
use crepitus_plant::chain::Body;
use crepitus_plant::guiding_hand::{GuidingHand, HandNumbers};
use crepitus_scene::Walk;

impl Leg {
    /// Input of a hand that moves the leg.
    pub fn hand(&self) -> HandInput {
        self.input.clone()
    }

    /// Takes, moves or gives back the leg at the end of a tick, as the input says.
    pub(super) fn follow_hand(&mut self) {
        if self.path.is_some() {
            self.before_s += TICK_S;
        }
        let target_rad = self.input.target_rad();
        if target_rad != self.target_rad {
            self.target_rad = target_rad;
            self.execute(target_rad);
        }
        let hand_rad = self.path.as_ref().map(|path| path.state().angle_rad);
        self.input.report(hand_rad, self.plant.shaft().angle_rad);
    }

    fn execute(&mut self, target_rad: Option<f64>) {
        let Some(target_rad) = target_rad else {
            if self.path.is_some() {
                self.give_back();
            }
            return;
        };
        if self.path.is_none() {
            self.take();
        }
        if let Some(path) = &mut self.path {
            path.aim(target_rad);
        }
    }

    /// Lets the hand hold the leg where it is.
    fn take(&mut self) {
        let body = self.plant.leg();
        let law = Hand::default();
        let numbers = HandNumbers {
            inertia_kg_m2: law.inertia_kg_m2,
            stiffness_nm_per_rad: law.stiffness_nm_per_rad,
            damping_nms_per_rad: law.damping_nms_per_rad,
            limit_nm: law.limit_nm,
        };
        self.plant
            .hold_by(|chain| Box::new(GuidingHand::new(numbers, body, chain)));
        self.lead_in = None;
        self.before_s += self.walk.time_s();
        self.walk = Walk::new(Motion::rest(body.angle_rad), self.step_s);
        self.path = Some(HandPath::taking(HandState {
            angle_rad: body.angle_rad,
            omega_rad_s: body.omega_rad_s,
        }));
    }

    /// Lets the scene hold the leg again, and leads it to the scene's motion.
    fn give_back(&mut self) {
        self.path = None;
        let (scene, body) = (&self.scene, self.plant.leg());
        self.plant
            .hold_by(|chain| scene.boundary(TICK_S, body, chain));
        if scene.is_held() {
            let (lead_in, way) = LeadIn::back(body, scene);
            self.lead_in = Some(lead_in);
            self.walk = Walk::new(way, self.step_s);
        }
    }
}

/// The next step of a hand's path.
pub(super) fn step(path: &mut HandPath, step_s: f64) -> MotionStep {
    let from = body(path.state());
    MotionStep {
        length_s: step_s,
        from,
        to: body(path.advance(step_s)),
    }
}

fn body(hand: HandState) -> Body {
    Body {
        angle_rad: hand.angle_rad,
        omega_rad_s: hand.omega_rad_s,
    }
}
