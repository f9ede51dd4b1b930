//! # The torque constant by a hanging weight
//!
//! A weight hangs on the arm of the brace. The device pulls it aside with a soft spring whose neutral angle moves slowly, and lets
//! it down again. Wherever it moves, friction is against the motion, so the way up and the way
//! down have it with opposite signs:
//!
//! ```text
//! K·i − μ·K·|i|·s = M·sin(φw − φ₀) + F·s        s = ±1, the sense of the motion
//! φw = φ − c·M·sin(φw − φ₀)                     K = Kt·n,   M = m·g·l
//! ```
//!
//! K is the torque at the joint for one ampere without losses, F the dry friction, μ the share of the motor's torque that the gear loses,
//! φ₀ the encoder's angle at which the weight hangs, c what gives way between motor and weight. At one angle half the sum of both
//! currents would give K·(1 − μ²)/(1 + F·μ/(M·sin φ)), some 10 % too little; the whole arc, in which the load grows from nothing to M,
//! separates K, μ and F.
//!
//! Currents are averaged over the *way*, ∫i·dφ/Δφ in every degree: that is the energy balance of the way, whatever the speed was, and
//! what stands still, with a friction that nobody knows, has no weight in it.
//!
//! | to find | look in |
//! |---|---|
//! | means over the way | `hanging/way.rs` |
//! | the fit and the intervals | `hanging/fit.rs` |

mod fit;
mod way;

pub use fit::{HangingFit, Refusal, found};
pub use way::{Mean, means};
