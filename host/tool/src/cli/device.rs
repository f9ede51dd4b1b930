//! The command line of the verbs that talk to a device.

use crate::pictures::PictureFormat;
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;

/// Which device.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct DeviceArguments {
    /// The device: a port (/dev/ttyACM0), the name of a simulated one that `serve-sim` offers, or
    /// `sim`, a simulated one that lives for this command [default: the one that is attached].
    #[arg(long, value_name = "DEVICE", global = true)]
    pub(crate) device: Option<String>,

    /// With --device sim: the scene whose leg and parameters it has.
    #[arg(
        long,
        value_name = "SCENE",
        global = true,
        default_value = "passive-examination"
    )]
    pub(crate) scene: PathBuf,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus demo
  crepitus demo --out /tmp/demo --json

Everything is real but the silicon: the host's library, a USB stack and a virtual cable, the \
program of the comms controller, the link, the program of the drive, and a simulated leg that an \
examiner bends and straightens. DIR gets recording.csv, recording.json, report.html and \
summary.json.")]
pub(crate) struct DemoArguments {
    /// Folder for what it records and reports [default: out/demo].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Write each figure of the report as a file of its own, too.
    #[arg(long, value_name = "svg|pdf", num_args = 0..=1, require_equals = true,
          default_missing_value = "svg")]
    pub(crate) pictures: Option<PictureFormat>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus info
  crepitus info --device sim --json")]
pub(crate) struct InfoArguments {
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus doctor
  crepitus doctor --device sim

Looks at everything between this program and the motor, one after the other, and says what to do \
about what is not in order. Nothing moves: the device is not armed. The exit code is 1 if \
something is wrong.")]
pub(crate) struct DoctorArguments {
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus params list
  crepitus params get crepitus.static_torque_nm
  crepitus params set crepitus.static_torque_nm=0.5 crepitus.kinetic_torque_nm=0.25
  crepitus params apply fine
  crepitus params apply scenes/bone-shaping.toml
  crepitus params save

A set is one commit: all of it or nothing comes into force, between two ticks, and torques then \
move within the slew limit. What is not saved is forgotten when the device is switched off.")]
pub(crate) struct ParamsArguments {
    #[command(subcommand)]
    pub(crate) action: ParamsAction,

    #[command(flatten)]
    pub(crate) device: DeviceArguments,
}

#[derive(Debug, Subcommand)]
pub(crate) enum ParamsAction {
    /// List all parameters: range, default, meaning. Needs no device.
    List,
    /// Show the device's parameters, or some of them.
    Get {
        /// Names; all if none is given.
        #[arg(value_name = "NAME")]
        names: Vec<String>,
    },
    /// Set parameters, all at once or none.
    Set {
        /// What to set.
        #[arg(value_name = "NAME=VALUE", required = true, value_parser = super::key_and_value)]
        values: Vec<(String, String)>,
    },
    /// Take a preset's numbers, or all that a scene says of the device.
    Apply {
        /// A preset, a scene that ships, or a scene's file.
        what: PathBuf,
    },
    /// Keep the parameters in force for the next start.
    Save,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus zero
  crepitus zero --device /dev/ttyACM0

Hold the joint straight first: counts are counted from here.")]
pub(crate) struct ZeroArguments {
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus arm --for 60s
  crepitus arm --device sim --for 2s

The torque is there as long as this command runs: it holds the lease. Any key or Ctrl-C disarms; \
if this program is killed, the device lets go within 250 ms by itself.")]
pub(crate) struct ArmArguments {
    /// How long: 30s, 5m [default: until a key is pressed].
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub(crate) for_s: Option<Duration>,

    #[command(flatten)]
    pub(crate) device: DeviceArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus disarm
  crepitus disarm --device /dev/ttyACM0")]
pub(crate) struct DisarmArguments {
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus stop
  crepitus stop --device /dev/ttyACM0

As disarm, but by the part of the protocol that never changes: it works with a device of any \
version. It is no substitute for the hand-held stop.")]
pub(crate) struct StopArguments {
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus clear-fault

Faults latch: see what it was with `crepitus info`, mend it, then clear it. That works only while \
the bridge floats.")]
pub(crate) struct ClearFaultArguments {
    #[command(flatten)]
    pub(crate) device: DeviceArguments,
}

/// How samples are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SampleFormat {
    /// A header and a line a sample.
    Csv,
    /// A JSON object a line.
    Jsonl,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus stream --rate 100
  crepitus stream --device sim --for 2s --rate 20000 --arm > samples.csv
  crepitus stream --format jsonl --rate 10 | head

On a terminal a line with the state goes along on stderr. A rate below the drive's 20000 Hz takes \
every n-th sample; it is no filter.")]
pub(crate) struct StreamArguments {
    /// Samples a second: 20000 divided by a whole number.
    #[arg(long, value_name = "HZ", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=20_000))]
    pub(crate) rate: u32,

    /// How they are printed; with --json as JSON lines.
    #[arg(long, default_value = "csv")]
    pub(crate) format: SampleFormat,

    /// How long: 500ms, 30s, 5m [default: until Ctrl-C].
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub(crate) for_s: Option<Duration>,

    /// Arm first, and disarm at the end.
    #[arg(long)]
    pub(crate) arm: bool,

    #[command(flatten)]
    pub(crate) device: DeviceArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus record monday.csv --for 60s --arm
  crepitus record try.csv --device sim --for 5s --arm --title \"First try\"
  crepitus report monday.csv

Every sample of the drive, 20000 a second, goes to FILE; what they are, with which parameters, \
and what is missing, to a JSON file of the same name. Whatever stops it, what is on the disk can \
be reported. About 100 MB a minute.")]
pub(crate) struct RecordArguments {
    /// The CSV file; it must not exist.
    pub(crate) file: PathBuf,

    /// How long: 500ms, 30s, 5m [default: until Ctrl-C].
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub(crate) for_s: Option<Duration>,

    /// Arm first, and disarm at the end.
    #[arg(long)]
    pub(crate) arm: bool,

    /// What it is of.
    #[arg(long, default_value = "Recording of a device")]
    pub(crate) title: String,

    #[command(flatten)]
    pub(crate) device: DeviceArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus report out/demo/recording.csv
  crepitus report monday.csv --out monday-report --pictures")]
pub(crate) struct ReportArguments {
    /// The recording: its CSV file.
    pub(crate) file: PathBuf,

    /// Folder for report.html and summary.json [default: FILE without its ending].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Write each figure of the report as a file of its own, too.
    #[arg(long, value_name = "svg|pdf", num_args = 0..=1, require_equals = true,
          default_missing_value = "svg")]
    pub(crate) pictures: Option<PictureFormat>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  crepitus serve-sim
  crepitus serve-sim --scene everything --name bench
  crepitus info --device bench

A simulated device as a serial port that any program can open, in real time, until Ctrl-C. \
`crepitus devices` lists it.")]
pub(crate) struct ServeSimArguments {
    /// The scene whose leg and parameters it has.
    #[arg(long, value_name = "SCENE", default_value = "passive-examination")]
    pub(crate) scene: PathBuf,

    /// The name under which it is found.
    #[arg(long, value_name = "NAME", default_value = "sim-1")]
    pub(crate) name: String,
}

/// A length of time: 500ms, 30s, 5m, 1h.
fn duration(text: &str) -> Result<Duration, String> {
    let wrong = || format!("{text:?} is no length of time: write for example 500ms, 30s or 5m");
    let split = text
        .find(|c: char| !(c.is_ascii_digit() || c == '.'))
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let number: f64 = number.parse().map_err(|_| wrong())?;
    let seconds = match unit.trim() {
        "ms" => 1e-3,
        "s" | "" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(wrong()),
    };
    Duration::try_from_secs_f64(number * seconds).map_err(|_| wrong())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_of_time_have_a_unit() {
        for (text, ms) in [
            ("500ms", 500),
            ("2s", 2_000),
            ("2", 2_000),
            ("1.5m", 90_000),
            ("1h", 3_600_000),
        ] {
            assert_eq!(duration(text), Ok(Duration::from_millis(ms)), "{text}");
        }
        for bad in ["", "s", "2x", "-1s", "1e9999s", "two"] {
            assert!(duration(bad).is_err(), "{bad}");
        }
    }
}
