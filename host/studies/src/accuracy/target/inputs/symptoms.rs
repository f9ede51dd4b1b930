//! Inputs of symptoms.
//!
//! | input | content |
//! |---|---|
//! | a motion of [`motions`](crate::accuracy::symptoms::motions), in full | strokes through walls, catches, blades, beats and snaps; means are over these |
//! | `wander`, `shaking hand`, `white velocities` at an angle | as those of rungs, where walls, thresholds, teeth and asperities are |

use super::device::taken;
use super::{Lengths, Motion, TICK_S, Task, motions as hard_motions, plan};
use crate::accuracy::symptoms::motions::motions;
use crate::sampling::Sampling;
use crepitus_ladder::{Plan, Subject};
use crepitus_model::SettingsError;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::render::effects::IS_SYMPTOM;
use crepitus_plant::encoder::Encoder;

/// Angles at which hard inputs begin, degrees: at the walls, thresholds and releases of a symptom at
/// its defaults. Teeth and asperities are at every 7.5° and about every 1.5°.
fn places_deg(subject: Subject) -> &'static [f64] {
    match subject.name() {
        "range-limit" => &[10.0, 120.0],
        "spasticity" => &[75.0],
        "clasp-knife" => &[30.0, 75.0],
        _ => &[60.0],
    }
}

/// Returns whether it is a symptom other than crepitus.
pub(super) fn is_symptom(subject: Subject) -> bool {
    let Subject::Effect(place, _) = subject else {
        return false;
    };
    IS_SYMPTOM.get(place) == Some(&true)
}

/// The tasks of a symptom.
pub(super) fn tasks(
    subject: Subject,
    lengths: Lengths,
) -> Result<Vec<Task<'static>>, SettingsError> {
    let mut tasks = Vec::new();
    for (name, hand, duration_s) in motions() {
        let motion = hand.motion();
        let sampling = Sampling::new(&motion, duration_s, TICK_S);
        let mut walk = sampling.walk_from(0);
        let from_rad = walk.now().0;
        let mut steps: Motion = Vec::new();
        walk.fill(&mut steps, usize::try_from(sampling.steps()).unwrap_or(0));
        tasks.push(task(subject, name.to_owned(), true, from_rad, &steps));
    }
    let hard = hard_motions(lengths.hard)?;
    for place_deg in places_deg(subject) {
        for (name, steps) in &hard {
            let name = format!("{name} at {place_deg}°");
            tasks.push(task(subject, name, false, place_deg.to_radians(), steps));
        }
    }
    Ok(tasks)
}

fn task(
    subject: Subject,
    name: String,
    is_usual: bool,
    from_rad: f64,
    steps: &Motion,
) -> Task<'static> {
    let encoder = Encoder::new(&EncoderSettings::default());
    Task {
        name,
        scene: None,
        is_usual,
        plan: Plan {
            place: encoder.count(from_rad),
            ..plan(subject, steps)
        },
        inputs: steps.iter().map(taken).collect(),
    }
}
