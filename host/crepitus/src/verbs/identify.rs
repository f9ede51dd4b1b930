//! `crepitus identify`: friction, inertia, backlash and cuffs of the brace from recordings of a
//! weight that swings in it.

mod chart;
mod page;
mod results;
mod table;

use crate::angle_table::AngleTable;
use crate::cli::{Force, above_zero, tolerance};
use crate::failure::{Failure, print, print_json, warn};
use crate::interrupt;
use crate::output::to_stderr;
use crate::progress::Progress;
use crate::results::folder;
use clap::{Args, ValueHint};
use crepitus_files::json_path;
use crepitus_files::output::NewFile;
use crepitus_identify::DEVIATIONS;
use crepitus_identify::brace::{Refusal, Weight, identify, summary};
use crepitus_identify::files::{NM_PER_A, SwingColumns, read_swings};
use serde_json::json;
use std::path::PathBuf;

/// Identify the brace: friction, inertia, backlash, cuff stiffness from recordings of a swinging weight.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus record swing --for 15s
  crepitus record armed --for 15s --arm
  crepitus identify swing armed --weight-kg 2.5 --lever-m 0.25 \\
      --weight-inertia-kg-m2 0.23 --out out/brace
  crepitus identify swing --weight-kg 2.5 --lever-m 0.25 \\
      --scene-out brace.toml
  crepitus identify swing.csv --angle phi --unit rad --weight-kg 2.5 \\
      --lever-m 0.25
  crepitus record simulated --device sim --scene weight-in-the-brace --for 8s
  crepitus identify simulated --weight-kg 2.44 --lever-m 0.2477 \\
      --weight-inertia-kg-m2 0.2202

What to record: clamp the upper half of the brace with its axis level, strap a bar with a weight into the cuffs \
of the lower half, as if it were the leg, and choose it so heavy that it swings four times or more. Begin to record, lift \
it by 50 to 70 degrees, hold it still, let go without pushing, and do not touch it until it has hung still for a second. \
Several releases may stand in one recording.

Without torque this shows dry and viscous friction, inertias, backlash and cuffs, all by the weight's moment in N·m. What the \
gear loses under load, and the torque constant, need another recording with --arm while the device pushes and brakes: \
crepitus params set crepitus.render=off lead-pipe.render=on lead-pipe.torque_nm=0.3 lead-pipe.elastic_nm_per_rad=3 \
lead-pipe.neutral_deg=60, with the zero set 60 degrees from where the weight hangs. Compared with the motor's \
torque, the weight is checked, too.

A quantity that a recording does not show is not reported; the text says why and what to do. Intervals are those of 95 %. \
Exit code 1: the recordings are not those of a weight that swings freely; the text says why.")]
pub(crate) struct Arguments {
    /// Recordings of one weight in one brace, as `crepitus record` writes them, or tables of time and angle such as CSV.
    #[arg(required = true, value_hint = ValueHint::FilePath)]
    recordings: Vec<PathBuf>,

    /// Mass of bar and weight, kg.
    #[arg(long, value_name = "KG")]
    weight_kg: f64,

    /// Distance of their centre of mass from the axis, m.
    #[arg(long, value_name = "M")]
    lever_m: f64,

    /// Their inertia about the axis, kg·m² [default: mass times the lever's square].
    #[arg(long, value_name = "KG_M2")]
    weight_inertia_kg_m2: Option<f64>,

    /// 95 % interval of the weight's moment, ± %; its inertia is taken to be known half as well.
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0)]
    weight_tolerance: f64,

    /// 95 % interval of the motor's torque constant, ± %.
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0)]
    torque_tolerance: f64,

    /// Folder for report.html, residual.svg and identified.json.
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    out: Option<PathBuf>,

    /// File for the identified values as [effects.…] tables of a scene; `-` is standard output.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    scene_out: Option<PathBuf>,

    #[command(flatten)]
    table: AngleTable,

    /// Column of the motor's current in a table, A [default: current_a if there is one].
    #[arg(long, value_name = "COLUMN")]
    current: Option<String>,

    /// Torque at the joint per ampere without losses: torque constant times gear ratio, of a table with a current.
    #[arg(long, value_name = "NM_PER_A", default_value_t = NM_PER_A)]
    nm_per_a: f64,

    #[command(flatten)]
    force: Force,
}

/// Standard deviation, as a share, of a 95 % interval in percent.
fn deviation(option: &str, percent: f64) -> Result<f64, Failure> {
    Ok(tolerance(option, percent)? / DEVIATIONS)
}

impl Arguments {
    fn weight(&self) -> Result<Weight, Failure> {
        let inertia = self.weight_inertia_kg_m2;
        Ok(Weight::new(
            above_zero("--weight-kg", self.weight_kg)?,
            above_zero("--lever-m", self.lever_m)?,
            inertia
                .map(|value| above_zero("--weight-inertia-kg-m2", value))
                .transpose()?,
            deviation("--weight-tolerance", self.weight_tolerance)?,
        ))
    }
}

/// Identifies, prints, writes.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let weight = arguments.weight()?;
    let torque_deviation = deviation("--torque-tolerance", arguments.torque_tolerance)?;
    let claim = arguments.force.claim("identify", &arguments.recordings);
    let scene_file = |file| NewFile::create(file, claim.force, &claim.inputs);
    let scene_file = arguments.scene_out.as_deref().map(scene_file).transpose()?;
    let on_stdout = scene_file.as_ref().is_some_and(NewFile::is_stdout);
    if on_stdout && as_json {
        return Err(Failure::input(
            "--json and --scene-out - would both write to standard output: name a file with --scene-out",
        ));
    }
    let out = arguments.out.as_deref();
    let prepare = |out| folder(out, claim.clone(), results::NAMES);
    let prepared = out.map(prepare).transpose()?;
    interrupt::listen();
    let columns = SwingColumns {
        table: arguments.table.columns(),
        current: arguments.current.clone(),
        nm_per_a: arguments.nm_per_a,
    };
    let mut progress = Progress::of_reading();
    let files = &arguments.recordings;
    let recordings = read_swings(files, &columns, &mut |text| warn(text), &mut |share| {
        progress.reached(share);
        !interrupt::requested()
    })?;
    let mut progress = Progress::of_study();
    let found = identify(&recordings, &weight, torque_deviation, &mut |share| {
        progress.reached(share);
        !interrupt::requested()
    });
    drop(progress);
    let brace = found.map_err(|refusal| match refusal {
        Refusal::Interrupted => Failure::interrupted(),
        refusal => Failure::Work(format!("nothing is identified: {refusal}")),
    })?;
    let summary = summary(&brace, &weight);
    if let (Some(out), Some(folder)) = (out, prepared) {
        results::write(out, folder, &brace, &summary)?;
    }
    if let Some(file) = scene_file {
        results::write_scene(file, &brace)?;
    }
    if as_json {
        return print_json(
            &json!({ "identified": summary, "out": out.map(json_path), "scene": arguments.scene_out.as_deref().map(json_path) }),
        );
    }
    brace.notes.iter().for_each(warn);
    let mut text = table::text(&brace);
    if let Some(out) = out {
        text = format!("{text}report: {}\n", out.join(results::PAGE).display());
    }
    if on_stdout {
        to_stderr(text.trim_end());
        return Ok(());
    }
    if let Some(file) = &arguments.scene_out {
        text = format!("{text}tables of a scene: {}\n", file.display());
    }
    print(&text)
}
