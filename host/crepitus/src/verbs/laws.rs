//! `crepitus laws`: what every friction law that haptics uses loses and costs, and which to take for
//! what.

mod plan;
mod target;

use crate::cli::Force;
use crate::failure::{Failure, print, print_json};
use crate::pictures::Pictures;
use crate::screen::All;
use crate::studying::{self, Watch};
use clap::Args;
use crepitus_studies::laws::{self, LawsOutcome, words};
use std::path::{Path, PathBuf};

/// Show which friction law to take for what: errors and cost of each.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus laws --quick
  crepitus laws --quick --target
  crepitus laws --law frozen --law lugre --task creep --all
  crepitus laws --joint fine --out /tmp/laws
  crepitus laws --list

Every law is fitted to the same joint and runs the same tasks: grating, rest, turning back, a hand on \
the leg, an hour in f32. A task has numbers that are known in closed form or by the event-driven \
reference. Two errors are kept apart: that of the model (the law converged, against what is demanded) \
and that of the numbers (the law at 20 kHz in f32, against itself converged). The answer comes first, \
a law a use; the rule is in the report. --all prints every number.

leaderboard.csv has a row for each law, joint and number, costs.csv a row for each law, summary.json \
all of it. A step is timed on this machine in CPU time; with --target the laws also run on an emulated \
STM32F405: modelled cycles, 0 wait states; not measured on hardware.")]
#[expect(clippy::struct_excessive_bools, reason = "flags of a command line")]
pub(crate) struct Arguments {
    /// Only this law: frozen, karnopp, lugre, … May be repeated.
    #[arg(long = "law", value_name = "NAME")]
    laws: Vec<String>,

    /// Only this task: grating, creep, hand, … May be repeated.
    #[arg(long = "task", value_name = "NAME")]
    tasks: Vec<String>,

    /// Only this joint, a preset that is crepitus alone. May be repeated.
    #[arg(long = "joint", visible_alias = "preset", value_name = "NAME")]
    joints: Vec<String>,

    /// The paper's joint, short tasks and few repeats: seconds instead of minutes.
    #[arg(long, conflicts_with = "long")]
    quick: bool,

    /// With a day in f32 for each law.
    #[arg(long)]
    long: bool,

    /// Also run every law on an emulated STM32F405: cycles and instructions of a step, which then
    /// decide between equals. Builds firmware/ladder, unless CREPITUS_IMAGES names a folder with it.
    #[arg(long)]
    target: bool,

    /// List the laws, the joints, and the tasks with what they demand, without running them.
    #[arg(long)]
    list: bool,

    #[command(flatten)]
    all: All,

    /// Folder for leaderboard.csv, costs.csv, summary.json and report.html [default: out/laws].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    #[command(flatten)]
    pictures: Pictures,
}

/// Runs the laws, writes the files, prints the answer.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let plan = plan::plan(arguments)?;
    if arguments.list {
        return if as_json {
            print_json(&words::value())
        } else {
            print(&words::list())
        };
    }
    let out = arguments.out.as_deref().unwrap_or(Path::new("out/laws"));
    let claim = arguments.force.claim("laws", [""; 0]);
    let folder = studying::folder(out, claim, &["leaderboard.csv", "costs.csv"])?;
    // Fails before the work if the image cannot be built.
    let ladder = arguments.target.then(target::ladder).transpose()?;
    let mut study = laws::run(&plan, &mut Watch::new()).map_err(studying::failed)?;
    if let Some(mut ladder) = ladder {
        target::add(&mut study, &plan, &mut ladder)?;
    }
    let outcome = LawsOutcome::new(&study);
    studying::write(&outcome, (folder, out), &arguments.pictures)?;
    studying::show(&outcome, out, arguments.all, as_json)
}
