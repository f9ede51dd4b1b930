//! The effects of a recording besides crepitus: which were on, with which settings, and
//! what columns they add to its report.

use super::COLUMNS;
use crepitus_model::parameters::Source;
use crepitus_model::render::effects::{EffectSettings, EffectSpec, SPECS};
use crepitus_protocol::parameters::find;
use crepitus_protocol::{LimitReason, Values};
use crepitus_recording::{History, Row};
use crepitus_scene::trace::{Column, ColumnKind};

/// See the module.
pub(super) struct Effects {
    /// Of the symptoms whose settings were the same whenever they were on.
    pub(super) settings: EffectSettings,
    /// The symptoms that were on at any time.
    symptoms: Vec<&'static EffectSpec>,
    /// The vibration actuator was.
    has_coil: bool,
}

impl Effects {
    /// Of these parameters.
    pub(super) fn of(parameters: &History) -> Self {
        let mut in_force = parameters.in_force();
        let sets = parameters.0.iter().filter_map(|set| {
            in_force.at(set.first_row);
            in_force.values()
        });
        let sets: Vec<Values> = sets.collect();
        let (mut unchanged, mut symptoms) = (Values::default(), Vec::new());
        // What has phases is a symptom.
        for spec in SPECS.iter().filter(|spec| spec.phases.is_some()) {
            let switch = find(&format!("{}.render", spec.name)).map(|(id, _)| id);
            let is_on = |values: &&Values| switch.is_some_and(|id| values.is_on(id));
            let while_on = sets.iter().filter(is_on);
            let mut while_on = while_on.map(|values| of_effect(values, spec));
            let Some(first) = while_on.next() else {
                continue;
            };
            symptoms.push(spec);
            if while_on.all(|others| others == first) {
                for (id, value) in first {
                    unchanged.set(id, value);
                }
            }
        }
        Self {
            settings: EffectSettings::read(&unchanged),
            symptoms,
            has_coil: sets
                .iter()
                .any(|values| EffectSettings::read(values).vibration_actuator.is_some()),
        }
    }

    /// The columns of the report: those of every recording, the phase of each symptom, and
    /// the current of the vibration actuator's coil.
    pub(super) fn columns(&self) -> Vec<Column> {
        let phases = self.symptoms.iter().filter_map(|spec| spec.phases);
        let phases = phases.map(|phases| Column {
            name: phases.column,
            kind: ColumnKind::Whole,
        });
        let coil = self.has_coil.then_some(Column {
            name: "coil_current_a",
            kind: ColumnKind::Number,
        });
        COLUMNS.into_iter().chain(phases).chain(coil).collect()
    }

    /// Their values in a row, in the order of the columns; NaN while nothing is rendered.
    pub(super) fn values(&self, row: &Row) -> impl Iterator<Item = f64> {
        let is_armed = row.flags.limit() != LimitReason::NotArmed;
        let phases = row.phases;
        let coil_a = row.coil_a.map_or(f64::NAN, f64::from);
        let phases = self.symptoms.iter().map(move |spec| {
            if is_armed {
                f64::from(phases.get(spec))
            } else {
                f64::NAN
            }
        });
        phases.chain(self.has_coil.then_some(coil_a))
    }
}

/// The parameters of an effect, by their ids.
fn of_effect(values: &Values, spec: &EffectSpec) -> Vec<(u8, f64)> {
    let all = values.iter().filter(|(p, _)| p.group == spec.name);
    all.map(|(p, value)| (p.id, value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::Tabled;
    use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
    use crepitus_protocol::telemetry::SampleFlags;
    use crepitus_recording::{ParameterSet, named_values};

    fn set(values: &Values, first_row: u64) -> ParameterSet {
        ParameterSet {
            revision: 1,
            first_row,
            first_tick: first_row,
            values: Some(named_values(values)),
        }
    }

    fn id(name: &str) -> u8 {
        find(name).expect("a parameter").0
    }

    #[test]
    fn what_was_on_has_a_column_and_what_never_changed_its_settings() {
        let off = Values::default();
        let mut on = off;
        on.set(id("lead-pipe.render"), 1.0);
        on.set(id("range-limit.render"), 1.0);
        let mut other = on;
        other.set(id("range-limit.flexion_limit_deg"), 90.0);
        let history = History(vec![
            set(&off, 0),
            set(&on, 10),
            set(&other, 20),
            set(&off, 30),
        ]);
        let effects = Effects::of(&history);
        assert_eq!(
            effects.settings.lead_pipe,
            Some(LeadPipeSettings::defaults())
        );
        assert_eq!(effects.settings.range_limit, None);
        let columns = effects.columns();
        let names: Vec<&str> = columns.iter().map(|c| c.name).collect();
        assert_eq!(
            names[COLUMNS.len()..],
            ["range_limit_phase", "lead_pipe_phase"]
        );
        let none = Effects::of(&History(vec![set(&off, 0)]));
        assert_eq!(none.columns(), COLUMNS);
        assert_eq!(none.settings, EffectSettings::default());
    }

    #[test]
    fn the_coil_has_a_column_if_the_actuator_was_on_and_a_value_while_it_is_driven() {
        let mut on = Values::default();
        on.set(id("vibration-actuator.render"), 1.0);
        let effects = Effects::of(&History(vec![set(&Values::default(), 0), set(&on, 9)]));
        let columns = effects.columns();
        assert_eq!(columns.last().map(|c| c.name), Some("coil_current_a"));
        let driven = Row {
            coil_a: Some(0.25),
            ..Row::default()
        };
        let values: Vec<f64> = effects.values(&driven).collect();
        assert_eq!(values.last(), Some(&0.25));
        assert_eq!(COLUMNS.len() + values.len(), columns.len());
        let asleep = effects.values(&Row::default()).last();
        assert!(asleep.is_some_and(f64::is_nan));
    }

    #[test]
    fn phases_are_known_while_it_is_armed() {
        let mut on = Values::default();
        on.set(id("lead-pipe.render"), 1.0);
        let effects = Effects::of(&History(vec![set(&on, 0)]));
        let phases = Row::default().phases.with_named("lead-pipe", "sliding");
        let row = Row {
            phases: phases.expect("a phase"),
            ..Row::default()
        };
        assert_eq!(effects.values(&row).collect::<Vec<_>>(), [1.0]);
        let not_armed = Row {
            flags: SampleFlags::default().with_limit(LimitReason::NotArmed),
            ..row
        };
        assert!(effects.values(&not_armed).all(f64::is_nan));
    }
}
