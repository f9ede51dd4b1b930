//! All effects, from the one table of them.

use crate::screen::All;
use crepitus_model::parameters::{Choice, ParameterSpec};
use crepitus_pages::table::{Cell, Table};
use crepitus_plant::effect::{Effect, Need};
use crepitus_plant::effects::EFFECTS;
use serde_json::{Value, json};
use std::fmt::Write;

/// The effects as text: a line each, or with everything that is known of them.
pub(super) fn text(all: All) -> String {
    const USE: &str = "A scene calls for one with [effects.NAME]; `crepitus effects SCENE` shows what each does and costs.";
    if !all.all {
        let table = Table::of(&EFFECTS)
            .people("effect", |effect| effect.name)
            .people("adds", |effect| effect.adds);
        return format!("{}\n{USE} --all lists their parameters.\n", table.to_text());
    }
    let mut text = String::new();
    for effect in EFFECTS {
        push(&mut text, effect);
    }
    text + USE + "\n"
}

// Writing to a String cannot fail.
fn push(text: &mut String, effect: &Effect) {
    let _ = writeln!(text, "{}: {}", effect.name, effect.adds);
    for Need { effect, why } in effect.needs {
        let _ = writeln!(text, "    needs {effect}: {why}");
    }
    let states = match effect.states {
        [] => "none".to_owned(),
        states => states.join(", "),
    };
    let _ = writeln!(text, "    states: {states}");
    text.push_str(&parameters(effect).to_text());
    for Choice {
        key,
        names,
        meaning,
        ..
    } in effect.choices
    {
        let _ = writeln!(text, "    {key} = \"{}\": {meaning}", names.join("\" | \""));
    }
    text.push('\n');
}

fn parameters(effect: &Effect) -> Table<'static, ParameterSpec> {
    Table::of(effect.parameters)
        .column("key", |p| {
            Cell::from(p.key).shown_as(format!("    {}", p.key))
        })
        .headed("")
        .column("symbol", |p| p.symbol)
        .column("unit", |p| p.unit)
        .column("default", |p| {
            let unit = if p.unit == "1" { "" } else { p.unit };
            let text = format!("= {} {unit}", number(p.default));
            Cell::from(p.default).shown_as(text.trim_end())
        })
        .headed("")
        .left()
        .column("min", |p| p.min)
        .column("max", |p| p.max)
        .people("", |p| format!("{} to {}", number(p.min), number(p.max)))
        .column("meaning", |p| p.meaning)
        .headed("")
}

/// Returns the number in the fewest digits that express it.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

fn to_json(effect: &Effect) -> Value {
    let choices = Table::of(effect.choices)
        .column("key", |c| c.key)
        .column("names", |c| c.names)
        .column("default", |c| c.names.get(usize::from(c.default)).copied())
        .column("meaning", |c| c.meaning);
    let needs = Table::of(effect.needs)
        .column("effect", |n| n.effect)
        .column("why", |n| n.why);
    json!({
        "name": effect.name,
        "adds": effect.adds,
        "states": effect.states,
        "needs": needs,
        "parameters": parameters(effect),
        "choices": choices,
    })
}

/// The effects as JSON.
pub(super) fn values() -> Vec<Value> {
    EFFECTS.iter().map(|e| to_json(e)).collect()
}
