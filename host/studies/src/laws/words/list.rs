//! Laws, tasks and joints, without running them.

use crate::laws::TASKS;
use crepitus_ladder::laws::ENTRIES;
use crepitus_pages::table::Table;
use crepitus_scene::preset::joints;
use serde_json::{Value, json};
use std::fmt::Write;

/// The lists as text.
pub fn text() -> String {
    let laws = Table::of(ENTRIES)
        .people("law", |entry| entry.name)
        .people("", |entry| entry.title);
    let joints = joints().iter().map(|joint| joint.name);
    let mut text = format!(
        "{}\njoints: {}\n",
        laws.to_text(),
        joints.collect::<Vec<_>>().join(", ")
    );
    for task in TASKS {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "\ntask {}: {}", task.name(), task.title());
        for quantity in task.quantities() {
            let unit = match quantity.unit {
                "1" => String::new(),
                unit => format!(", {unit}"),
            };
            let _ = writeln!(
                text,
                "  {}: {}{unit}; {}",
                quantity.name, quantity.title, quantity.demands
            );
        }
    }
    text
}

/// The lists for machines.
pub fn value() -> Value {
    let laws = ENTRIES
        .iter()
        .map(|entry| json!({ "name": entry.name, "title": entry.title }));
    let joints = joints().iter().map(|joint| joint.name);
    json!({
        "laws": laws.collect::<Vec<_>>(),
        "joints": joints.collect::<Vec<_>>(),
        "tasks": tasks(),
    })
}

/// Every task with what it measures.
pub(super) fn tasks() -> Vec<Value> {
    let tasks = TASKS.iter().map(|task| {
        let quantities = task.quantities().iter().map(|quantity| {
            json!({
                "name": quantity.name,
                "title": quantity.title,
                "unit": quantity.unit,
                "demands": quantity.demands,
                "use": quantity.of,
            })
        });
        json!({
            "name": task.name(),
            "title": task.title(),
            "quantities": quantities.collect::<Vec<_>>(),
        })
    });
    tasks.collect()
}
