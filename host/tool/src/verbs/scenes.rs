//! `crepitus scenes [NAME]`.

use crate::failure::{Failure, print, print_json};
use crate::shipped::{SHIPPED, Shipped};
use clap::Args;
use crepitus_scene::Overrides;
use serde_json::json;
use std::fmt::Write;
use std::path::Path;

/// List the scenes that ship, with what each shows.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus scenes
  crepitus scenes fig6-ideal-cycle > my-scene.toml")]
pub(crate) struct Arguments {
    /// Print the file of this scene, as a start for one's own.
    name: Option<String>,
}

/// Lists the scenes that ship, or prints one.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    if let Some(name) = &arguments.name {
        let name = name.trim_end_matches(".toml");
        return match Shipped::find(Path::new(name)) {
            Some(shipped) => print(shipped.text),
            None => Err(Failure::Input(format!(
                "no scene \"{name}\" ships: `crepitus scenes` lists those that do"
            ))),
        };
    }
    let mut text = String::new();
    let mut list = Vec::new();
    for shipped in SHIPPED {
        let scene = shipped
            .read(&Overrides::default())
            .map_err(Failure::input)?;
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{:22} {}", shipped.name, scene.title);
        list.push(json!({
            "name": shipped.name,
            "file": shipped.file(),
            "title": scene.title,
            "description": scene.description,
            "duration_s": scene.duration_s,
            "motion": scene.motion_kind.name(),
            "solver": scene.solver.name(),
            "effects": scene.effects().iter().map(|e| e.name).collect::<Vec<_>>(),
        }));
    }
    if as_json {
        return print_json(&list);
    }
    text.push_str("\nRun one with `crepitus run NAME`; `crepitus scenes NAME` prints its file.\n");
    print(&text)
}
