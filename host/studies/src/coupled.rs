//! Z-width: the stiffness range in which the device is stable on a leg.
//!
//! A rendered spring is sampled, held for a tick, and acts late; each of these
//! generates energy, about kr·τ·∫Ω² dt with τ the [mean lag](Lag::mean_s),
//! which the mechanics have to dissipate. So a hand moves the leg, stops,
//! and rests, and we check whether the shaft comes to rest, too, over
//!
//! ```text
//! kr  ×  damping of the cuff  ×  lag of the motor  ×  friction left in the gear
//! ```
//!
//! with the drive's pipeline (scenes with `device = true`), compared with the
//! criteria of the literature for the same numbers.
//!
//! | to find | look in |
//! |---|---|
//! | what is varied, and the scene of a cell | `setting` |
//! | when a shaft is quiet, settles or rings | `cell` |
//! | the criteria of the literature, and the linear system | `criteria` |
//! | the map, the presets' margins, each effect | `study` |
//! | files | [`tables`] |
//! | what is printed, and the page's text | `words` |

mod cell;
mod criteria;
pub mod report;
mod setting;
mod study;
pub mod tables;
mod words;

pub use cell::{Cell, Verdict};
pub use criteria::{Criteria, most_share};
pub use setting::{DAMPINGS, Extra, GEARS, Gear, LAGS, Lag, STIFFNESSES, Setting};
pub use study::{CoupledError, CoupledStudy, Margin, Onset, run};
