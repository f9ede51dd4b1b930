//! Laws, tasks and joints that the command line asks for.

use super::Arguments;
use crate::failure::Failure;
use crepitus_scene::preset::joints;
use crepitus_scene::similar::{question, similar};
use crepitus_studies::laws::task::Extent;
use crepitus_studies::laws::{ENTRIES, Plan, TASKS};

/// The plan, or the first name that is unknown.
pub(super) fn plan(arguments: &Arguments) -> Result<Plan, Failure> {
    let laws: Vec<&str> = ENTRIES.iter().map(|entry| entry.name).collect();
    known("law", &arguments.laws, &laws)?;
    let tasks: Vec<&str> = TASKS.iter().map(|task| task.name()).collect();
    known("task", &arguments.tasks, &tasks)?;
    let names: Vec<&str> = joints().iter().map(|joint| joint.name).collect();
    known("joint", &arguments.joints, &names)?;
    let extent = match (arguments.quick, arguments.long) {
        (true, _) => Extent::Quick,
        (_, true) => Extent::Long,
        _ => Extent::Full,
    };
    let mut plan = Plan {
        laws: arguments.laws.clone(),
        tasks: arguments.tasks.clone(),
        ..Plan::of(extent)
    };
    if !arguments.joints.is_empty() {
        let wanted = joints().iter();
        let wanted = wanted.filter(|joint| arguments.joints.iter().any(|name| name == joint.name));
        plan.joints = wanted.copied().collect();
    }
    Ok(plan)
}

/// Rejects a name that is not among these.
fn known(option: &str, given: &[String], names: &[&str]) -> Result<(), Failure> {
    let Some(name) = given.iter().find(|name| !names.contains(&name.as_str())) else {
        return Ok(());
    };
    let alike = question(similar(names.iter().copied(), name));
    Err(Failure::Input(format!(
        "--{option} {name}: there is no such {option}{alike}; expected one of {}",
        names.join(", ")
    )))
}
