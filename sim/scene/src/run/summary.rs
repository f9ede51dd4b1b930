//! The summary of a run: what `summary.json` holds.

mod parts;
mod warnings;

use super::{AddedTime, Totals};
use crate::scene::{DataFile, SCENE_VERSION, Scene, SolverChoice};
use crepitus_plant::energy_balance::Account;
use parts::{cycles, effects, hand_torque, impacts, plant_energy, tank_summary, torque_limit};
use serde::{Serialize, Serializer};
use warnings::run_warnings;

/// Version of the form of `summary.json`.
pub const SUMMARY_VERSION: u32 = 1;

/// A run in numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Version of this form.
    pub summary_version: u32,
    /// Version of the program.
    pub crepitus_version: &'static str,
    /// Version of the scene file's form.
    pub scene_version: u32,
    /// The commit that the program was built from, if it is known.
    pub crepitus_commit: Option<&'static str>,
    /// The scene file.
    pub scene: String,
    /// The scene as it was run, as TOML: `crepitus run summary.json` repeats it.
    pub scene_as_run: String,
    /// The recording that the motion was read from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data: Option<DataFile>,
    /// Title of the scene.
    pub title: String,
    /// Kind of motion.
    pub motion: &'static str,
    /// Seed of everything random, if the scene gives one.
    pub seed: Option<u64>,
    /// Name of the solver.
    pub solver: &'static str,
    /// Step of the solver, s; none for `reference`.
    pub step_s: Option<f64>,
    /// Precision of the solver.
    pub precision: &'static str,
    /// Convention of the stick-slip object, if there is one.
    pub convention: Option<&'static str>,
    /// Restart rule of the stick-slip object.
    pub restart: Option<&'static str>,
    /// Preset of the scene, if it started from one and no number of its joint was changed.
    pub preset: Option<&'static str>,
    /// The effects that ran.
    pub effects: Vec<EffectSummary>,
    /// Simulated time, s.
    pub simulated_s: f64,
    /// Steps taken; rows of `reference`.
    pub steps: u64,
    /// Highest speed of the shaft, rad/s.
    pub fastest_rad_s: f64,
    /// Events by kind.
    pub events: Option<EventCounts>,
    /// Stick-slip cycles.
    pub cycles: Option<CycleSummary>,
    /// The torque shown.
    pub torque: Option<TorqueSummary>,
    /// The energy balance of the object.
    pub energy: Option<EnergySummary>,
    /// Slips in which the shaft fell behind the object.
    pub lead: Option<LeadSummary>,
    /// Torque that the energy tank held back, if symptoms can give energy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tank: Option<TankSummary>,
    /// Torque beyond the largest of a device, if there was any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_limit: Option<TorqueLimitSummary>,
    /// Torque at the hand, if there is a plant and a hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hand_torque: Option<TorqueSummary>,
    /// The impacts of the plant, if a part of it can have any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impacts: Option<ImpactSummary>,
    /// The energy balance of the plant, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plant_energy: Option<PlantEnergySummary>,
    /// Time that the run took, with its outputs, s.
    pub wall_s: f64,
    /// Simulated time over that.
    pub real_time_factor: f64,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// One effect that ran.
#[derive(Clone, Debug, Serialize)]
pub struct EffectSummary {
    /// Name of the effect in scene files.
    pub name: &'static str,
    /// State variables of the effect.
    pub states: &'static [&'static str],
    /// Cost, once measured; never for `reference`.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub added: Option<AddedTime>,
    /// Parameters of the effect.
    pub parameters: Vec<ParameterValue>,
    /// Choices of the effect by name.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<ChoiceValue>,
}

/// An active choice.
#[derive(Clone, Debug, Serialize)]
pub struct ChoiceValue {
    /// Name, as in scene files.
    pub key: &'static str,
    /// Name of the chosen value.
    pub value: &'static str,
}

/// An active parameter.
#[derive(Clone, Debug, Serialize)]
pub struct ParameterValue {
    /// Name with unit, as in scene files.
    pub key: &'static str,
    /// Value.
    pub value: f64,
}

/// Events by kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct EventCounts {
    /// Stick ended.
    #[serde(rename = "break")]
    pub breaks: u64,
    /// Slip ended in stick.
    #[serde(rename = "stick")]
    pub sticks: u64,
    /// Slip ended in slip of the other sense.
    #[serde(rename = "reverse")]
    pub reverses: u64,
}

/// Cycles, from break to break in the same sense.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CycleSummary {
    /// Number of complete cycles.
    pub count: u64,
    /// One over the mean length, Hz.
    pub frequency_hz: Option<f64>,
    /// Shortest, s.
    pub shortest_s: Option<f64>,
    /// Longest, s.
    pub longest_s: Option<f64>,
}

/// Torque over time, N·m.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TorqueSummary {
    /// Smallest.
    pub min_nm: f64,
    /// Mean over time.
    pub mean_nm: f64,
    /// Largest.
    pub max_nm: f64,
    /// Root mean square over time.
    pub rms_nm: f64,
}

/// Torque that the energy tank held back.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TankSummary {
    /// The law of the tank: `ticks`, the device's, or `continuous`, that of `reference`.
    pub law: &'static str,
    /// Time of the first torque that was not paid in full, s.
    pub first_s: Option<f64>,
    /// Time with torque that was not paid in full, s.
    pub held_back_s: f64,
    /// The largest share held back.
    pub most_share: f64,
    /// Beats and reflexes that ended.
    pub pushes: u64,
    /// Those of them that were held back, but felt.
    pub weak: u64,
    /// Those of them of which less than half the height was shown.
    pub unfelt: u64,
}

/// Torque beyond the largest of a device.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TorqueLimitSummary {
    /// The largest torque of a device, N·m.
    pub limit_nm: f64,
    /// Whether the scene has a device, which then showed no more than that.
    pub is_applied: bool,
    /// Time of the first torque beyond, s.
    pub first_s: f64,
    /// Time beyond, s.
    pub beyond_s: f64,
    /// The torque that was asked for furthest beyond, N·m.
    pub most_nm: f64,
}

/// Impacts: each takes no time, so it has an impulse and no torque.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ImpactSummary {
    /// Number of impacts.
    pub count: u64,
    /// The largest impulse between rotor and joint, N·m·s.
    pub largest_nms: f64,
    /// The mean of their magnitudes, N·m·s; 0 if there is none.
    pub mean_nms: f64,
    /// The largest impulse that the hand felt in a tick, N·m·s.
    pub hand_largest_nms: f64,
}

/// Terms of the energy balance, J:
/// work_in + convention = spring_change + kinetic_change + friction + viscous + residual.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EnergySummary {
    /// ∫T dφ: work of the hand.
    pub work_in_j: f64,
    /// Energy that the convention adds to the object without a torque.
    pub convention_j: f64,
    /// Change of the spring's energy.
    pub spring_change_j: f64,
    /// Change of the object's kinetic energy.
    pub kinetic_change_j: f64,
    /// Dissipated by friction between shaft and object.
    pub friction_j: f64,
    /// Dissipated by the object's damping.
    pub viscous_j: f64,
    /// Residual.
    pub residual_j: f64,
    /// That, as a share of the energy that went through.
    pub residual_relative: f64,
}

/// Slips in which the shaft was slower than the object in the sense of the
/// slip, s·(Ω − θ̇) < 0, by more than rounding: friction pushed it along.
///
/// Under `paper` and `physical` that is a missed event; under `frozen` it is
/// what the convention does when the hand slows down in a slip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LeadSummary {
    /// Time in slips with the shaft behind, s.
    pub behind_s: f64,
    /// Energy that friction gave meanwhile, J.
    pub behind_j: f64,
    /// Largest velocity by which the shaft was behind, rad/s.
    pub worst_behind_rad_s: f64,
}

/// The energy balance of a plant, J:
/// sum of what was given = sum of what is stored, lost and rendered + residual.
#[derive(Clone, Debug, Default, Serialize)]
pub struct PlantEnergySummary {
    /// Terms of the balance, from the hand to the motor.
    pub terms: Vec<EnergyTerm>,
    /// Residual.
    pub residual_j: f64,
    /// That, as a share of the sum of all terms' magnitudes.
    pub residual_relative: f64,
    /// Work that the actuator took out of the mechanics, and where it comes
    /// from: it is the sum of the others.
    pub rendering: RenderingSummary,
}

/// One term of a plant's balance.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct EnergyTerm {
    /// The effect that it belongs to.
    pub effect: &'static str,
    /// Description of the term.
    pub what: &'static str,
    /// Account in which it counts.
    #[serde(serialize_with = "by_name")]
    pub account: Account,
    /// J.
    pub joule: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
fn by_name<S: Serializer>(account: &Account, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(account.name())
}

/// The work of the rendered torque, J.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RenderingSummary {
    /// Work of the model's torque, as its own balance has it.
    pub model_j: f64,
    /// Work of holding that torque over each tick, and of what the sensor does not
    /// see.
    pub sampling_j: f64,
    /// Work of the torque that each stage of the device adds.
    pub stages: Vec<StageWork>,
    /// Work of the torque that its guards and limits take away; none in a scene without a
    /// device.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limits_j: Option<f64>,
    /// Work of the difference between the torque commanded and that of the motor.
    pub actuator_j: f64,
    /// Work of the torque that there was.
    pub absorbed_j: f64,
}

/// Work of one stage of the device.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct StageWork {
    /// The effect that it belongs to.
    pub effect: &'static str,
    /// J.
    pub joule: f64,
}

/// Puts the totals of a run into words.
pub(super) fn summarise(scene: &Scene, totals: &Totals, wall_s: f64) -> Summary {
    let tally = totals.tally.as_ref();
    let (step, precision) = match scene.solver {
        SolverChoice::Reference => (None, "f64"),
        SolverChoice::Ladder {
            step_s, precision, ..
        } => (Some(step_s), precision.name()),
    };
    let mut warnings = scene.warnings.clone();
    warnings.extend(run_warnings(scene, totals));
    Summary {
        summary_version: SUMMARY_VERSION,
        crepitus_version: env!("CARGO_PKG_VERSION"),
        crepitus_commit: None,
        scene_as_run: scene.as_run.clone(),
        data: scene.data.clone(),
        scene_version: SCENE_VERSION,
        scene: scene.file.display().to_string(),
        title: scene.title.clone(),
        motion: scene.motion_kind.name(),
        seed: scene.seed,
        solver: scene.solver.name(),
        step_s: step,
        precision,
        convention: scene.crepitus.map(|c| c.settings.convention.name()),
        restart: scene.crepitus.map(|c| c.settings.restart.name()),
        preset: scene.crepitus.and_then(|c| c.preset),
        effects: effects(scene),
        simulated_s: totals.end_s,
        steps: totals.steps,
        fastest_rad_s: totals.fastest_rad_s,
        events: tally.map(|t| EventCounts {
            breaks: t.events[0],
            sticks: t.events[1],
            reverses: t.events[2],
        }),
        cycles: tally.map(|t| cycles(t, totals.crowded_steps > 0)),
        torque: tally.map(|t| t.torque.summary(totals.end_s)),
        energy: tally.map(|t| EnergySummary {
            work_in_j: t.energy.work_in_j,
            convention_j: t.energy.convention_j,
            spring_change_j: t.energy.spring_change_j,
            kinetic_change_j: t.energy.kinetic_change_j,
            friction_j: t.energy.friction_j,
            viscous_j: t.energy.viscous_j,
            residual_j: t.energy.residual_j(),
            residual_relative: t.energy.relative_residual(),
        }),
        lead: tally.map(|t| LeadSummary {
            behind_s: t.lead.behind_s,
            behind_j: t.lead.behind_j,
            worst_behind_rad_s: t.lead.worst_rad_s,
        }),
        tank: scene
            .gives_energy()
            .then(|| tank_summary(scene, &totals.tank)),
        torque_limit: torque_limit(scene, &totals.beyond),
        hand_torque: totals.plant.as_ref().and_then(|p| hand_torque(p, totals)),
        impacts: totals.plant.as_ref().and_then(impacts),
        plant_energy: totals.plant.as_ref().map(|p| plant_energy(p, tally)),
        wall_s,
        real_time_factor: totals.end_s / wall_s,
        warnings,
    }
}
