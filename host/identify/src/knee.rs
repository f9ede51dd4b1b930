//! # A model of a measured knee from a passive examination
//!
//! Somebody, or a dynamometer, bends and straightens a knee several times at several speeds. Torque and angle
//! give what the limb itself does, and the symptom that it has:
//!
//! ```text
//! torque(t) = limb(φ, Ω, Ω̇, t)·c + A·symptom(φ, Ω; p)(t) + rest
//!             └ linear ┘   one law of crepitus_model, followed along the measured motion
//! ```
//!
//! The limb is linear in its coefficients c, each between bounds: offset, gravity, elasticity, the steep ends of the
//! range, viscous damping, inertia, dry friction, drift. A law's torque is proportional to the torques among its
//! parameters, so the amplitude A is linear, too. The fit eliminates both and searches the shape p of the law alone
//! (variable projection: Golub & Pereyra, SIAM J. Numer. Anal. 10 (1973), 413–432).
//!
//! Strokes are the units that are independent of each other: intervals are those of the jackknife over strokes,
//! and models are compared by the error in the stroke that was left out.
//!
//! | to find | look in |
//! |---|---|
//! | resampling, velocity and acceleration | `motion.rs` |
//! | strokes | `stroke.rs` |
//! | what the limb does, between which bounds | `limb.rs`, `bounded.rs` |
//! | the symptoms, their parameters and ranges | `symptom.rs` |
//! | search | `search.rs` |
//! | intervals and errors of left-out strokes | `jackknife.rs` |
//! | which model, and what cannot be told | `verdict.rs`, [`Refusal`] |
//! | the nearest preset | [`grade`] |
//! | a result as JSON, and as a scene | [`summary`], [`scene`] |

mod bounded;
mod grade;
mod jackknife;
mod limb;
mod motion;
mod refusal;
mod scene;
mod search;
mod stroke;
mod summary;
mod symptom;
mod verdict;

pub use grade::{Grade, grade};
pub use motion::Examination;
pub use refusal::Refusal;
pub use scene::scene;
pub use stroke::Stroke;
pub use summary::summary;
pub use symptom::Symptom;
pub use verdict::{Candidate, KneeFit, RIGID_NM, Unexplained, Value, fit};
