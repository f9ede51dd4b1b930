//! Influence of each effect of a scene on the torque at the hand, and its
//! cost: each is left out in turn, and each absent one added.
//!
//! ```text
//! scene ─────> torque at the hand, tick by tick ─┐
//! variants ──> torque at the hand ───────────────┴─> influence ─┐
//! scene and variants in turn ──> time of a step ────────────────┴─> rows ─┬─> effects.csv
//!                                                                         └─> torques
//! sets of effects, growing ──> the smallest one within a tolerance ─────────> answer
//! ```
//!
//! The torque at the hand is `hand_torque_nm`, the mean of the tick that ended;
//! without a plant it is the joint's own `torque_nm`, and without a joint
//! zero. The first row, before the first tick, is ignored. Events are those of the joint
//! and of the other symptoms, without what the plays under them do.
//!
//! | to find | look in |
//! |---|---|
//! | which scenes cannot be studied | [`mod@refusal`] |
//! | which variants a scene has | [`variant`] |
//! | the torque at the hand in a run | `hand` |
//! | RMS, peak, bands, differences | [`influence`] |
//! | the whole study, its results, their file | [`study`], [`results`], [`effects_table`] |
//! | limits, and the smallest set of effects within | [`tolerance`], `smallest`, [`mod@answer`] |
//! | costs in instructions | [`price`] |
//! | the time window that the report shows | `window` |
//! | what is printed, and the page's text | `words` |
//! | runs on all cores | `crate::parallel` |

pub mod answer;
pub mod build_up;
pub mod effects_table;
mod hand;
pub mod influence;
pub mod price;
pub mod refusal;
pub mod report;
pub mod results;
pub mod row;
mod smallest;
pub mod study;
pub mod tolerance;
pub mod variant;
mod window;
mod words;

pub use answer::Answer;
pub use refusal::{Refusal, refusal};
pub use results::EffectsStudy;
pub use row::Row;
pub use study::{EffectsError, Plan, run};
pub use tolerance::Tolerance;
pub use window::{HandTorque, VariantTorque};
