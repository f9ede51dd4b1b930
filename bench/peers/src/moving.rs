//! Event-to-event timing on a moving hand: `reference` against the libraries.
//!
//! Everyone is asked for the events only. There is no closed form: the truth is what `reference`
//! finds, and it counts only if libraries that know nothing of it find the same.

mod contest;
mod differential_equations;
mod diffsol;
mod integrator;
mod ivp;
mod phases;
mod table;

pub use contest::{Case, hold};
pub use table::markdown;

use crate::motion::Hand;
use crate::work::Runner;
use crepitus_model::Convention;
use phases::{Phases, StickBy};
use std::f64::consts::TAU;

/// Settings of a library.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Setting {
    /// Relative tolerance, and absolute, both components being of order one.
    pub tolerance: f64,
    /// The longest step of a slip, s; none where there is no limit.
    pub slip_limit_s: Option<f64>,
    /// Source of the angle in a stick.
    pub stick_by: StickBy,
}

/// A method of a library.
pub struct Peer {
    /// Library and version, and method.
    pub name: &'static str,
    build: fn(Phases, Setting) -> Result<Runner, String>,
}

impl Peer {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self {
            name: "differential-equations 0.7.0 dopri5",
            build: |phases, setting| Ok(differential_equations::dopri5(phases, setting)),
        },
        Self {
            name: "differential-equations 0.7.0 dop853",
            build: |phases, setting| Ok(differential_equations::dop853(phases, setting)),
        },
        Self {
            name: "diffsol 0.18.0 tsit45",
            build: diffsol::tsit45,
        },
        Self {
            name: "diffsol 0.18.0 bdf",
            build: diffsol::bdf,
        },
        Self {
            name: "ivp 0.6.0 dopri5",
            build: |phases, setting| Ok(ivp::dopri5(phases, setting)),
        },
        Self {
            name: "ivp 0.6.0 dop853",
            build: |phases, setting| Ok(ivp::dop853(phases, setting)),
        },
    ];

    /// Sets the method up.
    fn build(&self, hand: &Hand, convention: Convention, s: Setting) -> Result<Runner, String> {
        (self.build)(Phases::new(hand, convention, s.stick_by), s)
    }
}

/// Every setting that is tried: tolerances from 1e-4 to 1e-13, sticks either way, and under
/// `physical` slips with and without a longest step of a ninth or a thirty-third of a period.
fn settings(convention: Convention, hand: &Hand, quick: bool) -> Vec<Setting> {
    let period_s = TAU / hand.joint.parameters.natural_rad_s();
    let slip_limits: &[Option<f64>] = match convention {
        Convention::Physical => &[None, Some(period_s / 9.0), Some(period_s / 33.0)],
        Convention::Frozen | Convention::Paper => &[None],
    };
    let mut all = Vec::new();
    for stick_by in [StickBy::Position, StickBy::Integration] {
        for &slip_limit_s in slip_limits {
            for half_decade in (8..=26).step_by(if quick { 2 } else { 1 }) {
                all.push(Setting {
                    tolerance: 10f64.powf(-f64::from(half_decade) / 2.0),
                    slip_limit_s,
                    stick_by,
                });
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{hand_sine, recorded_knee, strokes};
    use crate::work::{Delivery, Task};
    use crepitus_scene::preset::joints;

    #[test]
    fn a_library_finds_the_events_of_the_reference() {
        let mut out = Delivery::new();
        let peer = Peer::ALL.iter().find(|p| p.name == "ivp 0.6.0 dop853");
        let hands = joints().iter().flat_map(|&joint| {
            let knee = recorded_knee(joint).unwrap();
            [
                (hand_sine(joint), 1e-8),
                (strokes(joint), 1e-8),
                (knee, 1e-6),
            ]
        });
        for (hand, limit_s) in hands {
            let period_s = TAU / hand.joint.parameters.natural_rad_s();
            // One setting does not find every event of the other joints under `physical` or on the
            // recorded knee; the contest searches for one that does, and asks for two libraries.
            let is_paper = hand.joint == joints()[0];
            if !is_paper && hand.name == crate::motion::RECORDED_KNEE {
                continue;
            }
            let conventions = [Convention::Frozen, Convention::Physical];
            for convention in conventions.into_iter().take(1 + usize::from(is_paper)) {
                crate::ours::reference_events(convention, &hand)(Task::Events, &mut out).unwrap();
                let truth = out.events.clone();
                for stick_by in [StickBy::Position, StickBy::Integration] {
                    let setting = Setting {
                        tolerance: 1e-11,
                        slip_limit_s: Some(period_s / 33.0),
                        stick_by,
                    };
                    let mut runner = peer.unwrap().build(&hand, convention, setting).unwrap();
                    runner(Task::Events, &mut out).unwrap();
                    let case = format!("{}, {convention:?}, {stick_by:?}", hand.name());
                    assert!(truth.len() > 5, "{case}");
                    assert_eq!(out.events.len(), truth.len(), "{case}");
                    for (found_s, true_s) in out.events.iter().zip(&truth) {
                        assert!((found_s - true_s).abs() < limit_s, "{case}, {true_s} s");
                    }
                }
            }
        }
    }
}
