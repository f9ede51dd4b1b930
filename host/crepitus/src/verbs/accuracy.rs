//! `crepitus accuracy`: what accuracy costs in time, and the cheapest solver
//! that is accurate enough, on the host or on the target.

mod plan;
pub(super) mod target;

use crate::cli::Force;
use crate::failure::{Failure, print, print_json};
use crate::pictures::Pictures;
use crate::screen::All;
use crate::studying::{self, Watch};
use clap::Args;
use crepitus_files::json_path;
use crepitus_scene::cpu_time::CLOCK;
use crepitus_scene::instructions;
use crepitus_studies::accuracy::symptoms::SymptomPlan;
use crepitus_studies::accuracy::{
    self, AccuracyOutcome, Need, Question, Study, convergence, need_words, price, study,
};
use plan::Studied;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Show what accuracy costs in time: every solver against the reference.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus accuracy --quick
  crepitus accuracy --quick --target
  crepitus accuracy --scene slow-examination --out /tmp/accuracy
  crepitus accuracy --need torque=1e-2,interval=5e-4 --rate 20000
  crepitus accuracy --need torque=1e-2 --target
  crepitus accuracy --need frequency=1e-6 --convention physical \\
      --precision f64

The answer comes first, --all prints every table. Every solver, in f32 and f64 and at steps from 1 ms to 2 µs, is compared with the reference \
on four constant speeds, a hand-like sine, strokes and knee bends, the last two on the joint of every crepitus preset, and \
timed on this machine in CPU time (median and quartiles), their instructions counted where valgrind is there; in f32 also behind the device's encoder. So is every other symptom, \
on strokes, a steady movement and a tremor, timed beside a step of crepitus. With --target it is also \
run on an emulated STM32F405: modelled cycles, 0 wait states; not measured on hardware. The worst \
cycles are the worst observed, over inputs with breaks, matches and reversals.

A NEED is a list of limits that must hold on every speed and the sine of the paper's joint, or on --scene: torque (rms error of the torque as the \
device holds it for a step, over continuous time, N·m), peak-torque (the largest such error, N·m), \
torque-at-tick and peak-torque-at-tick (the same at the ends of steps alone, N·m), event (worst event-time error, s), interval (worst \
interval error, s), frequency (relative error of the cycle frequency). The answer is the \
cheapest solver that meets them on this host; with --target the one with the fewest mean cycles on \
the target at its tick of 50 µs in f32, equal means decided by the worst, whose worst step fits a \
fifth of the tick. Where none does the exit code is 1. With --need, files are written only if --out \
is given.")]
pub(crate) struct Arguments {
    /// Study the motion and the crepitus of this scene instead: a file, or the name of one that
    /// ships. Its solver and its encoder are ignored.
    #[arg(long, value_name = "SCENE")]
    scene: Option<PathBuf>,

    /// Folder for points.csv, symptoms.csv, summary.json and report.html [default: out/accuracy].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Fewer steps and repeats: seconds instead of minutes.
    #[arg(long)]
    quick: bool,

    /// Also run every solver, and every effect of the device, on an emulated STM32F405: cycles and
    /// instructions of a step. Builds firmware/ladder, unless CREPITUS_IMAGES names a folder with
    /// it. With --need these cycles choose.
    #[arg(long)]
    target: bool,

    #[command(flatten)]
    all: All,

    #[command(flatten)]
    force: Force,

    #[command(flatten)]
    pictures: Pictures,

    /// Which solver is the cheapest that is accurate enough? For example torque=1e-2,interval=5e-4.
    #[arg(long, value_name = "NEED")]
    need: Option<String>,

    /// Only steps of this rate, in Hz: that of the device is 20000.
    #[arg(
        long,
        value_name = "HZ",
        requires = "need",
        allow_negative_numbers = true
    )]
    rate: Option<f64>,

    /// The convention that the need is for [default: frozen, or that of the scene].
    #[arg(long, value_name = "CONVENTION", requires = "need")]
    convention: Option<String>,

    /// The precision that the need is for: the device computes in f32.
    #[arg(long, value_name = "PRECISION", requires = "need", default_value = "f32",
          value_parser = ["f32", "f64"])]
    precision: String,

    /// Other steps, in seconds.
    #[arg(long, value_name = "SECONDS,…", value_delimiter = ',', hide = true)]
    steps: Vec<f64>,
}

/// Studies, and writes the files or answers the need.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let need = arguments
        .need
        .as_deref()
        .map(str::parse::<Need>)
        .transpose()
        .map_err(|e| Failure::Input(format!("--need: {e}")))?;
    let studied = plan::plan(arguments)?;
    if instructions::is_counted() {
        return price::run_counted(&studied.plan).map_err(|e| Failure::Work(e.to_string()));
    }
    let out = match (&arguments.out, &need) {
        (Some(out), _) => Some(out.clone()),
        (None, None) => Some(PathBuf::from("out/accuracy")),
        (None, Some(_)) => None,
    };
    let is_whole = arguments.scene.is_none() && need.is_none();
    let prepare = |out: &Path| {
        let claim = arguments.force.claim("accuracy", &arguments.scene);
        let tables = [
            Some("points.csv"),
            is_whole.then_some("symptoms.csv"),
            arguments.target.then_some("cycles.csv"),
        ];
        let tables: Vec<&str> = tables.into_iter().flatten().collect();
        studying::folder(out, claim, &tables)
    };
    let folder = out.as_deref().map(prepare).transpose()?;
    // Fails before the work if the image cannot be built.
    let ladder = arguments.target.then(target::ladder).transpose()?;
    let mut study = study::run(&studied.plan, &mut Watch::new()).map_err(studying::failed)?;
    if need.is_none()
        && let Some(counts) = studying::counted((price::count(&studied.plan), price::STEPS))
    {
        study.price(&studied.plan, &counts);
    }
    if let Some(mut ladder) = ladder {
        let scenes = &studied.plan.scenes;
        target::add(&mut study, scenes, arguments.quick, &mut ladder)?;
    }
    if is_whole {
        let plan = SymptomPlan {
            steps_s: &studied.plan.steps_s,
            precisions: &studied.plan.precisions,
            repeats: studied.plan.repeats,
        };
        study.symptoms =
            accuracy::symptoms::points(&plan, &mut Watch::new()).map_err(studying::failed)?;
        study.actuator = accuracy::actuator::points(plan.repeats, &mut Watch::new())
            .map_err(studying::failed)?;
    }
    let by_motion = if is_whole {
        convergence::motions().and_then(|motions| convergence::orders_on(&motions))
    } else {
        Ok(Vec::new())
    };
    let by_motion =
        by_motion.map_err(|e| Failure::Work(format!("the orders cannot be measured: {e}")))?;
    study.orders.extend_from_slice(&by_motion);
    let outcome = AccuracyOutcome {
        study: &study,
        by_motion: &by_motion,
        precisions: &studied.plan.precisions,
        is_quick: arguments.quick,
    };
    if let Some(place) = folder.zip(out.as_deref()) {
        studying::write(&outcome, place, &arguments.pictures)?;
    }
    if let Some(need) = &need {
        let how = (arguments.all, as_json);
        return answer(need, &studied, &study, out.as_deref(), how);
    }
    let out = out.unwrap_or_default();
    studying::show(&outcome, &out, arguments.all, as_json)
}

/// Prints the answer to a need; fails if nothing meets it.
fn answer(
    need: &Need,
    studied: &Studied,
    study: &Study,
    out: Option<&Path>,
    (all, as_json): (All, bool),
) -> Result<(), Failure> {
    let question = Question {
        convention: studied.convention.name(),
        precision: studied.precision.name(),
        step_s: studied.step_s,
        target: study.target.as_ref(),
    };
    let answer = accuracy::answer(&study.points, need, &question);
    if as_json {
        print_json(&json!({
            "need": need, "question": question, "answer": answer, "out": out.map(json_path),
            "chosen_by": if question.target.is_some() { "target cycles" } else { CLOCK },
        }))?;
    } else {
        let text = need_words::in_words(need, &question, study, &answer);
        print(&all.limited(&text))?;
    }
    if answer.chosen.is_some() {
        Ok(())
    } else {
        Err(Failure::Negative)
    }
}
