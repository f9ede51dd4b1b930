//! Costs of a step: time on the host, cycles on the controller, memory.
//!
//! Timed in f32 at the device's tick on two motions of the paper's joint: steady grating, and a pass of
//! the knee. The laws take turns within each repeat, every second time in the opposite order, as the
//! study of accuracy times its rungs.

use super::runner::{TICK_S, between};
use super::tasks::DRAG_RAD_S;
use crate::accuracy::target::TargetError;
use crate::accuracy::timing::{cost, ns_per_step, stepping};
use crate::watcher::{StudyError, Watcher};
use crepitus_ladder::laws::{ENTRIES, Entry};
use crepitus_ladder::{Call, Cost};
use crepitus_model::{Parameters, Real, SettingsError, ShaftStep};
use crepitus_plant::Motion;
use crepitus_scene::cpu_time;
use serde::Serialize;

/// Ticks of a timed motion.
const TICKS: u32 = 40_000;
/// Ticks of a motion on the controller.
const CONTROLLER_TICKS: usize = 2_000;

/// Time of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StepTime {
    /// Median of the repeats, ns of CPU time.
    pub ns: f64,
    /// First and third quartile of the repeats, ns.
    pub quartiles_ns: [f64; 2],
    /// (third quartile − first quartile)/median of the repeats.
    pub spread: f64,
}

/// Cost of a step on the controller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ControllerCost {
    /// Mean cycles of a step.
    pub mean_cycles: f64,
    /// Most cycles of a step.
    pub worst_cycles: u32,
    /// Mean instructions of a step.
    pub mean_instructions: f64,
    /// Most instructions of a step.
    pub worst_instructions: u32,
    /// Steps that were run.
    pub steps: u64,
}

impl ControllerCost {
    fn of(cost: &Cost) -> Option<Self> {
        (cost.calls > 0).then(|| Self {
            mean_cycles: cost.mean_cycles(),
            worst_cycles: cost.worst_cycles,
            mean_instructions: cost.mean_instructions(),
            worst_instructions: cost.worst_instructions,
            steps: cost.calls,
        })
    }
}

/// Costs of a law.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Costs {
    /// Name of the law.
    pub law: &'static str,
    /// Memory of state and coefficients in f32, bytes.
    pub bytes: usize,
    /// Repeats of each timing.
    pub repeats: usize,
    /// Time in steady grating; `None` if it was not measured.
    pub grating: Option<StepTime>,
    /// Time in a pass of the knee; `None` if it was not measured.
    pub knee: Option<StepTime>,
    /// Cost on the controller; `None` if it was not run there.
    pub controller: Option<ControllerCost>,
}

impl Costs {
    /// The cost by which laws are compared: cycles of the controller, or else ns of the host.
    pub fn of_a_step(&self) -> f64 {
        match (&self.controller, &self.grating) {
            (Some(controller), _) => controller.mean_cycles,
            (None, Some(time)) => time.ns,
            (None, None) => f64::INFINITY,
        }
    }
}

/// Steps of the timed motions: steady grating from a stick, and a pass of the knee from rest.
pub fn timed_motions() -> [Vec<ShaftStep<f32>>; 2] {
    let knee = Motion::sine(45_f64.to_radians(), 0.25, -90.0).piece(0.0);
    let along = |pose: &dyn Fn(f64) -> (f64, f64)| {
        let at = |n: u32| pose(f64::from(n) * TICK_S);
        let steps = (0..TICKS).map(|n| {
            let shaft = between(at(n), at(n + 1));
            ShaftStep {
                delta_phi_rad: f32::from_f64(shaft.delta_phi_rad),
                omega_start_rad_s: f32::from_f64(shaft.omega_start_rad_s),
                omega_end_rad_s: f32::from_f64(shaft.omega_end_rad_s),
            }
        });
        steps.collect()
    };
    [
        along(&|time_s| (DRAG_RAD_S * time_s, DRAG_RAD_S)),
        along(&|time_s| knee.angle_and_velocity(time_s)),
    ]
}

/// Measures the laws on this computer, on this joint.
///
/// # Errors
/// Error of the watcher, or a joint that is invalid.
pub(super) fn costs(
    laws: &[&Entry],
    joint: &Parameters,
    repeats: usize,
    watcher: &mut dyn Watcher,
) -> Result<Vec<Costs>, StudyError> {
    let motions = timed_motions();
    let reading = cpu_time::reading_cost();
    let turns = 2 * repeats * laws.len();
    let mut done = 0_usize;
    // By law, by motion.
    let mut times = vec![[Vec::new(), Vec::new()]; laws.len()];
    for repeat in 0..repeats {
        for turn in 0..laws.len() {
            let place = if repeat.is_multiple_of(2) {
                turn
            } else {
                laws.len() - 1 - turn
            };
            let (Some(law), Some(times)) = (laws.get(place), times.get_mut(place)) else {
                continue;
            };
            for (times, steps) in times.iter_mut().zip(&motions) {
                times.push(ns_per_step(steps, |total| {
                    let omega = steps.first().map_or(0.0, |s| s.omega_start_rad_s);
                    law.timed(joint, TICK_S, omega, &mut |stepper| {
                        *total += stepping(steps, reading, stepper);
                    })
                })?);
                done += 1;
                watcher.progress(done as f64 / turns as f64)?;
            }
        }
    }
    let summed = laws.iter().zip(&mut times).map(|(law, [grating, knee])| {
        Ok::<_, SettingsError>(Costs {
            law: law.name,
            bytes: law.single(joint, TICK_S, 0.0)?.bytes(),
            repeats,
            grating: step_time(grating),
            knee: step_time(knee),
            controller: None,
        })
    });
    Ok(summed.collect::<Result<_, _>>()?)
}

fn step_time(times: &mut [f64]) -> Option<StepTime> {
    let measured = (!times.is_empty()).then(|| cost(times))?;
    Some(StepTime {
        ns: measured.ns_per_step,
        quartiles_ns: measured.quartiles_ns,
        spread: measured.spread,
    })
}

/// Runs the laws of these costs on the controller, from rest on both timed motions. `on_controller` gets the
/// name of a law, its joint, and steps of 50 µs, and returns what each of them cost.
///
/// # Errors
/// Error of the controller or of the watcher.
pub fn on_controller<T>(
    costs: &mut [Costs],
    joint: &Parameters,
    mut on_controller: impl FnMut(&'static str, &Parameters, &[ShaftStep<f32>]) -> Result<Vec<Call>, T>,
    watcher: &mut dyn Watcher,
) -> Result<(), TargetError<T>> {
    let motions = timed_motions();
    let laws = costs.len();
    for (place, costs) in costs.iter_mut().enumerate() {
        let mut sum = Cost::default();
        for steps in &motions {
            // Around the middle both grate, or would.
            let from = steps.len() / 2;
            let steps = steps.get(from..from + CONTROLLER_TICKS).unwrap_or(steps);
            let calls = on_controller(costs.law, joint, steps).map_err(TargetError::Target)?;
            sum.add(&Cost::of(&calls));
        }
        costs.controller = ControllerCost::of(&sum);
        let fraction = (place + 1) as f64 / laws as f64;
        watcher.progress(fraction).map_err(StudyError::from)?;
    }
    Ok(())
}

/// Place of a law among the entries, by which a controller knows it.
pub fn place_of(law: &str) -> Option<usize> {
    ENTRIES.iter().position(|entry| entry.name == law)
}
