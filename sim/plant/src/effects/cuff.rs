//! `cuff`: the brace on a leg that is not bone.
//!
//! ```text
//! torque on the leg = k·(φ_brace − φ_leg) + b·(Ω_brace − Ω_leg)
//! ```
//!
//! | number | default | source |
//! |---|---|---|
//! | stiffness | 120 N·m/rad | estimate: 3 N/mm of a cuff at 0.2 m; plausible 60 (two in series) to 300 |
//! | damping | 1 N·m·s/rad | estimate, 0.5 to 2 |
//! | brace inertia | 0.01 kg·m² | estimate: 0.25 kg at 0.2 m |
//!
//! With the drivetrain's 0.061 kg·m² on its left it is a low-pass at 7 Hz for
//! what is rendered: crepitus at 31.8 Hz and the tibia's 115 Hz reach the leg
//! through its tail. The brace turns about the knee's axis only; it cannot
//! pull the shank along its length.

use crate::compliance::{Compliance, Kind};
use crate::effect::{Effect, Part, numbers, parameters};

/// The effect.
pub const EFFECT: Effect = Effect {
    name: NAME,
    adds: "the compliance between brace and leg: straps, padding and soft tissue",
    states: &["brace angle", "brace velocity"],
    parameters: parameters! {
        stiffness_nm_per_rad "k" "N·m/rad", 0.1..=1e6, 120.0, "stiffness of the cuffs about the knee";
        damping_nms_per_rad "b" "N·m·s/rad", 0.0..=1e3, 1.0, "damping of the cuffs about the knee";
        brace_inertia_kg_m2 "J_b" "kg·m²", 1e-5..=10.0, 0.01, "inertia of the brace about the knee";
    },
    choices: &[],
    needs: &[],
    part: Part::Link(|given, context, left| {
        let [stiffness, damping, inertia_kg_m2] = numbers(given);
        Box::new(Compliance::new(
            left,
            context.start,
            &KIND,
            stiffness,
            damping,
            inertia_kg_m2,
        ))
    }),
};

const NAME: &str = "cuff";

const KIND: Kind = Kind {
    effect: NAME,
    body: "brace",
    column: "brace_torque_nm",
    advice: "torques at brace and leg are not those of such a cuff: choose more substeps, a softer cuff or a larger \
             brace_inertia_kg_m2",
};
