//! Runs that explain one hard case each, computed with the real model.
//!
//! One file a story, with a function of the name of the file; a new one gets a
//! field of [`Stories`].

mod implicit_euler;
mod parameter_change;
mod restick_rules;
mod three_solvers;
mod trace;
mod turn_back;

pub use implicit_euler::{ImplicitEuler, Method};
pub use parameter_change::{Change, ParameterChange};
pub use restick_rules::{RestickRules, Rule};
pub use three_solvers::{Curve, ThreeSolvers};
pub use turn_back::{Shaking, Swept, TurnBack};

use crepitus_model::SettingsError;

/// Points of a line, from left to right.
pub type Line = Vec<(f64, f64)>;

/// All stories.
#[derive(Clone, Debug, PartialEq)]
pub struct Stories {
    /// One joint under three solvers.
    pub three_solvers: ThreeSolvers,
    /// Stable, and wrong.
    pub implicit_euler: ImplicitEuler,
    /// One knee pass under the paper's two rules.
    pub restick_rules: RestickRules,
    /// A stiffer spring, and no energy from nowhere.
    pub parameter_change: ParameterChange,
    /// A hand that turns back gets no more than the spring held.
    pub turn_back: TurnBack,
}

/// All stories, computed: about a second of work.
///
/// # Errors
/// None in practice: every story has settings that the model takes.
pub fn all() -> Result<Stories, SettingsError> {
    Ok(Stories {
        three_solvers: three_solvers::three_solvers()?,
        implicit_euler: implicit_euler::implicit_euler()?,
        restick_rules: restick_rules::restick_rules()?,
        parameter_change: parameter_change::parameter_change()?,
        turn_back: turn_back::turn_back()?,
    })
}
