//! Cost of a tick of a symptom on the host, beside that of a step of crepitus:
//! all in turn within each repeat, as [the ladder](crate::accuracy::timing) is timed.

use super::SymptomPlan;
use super::motions::motions;
use crate::accuracy::scenes;
use crate::accuracy::timing::{Cost, MOST_STEPS, Track, cost, ns_per_step, stepping};
use crate::sampling::Sampling;
use crate::symptoms::Given;
use crate::symptoms::follow::timing;
use crate::watcher::{Cancelled, StudyError};
use crepitus_ladder::loops::{Loops, PlacedStep};
use crepitus_model::render::position::Sensing;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Real, SettingsError};
use crepitus_scene::cpu_time;
use crepitus_scene::scene::Precision;
use std::time::Duration;

/// The scene of the crepitus that they are compared with.
const CREPITUS: &str = "constant-0.988";

/// Cost of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct SymptomCost {
    pub(super) ns_per_step: f64,
    /// Over a step of crepitus.
    pub(super) ratio: f64,
    pub(super) spread: f64,
}

/// Costs at one step.
pub(super) struct Costs(Vec<(Option<Given>, Precision, Cost)>);

impl Costs {
    fn find(&self, given: Option<&Given>, precision: Precision) -> Cost {
        let mut own = self.0.iter();
        let found = own.find(|(of, p, _)| of.as_ref() == given && *p == precision);
        found.map_or(
            Cost {
                ns_per_step: f64::NAN,
                quartiles_ns: [f64::NAN; 2],
                spread: f64::NAN,
            },
            |(_, _, cost)| *cost,
        )
    }

    /// Returns the cost of a symptom in a precision.
    pub(super) fn of(&self, given: &Given, precision: Precision) -> SymptomCost {
        let cost = self.find(Some(given), precision);
        SymptomCost {
            ns_per_step: cost.ns_per_step,
            ratio: cost.ns_per_step / self.find(None, precision).ns_per_step,
            spread: cost.spread,
        }
    }
}

/// Times all in turns; `after_each` is called after every turn and may cancel.
pub(super) fn time(
    symptoms: &[Given],
    plan: &SymptomPlan<'_>,
    step_s: f64,
    mut after_each: impl FnMut() -> Result<(), Cancelled>,
) -> Result<Costs, StudyError> {
    let crepitus = scenes::standard()?
        .into_iter()
        .find(|s| s.name == CREPITUS && s.settings.convention == Convention::Frozen);
    let crepitus_steps = crepitus
        .as_ref()
        .map(|scene| Sampling::new(&scene.motion, scene.duration_s, step_s));
    let crepitus = crepitus
        .as_ref()
        .zip(crepitus_steps.as_ref())
        .map(|(scene, sampling)| Track::new(scene, sampling))
        .transpose()?;
    let steps = Steps::new(step_s);
    let contestants: Vec<(Option<&Given>, Precision)> = plan
        .precisions
        .iter()
        .flat_map(|p| {
            let of = symptoms.iter().map(|given| (Some(given), *p));
            [(None, *p)].into_iter().chain(of)
        })
        .collect();
    let mut times = vec![Vec::with_capacity(plan.repeats); contestants.len()];
    for repeat in 0..plan.repeats {
        for turn in 0..contestants.len() {
            let index = if repeat.is_multiple_of(2) {
                turn
            } else {
                contestants.len() - 1 - turn
            };
            if let (Some(&(given, precision)), Some(times)) =
                (contestants.get(index), times.get_mut(index))
            {
                let ns = match (given, &crepitus) {
                    (Some(given), _) => steps.ns_per_step(given, precision)?,
                    (None, Some(track)) => track.ns_per_step((Solver::ExactEvents, precision))?,
                    (None, None) => f64::NAN,
                };
                times.push(ns);
            }
            after_each()?;
        }
    }
    let costs = contestants.iter().zip(&mut times);
    Ok(Costs(
        costs
            .map(|(&(given, precision), times)| (given.cloned(), precision, cost(times)))
            .collect(),
    ))
}

/// The timed part of the motion, around its first quarter.
struct Steps {
    step_s: f64,
    from_rad: f64,
    /// Cost of reading the clock in each chunk.
    reading: Duration,
    single: Vec<PlacedStep<f32>>,
    double: Vec<PlacedStep<f64>>,
}

impl Steps {
    fn new(step_s: f64) -> Self {
        let [_, (_, strokes, duration_s), _] = motions();
        let motion = strokes.motion();
        let sampling = Sampling::new(&motion, duration_s, step_s);
        let most = sampling.steps().min(MOST_STEPS);
        let start = (sampling.steps() / 4).saturating_sub(most / 2);
        Self {
            step_s,
            from_rad: sampling.walk_from(start).now().0,
            reading: cpu_time::reading_cost(),
            single: prepared(&sampling, start, most),
            double: prepared(&sampling, start, most),
        }
    }

    fn ns_per_step(&self, given: &Given, precision: Precision) -> Result<f64, SettingsError> {
        match precision {
            Precision::F32 => self.run(given, &self.single),
            Precision::F64 => self.run(given, &self.double),
        }
    }

    fn run<F: Loops>(&self, given: &Given, steps: &[PlacedStep<F>]) -> Result<f64, SettingsError> {
        let (settings, place) = (given.settings(), given.place());
        let (timing, from) = (timing(self.step_s), Sensing::IDEAL.position(self.from_rad));
        ns_per_step(steps, |total| {
            F::law(&settings, place, &timing, &from, &mut |stepper| {
                *total += stepping(steps, self.reading, stepper);
            })
        })
    }
}

fn prepared<F: Real>(sampling: &Sampling<'_>, start: u64, most: u64) -> Vec<PlacedStep<F>> {
    let mut chunk = Vec::new();
    let most = usize::try_from(most).unwrap_or(usize::MAX);
    sampling.walk_from(start).fill_with_angles(&mut chunk, most);
    let place = |(angle_rad, step)| (step, Sensing::IDEAL.position(angle_rad));
    chunk.into_iter().map(place).collect()
}
