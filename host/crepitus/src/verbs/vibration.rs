//! `crepitus vibration`: what the hand gets of the grating, at each step of the chain
//! from a bare knee to the actuator on the shell.

use crate::cli::{Force, key_and_value, set_once};
use crate::failure::Failure;
use crate::pictures::Pictures;
use crate::results;
use crate::screen::All;
use crate::studying::{self, Watch};
use clap::{Args, value_parser};
use crepitus_scene::scene::MotionKind;
use crepitus_scene::shipped;
use crepitus_scene::{Overrides, Scene};
use crepitus_studies::vibration::{Plan, VibrationError, run as study_vibration};
use std::path::{Path, PathBuf};

/// Show what the hand gets of the grating, with the actuator on the shell and without.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus vibration
  crepitus vibration --speeds 0.1,1 --draws 200
  crepitus vibration my-scene.toml --set effects.vibration-actuator.gain=0.09

The scene needs a hand that grips a shell with an actuator: crepitus scenes fig8-6-actuator is one. \
Compared are a bare diseased knee, the motor alone, the actuator, a bone's ringing on it, the \
actuator on the brace, and the hand on the leg beside the shell: acceleration of the palm from 15 \
to 500 Hz, its level above the threshold of perception (known to 10 dB), the share of T/r that a \
shell gets which is held, correlation and lag with the bare knee, and what the coil does. \
Below are the margins of the loop that the actuator closes over the encoder.

With --draws everything is up to 30 % off at once, that often.")]
pub(crate) struct Arguments {
    /// Scene file, or name of a scene that ships.
    #[arg(default_value = "fig8-6-actuator")]
    scene: PathBuf,

    /// Speeds of the motion, rad/s; of a scene whose motion is constant [default: 0.1,0.5,1].
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    speeds: Option<Vec<f64>>,

    /// Number of draws in which all numbers are off at once.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = value_parser!(u32).range(..=MOST_DRAWS))]
    draws: u32,

    /// Folder for summary.json and report.html [default: out/SCENE-vibration].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Set a key of the scene.
    #[arg(long, value_name = "PATH=VALUE", value_parser = key_and_value)]
    set: Vec<(String, String)>,

    #[command(flatten)]
    force: Force,

    #[command(flatten)]
    pictures: Pictures,
}

/// The most draws: a study of days.
const MOST_DRAWS: i64 = 1_000_000;

/// Speeds without `--speeds`, rad/s.
const SPEEDS: [f64; 3] = [0.1, 0.5, 1.0];

/// Keys of a constant motion that a run at a speed sets.
const OF_SPEED: [&str; 3] = ["motion.velocity_rad_s", "motion.from_deg", "duration_s"];

/// The way of the joint in a run, rad, and the longest that one takes, s.
const WAY_RAD: f64 = 1.4;
const LONGEST_S: f64 = 4.0;

/// Studies a scene.
pub(crate) fn run(arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let plan = Plan {
        scenes: scenes(arguments)?,
        draws: usize::try_from(arguments.draws).unwrap_or(usize::MAX),
    };
    let out = arguments.out.clone().unwrap_or_else(|| out(&plan));
    let inputs = results::inputs(&arguments.scene, &plan.scenes, None);
    let claim = arguments.force.claim("vibration", inputs);
    let folder = studying::folder(&out, claim, &[])?;
    let study = study_vibration(&plan, &mut Watch::new()).map_err(failed)?;
    studying::write(&study, (folder, &out), &arguments.pictures)?;
    studying::show(&study, &out, All { all: true }, as_json)
}

/// The scene at each speed, over the same way.
fn scenes(arguments: &Arguments) -> Result<Vec<Scene>, Failure> {
    set_once(&arguments.set)?;
    let read = |set: &[(String, String)]| -> Result<Scene, Failure> {
        let overrides = Overrides {
            set: [&arguments.set[..], set].concat(),
            ..Overrides::default()
        };
        Ok(shipped::scene(&arguments.scene, &overrides)?)
    };
    let as_it_is = read(&[])?;
    if as_it_is.motion_kind != MotionKind::Constant {
        if arguments.speeds.is_some() {
            return Err(Failure::Input(format!(
                "--speeds: the motion of {} is not constant and has its own speed; leave --speeds out",
                arguments.scene.display()
            )));
        }
        return Ok(vec![as_it_is]);
    }
    if let Some((key, _)) = (arguments.set.iter()).find(|(key, _)| OF_SPEED.contains(&key.as_str()))
    {
        return Err(Failure::Input(format!(
            "--set {key}: a constant motion is run at each speed of --speeds, from 20° over {WAY_RAD} rad, for \
             {LONGEST_S} s at most; use --speeds"
        )));
    }
    let at = |speed: &f64| {
        if !(speed.is_finite() && *speed > 0.0) {
            return Err(Failure::Input(format!(
                "--speeds: {speed} is no speed; give rad/s above 0"
            )));
        }
        let duration_s = (WAY_RAD / speed).min(LONGEST_S);
        let values = [
            format!("{speed:?}"),
            "20.0".to_owned(),
            format!("{duration_s:?}"),
        ];
        let set: Vec<_> = OF_SPEED
            .map(str::to_owned)
            .into_iter()
            .zip(values)
            .collect();
        read(&set)
    };
    let speeds = arguments.speeds.as_deref().unwrap_or(&SPEEDS);
    speeds.iter().map(at).collect()
}

/// `out/<scene>-vibration`.
fn out(plan: &Plan) -> PathBuf {
    let file = plan.scenes.first().map(|scene| scene.file.clone());
    let mut name = file
        .unwrap_or_default()
        .file_stem()
        .unwrap_or_default()
        .to_owned();
    name.push("-vibration");
    Path::new("out").join(name)
}

fn failed(error: VibrationError) -> Failure {
    match error {
        VibrationError::Cancelled(_) => Failure::interrupted(),
        other => Failure::Input(format!(
            "{other}; crepitus scenes fig8-6-actuator is a scene that has all"
        )),
    }
}
