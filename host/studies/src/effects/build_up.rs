//! The effects of a scene added one by one, in the order of the table: from
//! the joint alone to the torque at the hand.
//!
//! All measures are of the second half of a run, in the steady state.

mod signals;

use crate::parallel::{Meter, each};
use crate::stability::story::Line;
use crate::watcher::{Cancelled, Watcher};
use crepitus_plant::effect::{Effect, Part};
use crepitus_scene::Scene;
use serde::Serialize;
use signals::Signals;

/// The shown part at the end of each run, s.
const SHOWN_S: f64 = 0.2;

/// The joint with one effect after the other.
#[derive(Clone, Debug)]
pub struct BuildUp {
    /// The joint with its sensor, then with one more effect each.
    pub rungs: Vec<Rung>,
    /// The torques at the end of each run.
    pub torques: Vec<RungTorques>,
}

/// The torques at the end of one run, without their slow part; N·m, against
/// time, s.
#[derive(Clone, Debug, PartialEq)]
pub struct RungTorques {
    /// The effect added last; empty for the joint alone.
    pub added: &'static str,
    /// Torque of the model.
    pub model_nm: Line,
    /// Torque at the hand.
    pub hand_nm: Line,
}

/// One set of effects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rung {
    /// The effect added last; empty for the joint alone.
    pub added: &'static str,
    /// Measures of the run, unless it failed.
    #[serde(flatten)]
    pub measured: Option<Measured>,
    /// Reason why the run failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// Measures of one run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Peak-to-peak value of the fast part of the torque at the hand, N·m: the
    /// torque minus its mean over 0.1 s around.
    pub ripple_nm: f64,
    /// Root mean square of that, N·m.
    pub ripple_rms_nm: f64,
    /// Lag of the fast part behind that of the model's torque, s, by best correlation.
    pub lag_s: f64,
    /// Mean length of a stick, s.
    pub stick_s: Option<f64>,
    /// Shortest time from break to break, s.
    pub shortest_s: Option<f64>,
    /// Longest time from break to break, s.
    pub longest_s: Option<f64>,
    /// Lowest speed of the shaft, rad/s.
    pub slowest_rad_s: f64,
    /// Highest speed of the shaft, rad/s.
    pub fastest_rad_s: f64,
}

/// Builds `scene` up; `None` without a joint or a plant.
///
/// # Errors
/// Error of the watcher.
pub(super) fn build_up(
    scene: &Scene,
    meter: &Meter,
    watcher: &mut dyn Watcher,
) -> Result<Option<BuildUp>, Cancelled> {
    if scene.crepitus.is_none() || !scene.is_coupled() {
        return Ok(None);
    }
    let scenes = prefixes(scene);
    let signals = each(&scenes, meter, watcher, |(_, scene)| {
        Signals::of(scene, meter)
    })?;
    let mut rungs = Vec::new();
    let mut torques = Vec::new();
    for ((added, _), signals) in scenes.iter().zip(signals) {
        let (measured, failure) = match signals {
            Ok(signals) => {
                let (model_nm, hand_nm) = signals.last(SHOWN_S);
                torques.push(RungTorques {
                    added,
                    model_nm,
                    hand_nm,
                });
                (Some(signals.measure()), None)
            }
            Err(failure) => (None, Some(failure)),
        };
        rungs.push(Rung {
            added,
            measured,
            failure,
        });
    }
    Ok(Some(BuildUp { rungs, torques }))
}

/// Number of runs.
pub(super) fn runs(scene: &Scene) -> usize {
    1 + scene.listed.len()
}

/// The joint with its sensor, and with one more effect each. The effects that
/// one needs precede it in the table.
fn prefixes(scene: &Scene) -> Vec<(&'static str, Scene)> {
    let is_plant = |e: &Effect| !matches!(e.part, Part::Joint | Part::Sensor);
    let last: Vec<&'static Effect> = scene
        .effects()
        .into_iter()
        .filter(|e| is_plant(e))
        .collect();
    let mut prefixes = vec![("", scene.first(0))];
    prefixes.extend(
        last.iter()
            .enumerate()
            .map(|(i, e)| (e.name, scene.first(i + 1))),
    );
    prefixes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_scene::Overrides;
    use std::path::Path;

    struct Patient;

    impl Watcher for Patient {
        fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
            Ok(())
        }
    }

    fn built(effects: &[&str]) -> Option<BuildUp> {
        let mut text =
            "version = 1\ntitle = \"steady\"\nduration_s = 0.8\n[motion]\nkind = \"constant\"\n\
                        velocity_rad_s = 0.5\n[solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n"
                .to_owned();
        text.extend(effects.iter().map(|e| format!("[effects.{e}]\n")));
        let scene = Scene::parse(Path::new("steady.toml"), &text, &Overrides::default()).unwrap();
        build_up(&scene, &Meter::new(1.0), &mut Patient).expect("nobody cancels")
    }

    #[test]
    fn each_rung_has_one_effect_more() {
        let built = built(&["crepitus", "encoder", "motor", "drivetrain", "cuff"]).unwrap();
        let added: Vec<_> = built.rungs.iter().map(|r| r.added).collect();
        assert_eq!(added, ["", "motor", "drivetrain", "cuff"]);
        assert_eq!(built.torques.len(), 4);
        let of = |i: usize| built.rungs[i].measured.unwrap();
        // Alone, the hand feels the model's torque.
        assert_eq!(of(0).lag_s, 0.0);
        assert!(of(0).stick_s.is_some());
        assert!(of(1).lag_s > 0.0 && of(1).ripple_nm < of(0).ripple_nm);
        assert!(of(3).ripple_nm < 0.2 * of(2).ripple_nm);
        assert!(of(3).lag_s > of(2).lag_s);
    }

    #[test]
    fn there_is_nothing_to_build_up_without_a_joint_or_a_plant() {
        assert!(built(&["drivetrain", "cuff"]).is_none());
        assert!(built(&["crepitus", "encoder"]).is_none());
    }
}
