//! `crepitus presets [NAME]`.

use crate::failure::{Failure, print, print_json};
use clap::Args;
use crepitus_client::values::show_number;
use crepitus_scene::preset::{self, Disorder, Evidence, Preset, PresetValue, Setting};
use crepitus_table::Table;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// List the presets by disorder: what to feel for, and what evidence there is.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus presets
  crepitus presets mas-2-catch
  crepitus presets --json

`sourced` numbers are from a publication, `derived` ones computed from such; an `estimate` is ours.")]
pub(crate) struct Arguments {
    /// Show the values of this preset, with unit and evidence.
    name: Option<String>,
}

/// Lists the presets, or shows one.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let presets = preset::shipped();
    let Some(name) = &arguments.name else {
        return if as_json {
            print_json(&presets.iter().map(to_json).collect::<Vec<_>>())
        } else {
            print(&list(presets))
        };
    };
    let preset = preset::find(name).ok_or_else(|| {
        Failure::Input(format!(
            "no preset \"{name}\" ships: `crepitus presets` lists those that do"
        ))
    })?;
    if as_json {
        print_json(&to_json(preset))
    } else {
        print(&shown(preset))
    }
}

/// One line a preset, by disorder.
fn list(presets: &[Preset]) -> String {
    let mut text = String::new();
    for disorder in Disorder::ALL {
        text.push_str(disorder.heading());
        if let Some(grade) = disorder.grade_0() {
            let _ = write!(text, "; {grade} is its absence");
        }
        text.push('\n');
        for preset in presets.iter().filter(|p| p.disorder == Some(disorder)) {
            let _ = writeln!(
                text,
                "  {:20} {:8}  {}",
                preset.name,
                evidence(preset.evidence),
                preset.feel.as_deref().unwrap_or_default()
            );
        }
        text.push('\n');
    }
    text.push_str(
        "Try one with `crepitus params apply NAME`; in a scene, preset = \"NAME\" below [effects.…].\n\
         `crepitus presets NAME` shows its values.\n",
    );
    text
}

fn evidence(evidence: Option<Evidence>) -> &'static str {
    evidence.map_or("", Evidence::name)
}

/// A preset with its values.
fn shown(preset: &Preset) -> String {
    let mut text = format!("{}\n", preset.title.as_deref().unwrap_or(&preset.name));
    for (key, line) in [
        ("severity", preset.severity.as_deref()),
        ("feel for", preset.feel.as_deref()),
        ("evidence", preset.evidence.map(Evidence::name)),
        ("source", preset.source.as_deref()),
    ] {
        if let Some(line) = line {
            let _ = writeln!(text, "  {key:9} {line}");
        }
    }
    for effect in preset.effects() {
        let values = preset.values.iter().filter(|v| v.effect == effect.name);
        let values: Vec<_> = values.collect();
        let table = Table::of(&values)
            .column("parameter", |v| v.key)
            .column("value", |v| match v.setting {
                Setting::Number(x, _) => show_number(x),
                Setting::Option(name) => name.to_owned(),
            })
            .column("unit", |v| unit(v).unwrap_or_default())
            .column("evidence", |v| evidence(v.evidence))
            .column("meaning", |v| match v.setting {
                Setting::Number(_, spec) => spec.meaning,
                Setting::Option(_) => "",
            });
        let _ = write!(text, "\n[effects.{}]\n{}", effect.name, table.to_text());
    }
    text.push_str("\nAll other parameters are at their defaults: `crepitus effects` lists them.\n");
    text
}

/// The unit, if there is one to show.
fn unit(value: &PresetValue) -> Option<&'static str> {
    match value.setting {
        Setting::Number(_, spec) => Some(spec.unit).filter(|unit| *unit != "1"),
        Setting::Option(_) => None,
    }
}

fn to_json(preset: &Preset) -> Value {
    let effects: Map<String, Value> = preset
        .effects()
        .map(|effect| {
            let settings = preset.settings_of(effect).into_iter();
            let settings: Map<_, _> = settings
                .map(|(key, setting)| (key.to_owned(), value_json(setting)))
                .collect();
            (effect.name.to_owned(), settings.into())
        })
        .collect();
    let values: Vec<_> = preset
        .values
        .iter()
        .map(|v| {
            json!({
                "effect": v.effect,
                "key": v.key,
                "value": value_json(v.setting),
                "unit": unit(v),
                "evidence": v.evidence.map(Evidence::name),
            })
        })
        .collect();
    json!({
        "name": preset.name,
        "title": preset.title,
        "disorder": preset.disorder.map(Disorder::name),
        "severity": preset.severity,
        "feel": preset.feel,
        "evidence": preset.evidence.map(Evidence::name),
        "source": preset.source,
        "effects": effects,
        "values": values,
    })
}

fn value_json(setting: Setting) -> Value {
    match setting {
        Setting::Number(x, _) => json!(x),
        Setting::Option(name) => json!(name),
    }
}
