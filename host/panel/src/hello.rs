//! First message to a page: the tables that it shows, each from its one source.

use crate::control::Page;
use crate::invitations::Invitations;
use crate::lesson::plans;
use crate::live::{NAMED, STATES};
use crate::tokens::Role;
use crepitus_knee::examination::Measure;
use crepitus_model::render::effects::{IS_SYMPTOM, SPECS};
use crepitus_protocol::coil::COIL_FAULTS;
use crepitus_protocol::fault::FAULTS;
use crepitus_protocol::parameters::{Kind, PARAMETERS, Parameter, When};
use crepitus_protocol::{TICKS_PER_S, Values};
use crepitus_scene::preset::{self, Disorder, Evidence, Judgement, Preset};
use crepitus_scene::values::{is_effect, is_of_knee, with_preset};
use serde_json::{Value, json};
use std::path::Path;

/// Tables that a student's phone needs, to name what it shows.
const OF_STUDENTS: [&str; 2] = ["version", "disorders"];

/// First message to a page: the tables of its role, its number, and for a teacher the links to hand on.
pub(crate) fn greeting(tables: &Value, links: &Invitations, role: Role, page: Page) -> Value {
    let mut hello = if role == Role::Student {
        let own = OF_STUDENTS.map(|key| (key.to_owned(), tables[key].clone()));
        Value::Object(own.into_iter().collect())
    } else {
        tables.clone()
    };
    hello["page"] = json!(page);
    hello["role"] = json!(role.name());
    if role == Role::Teacher {
        hello["links"] = json!({
            "student": links.student,
            "remote": links.remote,
            "projector": links.projector,
        });
    }
    hello
}

/// The tables. [`greeting`] adds what is of a page.
pub(crate) fn tables(source: &Value, sessions: Option<&Path>, has_experiments: bool) -> Value {
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "source": source,
        "tick_hz": TICKS_PER_S,
        "disorders": disorders(),
        "parameters": PARAMETERS.iter().map(parameter).collect::<Vec<_>>(),
        "groups": groups(),
        "states": states(),
        "targets": NAMED,
        "measures": measures(),
        "faults": FAULTS.iter().map(|fault| json!({
            "code": fault.fault as u8,
            "name": fault.name,
            "cause": fault.cause,
            "remedy": fault.clear,
        })).collect::<Vec<_>>(),
        "coil_faults": COIL_FAULTS.iter().map(|fault| json!({
            "code": fault.fault as u8,
            "name": fault.name,
            "cause": fault.cause,
            "remedy": fault.clear,
        })).collect::<Vec<_>>(),
        "lessons": plans::FILES.iter().filter_map(|file| {
            // A test reads every one.
            let plan = file.read().ok()?;
            Some(json!({
                "name": file.name,
                "title": plan.title,
                "description": plan.description,
                "knees": plan.knees.len(),
                "blind": plan.blind,
            }))
        }).collect::<Vec<_>>(),
        "stores": sessions.map(|folder| folder.display().to_string()),
        "experiments": has_experiments,
        "students_max": crate::lesson::MOST_STUDENTS,
    })
}

/// Disorders, with their names.
pub(crate) fn disorders() -> Value {
    let of = |disorder: Disorder| {
        json!({
            "name": disorder.name(),
            "heading": disorder.heading(),
            "grade_0": disorder.grade_0(),
        })
    };
    Disorder::ALL.into_iter().map(of).collect()
}

/// States of effects; the place of one is its bit.
pub(crate) fn states() -> Value {
    let states = STATES.iter();
    states
        .map(|state| json!({ "effect": state.effect, "phase": state.phase }))
        .collect()
}

/// Measures of an examination, and whether each tells something of the torque.
pub(crate) fn measures() -> Value {
    let of = |measure: Measure| {
        let spec = measure.spec();
        json!({
            "name": measure.name(),
            "unit": spec.unit,
            "digits": spec.digits,
            "is_of_torque": spec.is_of_torque,
        })
    };
    Measure::ALL.into_iter().map(of).collect()
}

/// Presets that ship, and the user's own.
pub(crate) fn presets(own: &[Preset]) -> Value {
    let shipped = preset::shipped()
        .iter()
        .map(|preset| described(preset, false));
    let own = own.iter().map(|preset| described(preset, true));
    shipped.chain(own).collect()
}

fn described(preset: &Preset, is_own: bool) -> Value {
    // What it sets: what differs from a knee without effects.
    let none = with_preset(&Values::default(), &Preset::default(), false);
    let made = with_preset(&none, preset, false);
    let values: Vec<_> = (none.iter().zip(made.iter()))
        .filter(|((_, before), (_, after))| before.to_bits() != after.to_bits())
        .map(|(_, (parameter, value))| json!([parameter.id, value]))
        .collect();
    let effects: Vec<_> = preset.effects().map(|effect| effect.name).collect();
    json!({
        "name": preset.name,
        "title": preset.title,
        "disorder": preset.disorder.map(Disorder::name),
        "severity": preset.severity,
        "level": preset.level.map(preset::Level::name),
        "feel": preset.feel,
        "evidence": preset.evidence.map(Evidence::name),
        "source": preset.source,
        "judged": preset.judgements().iter().map(Judgement::to_text).collect::<Vec<_>>(),
        "own": is_own,
        "effects": effects,
        "values": values,
    })
}

fn parameter(parameter: &Parameter) -> Value {
    let (unit, min, max, choices) = match parameter.kind {
        Kind::Number(spec) => {
            let unit = Some(spec.unit).filter(|unit| *unit != "1");
            (unit, Some(spec.min), Some(spec.max), None)
        }
        Kind::Choice(choice) => (None, None, None, Some(choice.names)),
    };
    json!({
        "id": parameter.id,
        "group": parameter.group,
        "key": parameter.key(),
        "name": format!("{}.{}", parameter.group, parameter.key()),
        "unit": unit,
        "min": min,
        "max": max,
        "default": parameter.default(),
        "choices": choices,
        "only_disarmed": parameter.when == When::Disarmed,
        "meaning": parameter.meaning(),
    })
}

/// Groups of parameters, in the order of the table.
fn groups() -> Vec<Value> {
    let mut names: Vec<&str> = Vec::new();
    for parameter in &PARAMETERS {
        if !names.contains(&parameter.group) {
            names.push(parameter.group);
        }
    }
    let is_symptom = |name: &str| {
        let spec = SPECS
            .iter()
            .zip(IS_SYMPTOM)
            .find(|(spec, _)| spec.name == name);
        // The stick-slip object is not in the table of effects.
        spec.map_or(is_of_knee(name), |(_, is_symptom)| *is_symptom)
    };
    let kind = |name: &str| match (is_symptom(name), is_effect(name)) {
        (true, _) => "symptom",
        (_, true) => "effect",
        _ => "brace",
    };
    names
        .into_iter()
        .map(|name| json!({ "name": name, "kind": kind(name) }))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preset_lists_what_it_sets() {
        let presets = presets(&[]);
        let all = presets.as_array().unwrap();
        assert_eq!(all.len(), preset::shipped().len());
        for preset in all {
            assert!(
                !preset["values"].as_array().unwrap().is_empty(),
                "{}",
                preset["name"]
            );
            assert!(!preset["effects"].as_array().unwrap().is_empty());
        }
    }

    #[test]
    fn every_lesson_that_ships_is_listed() {
        let tables = tables(&Value::Null, None, false);
        assert_eq!(
            tables["lessons"].as_array().unwrap().len(),
            plans::FILES.len()
        );
    }

    /// A link gives its holder rights: only a teacher has those of others.
    #[test]
    fn a_greeting_has_what_the_role_may_know() {
        let tables = tables(&json!({ "kind": "device", "serial": "1" }), None, false);
        let links = Invitations::new("of-student", "of-remote", "of-wall", false);
        for role in Role::ALL {
            let hello = greeting(&tables, &links, role, 7);
            assert!(hello["role"] == role.name() && hello["page"] == 7);
            assert_eq!(hello["links"].is_object(), role == Role::Teacher);
            assert_eq!(hello["source"].is_object(), role != Role::Student);
            let has_link = hello.to_string().contains("\"of-");
            assert_eq!(has_link, role == Role::Teacher);
        }
        let hello = greeting(&tables, &links, Role::Student, 7);
        assert_eq!(hello.as_object().unwrap().len(), OF_STUDENTS.len() + 2);
        // Without a network there is no code for a phone.
        assert!(links.student["qr"].is_null());
    }

    #[test]
    fn each_group_has_its_kind() {
        let tables = tables(&Value::Null, None, false);
        let groups = tables["groups"].as_array().unwrap();
        let kind = |name: &str| groups.iter().find(|g| g["name"] == name).unwrap()["kind"].clone();
        assert_eq!(kind("crepitus"), "symptom");
        assert_eq!(kind("spasticity"), "symptom");
        assert_eq!(kind("friction-compensation"), "effect");
        assert_eq!(kind("encoder"), "brace");
    }
}
