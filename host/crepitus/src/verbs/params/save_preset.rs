//! `params save-preset`.

use crate::cli::DeviceArguments;
use crate::failure::{Failure, print, print_json};
use crate::line::{connect, failure};
use crate::own_presets;
use clap::Args;
use clap::builder::PossibleValuesParser;
use crepitus_files::json_path;
use crepitus_scene::preset::{Disorder, Level};
use crepitus_scene::values::knee;
use serde_json::json;

/// Save the device's knee as a preset of one's own.
#[derive(Debug, Args)]
pub(super) struct SavePreset {
    /// Name of the preset: small letters, digits and hyphens.
    name: String,

    /// Title, one line.
    #[arg(long)]
    title: Option<String>,

    /// Sensation to feel for, one line.
    #[arg(long)]
    feel: Option<String>,

    /// Grade, one line.
    #[arg(long)]
    severity: Option<String>,

    /// Level, on the scale that all disorders share.
    #[arg(long, value_parser = PossibleValuesParser::new(Level::ALL.map(Level::name)))]
    level: Option<String>,

    /// Source of the numbers, one line.
    #[arg(long)]
    source: Option<String>,

    /// The disorder.
    #[arg(long, value_parser = PossibleValuesParser::new(Disorder::ALL.map(Disorder::name)))]
    disorder: Option<String>,

    /// Replace a preset of one's own.
    #[arg(long)]
    force: bool,
}

/// Saves the preset.
pub(super) fn run(
    device: &DeviceArguments,
    arguments: &SavePreset,
    as_json: bool,
) -> Result<(), Failure> {
    own_presets::check_name(&arguments.name)?;
    let mut client = connect(device)?;
    let (revision, values) = client.parameters().map_err(failure)?;
    let mut preset = knee(&values).map_err(|error| {
        Failure::Work(format!("the device's parameters are invalid: {error:?}"))
    })?;
    if preset.effects().next().is_none() {
        return Err(Failure::input(
            "every effect of the knee is off, so there is nothing to save: switch one on, for example with \
             `crepitus params set crepitus.render=on`",
        ));
    }
    preset.title.clone_from(&arguments.title);
    preset.feel.clone_from(&arguments.feel);
    preset.severity.clone_from(&arguments.severity);
    let wanted = arguments.level.as_deref();
    preset.level = Level::ALL.into_iter().find(|l| Some(l.name()) == wanted);
    preset.source.clone_from(&arguments.source);
    let wanted = arguments.disorder.as_deref();
    preset.disorder = Disorder::ALL.into_iter().find(|d| Some(d.name()) == wanted);
    let file = own_presets::write(&arguments.name, &preset, arguments.force)?;
    let effects: Vec<_> = preset.effects().map(|effect| effect.name).collect();
    if as_json {
        return print_json(&json!({
            "revision": revision.0,
            "name": arguments.name,
            "file": json_path(&file),
            "effects": effects,
        }));
    }
    print(&format!(
        "{}: {}\n`crepitus params apply {}` makes this knee again\n",
        file.display(),
        effects.join(", "),
        arguments.name
    ))
}
