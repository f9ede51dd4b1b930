//! The hand of a person on the leg: the law and the path of [`crepitus_knee::hand`], on the plant.

use crepitus_knee::{Hand, HandPath, HandState};
use crepitus_plant::boundary::{Boundary, MotionStep};
use crepitus_plant::chain::{Body, Chain};
use crepitus_plant::guiding_hand::{GuidingHand, HandNumbers};

/// The hand that takes this leg, at the right end of this chain.
pub(super) fn boundary(leg: Body, chain: &dyn Chain) -> Box<dyn Boundary> {
    let law = Hand::default();
    let numbers = HandNumbers {
        inertia_kg_m2: law.inertia_kg_m2,
        stiffness_nm_per_rad: law.stiffness_nm_per_rad,
        damping_nms_per_rad: law.damping_nms_per_rad,
        limit_nm: law.limit_nm,
    };
    Box::new(GuidingHand::new(numbers, leg, chain))
}

/// The path of a hand that takes this leg.
pub(super) fn path(leg: Body) -> HandPath {
    HandPath::taking(HandState {
        angle_rad: leg.angle_rad,
        omega_rad_s: leg.omega_rad_s,
    })
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
