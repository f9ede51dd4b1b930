//! `crepitus params`: list, read, set and save a device's parameters.

use crate::cli::{DeviceArguments, key_and_value};
use crate::failure::{Failure, print, print_json};
use crate::line::{connect, failure, failure_with};
use crate::shipped;
use clap::{Args, Subcommand};
use crepitus_client::values::{allowed_text, full_name, parse_value, show_value};
use crepitus_protocol::parameters::{self, Kind, PARAMETERS, Parameter, When};
use crepitus_protocol::{Revision, Values};
use crepitus_scene::{Overrides, preset};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// List, read, set and save a device's parameters.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus params list
  crepitus params get crepitus.static_torque_nm
  crepitus params set crepitus.static_torque_nm=0.5 crepitus.kinetic_torque_nm=0.25
  crepitus params apply fine
  crepitus params apply scenes/bone-shaping.toml
  crepitus params save

A set is one commit: all of its values take effect between two ticks, or none; torque then changes \
within the slew limit. Values that are not saved are lost when the device is switched off.")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Action,

    #[command(flatten)]
    device: DeviceArguments,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List all parameters: range, default, meaning. Needs no device.
    List,
    /// Show the device's parameters, or some of them.
    Get {
        /// Names [default: all].
        #[arg(value_name = "NAME")]
        names: Vec<String>,
    },
    /// Set parameters, all or none.
    Set {
        /// What to set.
        #[arg(value_name = "NAME=VALUE", required = true, value_parser = key_and_value)]
        values: Vec<(String, String)>,
    },
    /// Apply a preset, or the device parameters of a scene.
    Apply {
        /// A preset, a scene that ships, or a scene's file.
        what: PathBuf,
    },
    /// Save the current parameters for the next start.
    Save,
}

/// Runs the action.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let device = &arguments.device;
    match &arguments.action {
        Action::List => list(as_json),
        Action::Get { names } => get(device, names, as_json),
        Action::Set { values } => set(device, values, as_json),
        Action::Apply { what } => apply(device, what, as_json),
        Action::Save => {
            let mut client = connect(device)?;
            client
                .save()
                .map_err(|error| failure_with(&mut client, error))?;
            let (revision, _) = client.parameters().map_err(failure)?;
            print_done(revision, "saved for the next start", as_json)
        }
    }
}

/// The parameter of a name; the error suggests a similar one.
fn find(name: &str) -> Result<(u8, &'static Parameter), Failure> {
    parameters::find(name).ok_or_else(|| {
        let like = PARAMETERS
            .iter()
            .map(full_name)
            .max_by(|a, b| strsim::jaro_winkler(a, name).total_cmp(&strsim::jaro_winkler(b, name)))
            .unwrap_or_default();
        Failure::Input(format!(
            "unknown parameter {name:?}: did you mean {like:?}? `crepitus params list` lists all"
        ))
    })
}

fn list(as_json: bool) -> Result<(), Failure> {
    if as_json {
        let list: Vec<_> = PARAMETERS.iter().map(described).collect();
        return print_json(&list);
    }
    let mut text = String::new();
    for parameter in &PARAMETERS {
        let when = match parameter.when {
            When::Always => "",
            When::Disarmed => "; only while disarmed",
        };
        let _ = writeln!(
            text,
            "{}\n    {}\n    {}, default {}{when}",
            full_name(parameter),
            parameter.meaning(),
            allowed_text(parameter),
            show_value(parameter, parameter.default())
        );
    }
    print(&text)
}

fn described(parameter: &Parameter) -> Value {
    let (unit, min, max, choices) = match parameter.kind {
        Kind::Number(spec) => (Some(spec.unit), Some(spec.min), Some(spec.max), None),
        Kind::Choice(choice) => (None, None, None, Some(choice.names)),
    };
    json!({
        "id": parameter.id,
        "name": full_name(parameter),
        "unit": unit,
        "min": min,
        "max": max,
        "choices": choices,
        "default": named(parameter, parameter.default()),
        "only_disarmed": parameter.when == When::Disarmed,
        "meaning": parameter.meaning(),
    })
}

/// A number, or the name of a choice.
fn named(parameter: &Parameter, value: f64) -> Value {
    match parameter.kind {
        Kind::Number(_) => json!(value),
        Kind::Choice(_) => json!(show_value(parameter, value)),
    }
}

fn get(device: &DeviceArguments, names: &[String], as_json: bool) -> Result<(), Failure> {
    let wanted: Vec<_> = if names.is_empty() {
        PARAMETERS.iter().map(|p| (p.id, p)).collect()
    } else {
        names
            .iter()
            .map(|name| find(name))
            .collect::<Result<_, _>>()?
    };
    let mut client = connect(device)?;
    let (revision, values) = client.parameters().map_err(failure)?;
    let value = |id: u8| values.get(id).unwrap_or(f64::NAN);
    if as_json {
        let values: Map<String, Value> = wanted
            .iter()
            .map(|(id, parameter)| (full_name(parameter), named(parameter, value(*id))))
            .collect();
        return print_json(&json!({ "revision": revision.0, "values": values }));
    }
    let lines = wanted.iter().map(|(id, parameter)| {
        let unit = match parameter.kind {
            Kind::Number(spec) if spec.unit != "1" => format!(" {}", spec.unit),
            _ => String::new(),
        };
        format!(
            "{} = {}{unit}\n",
            full_name(parameter),
            show_value(parameter, value(*id))
        )
    });
    print(&format!(
        "revision {revision}\n{}",
        lines.collect::<String>()
    ))
}

fn set(
    device: &DeviceArguments,
    values: &[(String, String)],
    as_json: bool,
) -> Result<(), Failure> {
    let changes = values
        .iter()
        .map(|(name, text)| {
            let (id, parameter) = find(name)?;
            let value = parse_value(parameter, text)
                .map_err(|error| Failure::Input(format!("{name} = {text}: {error}")))?;
            Ok((id, value))
        })
        .collect::<Result<Vec<_>, Failure>>()?;
    let mut client = connect(device)?;
    let revision = client.set(&changes).map_err(failure)?;
    print_done(revision, "applied", as_json)
}

/// Commits a preset, or the device parameters of a scene.
fn apply(device: &DeviceArguments, what: &Path, as_json: bool) -> Result<(), Failure> {
    let preset = what.to_str().and_then(preset::find);
    let from_scene = if preset.is_some() {
        None
    } else {
        Some(values_of_scene(what)?)
    };
    let mut client = connect(device)?;
    let (base, now) = client.parameters().map_err(failure)?;
    let values: Values = match (preset, from_scene) {
        (Some(preset), _) => crepitus_board::values::with_preset(&now, preset, false),
        (None, Some(values)) => values,
        (None, None) => now,
    };
    let revision = client.commit(base, &values).map_err(failure)?;
    print_done(revision, "applied", as_json)
}

fn values_of_scene(what: &Path) -> Result<Values, Failure> {
    let scene = shipped::scene(what, &Overrides::default()).map_err(|failure| match failure {
        Failure::Input(text) if !what.exists() => Failure::Input(format!(
            "{text}; it is not a preset either: `crepitus presets` lists them"
        )),
        other => other,
    })?;
    crepitus_board::values::values(&scene).map_err(Failure::input)
}

fn print_done(revision: Revision, what: &str, as_json: bool) -> Result<(), Failure> {
    if as_json {
        print_json(&json!({ "revision": revision.0, "done": what }))
    } else {
        print(&format!("revision {revision} is {what}\n"))
    }
}
