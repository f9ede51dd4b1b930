//! The columns of a recording's report: those that every report draws, and those of the effects
//! that were on besides crepitus.

use crate::recorded::analysis::Derived;
use crepitus_model::parameters::Source;
use crepitus_model::render::effects::{EffectSettings, EffectSpec, SPECS};
use crepitus_protocol::parameters::{self, find};
use crepitus_protocol::{LimitReason, Values};
use crepitus_recording::History;
use crepitus_recording::Row;
use crepitus_scene::trace::{Column, ColumnKind};

/// The columns that every report of a recording draws.
const ALWAYS: [Column; 5] = [
    number("t_s"),
    number("angle_rad"),
    number("omega_rad_s"),
    number("torque_nm"),
    number("motor_torque_nm"),
];

/// The columns of crepitus.
const OBJECT: [Column; 3] = [
    Column {
        name: "phase",
        kind: ColumnKind::Phase,
    },
    number("theta_rad"),
    number("theta_dot_rad_s"),
];

const fn number(name: &'static str) -> Column {
    Column {
        name,
        kind: ColumnKind::Number,
    }
}

/// See the module.
#[derive(Debug)]
pub struct ReportColumns {
    /// Settings of symptoms: those that were the same whenever the symptom was on.
    settings: EffectSettings,
    /// Crepitus was on at any time, or may have been.
    has_crepitus: bool,
    /// The symptoms that were on at any time, with their switches.
    symptoms: Vec<(&'static EffectSpec, Option<u8>)>,
    /// The vibration actuator was.
    has_coil: bool,
    /// The parameters of some rows are unknown.
    is_unknown: bool,
}

impl ReportColumns {
    /// Returns the columns of a recording with these parameters.
    pub fn of(history: &History) -> Self {
        let mut in_force = history.in_force();
        let sets = history.0.iter().filter_map(|set| {
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
            symptoms.push((spec, switch));
            if while_on.all(|others| others == first) {
                for (id, value) in first {
                    unchanged.set(id, value);
                }
            }
        }
        let is_unknown = sets.len() < history.0.len();
        Self {
            is_unknown,
            settings: EffectSettings::read(&unchanged),
            has_crepitus: is_unknown
                || sets
                    .iter()
                    .any(|values| values.is_on(parameters::id::CREPITUS)),
            symptoms,
            has_coil: sets
                .iter()
                .any(|values| EffectSettings::read(values).vibration_actuator.is_some()),
        }
    }

    /// Number of columns at the beginning that have a value in every row. The last of them, the motor's torque,
    /// takes the parameters.
    pub fn certain(&self) -> usize {
        ALWAYS.len() - usize::from(self.is_unknown)
    }

    /// The settings of the symptoms that were the same whenever they were on.
    pub fn settings(&self) -> EffectSettings {
        self.settings
    }

    /// Columns of every recording, those of crepitus, the phase of each symptom, and the current of
    /// the vibration actuator's coil.
    pub fn columns(&self) -> Vec<Column> {
        let phases = self.symptoms.iter().filter_map(|(spec, _)| spec.phases);
        let phases = phases.map(|phases| Column {
            name: phases.column,
            kind: ColumnKind::Whole,
        });
        let coil = self.has_coil.then_some(Column {
            name: "coil_current_a",
            kind: ColumnKind::Number,
        });
        let object = self.has_crepitus.then_some(OBJECT);
        let object = object.into_iter().flatten();
        let first = ALWAYS.into_iter().chain(object);
        first.chain(phases).chain(coil).collect()
    }

    /// Their values in a row, in the place of what `values` held. NaN stands for none: of the coil
    /// and of symptoms while nothing is rendered, of symptoms and of the object while they are off
    /// by the parameters `in_force`. Where these are unknown the object has its phase alone.
    pub fn read(
        &self,
        row: &Row,
        derived: &Derived,
        in_force: Option<&Values>,
        values: &mut Vec<f64>,
    ) {
        let is_off = |switch: u8| in_force.is_some_and(|values| !values.is_on(switch));
        values.clear();
        values.extend([
            row.time_s,
            row.angle_rad,
            f64::from(row.omega_rad_s),
            f64::from(row.model_torque_nm),
            derived.motor_torque_nm,
        ]);
        if self.has_crepitus {
            let phase = if is_off(parameters::id::CREPITUS) {
                f64::NAN
            } else {
                f64::from(row.flags.phase_sign())
            };
            let object = &derived.object;
            values.extend([phase, object.theta_rad, object.theta_dot_rad_s]);
        }
        let is_armed = row.flags.limit() != LimitReason::NotArmed;
        let phases = row.phases;
        values.extend(self.symptoms.iter().map(|(spec, switch)| {
            if is_armed && !switch.is_some_and(is_off) {
                f64::from(phases.get(spec))
            } else {
                f64::NAN
            }
        }));
        if self.has_coil {
            values.push(row.coil_a.map_or(f64::NAN, f64::from));
        }
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
    use crate::recorded::analysis::Object;
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

    fn values(columns: &ReportColumns, row: &Row) -> Vec<f64> {
        values_under(columns, row, None)
    }

    fn values_under(columns: &ReportColumns, row: &Row, in_force: Option<&Values>) -> Vec<f64> {
        let derived = Derived {
            object: Object {
                theta_rad: 0.0,
                theta_dot_rad_s: 0.0,
            },
            event: None,
            motor_torque_nm: 0.5,
        };
        let mut values = vec![7.0];
        columns.read(row, &derived, in_force, &mut values);
        assert_eq!(values[ALWAYS.len() - 1], 0.5);
        values
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
        let effects = ReportColumns::of(&history);
        assert_eq!(
            effects.settings().lead_pipe,
            Some(LeadPipeSettings::defaults())
        );
        assert_eq!(effects.settings().range_limit, None);
        let columns = effects.columns();
        let names: Vec<&str> = columns.iter().map(|c| c.name).collect();
        assert_eq!(
            names[ALWAYS.len() + OBJECT.len()..],
            ["range_limit_phase", "lead_pipe_phase"]
        );
        let none = ReportColumns::of(&History(vec![set(&off, 0)]));
        assert_eq!(none.columns(), [&ALWAYS[..], &OBJECT].concat());
        assert_eq!(none.settings(), EffectSettings::default());
        assert_eq!(none.certain(), ALWAYS.len());
        let mut unknown = set(&off, 0);
        unknown.values = None;
        let first_unknown = ReportColumns::of(&History(vec![unknown, set(&off, 20)]));
        assert_eq!(
            first_unknown.certain(),
            ALWAYS.len() - 1,
            "all but the motor's torque"
        );
    }

    #[test]
    fn the_object_has_columns_unless_crepitus_was_off_all_the_time() {
        let on = Values::default();
        let mut off = on;
        off.set(parameters::id::CREPITUS, 0.0);
        let unknown = ParameterSet {
            values: None,
            ..set(&off, 10)
        };
        for (sets, has_object) in [
            (vec![set(&off, 0)], false),
            (vec![set(&off, 0), set(&off, 10)], false),
            (vec![set(&off, 0), set(&on, 10)], true),
            (vec![set(&off, 0), unknown], true),
        ] {
            let effects = ReportColumns::of(&History(sets));
            let columns = effects.columns();
            let found = columns.iter().any(|column| column.name == "phase");
            assert_eq!(found, has_object);
            assert_eq!(values(&effects, &Row::default()).len(), columns.len());
        }
    }

    #[test]
    fn the_coil_has_a_column_if_the_actuator_was_on_and_a_value_while_it_is_driven() {
        let mut on = Values::default();
        on.set(id("vibration-actuator.render"), 1.0);
        let effects = ReportColumns::of(&History(vec![set(&Values::default(), 0), set(&on, 9)]));
        let columns = effects.columns();
        assert_eq!(columns.last().map(|c| c.name), Some("coil_current_a"));
        let driven = Row {
            coil_a: Some(0.25),
            ..Row::default()
        };
        let values = values(&effects, &driven);
        assert_eq!(values.last(), Some(&0.25));
        assert_eq!(values.len(), columns.len());
        let asleep = self::values(&effects, &Row::default());
        assert!(asleep.last().is_some_and(|value| value.is_nan()));
    }

    #[test]
    fn phases_are_known_while_it_is_armed() {
        let mut on = Values::default();
        on.set(id("lead-pipe.render"), 1.0);
        let effects = ReportColumns::of(&History(vec![set(&on, 0)]));
        let phases = Row::default().phases.with_named("lead-pipe", "sliding");
        let row = Row {
            phases: phases.expect("a phase"),
            ..Row::default()
        };
        assert_eq!(values(&effects, &row).last(), Some(&1.0));
        let not_armed = Row {
            flags: SampleFlags::default().with_limit(LimitReason::NotArmed),
            ..row
        };
        let not_armed = values(&effects, &not_armed);
        assert!(not_armed.last().is_some_and(|phase| phase.is_nan()));
    }

    #[test]
    fn phases_are_known_while_their_effect_is_on() {
        let mut both = Values::default();
        both.set(id("lead-pipe.render"), 1.0);
        let mut neither = both;
        neither.set(id("lead-pipe.render"), 0.0);
        neither.set(parameters::id::CREPITUS, 0.0);
        let effects = ReportColumns::of(&History(vec![set(&both, 0), set(&neither, 10)]));
        let phases = Row::default().phases.with_named("lead-pipe", "sliding");
        let row = Row {
            phases: phases.expect("a phase"),
            ..Row::default()
        };
        let read = |in_force| {
            let values = values_under(&effects, &row, in_force);
            (values[ALWAYS.len()], *values.last().expect("a phase"))
        };
        assert_eq!(read(Some(&both)), (0.0, 1.0));
        let (object, lead_pipe) = read(Some(&neither));
        assert!(object.is_nan() && lead_pipe.is_nan());
        // What is not known to be off may be on.
        assert_eq!(read(None), (0.0, 1.0));
    }
}
