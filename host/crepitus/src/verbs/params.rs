//! `crepitus params`: list, read, set and save a device's parameters.

mod backup;
mod changes;
mod save_preset;
mod source;

use crate::cli::{DeviceArguments, key_and_value, once};
use crate::failure::{Failure, print, print_json, warn};
use crate::line::{Line, connect, failure, failure_with};
use clap::{Args, Subcommand, ValueHint};
use crepitus_client::Client;
use crepitus_client::connection::parameters::{described, find, named};
use crepitus_client::values::{allowed_text, full_name, parse_value, show_value};
use crepitus_protocol::parameters::{Kind, PARAMETERS, When};
use crepitus_protocol::{DeviceSettings, Revision, Values};
use crepitus_scene::scene::caps_warning;
use save_preset::SavePreset;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::path::PathBuf;

/// List, read, set and save a device's parameters.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus params list
  crepitus params get crepitus.static_torque_nm
  crepitus params set crepitus.static_torque_nm=0.5 \\
      crepitus.kinetic_torque_nm=0.25
  crepitus params apply mas-2-catch
  crepitus params apply contracture-mild --add
  crepitus params apply scenes/bone-shaping.toml
  crepitus params save-preset monday-knee --title 'The knee of Monday'
  crepitus params diff monday-knee
  crepitus params reset clonus
  crepitus params save
  crepitus params backup brace-7.toml
  crepitus params restore brace-7.toml

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
        /// Parameters with their new values.
        #[arg(value_name = "NAME=VALUE", required = true, value_parser = key_and_value)]
        values: Vec<(String, String)>,
    },
    /// Apply a preset or a scene, in one commit.
    ///
    /// A preset is a whole knee: its effects go on, at its values or at their defaults; other effects
    /// of the knee go off and to their defaults. A scene does so, too, and also switches friction
    /// compensation and vibration actuator on or off, which presets leave as they are. Encoder, motor, limits, range and sensor
    /// are the brace's, and stay. A file without `version` is a preset; [effects.NAME] tables are enough.
    Apply {
        /// A preset, a scene that ships, or a file of either.
        #[arg(value_name = "NAME|FILE", value_hint = ValueHint::FilePath)]
        what: PathBuf,
        /// Keep the effects that the preset does not have; it replaces those that it has.
        #[arg(long)]
        add: bool,
    },
    /// Show what differs from the defaults, or from a preset or a scene.
    ///
    /// With NAME|FILE, what `params apply` would change.
    Diff {
        /// A preset, a scene that ships, or a file of either.
        #[arg(value_name = "NAME|FILE", value_hint = ValueHint::FilePath)]
        what: Option<PathBuf>,
    },
    /// Set effects to their defaults, in one commit.
    ///
    /// By default all of the knee, which then has the paper's crepitus and nothing else. Friction
    /// compensation, the vibration actuator and the brace's own groups (encoder, motor, limits, …)
    /// are reset by name only.
    Reset {
        /// Effects or other groups of parameters [default: all effects of the knee].
        #[arg(value_name = "EFFECT", value_parser = changes::groups())]
        effects: Vec<String>,
    },
    /// Save the device's knee as a preset of one's own.
    ///
    /// The preset gets every value of the effects that are on, and lands in the folder that the
    /// environment variable CREPITUS_PRESETS names, or in crepitus/presets of the user's
    /// configuration.
    SavePreset(SavePreset),
    /// Save the current parameters for the next start.
    Save,
    Backup(backup::Backup),
    Restore(backup::Restore),
}

/// Runs the action.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let device = &arguments.device;
    match &arguments.action {
        Action::List => list(as_json),
        Action::Get { names } => get(device, names, as_json),
        Action::Set { values } => set(device, values, as_json),
        Action::Apply { what, add } => changes::apply(device, what, *add, as_json),
        Action::Diff { what } => changes::diff(device, what.as_deref(), as_json),
        Action::Reset { effects } => changes::reset(device, effects, as_json),
        Action::SavePreset(preset) => save_preset::run(device, preset, as_json),
        Action::Backup(arguments) => backup::backup(device, arguments, as_json),
        Action::Restore(arguments) => backup::restore(device, arguments, as_json),
        Action::Save => {
            let mut client = connect(device)?;
            client
                .save()
                .map_err(|error| failure_with(&mut client, error))?;
            let (revision, _) = client.parameters().map_err(failure)?;
            Done {
                revision,
                what: "saved for the next start",
                values: None,
            }
            .print(as_json)
        }
    }
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

fn get(device: &DeviceArguments, names: &[String], as_json: bool) -> Result<(), Failure> {
    let wanted: Vec<_> = if names.is_empty() {
        PARAMETERS.iter().map(|p| (p.id, p)).collect()
    } else {
        names
            .iter()
            .map(|name| find(name).map_err(Failure::input))
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
    once("params set", values.iter().map(|(name, _)| name.as_str()))?;
    let changes = values
        .iter()
        .map(|(name, text)| {
            let (id, parameter) = find(name).map_err(Failure::input)?;
            let value = parse_value(parameter, text)
                .map_err(|error| Failure::Input(format!("{name} = {text}: {error}")))?;
            Ok((id, value))
        })
        .collect::<Result<Vec<_>, Failure>>()?;
    let mut client = connect(device)?;
    let revision = client.set(&changes).map_err(failure)?;
    let (_, values) = client.parameters().map_err(failure)?;
    Done {
        revision,
        what: "applied",
        values: Some(values),
    }
    .print(as_json)
}

/// Change that a verb has made.
struct Done {
    revision: Revision,
    what: &'static str,
    /// The values, where they changed.
    values: Option<Values>,
}

impl Done {
    fn print(&self, as_json: bool) -> Result<(), Failure> {
        let warning = self.values.as_ref().and_then(caps_warning_of);
        if as_json {
            return print_json(&json!({
                "revision": self.revision.0,
                "done": self.what,
                "warnings": warning.as_slice(),
            }));
        }
        if let Some(warning) = warning {
            warn(warning);
        }
        print(&format!("revision {} is {}\n", self.revision, self.what))
    }

    /// The same, with the effects that it has switched or replaced, and whether the angle has
    /// a zero.
    fn print_with_switched(
        &self,
        client: &mut Client<Line>,
        before: &Values,
        as_json: bool,
    ) -> Result<(), Failure> {
        let values = self.values.as_ref().unwrap_or(before);
        let [on, off] = changes::switched(before, values);
        let changed = changes::changed(before, values);
        let is_zeroed = client.status().map_err(failure)?.zeroed;
        if as_json {
            return print_json(&json!({
                "revision": self.revision.0,
                "done": self.what,
                "on": on,
                "off": off,
                "changed": changed,
                "zeroed": is_zeroed,
                "warnings": self.values.as_ref().and_then(caps_warning_of).as_slice(),
            }));
        }
        self.print(false)?;
        for (names, state) in [
            (on, "now on"),
            (off, "now off"),
            (changed, "changed, on before"),
        ] {
            if !names.is_empty() {
                print(&format!("{state}: {}\n", names.join(", ")))?;
            }
        }
        if !is_zeroed {
            print(
                "the angle has no zero yet, and the device refuses to arm: straighten the knee and run \
                 `crepitus zero`\n",
            )?;
        }
        Ok(())
    }
}

/// Warns of effects of a device that can ask for more than its limit.
fn caps_warning_of(values: &Values) -> Option<String> {
    let settings = DeviceSettings::of(values).ok()?;
    let joint = settings.crepitus.as_ref().map(|joint| &joint.parameters);
    caps_warning(&settings.effects, joint, &settings.limits, &settings.range)
}
