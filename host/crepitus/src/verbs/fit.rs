//! `crepitus fit`: symptom, grade and parameters of a measured knee, from angle and torque of a passive
//! examination.

mod results;
mod table;

use crate::angle_table::AngleTable;
use crate::cli::Force;
use crate::failure::{Failure, print, print_json, warn};
use crate::interrupt;
use crate::output::to_stderr;
use crate::progress::Progress;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueHint};
use crepitus_files::json_path;
use crepitus_files::output::NewFile;
use crepitus_identify::files::{ExaminationColumns, TorqueUnit, read_examination};
use crepitus_identify::knee::{Refusal, fit, grade, scene, summary};
use serde_json::json;
use std::path::PathBuf;

/// Fit a model to a measured knee: symptom, grade and parameters from angle and torque of a passive examination.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus fit knee.csv --out out/knee
  crepitus fit isokinetic.csv --time Time --time-unit ms --angle Position \\
      --torque Torque --torque-unit ft-lb --angle-scale -1 --angle-offset 90
  crepitus fit pendulum.csv --angle knee_flexion --released-kg-m2 0.35
  crepitus fit examination.parquet --scene-out knee.toml
  crepitus run knee.toml

What to record: the relaxed knee, bent and straightened six times or more over 60 degrees or more, there and back, at \
30, 60, 120 and 200 deg/s, with a second's hold after each stroke; by a dynamometer, or by hand with a force sensor at a \
known lever. Angles count flexion, 0 is straight; torque is what knee and leg resist with, positive against flexion. Gravity \
and inertia of the leg need not be taken off.

A leg that is let go of (pendulum test) needs no torque but its inertia: --released-kg-m2.

Every symptom is fitted together with a limb; the proposal is the one with the least error in strokes that were left \
out. Intervals are those of 95 %, by the jackknife over strokes. The grade is that of the preset whose torque along the \
same motion is nearest. It proposes numbers, and makes no diagnosis.

Exit code 1: the examination does not tell; the text says why and what to record.")]
pub(crate) struct Arguments {
    /// A table of angle and torque over time such as CSV, or a recording of `crepitus record`.
    #[arg(value_hint = ValueHint::FilePath)]
    file: PathBuf,

    #[command(flatten)]
    table: AngleTable,

    /// Column of the torque [default: torque, moment or the like].
    #[arg(long, value_name = "COLUMN")]
    torque: Option<String>,

    /// Unit of the torque [default: that of the file or of the column's name, else nm].
    #[arg(long, value_name = "UNIT", value_parser = torque_units())]
    torque_unit: Option<TorqueUnit>,

    /// Factor of the torque, -1 where it is positive against extension, or the lever in m of a force in N.
    #[arg(
        long,
        value_name = "FACTOR",
        default_value_t = 1.0,
        allow_negative_numbers = true
    )]
    torque_scale: f64,

    /// Inertia of a leg that was let go of and swings freely, kg·m²: no torque is read.
    #[arg(long, value_name = "KG_M2", conflicts_with_all = ["torque", "torque_scale"])]
    released_kg_m2: Option<f64>,

    /// Folder for fit.json, residual.csv and knee.toml.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    out: Option<PathBuf>,

    /// File for a scene with the fitted knee; `-` is standard output.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    scene_out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,
}

/// Parses the name of a unit of torques.
fn torque_units() -> impl TypedValueParser<Value = TorqueUnit> {
    let names = PossibleValuesParser::new(TorqueUnit::ALL.map(|(name, _)| name));
    names.try_map(|name| TorqueUnit::find(&name).ok_or("unknown"))
}

pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let claim = arguments.force.claim("fit", [&arguments.file]);
    let scene_file = |file| NewFile::create(file, claim.force, &claim.inputs);
    let scene_file = arguments.scene_out.as_deref().map(scene_file).transpose()?;
    let on_stdout = scene_file.as_ref().is_some_and(NewFile::is_stdout);
    if on_stdout && as_json {
        return Err(Failure::input(
            "--json and --scene-out - would both write to standard output: name a file with --scene-out",
        ));
    }
    let out = arguments.out.as_deref();
    let prepare = |out| crate::results::folder(out, claim.clone(), results::NAMES);
    let prepared = out.map(prepare).transpose()?;
    interrupt::listen();
    let columns = ExaminationColumns {
        table: arguments.table.columns(),
        torque: arguments.torque.clone(),
        torque_unit: arguments.torque_unit,
        torque_scale: arguments.torque_scale,
        released_kg_m2: arguments.released_kg_m2,
    };
    let examination = read_examination(&arguments.file, &columns, &mut |warning| warn(warning))?;
    let mut progress = Progress::of_study();
    let found = fit(&examination, &mut |share| {
        progress.reached(share);
        !interrupt::requested()
    });
    drop(progress);
    let fitted = found.map_err(|refusal| match refusal {
        Refusal::Interrupted => Failure::interrupted(),
        refusal => Failure::Work(format!("no model is proposed: {refusal}")),
    })?;
    let grade = grade(&fitted);
    let scene = scene(&fitted, grade.as_ref(), &arguments.file);
    let summary = summary(&fitted, grade.as_ref());
    if let (Some(out), Some(folder)) = (out, prepared) {
        results::write(out, folder, &fitted, &summary, &scene)?;
    }
    if let Some(file) = scene_file {
        results::write_scene(file, &scene)?;
    }
    if as_json {
        return print_json(
            &json!({ "fit": summary, "out": out.map(json_path), "scene": arguments.scene_out.as_deref().map(json_path) }),
        );
    }
    let mut text = table::text(&fitted, grade.as_ref());
    if let Some(out) = out {
        text = format!("{text}results: {}\n", out.display());
    }
    if on_stdout {
        to_stderr(text.trim_end());
        return Ok(());
    }
    if let Some(file) = &arguments.scene_out {
        text = format!("{text}scene: {}\n", file.display());
    }
    print(&text)
}
