//! Identified values of a brace.

use crate::Estimate;
use crate::brace::fit::{Fit, GOOD_ENOUGH};
use crate::brace::passing::Passing;
use crate::brace::prior::Prior;
use crate::brace::problem::{RESIDUAL_S, STRIDE, Sought};
use crate::brace::quantity::Quantity;
use crate::brace::recording::{Recording, Weight};
use crate::brace::refusal::Refusal;
use crate::brace::shown::{Result, Shown};
use crate::brace::swing::{Swing, swings};
use crate::brace::{imperfect, plausible, visible};
use crate::parallel::in_parallel;
use crepitus_plant::swing::STEP_S;

/// Identified brace: values, quality of the fit, warnings.
#[derive(Clone, Debug)]
pub struct Brace {
    /// All quantities, in the order of [`Quantity::ALL`].
    pub shown: Vec<Shown>,
    /// RMS residual of the angle, rad.
    pub rms_rad: f64,
    /// Largest amplitude of all swings, rad.
    pub amplitude_rad: f64,
    /// Warnings about the use of these values.
    pub notes: Vec<String>,
    pub(crate) swings: Vec<Swing>,
    pub(crate) fit: Fit,
}

impl Brace {
    /// Returns a quantity's value, if it is visible.
    pub fn value(&self, quantity: Quantity) -> Option<Estimate> {
        let shown = self.shown.iter().find(|shown| shown.quantity == quantity)?;
        match &shown.result {
            Result::Seen(estimate) => Some(*estimate),
            Result::NotVisible { .. } => None,
        }
    }

    /// Returns the number of swings and their total duration, s.
    pub fn swung(&self) -> (usize, f64) {
        let steps: usize = self.swings.iter().map(|s| s.torques_nm.len()).sum();
        (self.swings.len(), steps as f64 * STEP_S)
    }

    /// Returns each swing as it was measured, and what the fit leaves of it.
    pub fn traces(&self) -> impl Iterator<Item = Trace> {
        let residuals = self.fit.residuals.iter();
        self.swings.iter().zip(residuals).map(|(swing, residuals)| {
            let hangs = self.fit.hangs_rad.get(swing.recording);
            let hang = hangs.copied().unwrap_or(0.0);
            let measured_rad = swing.angles_rad.iter().step_by(STRIDE);
            let points = (measured_rad.zip(residuals).enumerate())
                .filter(|(_, (_, residual))| !residual.is_nan())
                .map(|(i, (angle, residual))| TracePoint {
                    time_s: swing.begins_s + i as f64 * RESIDUAL_S,
                    measured_rad: angle - hang,
                    residual_rad: *residual,
                });
            Trace {
                recording: swing.recording,
                points: points.collect(),
            }
        })
    }
}

/// One swing, measured and fitted.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Place of its recording, from 0.
    pub recording: usize,
    /// Points of the swing over time.
    pub points: Vec<TracePoint>,
}

/// Angle of the motor's shaft from where the weight hangs.
#[derive(Clone, Copy, Debug)]
pub struct TracePoint {
    /// Time in the recording, s.
    pub time_s: f64,
    /// Measured by the encoder, rad.
    pub measured_rad: f64,
    /// Measured minus simulated, rad.
    pub residual_rad: f64,
}

/// Identifies a brace from recordings of one weight that swings in it. `torque_deviation` is the
/// standard deviation of the motor's torque constant, as a share of it. `progress` gets the
/// completed share of the work, from 0 to 1, and cancels the work by returning false.
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
    if !progress(0.7) {
        return Err(Refusal::Interrupted);
    }
    let count = recordings.len();
    let refined = |fit: Fit, sought| fit.refined(&all, count, &prior, sought).unwrap_or(fit);
    let mut fit = refined(fit, Sought::OfBrace);
    if imperfect::is_more_than_counts(&fit) || fit.suspects_encoder(&all, count, &prior) {
        if !progress(0.9) {
            return Err(Refusal::Interrupted);
        }
        let scaled = refined(fit.clone(), Sought::OfEncoder);
        if imperfect::is_scaled(&scaled) {
            fit = scaled;
        }
    }
    let amplitude_rad = plausible::amplitude_rad(&all, &fit);
    plausible::is_explained(&all, &fit, amplitude_rad)?;
    plausible::is_possible(&fit, &prior)?;
    plausible::agrees(&fit, &prior)?;
    let shown = Quantity::ALL.map(|quantity| Shown {
        quantity,
        result: visible::result(quantity, &fit, &prior, &all, recording),
    });
    let is_torque_seen = (shown.iter()).any(|shown| {
        shown.quantity == Quantity::TorqueConstant && matches!(shown.result, Result::Seen(_))
    });
    Ok(Brace {
        shown: shown.into(),
        rms_rad: fit.rms_rad,
        amplitude_rad,
        notes: [
            imperfect::notes(&fit),
            visible::notes(&fit, &prior, is_torque_seen),
        ]
        .concat(),
        swings: all,
        fit,
    })
}

/// Finds the beginnings of the swings that fit best; returns the swings with their fit.
///
/// A fit from the guess is enough where it leaves no more than whole counts do. Else teeth may
/// touch once more or less in it than in truth, which no small step repairs: many starts
/// are followed a short way, and the best of them to the end.
fn best(
    recordings: &[Recording],
    prior: &Prior,
    progress: &mut dyn FnMut(f64) -> bool,
) -> std::result::Result<(Vec<Swing>, Fit), Refusal> {
    /// Number of starts that are followed to the end.
    const FOLLOWED: usize = 5;
    let count = recordings.len();
    let mut watch = |share: f64| {
        if progress(share) {
            Ok(())
        } else {
            Err(Refusal::Interrupted)
        }
    };
    let from = |passing| -> std::result::Result<Vec<Swing>, Refusal> {
        let each = recordings.iter().enumerate();
        let found = each.map(|(place, recording)| swings(place, recording, passing));
        Ok(found.collect::<std::result::Result<Vec<_>, _>>()?.concat())
    };
    watch(0.0)?;
    let even = from(Passing::Even)?;
    let mut best = Fit::of(&even, count, prior).map(|fit| (even, fit));
    if best
        .as_ref()
        .is_some_and(|(_, fit)| fit.rms_rad < GOOD_ENOUGH)
    {
        return best.ok_or(Refusal::Singular);
    }
    watch(0.2)?;
    let others = Passing::ALL
        .into_iter()
        .map(from)
        .collect::<std::result::Result<Vec<_>, _>>()?;
    let near = in_parallel(&others, |all| Fit::candidates(all, count, prior));
    let mut starts: Vec<_> = (others.iter().zip(near))
        .flat_map(|(all, near)| near.into_iter().map(move |(rms, near)| (rms, near, all)))
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    starts.truncate(FOLLOWED);
    watch(0.5)?;
    let fits = in_parallel(&starts, |(_, near, all)| {
        Fit::from(all, count, prior, near.clone())
    });
    for ((_, _, all), fit) in starts.iter().zip(fits) {
        if let Some(fit) = fit
            && (best.as_ref()).is_none_or(|(_, least)| fit.rms_rad < least.rms_rad)
        {
            best = Some(((*all).clone(), fit));
        }
    }
    best.ok_or(Refusal::Singular)
}
