//! # What a live view shows of a device
//!
//! ```text
//!  rows, 20,000 a second
//!    ├──> [`Envelope`]  lowest and highest of every 5 ms: no spike is lost
//!    └──> [`Pace`]      is the hand too slow, right or too fast? a score afterwards
//! ```
//!
//! The panel in a browser and the monitor on a terminal draw the same bins and judge
//! by the same targets.
//!
//! | to find | look in |
//! |---|---|
//! | the lowest and highest value of a time | `envelope.rs` |
//! | the names of the states in a bin | [`STATES`] |
//! | where an empty end-feel hurts | `pain.rs` |
//! | target speeds by name | `target.rs` |
//! | how well a hand keeps to one | `pace.rs`; strokes are those of [`crepitus_knee::examination`] |

mod envelope;
mod pace;
mod pain;
mod target;

pub use crepitus_model::render::effects::STATES;
pub use envelope::{Bin, Bins, Envelope, Marks};
pub use pace::{Pace, Score, Verdict};
pub use pain::Pain;
pub use target::{Aim, NAMED, Target, TargetError};
