//! `params apply`, `reset` and `diff`: many parameters at once.

use super::Done;
use super::source::Source;
use crate::cli::DeviceArguments;
use crate::failure::{Failure, print, print_json};
use crate::line::{connect, failure};
use clap::builder::PossibleValuesParser;
use crepitus_client::connection::parameters::named;
use crepitus_client::values::{full_name, show_value};
use crepitus_pages::table::Table;
use crepitus_protocol::Values;
use crepitus_protocol::parameters::{Kind, PARAMETERS, Parameter};
use crepitus_scene::values::{RENDER, is_of_knee};
use serde_json::{Value, json};
use std::path::Path;

/// The groups of parameters.
pub(super) fn groups() -> PossibleValuesParser {
    let mut names: Vec<&'static str> = PARAMETERS.iter().map(|p| p.group).collect();
    names.dedup();
    names.sort_unstable();
    names.dedup();
    PossibleValuesParser::new(names)
}

/// Commits a preset, or the effects of a scene.
pub(super) fn apply(
    device: &DeviceArguments,
    what: &Path,
    add: bool,
    as_json: bool,
) -> Result<(), Failure> {
    let source = Source::find(what)?;
    let mut client = connect(device)?;
    let (base, now) = client.parameters().map_err(failure)?;
    let values = source.on(&now, add)?;
    let revision = client.commit(base, &values).map_err(failure)?;
    Done {
        revision,
        what: "applied",
        values: Some(values),
    }
    .print_with_switched(&mut client, &now, as_json)
}

/// Commits the defaults of some groups, or of the knee.
pub(super) fn reset(
    device: &DeviceArguments,
    groups: &[String],
    as_json: bool,
) -> Result<(), Failure> {
    let is_meant = |group: &str| match groups {
        [] => is_of_knee(group),
        some => some.iter().any(|name| name == group),
    };
    let mut client = connect(device)?;
    let (base, now) = client.parameters().map_err(failure)?;
    let mut values = now;
    for parameter in PARAMETERS.iter().filter(|p| is_meant(p.group)) {
        values.set(parameter.id, parameter.default());
    }
    let revision = client.commit(base, &values).map_err(failure)?;
    Done {
        revision,
        what: "applied",
        values: Some(values),
    }
    .print_with_switched(&mut client, &now, as_json)
}

/// The effects that `values` switch on, and off.
pub(super) fn switched(now: &Values, values: &Values) -> [Vec<&'static str>; 2] {
    let changed = |to: f64| {
        let pairs = now.iter().zip(values.iter());
        pairs
            .filter(|((p, was), (_, is))| is_switch(p) && was != is && *is == to)
            .map(|((p, _), _)| p.group)
            .collect()
    };
    [changed(1.0), changed(0.0)]
}

/// The effects that are on before and after, with other values.
pub(super) fn changed(now: &Values, values: &Values) -> Vec<&'static str> {
    let differs = |group: &str| {
        let mut pairs = now.iter().zip(values.iter());
        pairs.any(|((p, was), (_, is))| p.group == group && was.to_bits() != is.to_bits())
    };
    let is_on = |values: &Values, id: u8| values.get(id).is_some_and(|choice| choice != 0.0);
    let stays_on = |p: &Parameter| is_switch(p) && is_on(now, p.id) && is_on(values, p.id);
    let switches = PARAMETERS.iter().filter(|p| stays_on(p));
    switches
        .map(|p| p.group)
        .filter(|group| differs(group))
        .collect()
}

/// Returns whether it switches an effect.
fn is_switch(parameter: &Parameter) -> bool {
    matches!(parameter.kind, Kind::Choice(choice) if choice.key == RENDER)
}

/// A parameter that differs.
struct Difference {
    parameter: &'static Parameter,
    device: f64,
    other: f64,
}

/// Prints in which parameters the device differs from the defaults, or from what `what` would make of it.
pub(super) fn diff(
    device: &DeviceArguments,
    what: Option<&Path>,
    as_json: bool,
) -> Result<(), Failure> {
    let source = what.map(Source::find).transpose()?;
    let mut client = connect(device)?;
    let (revision, now) = client.parameters().map_err(failure)?;
    let other = match &source {
        Some(source) => source.on(&now, false)?,
        None => Values::default(),
    };
    let differences: Vec<_> = now
        .iter()
        .zip(other.iter())
        .filter(|((_, device), (_, other))| device.to_bits() != other.to_bits())
        .map(|((parameter, device), (_, other))| Difference {
            parameter,
            device,
            other,
        })
        .collect();
    let name = match what {
        Some(what) => what.display().to_string(),
        None => "default".to_owned(),
    };
    if as_json {
        let list: Vec<Value> = differences.iter().map(Difference::to_json).collect();
        return print_json(&json!({ "revision": revision.0, "from": name, "differences": list }));
    }
    if differences.is_empty() {
        return print(&format!(
            "revision {revision} does not differ from {name}\n"
        ));
    }
    let table = Table::of(&differences)
        .column("parameter", |d| full_name(d.parameter))
        .headed("")
        .column("device", |d| show_value(d.parameter, d.device))
        .headed("device")
        .right()
        .column("other", |d| show_value(d.parameter, d.other))
        .headed(name)
        .right()
        .column("unit", Difference::unit)
        .headed("unit");
    print(&format!("revision {revision}\n{}", table.to_text()))
}

impl Difference {
    fn unit(&self) -> &'static str {
        match self.parameter.kind {
            Kind::Number(spec) if spec.unit != "1" => spec.unit,
            _ => "",
        }
    }

    fn to_json(&self) -> Value {
        json!({
            "name": full_name(self.parameter),
            "device": named(self.parameter, self.device),
            "other": named(self.parameter, self.other),
            "unit": self.unit(),
        })
    }
}
