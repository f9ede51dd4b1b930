//! `params backup` and `restore`: a whole device, by names that outlive versions.

use super::Done;
use crate::cli::{DeviceArguments, Force};
use crate::failure::{Failure, print, print_json, warn};
use crate::line::{connect, failure, failure_with};
use clap::{Args, ValueHint};
use crepitus_client::connection::device_text;
use crepitus_client::values::{allowed_text, full_name, parse_value, show_number, show_value};
use crepitus_files::input;
use crepitus_files::output::{Inputs, NewFile};
use crepitus_protocol::Values;
use crepitus_protocol::parameters::{Kind, PARAMETERS, Parameter};
use serde_json::json;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;
use toml::{Table, Value};

/// Version of the form of the file.
const FORM: i64 = 1;

/// Most names in a message.
const MOST_NAMES: usize = 10;

/// Save all parameters of a device to a file.
///
/// Encoder, motor, limits, range and sensor as well as every effect, on or off: what `restore` needs to
/// make another brace the same, also with another version of the firmware. They are the active
/// values; the file says whether the device also has them saved for its next start.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus params backup brace-7.toml
  crepitus params backup try.toml --device sim")]
pub(super) struct Backup {
    /// The file; it must not exist, or use --force. With - it is standard output.
    #[arg(value_hint = ValueHint::FilePath)]
    file: PathBuf,

    #[command(flatten)]
    force: Force,
}

/// Set all parameters of a device from a file of `backup`, in one commit.
///
/// The file is checked first: values out of range are refused, and nothing is written. Parameters that
/// this version does not have are left out, and those that the file does not have stay as they are; both
/// are listed. If the backed up device had its values saved for its next start, they are saved here, too.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus params restore brace-7.toml
  crepitus params restore brace-7.toml --no-save   # for now only: a restart brings back the old values")]
pub(super) struct Restore {
    /// A file that `params backup` has written.
    #[arg(value_hint = ValueHint::FilePath)]
    file: PathBuf,

    /// Do not save the values for the next start.
    #[arg(long)]
    no_save: bool,
}

/// Writes the file.
pub(super) fn backup(
    device: &DeviceArguments,
    arguments: &Backup,
    as_json: bool,
) -> Result<(), Failure> {
    let file = &arguments.file;
    let new = NewFile::create(file, arguments.force.force, &Inputs::default())?;
    if new.is_stdout() && as_json {
        return Err(Failure::input(
            "--json and a backup to - would both write to standard output: name a file",
        ));
    }
    let mut client = connect(device)?;
    let (revision, values) = client.parameters().map_err(failure)?;
    let is_saved = client.status().map_err(failure)?.saved == Some(revision);
    let serial = device_text::serial(&client.handshake().comms);
    let mut text = format!(
        "# All parameters of a device; `crepitus params restore` sets them.\n\
         [backup]\nform = {FORM}\nmade_by = {}\ndevice = {}\nrevision = {revision}\n\
         # Saved on the device for its next start, too.\nsaved = {is_saved}\n",
        quoted(concat!("crepitus ", env!("CARGO_PKG_VERSION"))),
        quoted(&serial),
    );
    let mut groups: Vec<&str> = PARAMETERS.iter().map(|p| p.group).collect();
    groups.sort_unstable();
    groups.dedup();
    for group in groups {
        let _ = write!(text, "\n[parameters.{group}]\n");
        for (parameter, value) in values.iter().filter(|(p, _)| p.group == group) {
            let shown = show_value(parameter, value);
            let shown = match parameter.kind {
                Kind::Choice(_) => quoted(&shown),
                Kind::Number(_) => shown,
            };
            let _ = writeln!(text, "{} = {shown}", parameter.key());
        }
    }
    let cannot = |error| Failure::at(file, "cannot be written", &error);
    (&mut new.as_file())
        .write_all(text.as_bytes())
        .map_err(cannot)?;
    let on_stdout = new.is_stdout();
    new.persist()?;
    if !is_saved {
        warn(
            "the device's active values are not saved on it: it would start with others. The backup has the \
             active ones",
        );
    }
    if as_json {
        return print_json(&json!({
            "file": file, "revision": revision.0, "saved": is_saved, "parameters": PARAMETERS.len(),
        }));
    }
    if on_stdout {
        return Ok(());
    }
    print(&format!(
        "{}: {} parameters of revision {revision} of {serial}\n",
        file.display(),
        PARAMETERS.len()
    ))
}

/// A TOML string: its escapes are those of JSON.
fn quoted(text: &str) -> String {
    json!(text).to_string()
}

/// Content of a file of `backup`.
#[derive(Debug, Default)]
struct Content {
    /// Serial number of the device.
    device: String,
    is_saved: bool,
    values: Vec<(&'static Parameter, f64)>,
    /// Names that this version does not have.
    unknown: Vec<String>,
}

impl Content {
    /// Parses a file. A value out of range is an error, and all of them are named.
    fn of(text: &str) -> Result<Self, String> {
        let file: Table = toml::from_str(text).map_err(|error| error.to_string())?;
        let (Some(Value::Table(head)), Some(Value::Table(groups))) =
            (file.get("backup"), file.get("parameters"))
        else {
            return Err(
                "it has no [backup] and no [parameters.…]: expected a file that `crepitus params backup` has \
                 written; presets and scenes are set by `crepitus params apply`"
                    .to_owned(),
            );
        };
        let form = head.get("form").and_then(Value::as_integer);
        if form != Some(FORM) {
            return Err(format!(
                "its `form` is not {FORM}: restore it with the version of crepitus that has written it"
            ));
        }
        let mut content = Self {
            device: (head.get("device").and_then(Value::as_str))
                .unwrap_or("a device without a serial number")
                .to_owned(),
            is_saved: head.get("saved").and_then(Value::as_bool) == Some(true),
            ..Self::default()
        };
        let mut wrong = Vec::new();
        for (group, keys) in groups {
            let Value::Table(keys) = keys else {
                wrong.push(format!("`{group}` is no table of parameters"));
                continue;
            };
            for (key, value) in keys {
                let name = format!("{group}.{key}");
                let known = PARAMETERS.iter().find(|p| full_name(p) == name);
                let Some(parameter) = known else {
                    content.unknown.push(name);
                    continue;
                };
                match number(parameter, value) {
                    Ok(value) => content.values.push((parameter, value)),
                    Err(error) => wrong.push(error),
                }
            }
        }
        if wrong.is_empty() {
            Ok(content)
        } else {
            Err(format!("nothing was set: {}", listed(&wrong, "; ")))
        }
    }

    /// Names that the file does not have.
    fn missing(&self) -> Vec<String> {
        let there: BTreeSet<_> = self.values.iter().map(|(p, _)| p.id).collect();
        let missing = PARAMETERS.iter().filter(|p| !there.contains(&p.id));
        missing.map(full_name).collect()
    }
}

/// A value in its range.
fn number(parameter: &Parameter, value: &Value) -> Result<f64, String> {
    let text = match value {
        Value::Integer(number) => number.to_string(),
        Value::Float(number) => show_number(*number),
        Value::String(text) => text.clone(),
        other => other.type_str().to_owned(),
    };
    let value = parse_value(parameter, &text).map_err(|error| error.to_string())?;
    if parameter.allows(value) {
        return Ok(value);
    }
    let (name, allowed) = (full_name(parameter), allowed_text(parameter));
    Err(format!("invalid {name}: expected {allowed}, got {text}"))
}

/// The first texts of a list, and the number of the others.
fn listed(texts: &[String], separator: &str) -> String {
    let shown = texts[..texts.len().min(MOST_NAMES)].join(separator);
    match texts.len().saturating_sub(MOST_NAMES) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// Sets what the file has.
pub(super) fn restore(
    device: &DeviceArguments,
    arguments: &Restore,
    as_json: bool,
) -> Result<(), Failure> {
    let file = &arguments.file;
    let bad = |what: &str| Failure::Input(format!("{}: {what}", file.display()));
    let text = input::read_to_string(file, input::TEXT_BYTES)
        .map_err(|error| bad(&format!("cannot be read: {error}")))?;
    let content = Content::of(&text).map_err(|error| bad(&error))?;
    let missing = content.missing();
    let mut client = connect(device)?;
    let (base, before) = client.parameters().map_err(failure)?;
    let mut values: Values = before;
    for (parameter, value) in &content.values {
        values.set(parameter.id, *value);
    }
    let revision = client
        .commit(base, &values)
        .map_err(|error| failure_with(&mut client, error))?;
    let is_saved = content.is_saved && !arguments.no_save;
    if is_saved {
        client
            .save()
            .map_err(|error| failure_with(&mut client, error))?;
    }
    let what = match (is_saved, content.is_saved) {
        (true, _) => "restored, and saved for the next start",
        (false, true) => "restored, and not saved: a restart brings back the old values",
        (false, false) => {
            "restored, and not saved, as on the device of the backup: `crepitus params save` saves it"
        }
    };
    if as_json {
        return print_json(&json!({
            "revision": revision.0,
            "done": what,
            "from": content.device,
            "saved": is_saved,
            "parameters": content.values.len(),
            "unknown": content.unknown,
            "missing": missing,
        }));
    }
    if !content.unknown.is_empty() {
        warn(format!(
            "left out, as this version does not have them: {}",
            listed(&content.unknown, ", ")
        ));
    }
    if !missing.is_empty() {
        warn(format!(
            "not in the file, and as they were on the device: {}",
            listed(&missing, ", ")
        ));
    }
    Done {
        revision,
        what,
        values: Some(values),
    }
    .print(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "[backup]\nform = 1\ndevice = \"a\"\nsaved = true\n";

    #[test]
    fn names_of_other_versions_are_listed_and_values_out_of_range_refused_together() {
        let text = format!(
            "{HEAD}[parameters.crepitus]\nrender = \"off\"\nstatic_torque_nm = 1\nnew_in_two = 3\n\
             [parameters.telepathy]\nrender = \"on\"\n"
        );
        let content = Content::of(&text).unwrap();
        assert_eq!(content.unknown, ["crepitus.new_in_two", "telepathy.render"]);
        assert_eq!(content.values.len(), 2);
        let missing = content.missing();
        assert_eq!(missing.len(), PARAMETERS.len() - 2);
        assert!(missing.contains(&"encoder.lines".to_owned()));
        assert!(content.is_saved);
        let text = format!(
            "{HEAD}[parameters.crepitus]\nrender = \"maybe\"\nstatic_torque_nm = 1e9\nkinetic_torque_nm = nan\n"
        );
        let error = Content::of(&text).unwrap_err();
        for part in [
            "nothing was set",
            "render",
            "static_torque_nm",
            "kinetic_torque_nm",
        ] {
            assert!(error.contains(part), "{part}: {error}");
        }
    }

    #[test]
    fn other_files_are_no_backup() {
        for (text, part) in [
            ("", "params backup"),
            ("version = 1\n[effects.crepitus]\n", "params apply"),
            (
                "[backup]\nform = 2\n[parameters.crepitus]\n",
                "`form` is not 1",
            ),
            (
                "[backup]\nform = 1\n[parameters]\ncrepitus = 1\n",
                "no table",
            ),
            ("[backup", "line 1"),
        ] {
            let error = Content::of(text).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    #[test]
    fn a_list_of_names_is_short() {
        let names: Vec<_> = (0..12).map(|n| n.to_string()).collect();
        assert_eq!(
            listed(&names, ", "),
            "0, 1, 2, 3, 4, 5, 6, 7, 8, 9 and 2 more"
        );
    }
}
