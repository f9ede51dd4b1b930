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
use crate::results::{self, Identity, REPORT, report_files};
use crate::sections::torque_levels;
use crate::wav::Wav;
use clap::Args;
use crepitus_files::output::{Claim, Folder};
use crepitus_pages::report::{Figures, Setup, Text};
use crepitus_pages::words::footer;
use crepitus_scene::shipped::Source;
use crepitus_scene::{Observer, Overrides, RunError, Scene, Summary, run as runner};
use std::io;
use std::path::{Path, PathBuf};
use watch::{EventsAlone, Watch, WatchError};

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
    let run = Run::new(arguments, as_json)?;
    let (reported, place) = if arguments.no_trace {
        run.events_alone()?
    } else {
        run.traced()?
    };
    // Another program was quicker.
    run.tell_if_elsewhere("is in", &run.out, &place);
    run.print(&reported, &place)
}

/// A run that is asked for: its scene, and where its files go.
struct Run<'a> {
    arguments: &'a Arguments,
    as_json: bool,
    scene: Scene,
    /// The folder that was asked for.
    wanted: PathBuf,
    /// The folder of the run: that one, or a free one beside it.
    out: PathBuf,
}

impl<'a> Run<'a> {
    fn new(arguments: &'a Arguments, as_json: bool) -> Result<Self, Failure> {
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
        let run = Self {
            arguments,
            as_json,
            scene,
            wanted,
            out,
        };
        run.tell_if_elsewhere("goes to", &run.wanted, &run.out);
        Ok(run)
    }

    /// Says that a run is in another folder than was expected.
    fn tell_if_elsewhere(&self, verb: &str, expected: &Path, place: &Path) {
        if place != expected && !self.as_json {
            to_stderr(&format!(
                "{} holds another run: this one {verb} {} (--force would replace it)",
                self.wanted.display(),
                place.display()
            ));
        }
    }

    /// Simulates for the events and the summary; returns where they are, too.
    fn events_alone(&self) -> Result<(Reported<Summary>, PathBuf), Failure> {
        let folder = results::folder(&self.out, self.claim(), ["events.csv", "summary.json"])?;
        interrupt::listen();
        let watch = EventsAlone::new(&folder, self.scene.duration_s);
        let mut watch = watch.map_err(|e| self.not_written(&e))?;
        let summary = self.simulate(&mut watch)?;
        watch.finish(&folder).map_err(|e| self.not_written(&e))?;
        let place = self.write(folder, vec![results::summary_file(&summary)?])?;
        let reported = Reported {
            summary,
            differences: Vec::new(),
            sound: None,
        };
        Ok((reported, place))
    }

    /// Simulates for the trace and the report, too, with what is compared and heard.
    fn traced(&self) -> Result<(Reported<Summary>, PathBuf), Failure> {
        let (scene, arguments) = (&self.scene, self.arguments);
        let columns = runner::columns(scene);
        let measured = arguments.overlay.read(&columns)?;
        let claim = self.claim();
        let (wav, force) = (&arguments.wav, arguments.force);
        let listener = wav.listener(&columns, scene.trace_step_s, force, &claim.inputs)?;
        let names = [&REPORT[..], &["trace.csv", "events.csv"]].concat();
        let folder = results::folder(&self.out, claim, names)?;
        interrupt::listen();
        let setup = Setup {
            columns: &columns,
            rows_expected: runner::rows(scene),
            row_step_s: scene.trace_step_s,
            levels: scene.crepitus.map(|c| torque_levels(&c.settings)),
            effects: scene.effect_settings(),
        };
        let watch = Watch::new(&folder, &setup, scene.duration_s, arguments.trace_every);
        let mut watch = watch.map_err(|e| self.not_written(&e))?;
        watch.compare(measured, &columns);
        watch.listen(listener);
        let summary = self.simulate(&mut watch)?;
        let listener = watch.listener();
        let figures = watch.finish(&folder);
        let mut figures = figures.map_err(|e| self.not_written(&e))?;
        if let Some(balance) = &summary.plant_energy {
            figures.set_balance(balance.clone());
        }
        let place = self.write(folder, self.files(&summary, &figures)?)?;
        let sound = listener.map(|listener| listener.finish(&scene.title));
        let sound = sound.transpose()?;
        let differences = figures.differences();
        overlay::warn_of_nothing(&differences, arguments.overlay.file());
        let reported = Reported {
            summary,
            differences,
            sound,
        };
        Ok((reported, place))
    }

    /// Runs the scene to its end; the summary has the program's commit and, if asked for, the
    /// costs of the effects.
    fn simulate<O: Observer<Error = WatchError>>(&self, watch: &mut O) -> Result<Summary, Failure> {
        let summary = crepitus_scene::run(&self.scene, watch);
        let mut summary = summary.map_err(|e| self.failure(e))?;
        summary.crepitus_commit = option_env!("CREPITUS_COMMIT");
        if self.arguments.costs {
            runner::measure_costs(&self.scene, &mut summary);
        }
        Ok(summary)
    }

    /// The failure of a run, for people.
    fn failure(&self, error: RunError<WatchError>) -> Failure {
        let file = self.scene.file.display();
        match error {
            RunError::Observer(WatchError::Write(e)) => self.not_written(&e),
            RunError::Observer(WatchError::Sound(failure)) => failure,
            RunError::Observer(WatchError::Interrupted) => Failure::interrupted(),
            RunError::Settings(e) => Failure::Input(format!("{file}: {e}")),
            RunError::Diverged(e) => Failure::Work(format!("{file}: {e}")),
            // `RunError` is non-exhaustive.
            _ => Failure::Work(format!("{file}: the run failed")),
        }
    }

    fn not_written(&self, error: &io::Error) -> Failure {
        Failure::at(&self.out, "writing the results", error)
    }

    /// Page, summary and pictures.
    fn files(&self, summary: &Summary, figures: &Figures) -> Result<results::Files, Failure> {
        let scene = &self.scene;
        let specs: Vec<_> = scene.effects().iter().map(|e| e.parameters).collect();
        let text = Text {
            title: scene.title.clone(),
            description: scene.description.clone(),
            warnings: summary.warnings.clone(),
            sections: tables::sections(summary, &specs),
            footer: footer(),
        };
        let page = crepitus_pages::report::html(&text, figures);
        let pictures = &self.arguments.pictures;
        let pictures = pictures.files(|paper| crepitus_pages::report::pictures(figures, paper))?;
        report_files(page, summary, pictures)
    }

    /// The claim of the run on its folder.
    fn claim(&self) -> Claim {
        let (named, overlay) = (&self.arguments.scene, self.arguments.overlay.file());
        let mut inputs = results::inputs(named, [&self.scene], overlay);
        // A summary is repeated bit for bit, also in its own folder.
        let folder = named.parent().unwrap_or(Path::new(""));
        if named.ends_with("summary.json") && !Identity::of(&self.scene).is_another_in(folder) {
            inputs.retain(|input| input != named);
        }
        self.arguments.force.claim("run", inputs)
    }

    /// Puts the files in place. Beside those of the same run, which are still true, or with
    /// `--force` in the place of another's.
    fn write(&self, folder: Folder, files: results::Files) -> Result<PathBuf, Failure> {
        let run = Identity::of(&self.scene);
        if !self.arguments.force.force {
            return run.write(folder, (&self.wanted, &self.out), files);
        }
        let is_replaced = run.is_another_in(&self.out);
        results::write(folder, &self.out, files)?;
        if is_replaced && self.arguments.no_trace {
            results::remove_others(&self.out, self.claim())?;
        }
        Ok(self.out.clone())
    }

    fn print(&self, reported: &Reported<Summary>, place: &Path) -> Result<(), Failure> {
        if self.as_json {
            return print_json(&reported.json(place));
        }
        let summary = &reported.summary;
        for warning in &summary.warnings {
            warn(warning);
        }
        let (what, file) = if self.arguments.no_trace {
            ("summary", "summary.json")
        } else {
            ("report", "report.html")
        };
        let brief = format!("{}\n{}\n", summary.title, tables::in_brief(summary));
        let text = reported.text(&brief, what, &place.join(file));
        self.arguments.wav.print(&text)
    }
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
