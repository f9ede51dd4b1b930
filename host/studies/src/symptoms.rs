//! Symptoms besides crepitus, as studies run them: the law that the device
//! renders, in steps, and the event-driven reference, on one motion.
//!
//! | to find | look in |
//! |---|---|
//! | a symptom and its settings | [`given`] |
//! | a motion of the hand, in degrees | [`hand`] |
//! | what happens, and when | [`event`] |
//! | errors of the steps | `errors` |
//! | the law alone, step by step | [`follow`] |
//! | the reference, event by event | [`truth`] |

pub(crate) mod errors;
pub mod event;
pub mod follow;
pub mod given;
pub mod hand;
pub mod truth;

pub use event::SymptomEvent;
pub use given::Given;
pub use hand::Hand;
