//! Cost of a step on the host.
//!
//! Only the stepping is timed, by the loops of [`crepitus_ladder::loops`]: the step, its event
//! closure, and reading the torque, as in a tick of the device. The motion is sampled
//! beforehand, and a few thousand steps at a time are brought into the cache
//! before the clock starts. The clock is the CPU time of the thread, minus the
//! cost of reading it: on a busy machine wall time would include others' work.
//! All rungs of a scene and step take turns within each repeat, every second
//! time in the opposite order, so that a machine that slows down or speeds up
//! affects all alike.

use crate::accuracy::input::Feed;
use crate::accuracy::scenes::StudyScene;
use crate::sampling::{CHUNK_STEPS, Sampling};
use crepitus_ladder::loops::{Loops, Stepper};
use crepitus_model::solver::Solver;
use crepitus_model::{Real, SettingsError, ShaftStep};
use crepitus_scene::scene::Precision;
use crepitus_scene::{cpu_time, instructions};
use std::hint::black_box;
use std::time::Duration;

/// The most steps that one repeat times.
pub(super) const MOST_STEPS: u64 = 40_000;

/// A short scene is run again until this many steps are timed.
const LEAST_STEPS: u64 = 8_000;

/// A rung in a precision.
pub type Contestant = (Solver, Precision);

/// Cost of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Median of the repeats, ns of CPU time.
    pub ns_per_step: f64,
    /// First and third quartile of the repeats, ns.
    pub quartiles_ns: [f64; 2],
    /// (third quartile − first quartile)/median of the repeats.
    pub spread: f64,
}

/// Times `contestants` in turns; `after_each` is called after every turn and
/// may cancel.
///
/// # Errors
/// Error of `after_each`, or `E` from settings that cannot work together.
pub fn time<E: From<SettingsError>>(
    scene: &StudyScene,
    sampling: &Sampling<'_>,
    contestants: &[Contestant],
    repeats: usize,
    mut after_each: impl FnMut() -> Result<(), E>,
) -> Result<Vec<Cost>, E> {
    let track = Track::new(scene, sampling)?;
    let mut nanoseconds = vec![Vec::with_capacity(repeats); contestants.len()];
    for repeat in 0..repeats {
        for turn in 0..contestants.len() {
            let index = if repeat.is_multiple_of(2) {
                turn
            } else {
                contestants.len() - 1 - turn
            };
            if let (Some(&contestant), Some(times)) =
                (contestants.get(index), nanoseconds.get_mut(index))
            {
                times.push(track.ns_per_step(contestant)?);
            }
            after_each()?;
        }
    }
    Ok(nanoseconds.iter_mut().map(|times| cost(times)).collect())
}

/// The timed part of a scene, around the end of its first quarter: there the
/// hand-like sine is fastest, and short steps do not cover its rest only.
pub(super) struct Track<'a> {
    scene: &'a StudyScene,
    step_s: f64,
    /// Cost of reading the clock in each chunk.
    reading: Duration,
    single: Vec<ShaftStep<f32>>,
    double: Vec<ShaftStep<f64>>,
}

impl<'a> Track<'a> {
    pub(super) fn new(
        scene: &'a StudyScene,
        sampling: &Sampling<'_>,
    ) -> Result<Self, SettingsError> {
        Ok(Self {
            reading: cpu_time::reading_cost(),
            ..Self::untimed(scene, sampling)?
        })
    }

    /// A track of which nothing is timed: its clock is not read, as under valgrind it cannot be.
    pub(super) fn untimed(
        scene: &'a StudyScene,
        sampling: &Sampling<'_>,
    ) -> Result<Self, SettingsError> {
        let length = sampling.steps().min(MOST_STEPS);
        let start = (sampling.steps() / 4).saturating_sub(length / 2);
        let most = usize::try_from(length).unwrap_or(usize::MAX);
        let (mut single, mut double) = (Vec::new(), Vec::new());
        Feed::new(scene.input, sampling, start)?.fill(&mut single, most);
        Feed::new(scene.input, sampling, start)?.fill(&mut double, most);
        Ok(Self {
            scene,
            step_s: sampling.step_s(),
            reading: Duration::ZERO,
            single,
            double,
        })
    }

    pub(super) fn ns_per_step(
        &self,
        (solver, precision): Contestant,
    ) -> Result<f64, SettingsError> {
        match precision {
            Precision::F32 => self.run(solver, &self.single),
            Precision::F64 => self.run(solver, &self.double),
        }
    }

    /// Steps a joint through the first `most` steps, in a loop that is counted.
    pub(super) fn count(
        &self,
        (solver, precision): Contestant,
        most: u32,
    ) -> Result<(), SettingsError> {
        match precision {
            Precision::F32 => self.count_through(solver, &self.single, most),
            Precision::F64 => self.count_through(solver, &self.double, most),
        }
    }

    fn count_through<F: Loops>(
        &self,
        solver: Solver,
        steps: &[ShaftStep<F>],
        most: u32,
    ) -> Result<(), SettingsError> {
        let omega = steps.first().map_or(F::ZERO, |s| s.omega_start_rad_s);
        let most = usize::try_from(most).unwrap_or(usize::MAX).min(steps.len());
        let (settings, step_s) = (&self.scene.settings, self.step_s);
        F::joint(settings, solver, step_s, omega, &mut |stepper| {
            instructions::counted(&mut || stepper(steps.get(..most).unwrap_or(steps)));
        })
    }

    fn run<F: Loops>(&self, solver: Solver, steps: &[ShaftStep<F>]) -> Result<f64, SettingsError> {
        let omega = steps.first().map_or(F::ZERO, |s| s.omega_start_rad_s);
        let (settings, step_s) = (&self.scene.settings, self.step_s);
        ns_per_step(steps, |total| {
            F::joint(settings, solver, step_s, omega, &mut |stepper| {
                *total += stepping(steps, self.reading, stepper);
            })
        })
    }
}

/// CPU time of a step, ns: `once` goes through all steps and adds what that took, until enough are
/// timed.
pub(crate) fn ns_per_step<S>(
    steps: &[S],
    mut once: impl FnMut(&mut Duration) -> Result<(), SettingsError>,
) -> Result<f64, SettingsError> {
    let (mut total, mut timed) = (Duration::ZERO, 0_u64);
    let length = u64::try_from(steps.len()).unwrap_or(u64::MAX);
    while timed < LEAST_STEPS.max(length) && length > 0 {
        once(&mut total)?;
        timed += length;
    }
    Ok(total.as_secs_f64() * 1e9 / f64::from_whole(timed))
}

/// CPU time in which a loop goes through all steps, in chunks that are brought into the cache before the
/// clock starts; reading it takes `reading`.
pub(crate) fn stepping<S: Copy>(
    steps: &[S],
    reading: Duration,
    stepper: Stepper<'_, S>,
) -> Duration {
    let mut total = Duration::ZERO;
    let mut cached = Vec::with_capacity(CHUNK_STEPS);
    for part in steps.chunks(CHUNK_STEPS) {
        cached.clear();
        cached.extend_from_slice(part);
        let steps = black_box(cached.as_slice());
        let begun = cpu_time::now();
        stepper(steps);
        total += cpu_time::since(begun).saturating_sub(reading);
    }
    total
}

/// Median and spread.
pub(crate) fn cost(times: &mut [f64]) -> Cost {
    times.sort_by(f64::total_cmp);
    let median = quantile(times, 0.5);
    let quartiles_ns @ [first, third] = [0.25, 0.75].map(|q| quantile(times, q));
    Cost {
        ns_per_step: median,
        quartiles_ns,
        spread: (third - first) / median,
    }
}

/// A quantile of sorted numbers, linear between them; NaN if there are none.
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let place = q * f64::from(u32::try_from(last).unwrap_or(u32::MAX));
    let at = |place: f64| {
        let index = usize::try_from(place.whole()).unwrap_or(last);
        sorted.get(index.min(last)).copied().unwrap_or(f64::NAN)
    };
    let (low, high) = (at(place.floor()), at(place.ceil()));
    low + (high - low) * place.fract()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::scenes::standard;

    #[test]
    fn median_and_quartiles() {
        let cost = cost(&mut [5.0, 1.0, 4.0, 2.0, 3.0]);
        assert_eq!(cost.ns_per_step, 3.0);
        assert_eq!(cost.quartiles_ns, [2.0, 4.0]);
        assert!((cost.spread - 2.0 / 3.0).abs() < 1e-15);
        assert_eq!(quantile(&[1.0, 2.0], 0.5), 1.5);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn every_turn_is_taken_and_any_can_be_the_last() {
        let scenes = standard().unwrap();
        let sampling = Sampling::new(&scenes[0].motion, 0.1, 1e-3);
        let contestants = [
            (Solver::Exact, Precision::F32),
            (Solver::ExactEvents, Precision::F64),
        ];
        let mut turns = 0;
        let costs = time::<SettingsError>(&scenes[0], &sampling, &contestants, 3, || {
            turns += 1;
            Ok(())
        })
        .unwrap();
        assert_eq!((costs.len(), turns), (2, 6));
        assert!(costs.iter().all(|c| c.ns_per_step > 0.0 && c.spread >= 0.0));
        let stop = SettingsError::Step { step_s: 0.0 };
        assert!(time(&scenes[0], &sampling, &contestants, 3, || Err(stop)).is_err());
    }
}
