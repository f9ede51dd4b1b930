//! The command line: what all verbs share. The arguments of a verb are in its
//! file under `verbs`.

use crate::failure::Failure;
use crate::verbs::Verb;
use clap::{Args, Parser};
use std::path::PathBuf;
use std::time::Duration;

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
    /// Print JSON instead of text.
    #[arg(long, global = true)]
    pub(crate) json: bool,

    #[command(subcommand)]
    pub(crate) verb: Verb,
}

// Which device. No doc comment: it would replace the text of the verb.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct DeviceArguments {
    /// The device: a port (/dev/ttyACM0), the name of a simulated one from `serve-sim`, or, for this
    /// command only, `sim`, a simulated one, or `emulated`, the firmware's own images on emulated
    /// controllers, five to six times slower than real time [default: the one that is attached].
    #[arg(long, value_name = "DEVICE", global = true)]
    pub(crate) device: Option<String>,

    /// With --device sim or emulated: the scene that sets its leg and parameters.
    #[arg(
        long,
        value_name = "SCENE",
        global = true,
        default_value = "passive-examination"
    )]
    pub(crate) scene: PathBuf,
}

/// Parses `PATH=VALUE`, and whatever else has a name and a value.
pub(crate) fn key_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((path, value)) if !path.trim().is_empty() => {
            Ok((path.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("expected a name, `=` and a value, without spaces between them".to_owned()),
    }
}

/// Parses a duration: 500ms, 30s, 5m, 1h.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let invalid = || format!("expected a duration such as 500ms, 30s or 5m, got {text:?}");
    let split = text
        .find(|c: char| !(c.is_ascii_digit() || c == '.'))
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let number: f64 = number.parse().map_err(|_| invalid())?;
    let seconds = match unit.trim() {
        "ms" => 1e-3,
        "s" | "" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(invalid()),
    };
    Duration::try_from_secs_f64(number * seconds).map_err(|_| invalid())
}

/// Checks that the value of an option is above 0.
pub(crate) fn above_zero(option: &str, value: f64) -> Result<f64, Failure> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Failure::Input(format!(
            "{option}: expected a number above 0, got {value}"
        )))
    }
}

/// The half width of a 95 % interval, given in percent above 0, up to 50, as a share.
pub(crate) fn tolerance(option: &str, percent: f64) -> Result<f64, Failure> {
    if percent > 0.0 && percent <= 50.0 {
        Ok(percent / 100.0)
    } else {
        Err(Failure::Input(format!(
            "{option}: expected a number above 0, up to 50 %, got {percent}"
        )))
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

    #[test]
    fn durations_have_a_unit() {
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
