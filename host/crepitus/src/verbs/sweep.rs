//! `crepitus sweep SCENE --vary PATH=VALUES …`: many runs of a scene, a row each.

mod again;
mod estimate;
mod merge;
mod progress;
mod words;

use crate::cli::{Force, key_and_value, set_once};
use crate::failure::{Failure, print, print_json, warn};
use crate::interrupt;
use crate::results;
use clap::Args;
use crepitus_files::json_path;
use crepitus_scene::Overrides;
use crepitus_scene::shipped::Source;
use crepitus_studies::sweep::{
    Axis, Design, Format, Opening, Plan, Points, Recipe, Sampled, Shard, Store, StoreError,
    TableError, Written, run_all, totals, traced,
};
use progress::{End, Progress};
use serde_json::json;
use std::num::NonZero;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::thread::available_parallelism;
use std::time::Instant;

/// Run a scene many times with other values: a table with a row a run.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus sweep low-speed --vary effects.crepitus.static_torque_nm=1:4:lin7 \\
      --vary effects.crepitus.stiffness_nm_per_rad=20:200:log5
  crepitus sweep knee-pass-frozen --vary solver.kind=exact,exact-events,rk4 \\
      --vary solver.step_s=1e-5:1e-3:log9
  crepitus sweep everything --latin 1000 --seed 7 \\
      --vary effects.cuff.stiffness_nm_per_rad=30:300 \\
      --vary effects.limb.body_mass_kg=50:90
  crepitus sweep everything --sobol 4096 --vary …
  crepitus sweep low-speed --points saltelli.csv     # of another program
  crepitus sweep low-speed --vary … --estimate=1e7   # what that would cost
  crepitus sweep low-speed --vary … --shard 3/16     # a part, on any computer
  crepitus sweep --merge out/sweep-low-speed         # the table of all parts
  crepitus sweep --again out/sweep-low-speed         # the same once more

VALUES: FROM:TO:linN or FROM:TO:logN, N values with both ends; a list A,B,C; for --latin and --sobol \
FROM:TO, FROM:TO:log or a list. A grid runs every combination, the last --vary is the fastest.

The table (sweep.parquet, or sweep.csv) has the number of the point, what was varied, and every number of \
the run's summary, parameters under the path that they have in a scene. A run that fails is a row with its \
reason in the column `failure`. Rows do not depend on the number of cores. The same command goes on where \
it was stopped or killed.")]
pub(crate) struct Arguments {
    /// Scene file, name of a scene that ships, or summary.json of a run.
    #[arg(required_unless_present_any = ["merge", "again"], conflicts_with_all = ["merge", "again"])]
    scene: Option<PathBuf>,

    /// A key of the scene and its values; once for each that varies.
    #[arg(long, value_name = "PATH=VALUES")]
    vary: Vec<Axis>,

    /// Instead of a grid: N points of a Latin hypercube.
    #[arg(long, value_name = "N", conflicts_with_all = ["sobol", "points"])]
    latin: Option<u64>,

    /// Instead of a grid: N points of Sobol's sequence, best a power of two.
    #[arg(long, value_name = "N", conflicts_with = "points")]
    sobol: Option<u64>,

    /// Seed of --latin and --sobol [default: 0].
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,

    /// Instead of --vary: a CSV file with a PATH over each column and a point in each row.
    #[arg(long, value_name = "FILE", conflicts_with = "vary")]
    points: Option<PathBuf>,

    /// Set a key of the scene in every run.
    #[arg(long, value_name = "PATH=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,

    /// Render as the device does: input check, turn-back guard, slew and torque limits.
    #[arg(long)]
    as_device: bool,

    /// Folder of the table [default: out/sweep-SCENE].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    /// parquet or csv [default: parquet in programs that are built with it].
    #[arg(long, value_name = "FORMAT")]
    format: Option<Format>,

    /// Run part I of N; `--merge` makes the table when all are done.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,

    /// Also write the trace of each run, as traces/POINT.csv.
    #[arg(long)]
    traces: bool,

    /// Threads [default: all cores].
    #[arg(long, value_name = "N", value_parser = threads)]
    threads: Option<usize>,

    /// Run up to a thousand of the points for 5 s, write nothing, and say what the sweep would
    /// cost: all of it, or RUNS runs.
    #[arg(
        long,
        value_name = "RUNS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "all",
        conflicts_with_all = ["shard", "traces"]
    )]
    estimate: Option<Extent>,

    /// Make the table of a sweep that ran in parts, here or in several folders; it goes into the
    /// first.
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with_all = ["vary", "points", "latin", "sobol", "shard",
          "estimate", "out", "traces", "set", "as_device"])]
    merge: Option<Vec<PathBuf>>,

    /// Run the sweep of this folder again, from its sweep.json alone [default of --out: DIR-again].
    #[arg(long, value_name = "DIR", conflicts_with_all = ["vary", "points", "latin", "sobol", "seed", "set", "as_device",
          "merge", "estimate"])]
    again: Option<PathBuf>,
}

impl Arguments {
    /// Format of the table, unless another one is repeated.
    fn format(&self) -> Format {
        self.format.unwrap_or(Format::DEFAULT)
    }
}

/// Parses a number of threads.
fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) => Err("expected at least 1, got 0".to_owned()),
        Ok(threads) => Ok(threads),
        Err(_) => Err("expected a whole number, at least 1".to_owned()),
    }
}

/// Number of runs that are estimated.
#[derive(Clone, Copy, Debug)]
enum Extent {
    /// Those of the sweep.
    All,
    /// This many.
    Runs(u64),
}

/// `all`, or a number of runs, also as 1e7.
impl FromStr for Extent {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "all" {
            return Ok(Self::All);
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole and in range"
        )]
        match text.parse::<f64>() {
            Ok(x) if (1.0..=1e15).contains(&x) && x.fract() == 0.0 => Ok(Self::Runs(x as u64)),
            _ => Err("expected a number of runs, for example 10000000 or 1e7"),
        }
    }
}

/// Runs a sweep.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    if let Some(folders) = &arguments.merge {
        return merge::run(folders, arguments, as_json);
    }
    if let Some(folder) = &arguments.again {
        return again::run(folder, arguments, as_json);
    }
    let scene = arguments.scene.as_deref().unwrap_or(Path::new(""));
    let plan = plan(arguments, scene)?;
    interrupt::listen();
    if let Some(extent) = arguments.estimate {
        let runs = match extent {
            Extent::All => plan.runs(),
            Extent::Runs(runs) => runs,
        };
        let threads = arguments.threads.unwrap_or_else(cores);
        return estimate::run(&plan, runs, threads, as_json);
    }
    let out = match &arguments.out {
        Some(out) => out.clone(),
        None => results::named_after(scene, "sweep-", "")?,
    };
    let inputs = [scene.to_owned()]
        .into_iter()
        .chain(arguments.points.clone());
    let outcome = run_into(&out, &plan, arguments, inputs, arguments.format())?;
    outcome.print(&plan, &out, as_json)
}

/// Result of a command.
enum Outcome {
    /// Table, and the runs that it took.
    Table(Written, Option<Ran>),
    /// Parts of a shard.
    Shard(Box<Store>, Shard, Ran),
}

impl Outcome {
    fn print(&self, plan: &Plan, out: &Path, as_json: bool) -> Result<(), Failure> {
        match self {
            Self::Table(table, ran) => done(plan, table, ran.as_ref(), as_json),
            Self::Shard(store, shard, ran) => shard_done(store, *shard, out, ran, as_json),
        }
    }
}

/// Runs a plan, or the shard of it that is wanted, into a folder.
fn run_into(
    out: &Path,
    plan: &Plan,
    arguments: &Arguments,
    inputs: impl Iterator<Item = PathBuf>,
    format: Format,
) -> Result<Outcome, Failure> {
    let threads = arguments.threads.unwrap_or_else(cores);
    let inputs = plan.inputs().into_iter().chain(inputs);
    let opening = Opening {
        shard: arguments.shard.unwrap_or(Shard::WHOLE),
        format,
        traces: arguments.traces,
        claim: arguments.force.claim("sweep", inputs),
    };
    let commit = option_env!("CREPITUS_COMMIT");
    let recipe = Recipe::of(plan, commit);
    let store = Store::create(out, plan.identity(), &recipe, &opening);
    let mut store = store.map_err(store_failure)?;
    if let (Some(then), Some(now)) = (store.commit(), commit)
        && then != now
    {
        warn(format!(
            "the sweep in {} was begun by commit {then}, and this program is of {now}: its rows may differ",
            out.display()
        ));
    }
    if let Some(table) = store.table() {
        return Ok(Outcome::Table(table, None));
    }
    let points = arguments
        .shard
        .map_or(0..plan.runs(), |shard| shard.points(plan.runs()));
    let begun = Instant::now();
    let (runs, threads) = run_points(arguments, plan, points, threads, &mut store)?;
    let ran = Ran {
        runs,
        threads,
        wall_s: begun.elapsed().as_secs_f64(),
    };
    if let Some(shard) = arguments.shard {
        return Ok(Outcome::Shard(Box::new(store), shard, ran));
    }
    let table = table(&mut store, format, out)?;
    Ok(Outcome::Table(table, Some(ran)))
}

/// Runs of a sweep that this program has carried out.
struct Ran {
    runs: u64,
    threads: usize,
    wall_s: f64,
}

fn cores() -> usize {
    available_parallelism().map_or(1, NonZero::get)
}

fn plan(arguments: &Arguments, scene: &Path) -> Result<Plan, Failure> {
    set_once(&arguments.set)?;
    if arguments.seed.is_some() && arguments.latin.is_none() && arguments.sobol.is_none() {
        return Err(Failure::input(
            "--seed: only --latin and --sobol draw their points: leave it out",
        ));
    }
    let overrides = Overrides {
        as_device: arguments.as_device,
        set: arguments.set.clone(),
        ..Overrides::default()
    };
    let source = Source::find(scene)?;
    let sampled = |count| Sampled {
        axes: arguments.vary.clone(),
        count,
        seed: arguments.seed.unwrap_or(0),
    };
    let design = match (arguments.latin, arguments.sobol, &arguments.points) {
        (Some(count), _, _) => Design::latin_hypercube(sampled(count)),
        (_, Some(count), _) => Design::sobol(sampled(count)),
        (_, _, Some(file)) => Points::read(file)
            .map(Design::Listed)
            .map_err(|e| Failure::Input(format!("{}: {e}", file.display())))
            .map(Ok)?,
        _ => Design::grid(arguments.vary.clone()),
    };
    let design = design.map_err(Failure::input)?;
    let varied = design.paths();
    if let Some((path, _)) =
        (arguments.set.iter()).find(|(path, _)| varied.contains(&path.as_str()))
    {
        return Err(Failure::Input(format!(
            "--set {path}: it is varied, too: leave one of the two out"
        )));
    }
    Ok(Plan::new(source, overrides, design)?)
}

/// Runs what has no row yet of these points; how many that were, and on how many threads.
fn run_points(
    arguments: &Arguments,
    plan: &Plan,
    points: Range<u64>,
    threads: usize,
    store: &mut Store,
) -> Result<(u64, usize), Failure> {
    let missing = store.missing(points).map_err(store_failure)?;
    let wanted: u64 = missing.iter().map(|range| range.end - range.start).sum();
    let traces = if arguments.traces {
        Some(store.traces(&missing).map_err(store_failure)?)
    } else {
        None
    };
    let mut progress = Progress::new(store, wanted);
    let threads = plan.threads(threads);
    let outcome = run_all(missing, threads, &mut progress, |mut points, stop, give| {
        let Some(traces) = &traces else {
            return totals(plan, points, stop, give);
        };
        points.try_for_each(|point| {
            give(traced(plan, point, traces, stop)?);
            Ok(())
        })
    });
    let ran = progress.finish().map_err(store_failure)?;
    match outcome {
        Ok(threads) => Ok((ran, threads)),
        Err(End::Interrupted) => Err(Failure::Work(format!(
            "interrupted after {ran} of {wanted} runs: the same command goes on from there"
        ))),
        Err(End::Store(e)) => Err(store_failure(e)),
        Err(End::NoThread(e)) => Err(no_thread(&e)),
        Err(End::Trace(e)) => Err(Failure::Work(format!(
            "a trace cannot be written after {ran} of {wanted} runs: {e}: the same command goes on from there"
        ))),
    }
}

/// The system gives not even one thread.
fn no_thread(error: &std::io::Error) -> Failure {
    Failure::Work(format!(
        "no thread can be started: {error}: end other programs, or raise this one's limits"
    ))
}

/// Makes the table.
fn table(store: &mut Store, format: Format, out: &Path) -> Result<Written, Failure> {
    let mut bar = crate::progress::Progress::of_table();
    let mut poll = |share| {
        bar.reached(share);
        !interrupt::requested()
    };
    store.finish(format, &mut poll).map_err(|e| match e {
        TableError::Io(e) if e.kind() == std::io::ErrorKind::Interrupted => Failure::Work(
            "interrupted: all rows are there, and the same command makes the table".to_owned(),
        ),
        TableError::Io(e) => Failure::at(out, "writing the table", &e),
        TableError::Output(e) => e.into(),
        e => Failure::Work(format!("{}: {e}", out.display())),
    })
}

fn store_failure(error: StoreError) -> Failure {
    match error {
        StoreError::Io { path, error } => Failure::at(&path, "the rows of a sweep", &error),
        StoreError::Another { .. } | StoreError::Unreadable { .. } => Failure::Input(format!(
            "{error}: name another folder with --out, or replace it with --force"
        )),
        StoreError::Output(error) => error.into(),
        StoreError::Scene(error) => error.into(),
        StoreError::Running { .. } => Failure::Input(format!(
            "{error}: wait until it has ended, or name another folder with --out"
        )),
        error => Failure::input(error),
    }
}

fn done(plan: &Plan, table: &Written, ran: Option<&Ran>, as_json: bool) -> Result<(), Failure> {
    if as_json {
        return print_json(&json!({
            "table": json_path(&table.file),
            "bytes": table.bytes,
            "runs": plan.runs(),
            "failed": table.failed,
            "ran": ran.map_or(0, |r| r.runs),
            "wall_s": ran.map(|r| r.wall_s),
            "threads": ran.map(|r| r.threads),
            "sweep": plan.identity(),
        }));
    }
    warn_of_failed(table, plan.runs());
    let what = match ran {
        None => format!("{} runs: this sweep is complete already", plan.runs()),
        Some(ran) => words::ran(plan.runs(), ran),
    };
    let size = words::size(table.bytes);
    print(&format!(
        "{what}\ntable: {} ({size})\n",
        table.file.display()
    ))
}

/// Warns of failed runs, and of points that several programs have run.
fn warn_of_failed(table: &Written, runs: u64) {
    if table.failed > 0 {
        warn(format!(
            "{} of {runs} runs failed: the column `failure` says why",
            table.failed
        ));
    }
    if table.doubled > 0 {
        warn(format!(
            "{} points are in two parts each, with the same rows: each is in the table once",
            table.doubled
        ));
    }
}

fn shard_done(
    store: &Store,
    shard: Shard,
    out: &Path,
    ran: &Ran,
    as_json: bool,
) -> Result<(), Failure> {
    let runs = store.identity().runs;
    let missing = store.missing(0..runs).map_err(store_failure)?;
    let missing: u64 = missing.iter().map(|range| range.end - range.start).sum();
    let of_shard = shard.points(runs);
    if as_json {
        return print_json(&json!({
            "out": json_path(out),
            "points": [of_shard.start, of_shard.end],
            "ran": ran.runs,
            "missing": missing,
            "wall_s": ran.wall_s,
            "threads": ran.threads,
            "sweep": store.identity(),
        }));
    }
    let rest = if missing == 0 {
        "all parts are here".to_owned()
    } else {
        format!("{missing} runs of other parts are not in this folder yet")
    };
    print(&format!(
        "{}\n{rest}\nthe table: crepitus sweep --merge {}\n",
        words::ran(of_shard.end - of_shard.start, ran),
        out.display()
    ))
}
