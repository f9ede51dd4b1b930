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
//!  slip:  T = s·Tk, the object swings freely            until it is caught up with
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
//! | what people set, ranges, presets | [`parameters`], [`presets`], [`settings`] |
//! | what a tick uses | [`active`], [`ticks`], [`shaft`] |
//! | the object itself | [`stick_slip`], [`frozen`], [`velocity_match`], [`implicit_euler`] |
//! | how a slip is carried forward | [`propagate`], [`oscillator`] |
//! | how the end of a phase is found | [`locate`] |
//! | which of these a scene or a firmware selects | [`solver`] |
//! | what a device renders, from sample to torque; every stage a file | [`render`] |
//! | what the hand gets back of its work | [`energy_observer`] |
//! | counts of the motor encoder to angle and speed | [`encoder`] |
//! | how the motor's current follows | [`current_loop`] |
//! | what a device never does | [`device_limits`] |
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

pub mod active;
pub mod compensated;
pub mod current_loop;
pub mod device_limits;
pub mod encoder;
pub mod energy_observer;
mod event;
pub mod frozen;
pub mod implicit_euler;
pub mod locate;
pub mod oscillator;
pub mod parameters;
mod phase;
pub mod presets;
pub mod propagate;
pub mod real;
pub mod render;
pub mod settings;
pub mod shaft;
pub mod solver;
pub mod stick_slip;
pub mod ticks;
pub mod velocity_match;

pub use active::Active;
pub use current_loop::CurrentLoop;
pub use energy_observer::EnergyObserver;
pub use event::{EVENTS_PER_STEP, Event};
pub use frozen::Frozen;
pub use parameters::{Parameters, Tabled};
pub use phase::{EventKind, Phase, Sense};
pub use real::Real;
pub use render::Pipeline;
pub use render::bone_shaping::BoneShaping;
pub use render::crepitus::{Crepitus, Renderer};
pub use render::friction_compensation::FrictionCompensation;
pub use render::guarded::Guarded;
pub use render::input_check::Sample;
pub use settings::{Convention, Restart, Settings, SettingsError, Validated};
pub use shaft::ShaftStep;
pub use stick_slip::StickSlip;
pub use velocity_match::VelocityMatch;
