//! `crepitus stability`: which hard cases hold on which solver, and by what
//! margin.

mod plan;

use crate::cli::Force;
use crate::failure::{Failure, print, print_json};
use crate::pictures::Pictures;
use crate::screen::All;
use crate::studying::{self, Watch};
use clap::Args;
use crepitus_studies::coupled::{self, CoupledError};
use crepitus_studies::stability::story::{self, Stories};
use crepitus_studies::stability::{StabilityOutcome, markdown, matrix, value};
use std::path::{Path, PathBuf};

/// Try the hard cases on the solvers that they concern: what holds, and by what margin.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus stability
  crepitus stability --case sudden-stop
  crepitus stability --case H10 --case H16 --solver exact-events --solver rk4
  crepitus stability --long --out /tmp/stability
  crepitus stability --coupled

A hard case runs on the solvers that it concerns, under the conventions that they have, in f32 and f64; many are of the \
device, and run on its solver alone. A cell of the matrix \
holds, with the measured margin; or degrades: right in kind, but a number exceeds its limit; or \
fails: the simulated joint is not the one that was asked for. Some cells must hold; if one \
does not, the exit code is 1. The answer comes first; --all prints a line a case, or, with one --case, everything about it.

With --coupled a hand that stops is put to the whole device instead: which stiffness stays quiet \
with which cuff, lag and friction left in the gear, and what the presets have left.")]
pub(crate) struct Arguments {
    /// Only this case, by number or name: H05, reversal-in-stick. May be repeated.
    #[arg(long = "case", value_name = "NAME")]
    cases: Vec<String>,

    /// Only this solver: exact, exact-events, rk4, … May be repeated.
    #[arg(long = "solver", value_name = "KIND")]
    solvers: Vec<String>,

    /// Only this convention: frozen, paper or physical. May be repeated.
    #[arg(long = "convention", value_name = "CONVENTION")]
    conventions: Vec<String>,

    /// Only this precision: the device computes in f32.
    #[arg(long, value_name = "PRECISION", value_parser = ["f32", "f64"])]
    precision: Option<String>,

    /// Include the cases that take hours of simulated time.
    #[arg(long)]
    long: bool,

    /// List the cases with inputs, criteria and sources, without running them.
    #[arg(long)]
    list: bool,

    /// Map the stiffness at which the device begins to ring on a leg, instead of the cases.
    #[arg(long, conflicts_with_all = ["cases", "solvers", "conventions", "precision", "long", "list"])]
    coupled: bool,

    #[command(flatten)]
    all: All,

    /// Folder for cases.csv, summary.json and report.html [default: out/stability; out/coupled].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    #[command(flatten)]
    pictures: Pictures,
}

/// Runs the cases, writes the files, prints the matrix.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    if arguments.coupled {
        return coupled(arguments, as_json);
    }
    let plan = plan::plan(arguments)?;
    if arguments.list {
        return if as_json {
            print_json(&value(&plan.cases))
        } else {
            print(&markdown(&plan.cases))
        };
    }
    let default = Path::new("out/stability");
    let out = arguments.out.as_deref().unwrap_or(default);
    let claim = arguments.force.claim("stability", [""; 0]);
    let folder = studying::folder(out, claim, &["cases.csv"])?;
    let matrix = matrix::run(&plan, &mut Watch::new()).map_err(studying::failed)?;
    let stories = stories(arguments)?;
    let outcome = StabilityOutcome {
        matrix: &matrix,
        stories: stories.as_ref(),
        subjects: plan.subjects.len(),
        is_named: !arguments.cases.is_empty(),
    };
    studying::write(&outcome, (folder, out), &arguments.pictures)?;
    studying::show(&outcome, out, arguments.all, as_json)
}

/// Makes the map of where the device stays quiet on a leg.
fn coupled(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let out = arguments.out.as_deref().unwrap_or(Path::new("out/coupled"));
    let claim = arguments.force.claim("stability --coupled", [""; 0]);
    let tables = ["cells.csv", "onsets.csv", "margins.csv", "scene.toml"];
    let folder = studying::folder(out, claim, &tables)?;
    let study = coupled::run(&mut Watch::new()).map_err(|error| match error {
        CoupledError::Cancelled(_) => Failure::interrupted(),
        CoupledError::Run(why) => Failure::Work(format!("the study failed: {why}")),
    })?;
    studying::write(&study, (folder, out), &arguments.pictures)?;
    studying::show(&study, out, arguments.all, as_json)
}

/// The stories: with the whole catalogue, or if `--pictures` is given.
fn stories(arguments: &Arguments) -> Result<Option<Stories>, Failure> {
    if arguments.cases.is_empty() || arguments.pictures.wanted() {
        story::all()
            .map(Some)
            .map_err(|e| Failure::Work(format!("a story cannot be computed: {e}")))
    } else {
        Ok(None)
    }
}
