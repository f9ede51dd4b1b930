//! # Parameters of the brace from a weight that swings in it
//!
//! A bar of known mass is strapped into the cuffs, lifted and let go of. It is known in
//! N·m what gravity does to it, so what friction, gap and cuffs do to its swing, as the
//! encoder at the motor sees it, comes out in absolute units; and what the motor does,
//! if it is on, whose current is recorded with every sample.
//!
//! ```text
//! Recording ─> swings ─> start ─> fit ─┬─> Refusal: what it shows instead, what to do
//!  + Weight     whole?   guesses       └─> Brace: each Quantity with its interval,
//!                                           or why it is not visible ─> scene
//! ```
//!
//! | to find | look in |
//! |---|---|
//! | the equations | [`swing`](crepitus_plant::swing) |
//! | what is compared, and the intervals | `problem.rs`, `prior.rs`, `fit.rs` |
//! | where a swing begins and ends | `swing.rs`, `passing.rs` |
//! | the quantities, and where each stands in a scene | [`Quantity`] |
//! | what the model of rigid parts leaves out, and how a result names it | `imperfect.rs`, [`Imperfections`](crepitus_plant::swing::Imperfections) |
//! | a result as JSON | [`summary`] |
//! | what is visible, and what is refused | `visible.rs`, `whole.rs`, `plausible.rs`, [`Refusal`] |
//!
//! ```
//! use crepitus_identify::brace::{Recording, Refusal, TORQUE_DEVIATION, Weight, identify};
//!
//! let weight = Weight::new(2.5, 0.25, None, 0.005);
//! let nothing = Recording {
//!     samples: Vec::new(),
//!     tick_s: 5e-5,
//!     rad_per_count: 36e-6,
//!     torque_constant_nm_per_a: 0.0389,
//!     gear_ratio: 86.0,
//! };
//! let refused = identify(&[nothing], &weight, TORQUE_DEVIATION, &mut |_| true);
//! assert!(matches!(refused, Err(Refusal::Short { .. })));
//! ```

mod fit;
mod identified;
mod imperfect;
mod numbers;
mod passing;
mod plausible;
mod prior;
mod problem;
mod quantity;
mod recording;
mod refusal;
mod residuals;
pub mod scene;
mod shown;
mod start;
mod summary;
mod swing;
mod visible;
mod whole;

pub use identified::{Brace, Trace, TracePoint, identify};
pub use prior::TORQUE_DEVIATION;
pub use quantity::Quantity;
pub use recording::{Measured, Recording, Sample, Weight};
pub use refusal::Refusal;
pub use shown::{Result as QuantityResult, Shown};
pub use summary::summary;
