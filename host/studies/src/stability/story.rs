//! Runs that explain one hard case each, computed with the real model, and their pictures: one
//! file a story.

mod implicit_euler;
mod parameter_change;
mod restick_rules;
mod three_solvers;
mod trace;
mod turn_back;

use crate::Paper;
use crate::story::{Story, figure, mark};
use crepitus_model::{Parameters, SettingsError};
use crepitus_pages::plot::{Figure, Mark};

/// Points of a line, from left to right.
pub type Line = Vec<(f64, f64)>;

/// All stories.
#[derive(Clone, Debug, PartialEq)]
pub struct Stories(Vec<Story>);

/// All stories, computed: about a second of work.
///
/// # Errors
/// None in practice: every story has settings that the model takes.
pub fn all() -> Result<Stories, SettingsError> {
    Ok(Stories(vec![
        three_solvers::story()?,
        implicit_euler::story()?,
        restick_rules::story()?,
        parameter_change::story()?,
        turn_back::story()?,
    ]))
}

/// The stories as figures of a page, or files.
pub fn figures(stories: &Stories, paper: Paper) -> Vec<Figure> {
    let stories = stories.0.iter();
    stories.map(|story| figure(story, paper)).collect()
}

/// The device's tick, s.
const STEP_S: f64 = 5e-5;

/// Ts and Tk of the paper.
fn levels() -> Vec<Mark> {
    let p = Parameters::default();
    vec![
        mark(p.static_torque_nm, "Ts"),
        mark(p.kinetic_torque_nm, "Tk"),
    ]
}

/// `once`, or `4 times`.
fn times(count: usize) -> String {
    match count {
        1 => "once".to_owned(),
        n => format!("{n} times"),
    }
}
