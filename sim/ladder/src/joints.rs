//! # Many joints at once
//!
//! Joints that differ in their parameters, on one motion or each on its own, with the bits that each
//! has by itself.
//!
//! ```text
//!  motion ──> Joints ──┬─ steps: joint by joint through an array of steps ──> columns
//!   (one, or n)        └─ step:  all of them by one step                  ──> torque, phase
//! ```
//!
//! The rung of the ladder is chosen once, where the first joint is made; from there on a loop knows its
//! type. A slip of `frozen` lasts a known time: through it a loop over steps fills arrays, and computes the
//! object's motion in lanes of f32 or f64; a loop over joints counts down. Slips of `paper` and `physical` are
//! stepped side by side. Lanes are as wide as the registers of the processor are.
//!
//! | to find | look in |
//! |---|---|
//! | joints, their state and its copies | `joints` |
//! | a joint with its shaft | `each` |
//! | a loop over steps, for every rung | `loops` |
//! | joints of a rung without its type | `many` |
//! | what a step is given and what is kept of it | `motion` |
//! | energy that a joint can return | `passivity` |
//! | joints of a rung step by step; slips in arrays | `rung`, `slips` |
//! | arrays of steps side by side, runtime choice of the instruction set | `lanes` |
mod each;
mod joints;
mod lanes;
mod loops;
mod many;
mod motion;
mod passivity;
mod rung;
mod slips;

pub use each::StepPart;
pub use joints::{JointError, Joints};
pub use many::Lanes;
pub use motion::{Columns, Counts, Motion, State, StepEvent};
pub use passivity::Passivity;
