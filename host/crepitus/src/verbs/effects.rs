//! `crepitus effects`: what effects there are; what each effect of a scene
//! does to the torque at the hand and what it costs; the fewest that will do.

mod list;

use crate::cli::{Force, key_and_value, set_once};
use crate::failure::{Failure, print, print_json};
use crate::pictures::Pictures;
use crate::results;
use crate::screen::All;
use crate::studying::{self, Watch};
use clap::Args;
use crepitus_scene::{Overrides, Scene, SceneError, instructions, shipped};
use crepitus_studies::effects::{
    EffectsError, Plan, Refusal, Tolerance, price, refusal, run as study_effects,
};
use std::path::{Path, PathBuf};

/// List the effects; or show what each effect of a scene does and costs.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus effects
  crepitus effects slow-examination
  crepitus effects my-scene.toml --tolerance torque=5e-3
  crepitus effects my-scene.toml --tolerance torque=0.02,events=0.01 \\
      --set duration_s=2

Without a SCENE all effects are listed, with --all their parameters, too. With one, each of its effects is \
left out in turn and each absent one added: how much that changes the torque at the hand (RMS, \
peak, three bands of frequency, number of events), and what it costs (time of a step, its instructions where valgrind is there, states). The answer comes first.

A TOLERANCE is a list of limits: torque (rms difference of the torque at the hand, N·m), peak \
(largest difference, N·m), events (relative difference of the number of events). The answer is \
the smallest set of the scene's effects that stays within all of them; sets are tried \
from small to large until one does.")]
pub(crate) struct Arguments {
    /// Scene file, or name of a scene that ships.
    scene: Option<PathBuf>,

    /// Folder for effects.csv, summary.json and report.html [default: out/SCENE-effects].
    #[arg(long, value_name = "DIR", requires = "scene")]
    out: Option<PathBuf>,

    /// Which effects are enough to stay this near to the whole scene? For example torque=5e-3.
    #[arg(long, value_name = "TOLERANCE", requires = "scene")]
    tolerance: Option<String>,

    /// Set a key of the scene.
    #[arg(long, value_name = "PATH=VALUE", value_parser = key_and_value, requires = "scene")]
    set: Vec<(String, String)>,

    #[command(flatten)]
    all: All,

    #[command(flatten)]
    force: Force,

    #[command(flatten)]
    pictures: Pictures,
}

/// Lists the effects, or studies those of a scene.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let Some(path) = &arguments.scene else {
        if arguments.pictures.wanted() {
            return Err(Failure::input(
                "--pictures needs a SCENE: a list of effects has no figures",
            ));
        }
        return if as_json {
            print_json(&list::values())
        } else {
            print(&list::text(arguments.all))
        };
    };
    let plan = plan(arguments, path)?;
    if instructions::is_counted() {
        instructions::run_counted(&price::to_count(&plan.scene), price::STEPS);
        return Ok(());
    }
    let out = match &arguments.out {
        Some(out) => out.clone(),
        None => results::named_after(&plan.scene.file, "", "-effects")?,
    };
    let inputs = results::inputs(path, [&plan.scene], None);
    let claim = arguments.force.claim("effects", inputs);
    let folder = studying::folder(&out, claim, &["effects.csv"])?;
    let mut study = study_effects(&plan, &mut Watch::new()).map_err(|e| failed(&plan.scene, e))?;
    let count = price::to_count(&plan.scene).len();
    if let Some(counts) = studying::counted((count, price::STEPS)) {
        study.price(&plan.scene, &counts);
    }
    studying::write(&study, (folder, &out), &arguments.pictures)?;
    studying::show(&study, &out, arguments.all, as_json)
}

fn plan(arguments: &Arguments, path: &Path) -> Result<Plan, Failure> {
    let tolerance = arguments
        .tolerance
        .as_deref()
        .map(str::parse::<Tolerance>)
        .transpose()
        .map_err(|e| Failure::Input(format!("--tolerance: {e}")))?;
    set_once(&arguments.set)?;
    let overrides = Overrides {
        set: arguments.set.clone(),
        ..Overrides::default()
    };
    let scene = shipped::scene(path, &overrides)?;
    match refusal(&scene) {
        Some(refused) => Err(refuse(&scene, refused)),
        None => Ok(Plan { scene, tolerance }),
    }
}

/// A refusal in the form of a scene's own errors.
fn refuse(scene: &Scene, refusal: Refusal) -> Failure {
    Failure::input(SceneError {
        file: scene.file.clone(),
        origin: None,
        key: refusal.key().to_owned(),
        message: refusal.to_string(),
    })
}

fn failed(scene: &Scene, error: EffectsError) -> Failure {
    match error {
        EffectsError::Cancelled(_) => Failure::interrupted(),
        EffectsError::Refused(refusal) => refuse(scene, refusal),
        other => Failure::Work(format!("{}: {other}", scene.file.display())),
    }
}
