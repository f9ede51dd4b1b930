//! Parts of a summary, from the totals of a run.

use super::{
    ChoiceValue, CycleSummary, EffectSummary, EnergyTerm, ImpactSummary, ParameterValue,
    PlantEnergySummary, RenderingSummary, StageWork, TankSummary, TorqueLimitSummary,
    TorqueSummary,
};
use crate::run::Totals;
use crate::run::coupled::PlantTotals;
use crate::run::held_back::{Beyond, TankTotals};
use crate::run::tally::Tally;
use crate::scene::{Scene, SolverChoice};
use crepitus_model::parameters::Tabled;
use crepitus_plant::effect::{Effect, Part};

pub(super) fn tank_summary(scene: &Scene, totals: &TankTotals) -> TankSummary {
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

pub(super) fn torque_limit(scene: &Scene, beyond: &Beyond) -> Option<TorqueLimitSummary> {
    beyond.first_s.map(|first_s| TorqueLimitSummary {
        limit_nm: beyond.limit_nm,
        is_applied: scene.is_device,
        first_s,
        beyond_s: beyond.lasted_s,
        most_nm: beyond.most_nm,
    })
}

#[expect(clippy::cast_precision_loss, reason = "below 2^53")]
pub(super) fn hand_torque(plant: &PlantTotals, totals: &Totals) -> Option<TorqueSummary> {
    let ticks = totals.steps as f64;
    plant.felt.map(|felt| felt.summary(ticks))
}

#[expect(clippy::cast_precision_loss, reason = "below 2^53")]
pub(super) fn impacts(plant: &PlantTotals) -> Option<ImpactSummary> {
    plant.impacts.map(|impacts| ImpactSummary {
        count: impacts.count,
        largest_nms: impacts.largest_nms,
        mean_nms: impacts.sum_nms / impacts.count.max(1) as f64,
        hand_largest_nms: plant.struck_nms,
    })
}

pub(super) fn plant_energy(plant: &PlantTotals, tally: Option<&Tally>) -> PlantEnergySummary {
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
                account: t.account,
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
pub(super) fn cycles(tally: &Tally, were_crowded: bool) -> CycleSummary {
    let c = tally.cycles;
    let any = c.count > 0 && !were_crowded;
    #[expect(clippy::cast_precision_loss, reason = "nearest is meant")]
    let count = c.count as f64;
    CycleSummary {
        count: c.count,
        frequency_hz: any.then(|| count / c.total_s),
        shortest_s: any.then_some(c.length_s.low),
        longest_s: any.then_some(c.length_s.high),
    }
}

pub(super) fn effects(scene: &Scene) -> Vec<EffectSummary> {
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
