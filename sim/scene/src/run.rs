//! Runs a scene.
//!
//! The scene decides once which types do the work (precision, convention,
//! solver, sensor); the loop then contains nothing of what the scene leaves
//! out. What is observed on the way goes to an [`Observer`]; nothing of a run
//! is kept in memory but its totals.

mod accounting;
mod any_device;
mod command;
mod coupled;
mod device;
mod energy;
mod event_driven;
mod held_back;
mod joined;
mod lead;
mod probe;
mod reached;
mod recorder;
mod sensor;
mod stages;
mod stepped_plant;
mod stepping;
mod summary;
mod tally;
mod untraced;
mod watch;
mod watching;

pub use coupled::{FELT_COLUMN, STRUCK_COLUMN};
pub use held_back::HELD_BACK_COLUMN;
pub use joined::Joined;
pub use lead::Lead;
pub use probe::{AddedTime, StepTime, step_times};
pub use stepped_plant::{Holder, MOST_TORQUE_NM, NotStepped, SteppedPlant};
pub use summary::{
    CycleSummary, EffectSummary, EnergySummary, EnergyTerm, EventCounts, LeadSummary,
    ParameterValue, PlantEnergySummary, SUMMARY_VERSION, Summary, TankSummary, TorqueLimitSummary,
    TorqueSummary,
};
pub use tally::TorqueTally;
pub use untraced::is_stepless;

use crate::any_joint::Precise;
use crate::scene::{Precision, Scene, SolverChoice};
use crate::trace::{Column, ColumnKind, EventRecord, SymptomEvent};
use crepitus_model::SettingsError;
use crepitus_model::solver::Solver;
use crepitus_plant::Plant;
use std::convert::Infallible;
use std::time::Instant;
use watch::{Ended, Watch, watched};

/// Sees a run go by.
pub trait Observer {
    /// Error of the observer.
    type Error;

    /// Whether rows of the trace are needed.
    const WANTS_ROWS: bool = true;

    /// Whether the run is to make every step of its solver, as for who times or judges them. One that
    /// wants no rows may go without: then a run goes from event to event where that gives the same
    /// events, to 1e-9 s, and the same totals, to rounding ([`is_stepless`]).
    const NEEDS_STEPS: bool = true;

    /// A row of the trace, in the order of [`columns`].
    fn row(&mut self, _: &[f64]) -> Result<(), Self::Error> {
        Ok(())
    }

    /// An event; it comes before the first row that is not before it.
    fn event(&mut self, _: &EventRecord) -> Result<(), Self::Error> {
        Ok(())
    }

    /// An event of a symptom, in the same order of time; those of the play under it
    /// only in scenes that ask for them.
    fn symptom(&mut self, _: &SymptomEvent) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Called now and then with the time reached.
    fn progress(&mut self, _: f64) -> Result<(), Self::Error> {
        Ok(())
    }
}

/// Sees nothing: a run for its totals.
#[derive(Clone, Copy, Debug, Default)]
pub struct Blind;

impl Observer for Blind {
    type Error = Infallible;
    const WANTS_ROWS: bool = false;
}

/// Reason for the early end of a run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError<E> {
    /// The observer failed.
    #[error(transparent)]
    Observer(E),
    /// Settings that do not go together.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The solver is not stable with this step.
    #[error(transparent)]
    Diverged(#[from] Diverged),
}

/// A state is NaN, infinite, or soon will be: what computes it is unstable with this step.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Diverged {
    /// Divergence of the object.
    #[error(
        "solver \"{solver}\" diverged: by t = {by_s} s the object's state is no number. ωn·h = {radians_per_step:.3} \
         with this step; choose a shorter one, or a solver that propagates exactly"
    )]
    Object {
        /// Name of the solver.
        solver: &'static str,
        /// Time of detection, s.
        by_s: f64,
        /// ωn·h, what decides on its stability.
        radians_per_step: f64,
    },
    /// Divergence of the shaft, which a plant moves and the device's torque of the step before.
    #[error(
        "the plant and the device diverged: by t = {by_s} s the shaft's angle or speed is no number, or above 1e15, with steps \
         of {step_s} s; choose shorter ones, and a solver that propagates exactly"
    )]
    Shaft {
        /// Time of detection, s.
        by_s: f64,
        /// A step, s.
        step_s: f64,
    },
}

/// The totals of a run before they are put into words.
pub(crate) struct Totals {
    steps: u64,
    end_s: f64,
    tally: Option<tally::Tally>,
    fastest_rad_s: f64,
    /// Steps with as many events as a step may have.
    crowded_steps: u64,
    /// Torque that the tank held back.
    tank: held_back::TankTotals,
    /// Torque beyond the largest of a device.
    beyond: held_back::Beyond,
    plant: Option<coupled::PlantTotals>,
}

/// The columns that the trace of a scene has.
pub fn columns(scene: &Scene) -> Vec<Column> {
    if scene.is_coupled()
        && let Ok(plant) = scene.assemble()
    {
        return columns_with(scene, Some(&plant), scene.is_held());
    }
    columns_with(scene, None, false)
}

/// The columns of a scene on a plant, if it has one, whose leg somebody holds, or nobody.
fn columns_with(scene: &Scene, plant: Option<&Plant>, is_held: bool) -> Vec<Column> {
    let number = |name| Column {
        name,
        kind: ColumnKind::Number,
    };
    let mut columns = ["t_s", "angle_rad", "omega_rad_s"].map(number).to_vec();
    if scene.crepitus.is_some() {
        columns.push(Column {
            name: "phase",
            kind: ColumnKind::Phase,
        });
        columns.extend(["theta_rad", "theta_dot_rad_s", "torque_nm"].map(number));
    }
    if scene.encoder.is_some() {
        columns.extend(<sensor::Encoded<f64> as sensor::Sensor<f64>>::COLUMNS);
    }
    if scene.solver == SolverChoice::Reference {
        columns.extend(stages::listed(scene).map(|spec| number(spec.column)));
        columns.extend(scene.gives_energy().then(|| number(HELD_BACK_COLUMN)));
    }
    if let Some(plant) = plant {
        for spec in stages::listed(scene) {
            columns.push(number(spec.column));
            columns.extend(spec.phases.map(|phases| Column {
                name: phases.column,
                kind: ColumnKind::Whole,
            }));
        }
        columns.extend(scene.gives_energy().then(|| number(HELD_BACK_COLUMN)));
        if scene.is_device {
            columns.extend(device::COLUMNS);
        }
        columns.extend(plant.columns().into_iter().map(number));
        if is_held {
            columns.push(number(coupled::FELT_COLUMN));
            if plant.impacts().is_some() {
                columns.push(number(coupled::STRUCK_COLUMN));
            }
        }
    }
    columns
}

/// Number of steps of a scene; of `reference`, of rows.
pub fn step_count(scene: &Scene) -> u64 {
    steps(scene).0
}

/// Number of rows in the trace of a scene.
pub fn rows(scene: &Scene) -> u64 {
    let (steps, every) = steps(scene);
    steps / every + 1
}

/// Runs `scene` to its end. What each effect costs is not in the summary yet:
/// see [`measure_costs`].
///
/// # Errors
/// The observer's error, or incompatible settings.
pub fn run<O: Observer>(scene: &Scene, observer: &mut O) -> Result<Summary, RunError<O::Error>> {
    let begun = Instant::now();
    let totals = watched(observer, |watch| simulate(scene, watch))?;
    let wall_s = begun.elapsed().as_secs_f64();
    Ok(summary::summarise(scene, &totals, wall_s))
}

/// Times each effect of `scene` in CPU time, in a few thousand steps with it
/// and without it, and notes the costs in its `summary`.
pub fn measure_costs(scene: &Scene, summary: &mut Summary) {
    for cost in probe::costs(scene) {
        for effect in &mut summary.effects {
            if effect.name == cost.effect {
                effect.added = Some(cost.added);
            }
        }
    }
}

/// Runs `scene` without timing anything.
fn simulate(scene: &Scene, watch: &mut dyn Watch) -> Result<Totals, Ended> {
    if watch.needs_steps() {
        return step_by_step(scene, watch);
    }
    match untraced::simulate(scene, watch)? {
        untraced::Way::Whole(totals) => Ok(totals),
        untraced::Way::Unfit(reported) => {
            step_by_step(scene, &mut untraced::Later { watch, reported })
        }
        untraced::Way::Steps => step_by_step(scene, watch),
    }
}

/// Runs `scene` with every step or row that it has.
fn step_by_step(scene: &Scene, watch: &mut dyn Watch) -> Result<Totals, Ended> {
    match scene.solver {
        SolverChoice::Reference => event_driven::simulate(scene, watch),
        SolverChoice::Ladder {
            solver,
            step_s,
            precision,
        } => match precision {
            Precision::F32 => step_through::<f32>(scene, solver, step_s, watch),
            Precision::F64 => step_through::<f64>(scene, solver, step_s, watch),
        },
    }
}

fn step_through<F: Precise>(
    scene: &Scene,
    solver: Solver,
    step_s: f64,
    watch: &mut dyn Watch,
) -> Result<Totals, Ended> {
    if scene.is_coupled() {
        coupled::simulate::<F>(scene, solver, watch)
    } else {
        stepping::simulate::<F>(scene, solver, step_s, watch)
    }
}

/// Number of steps, and of steps between trace rows.
fn steps(scene: &Scene) -> (u64, u64) {
    let step_s = scene.step_s();
    // A duration written in decimals may miss a whole number by rounding.
    let steps = whole(scene.duration_s / step_s * (1.0 + 1e-12) + 1e-9);
    let every = whole((scene.trace_step_s / step_s).round()).max(1);
    (steps, every)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "non-negative, and below 2^53 by the scene's checks"
)]
fn whole(x: f64) -> u64 {
    x as u64
}
