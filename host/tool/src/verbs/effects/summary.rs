//! `summary.json` of a study of effects, and its conclusion in a sentence or
//! two.

use super::table::torque;
use crate::studying;
use crepitus_scene::cpu_time::CLOCK;
use crepitus_study::effects::variant::Change;
use crepitus_study::effects::{EffectsStudy, Row};
use serde::Serialize;

/// Version of this form.
const SUMMARY_VERSION: u32 = 1;

/// Smaller differences of the torque do not matter, N·m.
pub(super) const WORTH_HAVING_NM: f64 = 5e-3;

/// A study with what it comes to.
#[derive(Serialize)]
pub(super) struct Summary<'a> {
    #[serde(rename = "summary_version")]
    version: u32,
    pub(super) crepitus_version: &'static str,
    /// Computer on which the times were measured.
    host: String,
    /// Clock of these times.
    clock: &'static str,
    pub(super) conclusion: String,
    #[serde(flatten)]
    study: &'a EffectsStudy,
}

impl<'a> Summary<'a> {
    pub(super) fn new(study: &'a EffectsStudy) -> Self {
        Self {
            version: SUMMARY_VERSION,
            crepitus_version: env!("CARGO_PKG_VERSION"),
            host: studying::host(),
            clock: CLOCK,
            conclusion: conclusion(study),
            study,
        }
    }

    /// Computer, clock and build of the measured times.
    pub(super) fn measured_on(&self) -> String {
        format!("one core, {}", studying::measured_on(&self.host))
    }
}

/// Sentences on the effects that matter, those that do not, and those that are missing.
fn conclusion(study: &EffectsStudy) -> String {
    let rows = study.by_influence();
    let of = |change| rows.iter().filter(move |row| row.change == change);
    let mut sentences = Vec::new();
    let nm = |row: &Row| torque(row.added().map_or(f64::NAN, |a| a.rms_nm));
    let left_out: Vec<&&Row> = of(Change::Without).collect();
    match left_out.as_slice() {
        [] => {}
        [only] => sentences.push(format!("{} makes {} RMS at the hand.", only.effect, nm(only))),
        [most, .., least] => sentences.push(format!(
            "Of the scene's effects {} changes the torque at the hand most, by {} RMS, and {} least, by {}.",
            most.effect,
            nm(most),
            least.effect,
            nm(least)
        )),
    }
    let small = |row: &&&Row| row.added().is_some_and(|a| a.rms_nm < WORTH_HAVING_NM);
    let below: Vec<&str> = left_out
        .iter()
        .copied()
        .filter(small)
        .map(|row| row.effect)
        .collect();
    if !below.is_empty() {
        sentences.push(format!(
            "Below the {} worth having: {}.",
            torque(WORTH_HAVING_NM),
            below.join(", ")
        ));
    }
    if let Some(most) = of(Change::With).next() {
        sentences.push(format!(
            "Of those that it leaves out {} would change it most, by {}.",
            most.effect,
            nm(most)
        ));
    }
    if let Some(costliest) = costliest(&rows) {
        sentences.push(costliest);
    }
    if sentences.is_empty() {
        "No variant of the scene runs.".to_owned()
    } else {
        sentences.join(" ")
    }
}

/// The effect of the scene that takes the most time.
fn costliest(rows: &[&Row]) -> Option<String> {
    let measured = |row: &Row| row.added()?.time.ns_per_step;
    let (costliest, cost) = rows
        .iter()
        .filter(|row| row.change == Change::Without)
        .filter_map(|row| Some((row, measured(row)?)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!(
        "The costliest is {}: {:.0} of {:.0} ns a step here.",
        costliest.effect,
        cost,
        cost + costliest.ns_per_step
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
