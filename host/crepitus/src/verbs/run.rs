//! `crepitus run SCENE`: simulates a scene, writes its files, prints a summary.

mod plant;
mod tables;
mod watch;

use crate::cli::{Force, key_and_value, set_once};
use crate::failure::{Failure, print_json, warn};
use crate::interrupt;
use crate::output::to_stderr;
use crate::overlay::{self, Overlay};
use crate::pictures::Pictures;
use crate::reported::Reported;
use crate::results::{self, Identity, REPORT, footer, report_files};
use crate::sections::torque_levels;
use crate::wav::Wav;
use clap::Args;
use crepitus_files::output::{Claim, Folder};
use crepitus_pages::report::{Setup, Text};
use crepitus_scene::shipped::Source;
use crepitus_scene::{Overrides, RunError, Scene, Summary, run as runner};
use std::path::{Path, PathBuf};
use watch::{Watch, WatchError};

/// Simulate a scene and write its trace, events, summary and report.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus run scenes/fig6-ideal-cycle.toml
  crepitus run slow-examination --out /tmp/exam --solver exact --step 1e-3
  crepitus run high-speed --set effects.crepitus.preset=fine \\
      --set duration_s=2
  crepitus run passive-examination --as-device
  crepitus run fig8 --wav knee.wav --wav-of hand
  crepitus run fig8 --overlay bench.csv \\
      --overlay-columns t_s=time,hand_torque_nm=M
  crepitus run out/high-speed/summary.json

SCENE is a file, the name of a scene that ships, or the summary.json of a run, which is repeated bit \
for bit. Any key of the scene can be \
set: PATH is its name with the tables before it, VALUE is written as in the file.")]
pub(crate) struct Arguments {
    /// Scene file, name of a scene that ships, or summary.json of a run.
    scene: PathBuf,

    /// Folder for trace.csv, events.csv, summary.json and report.html [default: out/SCENE]. If
    /// another run is there: DIR-2, DIR-3, …
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    force: Force,

    /// Time each effect, and write its cost into summary and report.
    #[arg(long)]
    costs: bool,

    /// Write summary.json and events.csv alone: no trace, no report.
    #[arg(long, conflicts_with_all = ["Pictures", "Overlay", "Wav", "trace_every"])]
    no_trace: bool,

    /// Another solver: exact, exact-events, reference, … (a wrong name lists them all).
    #[arg(long, value_name = "KIND")]
    solver: Option<String>,

    /// Another solver step, in seconds.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    step: Option<String>,

    /// Another precision: f32 or f64.
    #[arg(long, value_name = "PRECISION")]
    precision: Option<String>,

    /// Render as the device does: input check, turn-back guard, slew and torque limits.
    #[arg(long)]
    as_device: bool,

    /// Set a key of the scene.
    #[arg(long, value_name = "PATH=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,

    #[command(flatten)]
    pictures: Pictures,

    #[command(flatten)]
    overlay: Overlay,

    #[command(flatten)]
    wav: Wav,

    /// Write only every Nth row of the trace.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    trace_every: u64,
}

/// Runs a scene.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let scene = read(arguments)?;
    let wanted = match &arguments.out {
        Some(out) => out.clone(),
        None => results::named_after(&scene.file, "", "")?,
    };
    arguments.wav.check_stdout(as_json)?;
    let out = if arguments.force.force {
        wanted.clone()
    } else {
        Identity::of(&scene).free_folder(&wanted)?
    };
    let tell = |verb: &str, out: &Path| {
        if !as_json {
            to_stderr(&format!(
                "{} holds another run: this one {verb} {} (--force would replace it)",
                wanted.display(),
                out.display()
            ));
        }
    };
    if out != wanted {
        tell("goes to", &out);
    }
    let (reported, place) = simulate(&scene, (&wanted, &out), arguments)?;
    // Another program was quicker.
    if place != out {
        tell("is in", &place);
    }
    let out = place;
    if as_json {
        return print_json(&reported.json(&out));
    }
    let summary = &reported.summary;
    for warning in &summary.warnings {
        warn(warning);
    }
    let (what, file) = if arguments.no_trace {
        ("summary", "summary.json")
    } else {
        ("report", "report.html")
    };
    let brief = format!("{}\n{}\n", summary.title, tables::in_brief(summary));
    let text = reported.text(&brief, what, &out.join(file));
    arguments.wav.print(&text)
}

/// The scene that the arguments name, with their overrides.
fn read(arguments: &Arguments) -> Result<Scene, Failure> {
    set_once(&arguments.set)?;
    let overrides = Overrides {
        solver: arguments.solver.clone(),
        step: arguments.step.clone(),
        precision: arguments.precision.clone(),
        as_device: arguments.as_device,
        set: arguments.set.clone(),
    };
    let source = Source::find(&arguments.scene)?;
    let mut scene = source.scene(&overrides)?;
    let now = option_env!("CREPITUS_COMMIT");
    if let (Some(then), Some(now)) = (source.commit(), now)
        && then != now
    {
        scene.warnings.push(format!(
            "the run that is repeated was of commit {then}, and this program is of {now}: its numbers may differ"
        ));
    }
    Ok(scene)
}

/// The failure of a run, for people.
fn failure(scene: &Scene, out: &Path, error: RunError<WatchError>) -> Failure {
    let file = scene.file.display();
    match error {
        RunError::Observer(WatchError::Write(e)) => Failure::at(out, "writing the results", &e),
        RunError::Observer(WatchError::Sound(failure)) => failure,
        RunError::Observer(WatchError::Interrupted) => Failure::interrupted(),
        RunError::Settings(e) => Failure::Input(format!("{file}: {e}")),
        RunError::Diverged(e) => Failure::Work(format!("{file}: {e}")),
        // `RunError` is non-exhaustive.
        _ => Failure::Work(format!("{file}: the run failed")),
    }
}

/// Adds to a run's summary the program's commit and, if asked for, the costs of its effects.
fn completed(mut summary: Summary, scene: &Scene, arguments: &Arguments) -> Summary {
    summary.crepitus_commit = option_env!("CREPITUS_COMMIT");
    if arguments.costs {
        runner::measure_costs(scene, &mut summary);
    }
    summary
}

/// Runs the scene and writes its files; returns where they are, too.
fn simulate(
    scene: &Scene,
    (wanted, out): (&Path, &Path),
    arguments: &Arguments,
) -> Result<(Reported<Summary>, PathBuf), Failure> {
    let columns = runner::columns(scene);
    let measured = arguments.overlay.read(&columns)?;
    let claim = claim(scene, arguments);
    let listener =
        (arguments.wav).listener(&columns, scene.trace_step_s, arguments.force, &claim.inputs)?;
    let failed = |e: &std::io::Error| Failure::at(out, "writing the results", e);
    let folder = if arguments.no_trace {
        results::folder(out, claim.clone(), ["events.csv", "summary.json"])?
    } else {
        let names = [&REPORT[..], &["trace.csv", "events.csv"]].concat();
        results::folder(out, claim.clone(), names)?
    };
    interrupt::listen();
    let failed_run = |e| failure(scene, out, e);
    if arguments.no_trace {
        let mut watch =
            watch::EventsAlone::new(&folder, scene.duration_s).map_err(|e| failed(&e))?;
        let summary = crepitus_scene::run(scene, &mut watch).map_err(failed_run)?;
        let summary = completed(summary, scene, arguments);
        watch.finish(&folder).map_err(|e| failed(&e))?;
        let files = vec![results::summary_file(&summary)?];
        let out = write(scene, folder, (wanted, out), files, arguments)?;
        let reported = Reported {
            summary,
            differences: Vec::new(),
            sound: None,
        };
        return Ok((reported, out));
    }
    let setup = Setup {
        columns: &columns,
        rows_expected: runner::rows(scene),
        row_step_s: scene.trace_step_s,
        levels: scene.crepitus.map(|c| torque_levels(&c.settings)),
        effects: scene.effect_settings(),
    };
    let mut watch = Watch::new(&folder, &setup, scene.duration_s, arguments.trace_every)
        .map_err(|e| failed(&e))?;
    watch.compare(measured, &columns);
    watch.listen(listener);
    let summary = crepitus_scene::run(scene, &mut watch).map_err(failed_run)?;
    let summary = completed(summary, scene, arguments);
    let listener = watch.listener();
    let mut figures = watch.finish(&folder).map_err(|e| failed(&e))?;
    if let Some(balance) = plant::balance(&summary) {
        figures.set_balance(balance);
    }
    let specs: Vec<_> = scene.effects().iter().map(|e| e.parameters).collect();
    let text = Text {
        title: scene.title.clone(),
        description: scene.description.clone(),
        warnings: summary.warnings.clone(),
        sections: tables::sections(&summary, &specs),
        footer: footer(),
    };
    let page = crepitus_pages::report::html(&text, &figures);
    let pictures = arguments
        .pictures
        .files(|paper| crepitus_pages::report::pictures(&figures, paper))?;
    let files = report_files(page, &summary, pictures)?;
    let out = write(scene, folder, (wanted, out), files, arguments)?;
    let sound = listener
        .map(|listener| listener.finish(&scene.title))
        .transpose()?;
    let differences = figures.differences();
    overlay::warn_of_nothing(&differences, arguments.overlay.file());
    let reported = Reported {
        summary,
        differences,
        sound,
    };
    Ok((reported, out))
}

/// The claim of a run on its folder.
fn claim(scene: &Scene, arguments: &Arguments) -> Claim {
    let overlay = arguments.overlay.file();
    let mut inputs = results::inputs(&arguments.scene, [scene], overlay);
    // A summary is repeated bit for bit, also in its own folder.
    let folder = arguments.scene.parent().unwrap_or(Path::new(""));
    if arguments.scene.ends_with("summary.json") && !Identity::of(scene).is_another_in(folder) {
        inputs.retain(|input| *input != arguments.scene);
    }
    arguments.force.claim("run", inputs)
}

/// Puts the files in place. Beside those of the same run, which are still true, or with
/// `--force` in the place of another's.
fn write(
    scene: &Scene,
    folder: Folder,
    (wanted, out): (&Path, &Path),
    files: results::Files,
    arguments: &Arguments,
) -> Result<PathBuf, Failure> {
    let run = Identity::of(scene);
    if !arguments.force.force {
        return run.write(folder, (wanted, out), files);
    }
    let is_replaced = run.is_another_in(out);
    results::write(folder, out, files)?;
    if is_replaced && arguments.no_trace {
        results::remove_others(out, claim(scene, arguments))?;
    }
    Ok(out.to_owned())
}
