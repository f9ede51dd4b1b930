//! The stick-slip joint: settings, and the coefficients that every solver uses.
//!
//! ```text
//! parameters → settings → coefficients (one step length) ─┐
//!                        shaft (the path within a step) ──┼→ a solver's stick_slip → events
//!                        oscillator (the free object) ────┘
//! ```

mod coast;
pub mod coefficients;
pub mod compensated;
mod divisor;
mod event;
pub mod oscillator;
mod parameters;
mod phase;
mod settings;
pub mod shaft;
mod slip_lane;
mod stick_slip;
pub mod ticks;

pub use coast::Coast;
pub(crate) use coefficients::Given;
pub use coefficients::StepCoefficients;
pub use event::{EVENTS_PER_STEP, Event};
pub use parameters::Parameters;
pub use phase::{EventKind, Phase, Sense};
pub use settings::{
    Convention, LONGEST_STEP_S, MOST_STIFFNESS_NM_PER_RAD, Restart, Settings, SettingsError,
    Validated,
};
pub use shaft::ShaftStep;
pub use slip_lane::SlipLane;
pub use stick_slip::StickSlip;
