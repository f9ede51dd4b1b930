//! Grade of a fitted knee: the nearest preset of the same symptom.
//!
//! Near is by the values that both have, each as the logarithm of a ratio where it is above zero (a torque that is
//! twice as great is as far away as one that is half as great), weighted by how well the fit tells them:
//!
//! ```text
//! d² = mean of (ln x − ln p)² / (0.3² + (half width/x)²)
//! ```

use super::{Candidate, KneeFit, Symptom};
use crepitus_scene::preset::{self, Disorder, Preset, Setting};

/// Ratio of two values that are one step of a scale apart, as a logarithm.
const STEP: f64 = 0.3;

/// Distance beyond which no preset is near.
const FAR: f64 = 3.0;

/// Nearest preset of a fitted knee.
#[derive(Clone, Copy, Debug)]
pub struct Grade {
    /// The preset.
    pub preset: &'static Preset,
    /// Distance from it, in steps.
    pub distance: f64,
    /// The next one of another grade, and its distance.
    pub next: Option<(&'static str, f64)>,
}

impl Grade {
    /// Returns whether the preset is as far away as one that describes another knee.
    pub fn is_far(&self) -> bool {
        self.distance > FAR
    }
}

/// Returns the nearest preset; `None` without a symptom.
pub fn grade(fitted: &KneeFit) -> Option<Grade> {
    let best = &fitted.best;
    let effect = best.symptom.effect()?;
    let mut near: Vec<(f64, &'static Preset)> = (preset::shipped().iter())
        .filter(|preset| is_of(preset, best, effect))
        .filter_map(|preset| Some((distance(preset, best, effect)?, preset)))
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (distance, preset) = *near.first()?;
    Some(Grade {
        preset,
        distance,
        next: near
            .get(1)
            .map(|(distance, next)| (next.name.as_str(), *distance)),
    })
}

/// Returns whether a preset is of this effect alone, and of its form.
fn is_of(preset: &Preset, best: &Candidate, effect: &str) -> bool {
    let only = preset.crepitus.is_none()
        && preset
            .listed
            .iter()
            .all(|listed| listed.effect.name == effect);
    let disorders: &[Disorder] = match best.symptom {
        Symptom::Healthy => &[],
        Symptom::LeadPipe => &[Disorder::Rigidity],
        Symptom::Cogwheel => &[Disorder::Cogwheel],
        Symptom::Catch | Symptom::Reflex => &[Disorder::Spasticity],
        Symptom::ClaspKnife => &[Disorder::ClaspKnife],
        Symptom::Clonus => &[Disorder::Clonus],
        Symptom::RangeLimit => &[Disorder::RangeDeficit, Disorder::EndFeel],
    };
    let form = best.symptom.choice();
    let has_form = preset
        .values
        .iter()
        .any(|value| match (value.setting, form) {
            (Setting::Option(name), Some((key, choice))) => value.key == key && name == choice,
            _ => false,
        });
    let is_of_disorder = preset
        .disorder
        .is_some_and(|disorder| disorders.contains(&disorder));
    only && is_of_disorder && !preset.listed.is_empty() && (form.is_none() || has_form)
}

fn distance(preset: &Preset, best: &Candidate, effect: &str) -> Option<f64> {
    let listed = preset
        .listed
        .iter()
        .find(|listed| listed.effect.name == effect)?;
    let (mut sum, mut count) = (0.0, 0.0);
    for value in best.values.iter().filter(|value| value.is_told) {
        let specs = listed.effect.parameters.iter().zip(&listed.given.numbers);
        let Some((_, preset)) = specs.into_iter().find(|(spec, _)| spec.key == value.key) else {
            continue;
        };
        let (x, p) = (value.estimate.value, *preset);
        let off = if x > 0.0 && p > 0.0 {
            (x / p).ln()
        } else {
            x - p
        };
        let known = value.estimate.share().min(3.0);
        sum += off * off / (STEP * STEP + known * known);
        count += 1.0;
    }
    (count > 0.0).then(|| f64::sqrt(sum / count))
}
