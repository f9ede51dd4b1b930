//! The command line.

pub(crate) mod device;

use crate::pictures::PictureFormat;
use clap::{Args, Parser, Subcommand, ValueEnum};
use device::{
    ArmArguments, ClearFaultArguments, DemoArguments, DisarmArguments, DoctorArguments,
    InfoArguments, ParamsArguments, RecordArguments, ReportArguments, ServeSimArguments,
    StopArguments, StreamArguments, ZeroArguments,
};
use std::path::PathBuf;

/// A motorised brace as a patient with a diseased knee: simulate the joint
/// that the trainee feels, and run the device that renders it.
///
/// Exit codes: 0 done, 1 the work failed, 2 bad usage or bad input.
#[derive(Debug, Parser)]
#[command(
    name = "crepitus",
    version,
    max_term_width = 100,
    arg_required_else_help = true
)]
#[command(after_help = "\
Start with:
  crepitus demo                             the whole device, simulated; then open out/demo/report.html
  crepitus scenes                           what there is to see
  crepitus run scenes/slow-examination.toml simulate it, then open out/slow-examination/report.html")]
pub(crate) struct Cli {
    /// Print JSON for machines instead of text for people.
    #[arg(long, global = true)]
    pub(crate) json: bool,

    #[command(subcommand)]
    pub(crate) verb: Verb,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Verb {
    /// Run the whole chain, simulated: host, USB, both controllers, leg; record and report it.
    Demo(DemoArguments),
    /// List the devices that are attached, and the simulated ones.
    #[command(after_help = "Example:\n  crepitus devices --json")]
    Devices,
    /// Show who a device is, how it is, and what it has counted.
    Info(InfoArguments),
    /// Examine a device: what is wrong, and what to do about it.
    Doctor(DoctorArguments),
    /// List, read, set and keep a device's parameters.
    Params(ParamsArguments),
    /// Tell a device that the joint's angle is zero now.
    Zero(ZeroArguments),
    /// Have torque rendered, as long as this command runs.
    Arm(ArmArguments),
    /// No more torque.
    Disarm(DisarmArguments),
    /// No more torque, from a device of any version.
    Stop(StopArguments),
    /// Forget the faults of a device.
    ClearFault(ClearFaultArguments),
    /// Print a device's samples as they come.
    Stream(StreamArguments),
    /// Record a device's samples to a file.
    Record(RecordArguments),
    /// Make the report of a recording.
    Report(ReportArguments),
    /// Offer a simulated device as a serial port.
    ServeSim(ServeSimArguments),
    /// Simulate a scene and write its trace, events, summary and report.
    Run(RunArguments),
    /// Show what accuracy costs in time: every solver against the reference.
    Accuracy(AccuracyArguments),
    /// Try the hard cases on every solver: what holds, and by what margin.
    Stability(StabilityArguments),
    /// List the effects; or show what each effect of a scene does and costs.
    Effects(EffectsArguments),
    /// List the scenes that ship, with what each shows.
    Scenes(ScenesArguments),
    /// List the parameter presets, with what each feels like and its source.
    #[command(after_help = "Example:\n  crepitus presets --json")]
    Presets,
    /// Print a completion script for a shell.
    #[command(after_help = "\
Example:
  crepitus completions bash > ~/.local/share/bash-completion/completions/crepitus")]
    Completions {
        /// The shell.
        shell: Shell,
    },
}

/// A shell that completions can be made for.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Shell {
    Bash,
    Elvish,
    Fish,
    Powershell,
    Zsh,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus run scenes/fig6-ideal-cycle.toml
  crepitus run slow-examination --out /tmp/exam --solver exact --step 1e-3
  crepitus run high-speed --set effects.crepitus.preset=fine --set duration_s=2
  crepitus run passive-examination --as-device

SCENE is a file, or the name of a scene that ships. Any key of the scene can be \
set: PATH is its name with the tables before it, VALUE is written as in the file.")]
pub(crate) struct RunArguments {
    /// Scene file, or name of a scene that ships.
    pub(crate) scene: PathBuf,

    /// Folder for trace.csv, events.csv, summary.json and report.html [default: out/SCENE].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Another solver: exact, exact-events, reference, … (a wrong name lists them all).
    #[arg(long, value_name = "KIND")]
    pub(crate) solver: Option<String>,

    /// Another solver step, in seconds.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    pub(crate) step: Option<String>,

    /// Another precision: f32 or f64.
    #[arg(long, value_name = "PRECISION")]
    pub(crate) precision: Option<String>,

    /// Render as the device does: input check, turn-back guard, slew and torque limits.
    #[arg(long)]
    pub(crate) as_device: bool,

    /// Set a key of the scene.
    #[arg(long, value_name = "PATH=VALUE", value_parser = key_and_value)]
    pub(crate) set: Vec<(String, String)>,

    /// Write each chart of the report as a file of its own, too.
    #[arg(long, value_name = "svg|pdf", num_args = 0..=1, require_equals = true,
          default_missing_value = "svg")]
    pub(crate) pictures: Option<PictureFormat>,

    /// Write only every Nth row of the trace.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) trace_every: u64,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus accuracy --quick
  crepitus accuracy --quick --target
  crepitus accuracy --scene slow-examination --out /tmp/accuracy
  crepitus accuracy --need torque=1e-2,interval=5e-4 --rate 20000
  crepitus accuracy --need torque=1e-2 --target
  crepitus accuracy --need frequency=1e-6 --convention physical --precision f64

Every solver, in f32 and f64 and at steps from 1 ms to 2 µs, is compared with the reference \
on four constant speeds and a hand-like sine, and timed on this machine in CPU time. With --target it is also \
run on an emulated STM32F405: modelled cycles, 0 wait states; not measured on hardware. The worst \
cycles are the worst observed, over inputs with breaks, matches and reversals.

A NEED is a list of limits that must hold on every scene: torque (rms error of the torque as the \
device holds it for a step, over continuous time, N·m), peak-torque (the largest such error, N·m), \
torque-at-tick and peak-torque-at-tick (the same at the ends of steps alone, N·m), event (worst event-time error, s), interval (worst \
interval error, s), frequency (relative error of the cycle frequency). The answer is the \
cheapest solver that meets them on this host; with --target the one with the fewest mean cycles on \
the target at its tick of 50 µs in f32, equal means decided by the worst, whose worst step fits a \
fifth of the tick. Where none does the exit code is 1. With --need, files are written only if --out \
is given.")]
pub(crate) struct AccuracyArguments {
    /// Study the motion and the crepitus of this scene instead: a file, or the name of one that
    /// ships. Its solver and its encoder play no part.
    #[arg(long, value_name = "SCENE")]
    pub(crate) scene: Option<PathBuf>,

    /// Folder for points.csv, summary.json and report.html [default: out/accuracy].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Fewer steps and repeats: seconds instead of minutes.
    #[arg(long)]
    pub(crate) quick: bool,

    /// Also run every solver, and every effect of the device, on an emulated STM32F405: cycles and
    /// instructions of a step. Builds firmware/ladder, unless CREPITUS_IMAGES names a folder with
    /// it. With --need these cycles choose.
    #[arg(long)]
    pub(crate) target: bool,

    /// Write each diagram of the report as a file of its own, too.
    #[arg(long, value_name = "svg|pdf", num_args = 0..=1, require_equals = true,
          default_missing_value = "svg")]
    pub(crate) pictures: Option<PictureFormat>,

    /// Which solver is the cheapest that is accurate enough? For example torque=1e-2,interval=5e-4.
    #[arg(long, value_name = "NEED")]
    pub(crate) need: Option<String>,

    /// Only steps of this rate, in Hz: that of the device is 20000.
    #[arg(
        long,
        value_name = "HZ",
        requires = "need",
        allow_negative_numbers = true
    )]
    pub(crate) rate: Option<f64>,

    /// The convention that the need is for [default: frozen, or that of the scene].
    #[arg(long, value_name = "CONVENTION", requires = "need")]
    pub(crate) convention: Option<String>,

    /// The precision that the need is for: the device computes in f32.
    #[arg(long, value_name = "PRECISION", requires = "need", default_value = "f32",
          value_parser = ["f32", "f64"])]
    pub(crate) precision: String,

    /// Other steps, in seconds.
    #[arg(long, value_name = "SECONDS,…", value_delimiter = ',', hide = true)]
    pub(crate) steps: Vec<f64>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus stability
  crepitus stability --case sudden-stop
  crepitus stability --case H10 --case H16 --solver exact-events --solver rk4
  crepitus stability --long --out /tmp/stability
  crepitus stability --coupled

Every hard case is put to every solver under every convention, in f32 and f64. A cell of the \
matrix holds, with the margin that was measured; or degrades: right in kind, a number is above \
its limit; or fails: something else than the joint was simulated. Some cells must hold; if one \
does not, the exit code is 1. With one --case, everything about it is printed.

With --coupled a hand that stops is put to the whole device instead: which stiffness stays quiet \
with which cuff, lag and friction left in the gear, and what the presets have left.")]
#[expect(clippy::struct_excessive_bools, reason = "switches of a command line")]
pub(crate) struct StabilityArguments {
    /// Only this case, by number or name: H05, reversal-in-stick. May be given again.
    #[arg(long = "case", value_name = "NAME")]
    pub(crate) cases: Vec<String>,

    /// Only this solver: exact, exact-events, rk4, … May be given again.
    #[arg(long = "solver", value_name = "KIND")]
    pub(crate) solvers: Vec<String>,

    /// Only this convention: frozen, paper or physical. May be given again.
    #[arg(long = "convention", value_name = "CONVENTION")]
    pub(crate) conventions: Vec<String>,

    /// Only this precision: the device computes in f32.
    #[arg(long, value_name = "PRECISION", value_parser = ["f32", "f64"])]
    pub(crate) precision: Option<String>,

    /// Also the cases of hours of simulated time.
    #[arg(long)]
    pub(crate) long: bool,

    /// List the cases, with inputs, criteria and sources, and run none.
    #[arg(long)]
    pub(crate) list: bool,

    /// Map the stiffness at which the device begins to ring on a leg, instead of the cases.
    #[arg(long, conflicts_with_all = ["cases", "solvers", "conventions", "precision", "long", "list"])]
    pub(crate) coupled: bool,

    /// Folder for cases.csv, summary.json and report.html [default: out/stability; out/coupled].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Write the matrix and each picture of the report as a file of its own, too.
    #[arg(long, value_name = "svg|pdf", num_args = 0..=1, require_equals = true,
          default_missing_value = "svg")]
    pub(crate) pictures: Option<PictureFormat>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus effects
  crepitus effects slow-examination
  crepitus effects my-scene.toml --tolerance torque=5e-3
  crepitus effects my-scene.toml --tolerance torque=0.02,events=0.01 --set duration_s=2

Without a SCENE all effects are listed, with their parameters. With one, each of its effects is \
left out in turn and each absent one added: how much that changes the torque at the hand (RMS, \
peak, three bands of frequency, number of events), and what it costs (time of a step, states).

A TOLERANCE is a list of limits: torque (rms difference of the torque at the hand, N·m), peak \
(largest difference, N·m), events (relative difference of the number of events). The answer is \
the smallest set of the scene's effects that stays within all of them; all sets are tried, the \
small ones first.")]
pub(crate) struct EffectsArguments {
    /// Scene file, or name of a scene that ships.
    pub(crate) scene: Option<PathBuf>,

    /// Folder for effects.csv, summary.json and report.html [default: out/SCENE-effects].
    #[arg(long, value_name = "DIR", requires = "scene")]
    pub(crate) out: Option<PathBuf>,

    /// Which effects are enough to stay this near to the whole scene? For example torque=5e-3.
    #[arg(long, value_name = "TOLERANCE", requires = "scene")]
    pub(crate) tolerance: Option<String>,

    /// Set a key of the scene.
    #[arg(long, value_name = "PATH=VALUE", value_parser = key_and_value, requires = "scene")]
    pub(crate) set: Vec<(String, String)>,

    /// Write each figure of the report as a file of its own, too.
    #[arg(long, value_name = "svg|pdf", num_args = 0..=1, require_equals = true,
          default_missing_value = "svg", requires = "scene")]
    pub(crate) pictures: Option<PictureFormat>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus scenes
  crepitus scenes fig6-ideal-cycle > my-scene.toml")]
pub(crate) struct ScenesArguments {
    /// Print the file of this scene, as a start for one's own.
    pub(crate) name: Option<String>,
}

fn key_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((path, value)) if !path.trim().is_empty() => {
            Ok((path.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write PATH=VALUE, for example solver.step_s=1e-3".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn every_verb_shows_an_example() {
        for verb in Cli::command().get_subcommands_mut() {
            let help = verb.render_long_help().to_string();
            assert!(help.contains("Example"), "{}", verb.get_name());
        }
    }
}
