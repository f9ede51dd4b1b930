//! # Experiments with people
//!
//! ```text
//!  TOML ─> Protocol ─check─> Session ─> Trial ──> device, or a simulated observer
//!  seed, pseudonym ────────>   │ ▲                        │
//!                              │ └────── Response ────────┘
//!                              └─> Row ─> trials.csv, a line a trial, on the disk before the next one
//!                                            └──> results: counts by level, reversals, ICC, kappa, shares
//! ```
//!
//! Three kinds of protocols share order, table and storage:
//!
//! | kind | a trial | an answer |
//! |---|---|---|
//! | `[threshold]` | reference and comparison of one quantity, in a random order | the interval that has more of it |
//! | `[abx]` | conditions A, B, and X, which is one of them | which one X is |
//! | `[realism]` | one knee | a free description; then realism, severity, type |
//!
//! **Blind.** A [`Trial`] has its stimuli for the device; neither its number nor its intervals tell
//! the level. [`Session`] is a state machine without input, output or clock: Python, the
//! command line and a page drive the same one. Equal protocols, seeds and answers give equal
//! trials, so a session that was killed goes on from its table.
//!
//! | to find | look in |
//! |---|---|
//! | the form of a protocol | [`protocol`] |
//! | what may be called when | [`session`] |
//! | rules of staircases | [`staircase`] |
//! | the order of trials, from a seed | [`order`] |
//! | files of a session, on which a killed one goes on | [`table`] |
//! | participants: consent, export, deletion | [`store`] |
//! | counts by level, reversals; A or B | [`choices`] |
//! | what clinicians say of a knee, and how consistently | [`realism`] |
//! | results of a study: JSON, text, a page, judgements of presets | [`findings`] |
//! | Cohen's kappa; intraclass correlation; resampling | [`agreement`], [`correlation`], [`bootstrap`] |

pub mod agreement;
pub mod bootstrap;
pub mod choices;
pub mod correlation;
pub mod finding;
pub mod findings;
pub mod order;
pub mod protocol;
mod protocol_error;
pub mod realism;
pub mod session;
pub mod staircase;
pub mod store;
pub mod table;
pub mod trial;

pub use findings::Findings;
pub use protocol::{Protocol, ProtocolError};
pub use session::{Session, SessionError};
pub use store::{Store, StoreError};
pub use table::{Begun, Held};
pub use trial::{Rating, Response, Row, Stimulus, Trial};
