//! The symptoms of a recording besides crepitus: which were on, and with which
//! settings.

use super::COLUMNS;
use crepitus_model::parameters::Source;
use crepitus_model::render::effects::{EffectSettings, EffectSpec, SPECS};
use crepitus_protocol::parameters::find;
use crepitus_protocol::{LimitReason, Values};
use crepitus_recording::{History, Row};
use crepitus_scene::trace::{Column, ColumnKind};

/// See the module.
pub(super) struct Symptoms {
    /// Of those whose settings were the same whenever they were on.
    pub(super) settings: EffectSettings,
    /// Those that were on at any time.
    on: Vec<&'static EffectSpec>,
}

impl Symptoms {
    /// Of these parameters.
    pub(super) fn of(parameters: &History) -> Self {
        let mut in_force = parameters.in_force();
        let sets = parameters.0.iter().filter_map(|set| {
            in_force.at(set.first_row);
            in_force.values()
        });
        let sets: Vec<Values> = sets.collect();
        let (mut unchanged, mut on) = (Values::default(), Vec::new());
        // What has phases is a symptom.
        for spec in SPECS.iter().filter(|spec| spec.phases.is_some()) {
            let switch = find(&format!("{}.render", spec.name)).map(|(id, _)| id);
            let is_on = |values: &&Values| switch.is_some_and(|id| values.is_on(id));
            let mut while_on = sets
                .iter()
                .filter(is_on)
                .map(|values| of_effect(values, spec));
            let Some(first) = while_on.next() else {
                continue;
            };
            on.push(spec);
            if while_on.all(|others| others == first) {
                for (id, value) in first {
                    unchanged.set(id, value);
                }
            }
        }
        Self {
            settings: EffectSettings::read(&unchanged),
            on,
        }
    }

    /// The columns of the report: those of every recording, and the phase of each
    /// symptom.
    pub(super) fn columns(&self) -> Vec<Column> {
        let phases = self.on.iter().filter_map(|spec| spec.phases);
        let phases = phases.map(|phases| Column {
            name: phases.column,
            kind: ColumnKind::Whole,
        });
        COLUMNS.into_iter().chain(phases).collect()
    }

    /// The phases of a row, in the order of the columns; NaN while nothing is rendered.
    pub(super) fn phases(&self, row: &Row) -> impl Iterator<Item = f64> {
        let is_armed = row.flags.limit() != LimitReason::NotArmed;
        let phases = row.phases;
        self.on.iter().map(move |spec| {
            if is_armed {
                f64::from(phases.get(spec))
            } else {
                f64::NAN
            }
        })
    }
}

/// The parameters of an effect, by their ids.
fn of_effect(values: &Values, spec: &EffectSpec) -> Vec<(u8, f64)> {
    let all = values.iter().filter(|(p, _)| p.group == spec.name);
    all.map(|(p, value)| (p.id, value)).collect()
}
