//! The brace as its recordings show it.

use crate::Estimate;
use crate::brace::fit::{Fit, GOOD_ENOUGH};
use crate::brace::prior::Prior;
use crate::brace::quantity::Quantity;
use crate::brace::recording::{Recording, Weight};
use crate::brace::refusal::Refusal;
use crate::brace::swing::{Passing, Swing, swings};
use crate::brace::{plausible, visible};

/// What recordings say of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub enum Result {
    /// Its value in the unit of its [spec](Quantity::spec), with its 95 % interval.
    Seen(Estimate),
    /// These recordings do not show it.
    NotVisible {
        /// Why, and what to do.
        why: String,
    },
}

/// A quantity and what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Which.
    pub quantity: Quantity,
    /// What is known.
    pub result: Result,
}

/// A brace.
#[derive(Clone, Debug)]
pub struct Brace {
    /// All quantities, in the order of [`Quantity::ALL`].
    pub shown: Vec<Shown>,
    /// Root mean square of what the fit leaves of the angle, rad.
    pub rms_rad: f64,
    /// The greatest amplitude, rad.
    pub amplitude_rad: f64,
    /// What a person should know who takes these values.
    pub notes: Vec<String>,
    pub(crate) swings: Vec<Swing>,
    pub(crate) fit: Fit,
}

impl Brace {
    /// A quantity's value, if it is visible.
    pub fn value(&self, quantity: Quantity) -> Option<Estimate> {
        let shown = self.shown.iter().find(|shown| shown.quantity == quantity)?;
        match &shown.result {
            Result::Seen(estimate) => Some(*estimate),
            Result::NotVisible { .. } => None,
        }
    }

    /// Number of swings, and their length together, s.
    pub fn swung(&self) -> (usize, f64) {
        let steps: usize = self.swings.iter().map(|s| s.torques_nm.len()).sum();
        (
            self.swings.len(),
            steps as f64 * crate::brace::model::STEP_S,
        )
    }
}

/// Identifies a brace from recordings of one weight that swings in it. `torque_deviation` is
/// the standard deviation of the motor's torque constant, as a share. `progress` gets the share of
/// the work that is done, and ends it by returning false.
///
/// # Errors
/// [`Refusal`]: what the recordings show instead.
pub fn identify(
    recordings: &[Recording],
    weight: &Weight,
    torque_deviation: f64,
    progress: &mut dyn FnMut(f64) -> bool,
) -> std::result::Result<Brace, Refusal> {
    plausible::given(weight, torque_deviation)?;
    let Some(recording) = recordings.first() else {
        return Err(Refusal::Short { duration_s: 0.0 });
    };
    let prior = Prior::of(weight, torque_deviation);
    let (all, fit) = best(recordings, &prior, progress)?;
    let amplitude_rad = plausible::amplitude_rad(&all, &fit);
    plausible::is_explained(&all, &fit, amplitude_rad)?;
    plausible::is_possible(&fit, &prior)?;
    plausible::agrees(&fit, &prior)?;
    let shown = Quantity::ALL.map(|quantity| Shown {
        quantity,
        result: visible::result(quantity, &fit, &prior, &all, recording),
    });
    Ok(Brace {
        shown: shown.into(),
        rms_rad: fit.rms_rad,
        amplitude_rad,
        notes: visible::notes(&fit, &prior, &all),
        swings: all,
        fit,
    })
}

/// The swings from where they begin best, and their fit.
fn best(
    recordings: &[Recording],
    prior: &Prior,
    progress: &mut dyn FnMut(f64) -> bool,
) -> std::result::Result<(Vec<Swing>, Fit), Refusal> {
    /// Fits: one for each beginning, and two more.
    const FITS: f64 = 5.0;
    let mut best: Option<(Vec<Swing>, Fit)> = None;
    let is_good = |best: &Option<(Vec<Swing>, Fit)>| {
        (best.as_ref()).is_some_and(|(_, fit)| fit.rms_rad < GOOD_ENOUGH)
    };
    for passing in Passing::ALL {
        if is_good(&best) {
            break;
        }
        if !progress(f64::from(passing as u8) / FITS) {
            return Err(Refusal::Interrupted);
        }
        let mut all = Vec::new();
        for (place, recording) in recordings.iter().enumerate() {
            all.extend(swings(place, recording, passing)?);
        }
        if let Some(fit) = Fit::of(&all, recordings.len(), prior)
            && (best.as_ref()).is_none_or(|(_, least)| fit.rms_rad < least.rms_rad)
        {
            best = Some((all, fit));
        }
    }
    if let Some((all, least)) = &mut best
        && least.rms_rad >= GOOD_ENOUGH
    {
        if !progress(3.0 / FITS) {
            return Err(Refusal::Interrupted);
        }
        if let Some(fit) = Fit::around(all, recordings.len(), prior)
            && fit.rms_rad < least.rms_rad
        {
            *least = fit;
        }
    }
    best.ok_or(Refusal::Singular)
}
