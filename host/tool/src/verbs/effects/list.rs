//! All effects, from the one table of them.

use crepitus_model::parameters::ParameterSpec;
use crepitus_plant::effect::{ChoiceSpec, Effect, Need};
use crepitus_plant::effects::EFFECTS;
use serde_json::{Value, json};
use std::fmt::Write;

/// The effects for a person.
pub(super) fn text() -> String {
    let mut text = String::new();
    for effect in EFFECTS {
        push(&mut text, effect);
    }
    text.push_str(
        "A scene calls for one with [effects.NAME] and sets its numbers there; `crepitus effects SCENE` shows what \
         each does and costs.\n",
    );
    text
}

// Writing to a String cannot fail.
fn push(text: &mut String, effect: &Effect) {
    let _ = writeln!(text, "{}: {}", effect.name, effect.adds);
    for Need { effect, why } in effect.needs {
        let _ = writeln!(text, "    needs {effect}: {why}");
    }
    let states = if effect.states.is_empty() {
        "none".to_owned()
    } else {
        effect.states.join(", ")
    };
    let _ = writeln!(text, "    states: {states}");
    let width = |cells: &mut dyn Iterator<Item = String>| {
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let keys = width(&mut effect.parameters.iter().map(|p| p.key.to_owned()))
        .max(width(&mut effect.choices.iter().map(|c| c.key.to_owned())));
    let values = width(&mut effect.parameters.iter().map(value));
    let ranges = width(&mut effect.parameters.iter().map(range));
    for p in effect.parameters {
        let _ = writeln!(
            text,
            "    {:keys$} = {:values$}  {:ranges$}  {}",
            p.key,
            value(p),
            range(p),
            p.meaning
        );
    }
    for ChoiceSpec {
        key,
        names,
        meaning,
    } in effect.choices
    {
        let _ = writeln!(
            text,
            "    {key:keys$} = {}: {meaning}",
            names
                .iter()
                .map(|n| format!("\"{n}\""))
                .collect::<Vec<_>>()
                .join(" | ")
        );
    }
    text.push('\n');
}

/// Default and unit.
fn value(p: &ParameterSpec) -> String {
    match p.unit {
        "" | "1" => number(p.default),
        unit => format!("{} {unit}", number(p.default)),
    }
}

fn range(p: &ParameterSpec) -> String {
    format!("{} to {}", number(p.min), number(p.max))
}

/// In as few digits as say it.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// An effect for machines.
fn to_json(effect: &Effect) -> Value {
    let parameters: Vec<Value> = effect
        .parameters
        .iter()
        .map(|p| {
            json!({
                "key": p.key,
                "symbol": p.symbol,
                "unit": p.unit,
                "default": p.default,
                "min": p.min,
                "max": p.max,
                "meaning": p.meaning,
            })
        })
        .collect();
    let choices: Vec<Value> = effect
        .choices
        .iter()
        .map(|c| {
            json!({
                "key": c.key,
                "names": c.names,
                "default": c.names.first(),
                "meaning": c.meaning,
            })
        })
        .collect();
    let needs: Vec<Value> = effect
        .needs
        .iter()
        .map(|n| json!({ "effect": n.effect, "why": n.why }))
        .collect();
    json!({
        "name": effect.name,
        "adds": effect.adds,
        "states": effect.states,
        "needs": needs,
        "parameters": parameters,
        "choices": choices,
    })
}

/// The effects for machines.
pub(super) fn values() -> Vec<Value> {
    EFFECTS.iter().map(|e| to_json(e)).collect()
}
