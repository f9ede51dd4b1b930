//! # The joint of Crepitus
//!
//! A diseased knee grates because cartilage sticks and slips. Ishikawa,
//! Okamoto et al. render this with an *imaginary object* of inertia J on a
//! rotary spring kr, dragged by the joint's shaft through Coulomb friction:
//!
//! ```text
//!  hand ── shaft φ, Ω ──┤friction: Ts in stick, Tk in slip├── object θ, J ──/\/\/ kr ── ground
//!
//!            J·θ̈ + c·θ̇ + kr·θ = T          T is the torque shown to the hand
//!
//!  stick: θ follows the shaft by position, T grows      until |T| = Ts
//!  slip:  T = s·Tk, the object swings freely            until the velocities match
//! ```
//!
//! φ grows with flexion; T > 0 opposes growing φ, so the torque on the leg is
//! −T. All quantities are SI.
//!
//! The crate is `no_std`, allocates nothing, and its control path neither
//! panics nor loops without a bound: the same code runs in the firmware, in the
//! simulator and on the host, in f32 or f64. Its only `unsafe` is the square root
//! of a Cortex-M4F, one instruction.
//!
//! | to find | look in |
//! |---|---|
//! | how a parameter is declared: name, unit, range, id | [`parameters`] |
//! | the joint: its settings and presets, the numbers that a step uses, the shaft's path, the object's free motion | [`joint`] |
//! | the solver ladder: phases stepped through, slips carried forward, events located | [`solver`] |
//! | the rendering pipeline, from sample to torque; a file for every stage | [`render`] |
//! | encoder, motor current, device limits, the observer of the hand's energy | [`control`] |
//! | f32 and f64 | [`real`] |
#![no_std]
#![deny(unsafe_code)]
#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::float_cmp
)]
#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing,
        clippy::float_cmp
    )
)]

#[cfg(test)]
extern crate std;

#[macro_use]
mod named;

pub mod control;
pub mod joint;
pub mod parameters;
pub mod real;
pub mod render;
pub mod solver;

pub use control::current_loop::CurrentLoop;
pub use control::energy_observer::EnergyObserver;
pub use joint::{
    Convention, EVENTS_PER_STEP, Event, EventKind, Parameters, Phase, Restart, Sense, Settings,
    SettingsError, ShaftStep, StepCoefficients, StickSlip, Validated,
};
pub use parameters::Tabled;
pub use real::Real;
pub use render::Pipeline;
pub use render::crepitus::{Crepitus, Renderer};
pub use render::effects::bone_shaping::BoneShaping;
pub use render::effects::friction_compensation::FrictionCompensation;
pub use render::guarded::Guarded;
pub use render::input_check::Sample;
pub use solver::frozen::Frozen;
pub use solver::velocity_match::VelocityMatch;
