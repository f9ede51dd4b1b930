//! Errors of a law's steps against the reference.
//!
//! Torque is compared at the ends of steps. At an event it may jump; so a step's end that
//! lies between the true time of an event and the time at which it was found is left
//! out: there the time is wrong, which is measured by itself, and not the torque.

use super::event::{SymptomEvent, matched, own};
use super::follow::follow;
use super::given::Given;
use super::truth::{true_events, true_torques};
use crate::sampling::Sampling;
use crepitus_model::{Real, SettingsError};
use crepitus_plant::Motion;
use crepitus_scene::reference::symptoms::SymptomError;

/// Times within this share of a step are one.
const SAME_TIME: f64 = 1e-6;

/// The reference's events and torques for one motion.
pub(crate) struct Truth {
    pub(crate) events: Vec<SymptomEvent>,
    /// Steps from one torque to the next.
    pub(crate) stride: u64,
    /// Torque at the end of every `stride`th step, from the first on, N·m.
    torques_nm: Vec<f64>,
}

impl Truth {
    /// Events up to the end of the last step, and the torque at the end of every
    /// `stride`th.
    pub(crate) fn new(
        given: &Given,
        motion: &Motion,
        sampling: &Sampling<'_>,
        stride: u64,
    ) -> Result<Self, SymptomError> {
        let times_s = (1..=sampling.steps() / stride).map(|k| sampling.time_s(k * stride, 0.0));
        Ok(Self {
            events: own(true_events(given, motion, sampling.end_s())?),
            stride,
            torques_nm: true_torques(given, motion, times_s)?,
        })
    }
}

/// Errors of one kind: the largest, and the mean of their squares.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Size {
    most: f64,
    squares: f64,
    count: f64,
}

impl Size {
    fn add(&mut self, error: f64) {
        // NaN is the worst, and stays.
        if error.abs() > self.most || error.is_nan() {
            self.most = error.abs();
        }
        self.squares += error * error;
        self.count += 1.0;
    }

    /// The largest; NaN without any.
    pub(crate) fn most(&self) -> f64 {
        if self.count > 0.0 {
            self.most
        } else {
            f64::NAN
        }
    }

    /// The root of the mean square; NaN without any.
    pub(crate) fn rms(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }
}

/// Errors of a law on some motions.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Errors {
    pub(crate) events: u64,
    pub(crate) events_true: u64,
    pub(crate) unmatched: u64,
    pub(crate) event_s: Size,
    pub(crate) torque_nm: Size,
}

impl Errors {
    /// Follows another motion.
    pub(crate) fn add<F: Real>(
        &mut self,
        given: &Given,
        sampling: &Sampling<'_>,
        truth: &Truth,
    ) -> Result<(), SettingsError> {
        let mut torques_nm = Vec::with_capacity(truth.torques_nm.len());
        let found = own(follow::<F>(given, sampling, &mut |n, torque_nm| {
            if n.is_multiple_of(truth.stride) {
                torques_nm.push(torque_nm);
            }
        })?);
        self.compare(sampling, truth, &found, &torques_nm);
        Ok(())
    }

    /// Compares events, and the torques at the strides, with the reference.
    pub(crate) fn compare(
        &mut self,
        sampling: &Sampling<'_>,
        truth: &Truth,
        found: &[SymptomEvent],
        torques_nm: &[f64],
    ) {
        let step_s = sampling.step_s();
        let matching = matched(&truth.events, found, step_s, sampling.end_s());
        self.events += u64::try_from(found.len()).unwrap_or(u64::MAX);
        self.events_true += u64::try_from(truth.events.len()).unwrap_or(u64::MAX);
        self.unmatched += matching.unmatched;
        let mut between = Vec::with_capacity(matching.pairs.len());
        for &(i, j) in &matching.pairs {
            if let (Some(t), Some(f)) = (truth.events.get(i), found.get(j)) {
                self.event_s.add(f.time_s - t.time_s);
                let same_s = SAME_TIME * step_s;
                let (early_s, late_s) = (t.time_s.min(f.time_s), t.time_s.max(f.time_s));
                between.push((early_s - same_s, late_s + same_s));
            }
        }
        let mut next = between.iter().peekable();
        for (k, (torque_nm, true_nm)) in (1_u64..).zip(torques_nm.iter().zip(&truth.torques_nm)) {
            let now_s = sampling.time_s(k * truth.stride, 0.0);
            while next.next_if(|(_, late_s)| *late_s < now_s).is_some() {}
            if next.peek().is_none_or(|(early_s, _)| *early_s > now_s) {
                self.torque_nm.add(torque_nm - true_nm);
            }
        }
    }
}
