//! The summary of a run: what `summary.json` holds.

use super::coupled::PlantTotals;
use super::held_back::{Beyond, TankTotals};
use super::tally::Tally;
use super::{AddedTime, Totals};
use crate::scene::{Crepitus, DataFile, SCENE_VERSION, Scene, SolverChoice};
use crepitus_model::parameters::Tabled;
use crepitus_model::render::effects::FELT_SHARE;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, EVENTS_PER_STEP, Parameters};
use crepitus_plant::effect::{Effect, Part};
use serde::Serialize;

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
    /// Preset of the scene, if it started from one.
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
#[derive(Clone, Debug, Serialize)]
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
    /// `given`, `stored`, `lost` or `rendered`.
    pub account: &'static str,
    /// J.
    pub joule: f64,
}

/// The work of the rendered torque, J.
#[derive(Clone, Debug, Serialize)]
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
        torque: tally.map(|t| TorqueSummary {
            min_nm: t.torque.min_nm,
            mean_nm: t.torque.integral / totals.end_s,
            max_nm: t.torque.max_nm,
            rms_nm: (t.torque.square / totals.end_s).sqrt(),
        }),
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

fn tank_summary(scene: &Scene, totals: &TankTotals) -> TankSummary {
    TankSummary {
        law: match scene.solver {
            SolverChoice::Reference => "continuous",
            SolverChoice::Ladder { .. } => "ticks",
        },
        first_s: totals.first_s,
        held_back_s: totals.held_back_s,
        most_share: totals.most_share,
        pushes: totals.pushes,
        weak: totals.weak,
        unfelt: totals.unfelt,
    }
}

fn torque_limit(scene: &Scene, beyond: &Beyond) -> Option<TorqueLimitSummary> {
    beyond.first_s.map(|first_s| TorqueLimitSummary {
        limit_nm: beyond.limit_nm,
        is_applied: scene.is_device,
        first_s,
        beyond_s: beyond.lasted_s,
        most_nm: beyond.most_nm,
    })
}

#[expect(clippy::cast_precision_loss, reason = "below 2^53")]
fn hand_torque(plant: &PlantTotals, totals: &Totals) -> Option<TorqueSummary> {
    let ticks = totals.steps as f64;
    plant.felt.map(|felt| TorqueSummary {
        min_nm: felt.min_nm,
        mean_nm: felt.sum / ticks,
        max_nm: felt.max_nm,
        rms_nm: (felt.squares / ticks).sqrt(),
    })
}

#[expect(clippy::cast_precision_loss, reason = "below 2^53")]
fn impacts(plant: &PlantTotals) -> Option<ImpactSummary> {
    plant.impacts.map(|impacts| ImpactSummary {
        count: impacts.count,
        largest_nms: impacts.largest_nms,
        mean_nms: impacts.sum_nms / impacts.count.max(1) as f64,
        hand_largest_nms: plant.struck_nms,
    })
}

fn plant_energy(plant: &PlantTotals, tally: Option<&Tally>) -> PlantEnergySummary {
    let balance = &plant.balance;
    let rendering = &plant.rendering;
    let model_j = tally.map_or(0.0, |t| t.energy.work_in_j);
    let stages_j: f64 = rendering.stages.iter().map(|s| s.1).sum();
    PlantEnergySummary {
        terms: balance
            .terms()
            .iter()
            .map(|t| EnergyTerm {
                effect: t.effect,
                what: t.what,
                account: t.account.name(),
                joule: t.joule,
            })
            .collect(),
        residual_j: balance.residual_j(),
        residual_relative: balance.relative_residual(),
        rendering: RenderingSummary {
            model_j,
            sampling_j: rendering.held - model_j,
            stages: rendering
                .stages
                .iter()
                .map(|&(effect, joule)| StageWork { effect, joule })
                .collect(),
            limits_j: rendering.limits,
            actuator_j: rendering.absorbed
                - rendering.held
                - stages_j
                - rendering.limits.unwrap_or(0.0),
            absorbed_j: rendering.absorbed,
        },
    }
}

/// Cycles of a run whose steps `were_crowded`: what it counted is then not what
/// there was, and no frequency follows from it.
fn cycles(tally: &Tally, were_crowded: bool) -> CycleSummary {
    let c = tally.cycles;
    let any = c.count > 0 && !were_crowded;
    #[expect(clippy::cast_precision_loss, reason = "nearest is meant")]
    let count = c.count as f64;
    CycleSummary {
        count: c.count,
        frequency_hz: any.then(|| count / c.total_s),
        shortest_s: any.then_some(c.shortest_s),
        longest_s: any.then_some(c.longest_s),
    }
}

fn effects(scene: &Scene) -> Vec<EffectSummary> {
    scene
        .effects()
        .into_iter()
        .map(|effect| {
            let (values, choices) = in_force(scene, effect);
            EffectSummary {
                name: effect.name,
                states: effect.states,
                added: None,
                parameters: effect
                    .parameters
                    .iter()
                    .zip(values)
                    .map(|(parameter, value)| ParameterValue {
                        key: parameter.key,
                        value,
                    })
                    .collect(),
                choices,
            }
        })
        .collect()
}

/// An effect's numbers and choices in a scene.
fn in_force(scene: &Scene, effect: &Effect) -> (Vec<f64>, Vec<ChoiceValue>) {
    match effect.part {
        Part::Joint => (
            scene
                .crepitus
                .map(|c| c.settings.parameters.values().to_vec())
                .unwrap_or_default(),
            Vec::new(),
        ),
        Part::Sensor => (
            scene
                .encoder
                .map(|e| e.values().to_vec())
                .unwrap_or_default(),
            Vec::new(),
        ),
        _ => scene
            .listed
            .iter()
            .find(|l| l.effect.name == effect.name)
            .map(|l| {
                let chosen =
                    effect
                        .choices
                        .iter()
                        .zip(&l.given.choices)
                        .map(|(choice, &option)| ChoiceValue {
                            key: choice.key,
                            value: choice.names[usize::from(option)],
                        });
                (l.given.numbers.clone(), chosen.collect())
            })
            .unwrap_or_default(),
    }
}

/// Warnings about the run.
fn run_warnings(scene: &Scene, totals: &Totals) -> Vec<String> {
    let mut warnings = totals
        .plant
        .as_ref()
        .map(|p| p.warnings.clone())
        .unwrap_or_default();
    if let Some(plant) = &totals.plant {
        warnings.extend(balance_warning(plant.balance.relative_residual()));
    }
    warnings.extend(tank_warning(scene, &totals.tank));
    warnings.extend(torque_limit(scene, &totals.beyond).map(|limit| limit_warning(&limit)));
    if totals.crowded_steps > 0 {
        warnings.push(format!(
            "{} steps had {EVENTS_PER_STEP} events, the most that a step takes in, and more may have followed: events and cycles are not those of the joint, and no frequency is given; choose a shorter step",
            totals.crowded_steps
        ));
    }
    let missed_s = scene.duration_s - totals.end_s;
    if missed_s > 1e-9 * scene.duration_s {
        warnings.push(format!(
            "duration_s = {} s is not a whole number of steps of {} s: the run ends at {} s",
            scene.duration_s,
            scene.step_s(),
            totals.end_s
        ));
    }
    warnings.extend(lead_warning(scene, totals));
    if let (Some(crepitus), SolverChoice::Ladder { solver, step_s, .. }) =
        (&scene.crepitus, scene.solver)
    {
        warnings.extend(step_warnings(
            crepitus,
            solver,
            step_s,
            totals.fastest_rad_s,
        ));
    }
    warnings.extend(pitch_warnings(scene, totals.fastest_rad_s));
    warnings
}

/// Beats and reflexes that the tank held back.
fn tank_warning(scene: &Scene, totals: &TankTotals) -> Option<String> {
    let first_s = totals.first_s?;
    let law = match scene.solver {
        SolverChoice::Reference => {
            "; `reference` has the tank as a continuous law, which a device takes tick by tick"
        }
        SolverChoice::Ladder { .. } => "",
    };
    Some(format!(
        "the energy tank held back torque of {} from t = {first_s:.4} s on, for {:.3} s in all, by up to {:.0} %: of {} beats and \
         reflexes that ended {} were weak and {} not felt (less than {:.0} % of their height){law}",
        totals.effects.join(" and "),
        totals.held_back_s,
        1e2 * totals.most_share,
        totals.pushes,
        totals.weak,
        totals.unfelt,
        1e2 * FELT_SHARE,
    ))
}

/// Torque that no device shows.
fn limit_warning(limit: &TorqueLimitSummary) -> String {
    let TorqueLimitSummary {
        limit_nm,
        first_s,
        beyond_s,
        most_nm,
        ..
    } = limit;
    let when = format!(
        "from t = {first_s:.4} s on, for {beyond_s:.3} s in all, up to {:.2} N·m",
        most_nm.abs()
    );
    if limit.is_applied {
        format!(
            "the torque asked for was above the device's limit of {limit_nm} N·m {when}: the device showed {limit_nm} N·m then"
        )
    } else {
        format!(
            "the torque is above the {limit_nm} N·m that a device shows at most {when}: this scene has no device and no limit (`--as-device` applies it)"
        )
    }
}

/// Slips that went on after their end.
fn lead_warning(scene: &Scene, totals: &Totals) -> Option<String> {
    let convention = scene.crepitus?.settings.convention;
    let lead = totals.tally.as_ref()?.lead;
    let missed = convention != Convention::Frozen && lead.behind_s > 0.0;
    missed.then(|| {
        format!(
            "for {:.3e} s the shaft was slower than the object it slips over, by up to {:.3e} rad/s: the solver \
             missed the end of a slip, and friction gave {:.3e} J",
            lead.behind_s, lead.worst_rad_s, lead.behind_j
        )
    })
}

/// The share of a plant's energy that may be missing: a tenth of a percent of
/// all that moved.
const MOST_MISSING: f64 = 1e-3;

/// An energy balance that does not close.
fn balance_warning(share: f64) -> Option<String> {
    // Written so that NaN warns.
    let closes = share.abs() <= MOST_MISSING;
    (!closes).then(|| {
        format!(
            "the energy of the plant balances to {:.1e} of all that moved only, above {MOST_MISSING:e}: the step is too long for a part of it, and its torques are not to be trusted; choose a shorter step",
            share.abs()
        )
    })
}

/// Steps in which the shaft turns by more than what comes once in an angle: a law takes in one of them a step.
fn pitch_warnings(scene: &Scene, fastest_rad_s: f64) -> Vec<String> {
    if scene.solver == SolverChoice::Reference {
        return Vec::new();
    }
    let effects = scene.effect_settings();
    let texture = effects.texture.map(|s| ("texture", s.pitch_deg));
    let teeth = effects.cogwheel.filter(|s| s.mode == 1);
    let teeth = teeth.map(|s| ("cogwheel", s.pitch_deg));
    let step_s = scene.step_s();
    let turn_deg = (fastest_rad_s * step_s).to_degrees();
    let passed = [texture, teeth].into_iter().flatten();
    passed
        .filter(|(_, pitch_deg)| turn_deg > *pitch_deg)
        .map(|(name, pitch_deg)| {
            format!(
                "{name}: step longer than its pitch: at the highest speed, {fastest_rad_s:.3} rad/s, the joint turns by \
                 {turn_deg:.3} degrees in a step of {:.1} µs, and its pitch is {pitch_deg} degrees; of several in a step \
                 one is felt: choose a shorter step, or --solver reference",
                step_s * 1e6
            )
        })
        .collect()
}

/// Steps too long to see what happens within them.
fn step_warnings(
    crepitus: &Crepitus,
    solver: Solver,
    step_s: f64,
    fastest_rad_s: f64,
) -> Vec<String> {
    let p: &Parameters = &crepitus.settings.parameters;
    let mut warnings = Vec::new();
    // 2(Ts − Tk)/(kr·Ω): the shortest stick of the run.
    let stick_s =
        2.0 * (p.static_torque_nm - p.kinetic_torque_nm) / (p.stiffness_nm_per_rad * fastest_rad_s);
    // That rung locates every event inside the step.
    if stick_s < step_s && solver != Solver::ExactEvents {
        warnings.push(format!(
            "step longer than a stick phase: at the highest speed, {fastest_rad_s:.3} rad/s, a stick lasts \
             {:.1} µs and a step {:.1} µs; a solver that does not locate events inside the step misses cycles",
            stick_s * 1e6,
            step_s * 1e6
        ));
    }
    let radians = p.natural_rad_s() * step_s;
    if radians > std::f64::consts::FRAC_PI_4 {
        warnings.push(format!(
            "step long against the object's swing: ωn·h = {radians:.2}, above π/4; a shorter step shows the slip"
        ));
    }
    warnings
}
