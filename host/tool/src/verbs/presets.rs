//! `crepitus presets`.

use crate::failure::{Failure, print, print_json};
use clap::Args;
use crepitus_model::Parameters;
use crepitus_model::joint::presets::{Evidence, PRESETS, Preset};
use crepitus_model::parameters::Tabled;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// List the parameter presets, with what each feels like and its source.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  crepitus presets --json")]
pub(crate) struct Arguments {}

/// Lists the presets.
pub(crate) fn run(_: &Arguments, as_json: bool) -> Result<(), Failure> {
    if as_json {
        return print_json(&PRESETS.iter().map(to_json).collect::<Vec<_>>());
    }
    let mut text = String::new();
    for preset in &PRESETS {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}: {}", preset.name, preset.feels_like);
        for (p, value) in Parameters::TABLE.iter().zip(preset.parameters.values()) {
            let _ = writeln!(
                text,
                "    {:2} = {value:<7} {:10} {}",
                p.symbol, p.unit, p.key
            );
        }
        let _ = writeln!(text, "    {}: {}\n", evidence(preset), preset.source);
    }
    text.push_str("Use one in a scene with [effects.crepitus] preset = \"NAME\".\n");
    print(&text)
}

fn to_json(preset: &Preset) -> Value {
    let parameters: Map<_, _> = Parameters::TABLE
        .iter()
        .zip(preset.parameters.values())
        .map(|(p, value)| (p.key.to_owned(), json!(value)))
        .collect();
    json!({
        "name": preset.name,
        "feels_like": preset.feels_like,
        "evidence": evidence(preset),
        "source": preset.source,
        "parameters": parameters,
    })
}

fn evidence(preset: &Preset) -> &'static str {
    match preset.evidence {
        Evidence::Sourced => "source",
        Evidence::Estimate => "estimate",
    }
}
