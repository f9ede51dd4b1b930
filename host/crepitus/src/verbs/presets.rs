//! `crepitus presets [NAME]`.

use crate::failure::{Failure, print, print_json};
use crate::own_presets;
use clap::Args;
use crepitus_client::values::show_number;
use crepitus_pages::table::Table;
use crepitus_scene::preset::{self, Disorder, Evidence, Level, Preset, Setting};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// List the presets by disorder: what to feel for, and what evidence there is.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus presets
  crepitus presets mas-2-catch
  crepitus presets --json

`sourced` numbers are from a publication, `derived` ones computed from such; an `estimate` is ours.")]
pub(crate) struct Arguments {
    /// Show the values of this preset, with unit and evidence.
    name: Option<String>,
}

/// Lists the presets, or shows one.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    if let Some(name) = &arguments.name {
        let (preset, file) = find(name)?;
        return if as_json {
            print_json(&preset.to_json(file.as_deref()))
        } else {
            print(&shown(&preset, file.as_deref()))
        };
    }
    let own = own_presets::all();
    if as_json {
        let shipped = preset::shipped().iter().map(|preset| preset.to_json(None));
        let own = own.iter().map(|(preset, file)| preset.to_json(Some(file)));
        return print_json(&shipped.chain(own).collect::<Vec<_>>());
    }
    print(&list(&own))
}

/// A preset that ships, or one of the user's own with its file.
fn find(name: &str) -> Result<(Preset, Option<PathBuf>), Failure> {
    if let Some(preset) = preset::find(name) {
        return Ok((preset.clone(), None));
    }
    let Some(file) = own_presets::find(name) else {
        let text = own_presets::grade_0(name).unwrap_or_else(|| unknown(name));
        return Err(Failure::Input(text));
    };
    let preset = Preset::read(&file).map_err(Failure::input)?;
    Ok((preset, Some(file)))
}

/// That there is no such preset, with those whose names contain it.
fn unknown(name: &str) -> String {
    let alike = own_presets::suggestions(name);
    format!("no preset {name:?} ships or is your own{alike}: `crepitus presets` lists them")
}

/// One line a preset, by disorder.
fn list(own: &[(Preset, PathBuf)]) -> String {
    let mut text = String::new();
    for disorder in Disorder::ALL {
        text.push_str(disorder.heading());
        if let Some(grade) = disorder.grade_0() {
            let _ = write!(text, "; {grade} is its absence");
        }
        text.push('\n');
        let shipped = preset::shipped().iter();
        for preset in shipped.filter(|p| p.disorder == Some(disorder)) {
            text.push_str(&line(preset));
        }
        text.push('\n');
    }
    if let Some((_, file)) = own.first() {
        let folder = file.parent().unwrap_or(file);
        let _ = writeln!(text, "Your own, in {}", folder.display());
        for (preset, _) in own {
            text.push_str(&line(preset));
        }
        text.push('\n');
    }
    text.push_str(
        "Try one with `crepitus params apply NAME`; in a scene, preset = \"NAME\" below [effects.…] takes the values \
         of those that ship.\n\
         `crepitus presets NAME` shows its values.\n",
    );
    text
}

/// Name, evidence, and what to feel for.
fn line(preset: &Preset) -> String {
    let text = preset.feel.as_ref().or(preset.title.as_ref());
    let text = text.map_or("", String::as_str);
    let judgements = preset.judgements();
    let clinicians = judgements.iter().map(|j| j.clinicians).max();
    let judged = clinicians.map_or_else(String::new, |n| format!(" (judged by {n} clinicians)"));
    let line = format!(
        "  {:20} {:8}  {text}{judged}",
        preset.name,
        evidence(preset.evidence)
    );
    line.trim_end().to_owned() + "\n"
}

fn evidence(evidence: Option<Evidence>) -> &'static str {
    evidence.map_or("", Evidence::name)
}

/// A preset with its values.
fn shown(preset: &Preset, file: Option<&Path>) -> String {
    let mut text = format!("{}\n", preset.title.as_deref().unwrap_or(&preset.name));
    let file = file.map(|file| file.display().to_string());
    for (key, line) in [
        ("severity", preset.severity.as_deref()),
        ("level", preset.level.map(Level::name)),
        ("feel for", preset.feel.as_deref()),
        ("evidence", preset.evidence.map(Evidence::name)),
        ("source", preset.source.as_deref()),
        ("file", file.as_deref()),
    ] {
        if let Some(line) = line {
            let _ = writeln!(text, "  {key:9} {line}");
        }
    }
    for judgement in preset.judgements() {
        let _ = writeln!(text, "  {:9} {}", "judged", judgement.to_text());
    }
    for effect in preset.effects() {
        let values = preset.values.iter().filter(|v| v.effect == effect.name);
        let values: Vec<_> = values.collect();
        let table = Table::of(&values)
            .column("parameter", |v| v.key)
            .headed("")
            .column("value", |v| match v.setting {
                Setting::Number(x, _) => show_number(x),
                Setting::Option(name) => name.to_owned(),
            })
            .headed("value")
            .right()
            .column("unit", |v| v.unit().unwrap_or_default())
            .headed("unit")
            .column("evidence", |v| evidence(v.evidence))
            .headed("evidence")
            .column("meaning", |v| match v.setting {
                Setting::Number(_, spec) => without_evidence(spec.meaning),
                Setting::Option(_) => String::new(),
            })
            .headed("meaning");
        let _ = write!(text, "\n[effects.{}]\n{}", effect.name, table.to_text());
    }
    text.push_str("\nAll other parameters are at their defaults: `crepitus effects` lists them.\n");
    text
}

/// A parameter's meaning without the evidence of its default: "angle (estimate)".
fn without_evidence(meaning: &str) -> String {
    let begins = |e: Evidence| meaning.find(&format!(" ({}", e.name()));
    let Some(begin) = Evidence::ALL.into_iter().find_map(begins) else {
        return meaning.to_owned();
    };
    let (before, rest) = meaning.split_at(begin);
    let after = rest.split_once(')').map_or("", |(_, after)| after);
    format!("{before}{after}")
}
