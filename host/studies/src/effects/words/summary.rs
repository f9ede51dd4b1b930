//! `summary.json` of a study of effects, and its conclusion in a sentence or
//! two.

use super::table::torque;
use crate::effects::EffectsStudy;
use crate::effects::variant::Change;
use crate::machine::{self, Machine};
use crepitus_plant::effects::EFFECTS;
use crepitus_scene::cpu_time::CLOCK;
use serde::Serialize;

/// Version of this form.
const SUMMARY_VERSION: u32 = 1;

/// A study with what it comes to.
#[derive(Serialize)]
pub(super) struct Summary<'a> {
    #[serde(rename = "summary_version")]
    version: u32,
    crepitus_version: &'static str,
    /// Computer on which the times were measured.
    host: String,
    /// Its processor, and the build.
    machine: Machine,
    /// Clock of these times.
    clock: &'static str,
    conclusion: String,
    #[serde(flatten)]
    study: &'a EffectsStudy,
}

impl<'a> Summary<'a> {
    pub(super) fn new(study: &'a EffectsStudy) -> Self {
        Self {
            version: SUMMARY_VERSION,
            crepitus_version: env!("CARGO_PKG_VERSION"),
            host: machine::host(),
            machine: Machine::here(),
            clock: CLOCK,
            conclusion: conclusion(study),
            study,
        }
    }
}

/// Sentences on what runs and what it costs, what does not run, and what the hand feels of it.
pub(super) fn conclusion(study: &EffectsStudy) -> String {
    let Some(whole) = study.whole() else {
        return "No variant of the scene runs.".to_owned();
    };
    let (has, all) = (study.effects.len(), EFFECTS.len());
    let mut sentences = vec![format!(
        "{has} of {all} effects run: {:.0} ns a step, {} states. The other {} are not built: no state, no instruction.",
        whole.ns_per_step,
        whole.states,
        all - has
    )];
    let vibration = whole
        .ran()
        .map_or(f64::NAN, |ran| ran.torque.vibration_nm());
    if vibration.is_nan() {
        sentences.push("The run is too short for what vibrates.".to_owned());
    } else {
        sentences.push(format!(
            "Between 10 and 450 Hz the hand feels {} RMS.",
            torque(vibration)
        ));
        sentences.extend(felt(study, vibration));
    }
    sentences.extend(costliest(study));
    sentences.join(" ")
}

/// The effects of the scene that change what vibrates most and least.
fn felt(study: &EffectsStudy, vibration_nm: f64) -> Option<String> {
    let rows = study.by_vibration();
    let mut own = rows.iter().filter(|(row, _)| row.change == Change::Without);
    let left = |change_nm: f64| torque(vibration_nm + change_nm);
    let (most, change_nm) = own.next()?;
    let most = format!("Without {} that is {}", most.effect, left(*change_nm));
    Some(match own.next_back() {
        Some((least, change_nm)) => {
            format!(
                "{most}; without {}, which is felt least, {}.",
                least.effect,
                left(*change_nm)
            )
        }
        None => format!("{most}."),
    })
}

/// The effect of the scene that takes the most time.
fn costliest(study: &EffectsStudy) -> Option<String> {
    let rows = study
        .rows
        .iter()
        .filter(|row| row.change == Change::Without);
    let costs = rows.filter_map(|row| Some((row, row.added()?.time.ns_per_step?)));
    let (costliest, cost) = costs.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!(
        "The costliest is {}: {cost:.0} ns of a step.",
        costliest.effect
    ))
}

/// Warning if the timings spread: the machine was busy.
pub(super) fn unsteady(study: &EffectsStudy) -> Option<String> {
    /// Spread above which small costs cannot be measured.
    const UNSTEADY: f64 = 0.1;
    let spread = study.time_spread();
    (spread > UNSTEADY).then(|| {
        format!(
            "The machine was busy: three quarters of the timings took over {:.0} % longer than the fastest, so small \
             costs could not be measured.",
            100.0 * spread
        )
    })
}
