//! `crepitus scenes [NAME]`.

use crate::failure::{Failure, print, print_json};
use clap::Args;
use crepitus_pages::table::{Cell, Table};
use crepitus_scene::shipped::{SHIPPED, Shipped, similar_name};
use crepitus_scene::similar::question;
use crepitus_scene::{Overrides, SceneError};
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
                "no scene \"{name}\" ships{}: `crepitus scenes` lists those that do",
                question(similar_name(name))
            ))),
        };
    }
    let scenes = SHIPPED
        .iter()
        .map(|shipped| Ok((shipped, shipped.read(&Overrides::default())?)))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|e: SceneError| Failure::input(e))?;
    let table = Table::of(&scenes)
        .column("name", |(shipped, _)| shipped.name)
        .headed("")
        .column("file", |(shipped, _)| shipped.file().display().to_string())
        .column("title", |(_, scene)| scene.title.as_str())
        .headed("")
        .column("description", |(_, scene)| scene.description.as_deref())
        .column("duration_s", |(_, scene)| scene.duration_s)
        .column("motion", |(_, scene)| scene.motion_kind.name())
        .column("solver", |(_, scene)| scene.solver.name())
        .column("effects", |(_, scene)| {
            let names: Vec<_> = scene.effects().iter().map(|e| e.name).collect();
            Cell::from(names.as_slice())
        });
    if as_json {
        return print_json(&table);
    }
    print(&format!(
        "{}\nRun one with `crepitus run NAME`; `crepitus scenes NAME` prints its file.\n",
        table.to_text()
    ))
}
