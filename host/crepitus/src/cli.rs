//! The command line: what all verbs share. The arguments of a verb are in its
//! file under `verbs`.

use crate::failure::Failure;
use crate::verbs::Verb;
use clap::{Args, Parser};
use crepitus_files::output::{Claim, Inputs};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
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
  crepitus demo                   # the whole device, simulated
  crepitus scenes                 # what there is to see
  crepitus run slow-examination   # simulate it

The reports are out/demo/report.html and out/slow-examination/report.html.")]
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

    /// With --device sim or emulated: the scene that sets its leg and parameters; armed with --zero
    /// the leg begins straight, and is led to where the scene's motion begins at up to 30 deg/s
    /// [default: passive-examination].
    #[arg(long, value_name = "SCENE", global = true)]
    pub(crate) scene: Option<PathBuf>,
}

/// Whether to arm, for verbs that can do without.
#[derive(Args, Clone, Copy, Debug, Default)]
pub(crate) struct Arming {
    /// Arm first, and disarm at the end.
    #[arg(long)]
    pub(crate) arm: bool,

    /// Set the angle's zero before: hold the leg straight.
    #[arg(long)]
    pub(crate) zero: bool,
}

impl Arming {
    /// Arm, and set the zero before or not.
    pub(crate) fn armed(zero: bool) -> Self {
        Self { arm: true, zero }
    }
}

// Handling of what is in the way; shared by all verbs that write files. No doc comment: see above.
#[derive(Clone, Copy, Debug, Default, Args)]
pub(crate) struct Force {
    /// Replace what is in the way: another run or sweep, and files that crepitus did not write, that were
    /// changed since, or that are of another verb. Never an input, and never a folder.
    #[arg(long)]
    pub(crate) force: bool,
}

impl Force {
    /// The claim of a verb that reads these files.
    pub(crate) fn claim<P: AsRef<Path>>(
        self,
        verb: &str,
        inputs: impl IntoIterator<Item = P>,
    ) -> Claim {
        Claim::by(verb)
            .force(self.force)
            .reading(Inputs::of(inputs))
    }
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

/// Refuses names that stand twice: only the last would count, silently.
pub(crate) fn once<'a>(
    option: &str,
    names: impl IntoIterator<Item = &'a str>,
) -> Result<(), Failure> {
    let mut seen = BTreeSet::new();
    match names.into_iter().find(|name| !seen.insert(*name)) {
        None => Ok(()),
        Some(name) => Err(Failure::Input(format!(
            "{option}: `{name}` is set twice: give it one value"
        ))),
    }
}

/// Refuses a key that `--set` has twice.
pub(crate) fn set_once(set: &[(String, String)]) -> Result<(), Failure> {
    once("--set", set.iter().map(|(path, _)| path.as_str()))
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

    /// A broken one does less than it says when it is pasted: without `--device sim`, say.
    #[test]
    fn no_example_is_broken_by_the_width_of_the_terminal() {
        let mut cli = Cli::command();
        cli.build();
        let commands = cli.get_subcommands().chain([&cli]);
        for (command, width) in commands.flat_map(|command| [(command, 80), (command, 100)]) {
            let source = command.get_after_help().map(ToString::to_string);
            let help = command.clone().term_width(width).render_long_help();
            let help = help.to_string();
            let mut lines = help.lines();
            let examples = source.iter().flat_map(|text| text.lines());
            for example in examples.filter(|line| line.starts_with("  ")) {
                assert!(example.chars().count() <= 78, "{example}");
                assert!(
                    lines.any(|line| line == example),
                    "{width}: {example}\n{help}"
                );
            }
        }
    }

    /// The commands in a text, without comments and what is behind a redirection.
    fn commands(text: &str) -> Vec<String> {
        let joined = text.replace("\\\n", " ");
        let lines = joined.lines().map(str::trim);
        let lines = lines.filter(|line| line.starts_with("crepitus "));
        // `…` stands for what the reader knows, `[` and `|` for what may be; two commands in a line
        // are those of two terminals.
        let is_whole = |line: &&str| {
            let is_table = line.starts_with("crepitus  ") || line.matches("crepitus ").count() > 1;
            !is_table && !line.contains(['…', '[', '|']) && !line.contains("SCENE")
        };
        let whole = lines.filter(is_whole);
        let ends = [" # ", "  # ", " > ", " >", " &&"];
        let cut = |line: &str| {
            let end = ends.iter().filter_map(|end| line.find(end)).min();
            line.get(..end.unwrap_or(line.len()))
                .unwrap_or_default()
                .to_owned()
        };
        whole.map(cut).collect()
    }

    /// The words of a command, as a shell splits them.
    fn words(command: &str) -> Vec<String> {
        let mut words = vec![String::new()];
        let mut quote = None;
        for c in command.chars() {
            match (quote, c) {
                (None, '"' | '\'') => quote = Some(c),
                (Some(q), _) if c == q => quote = None,
                (None, ' ') => words.push(String::new()),
                _ => words.last_mut().expect("a word").push(c),
            }
        }
        words.retain(|word| !word.is_empty());
        words
    }

    #[test]
    fn every_command_that_is_shown_is_one() {
        let mut shown = Vec::new();
        for command in Cli::command().get_subcommands() {
            let text = command.get_after_help().map(ToString::to_string);
            shown.extend(commands(&text.unwrap_or_default()));
        }
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let docs = std::fs::read_dir(root.join("docs")).expect("documents");
        let files = docs.map(|entry| entry.expect("an entry").path());
        for file in files.chain([root.join("README.md")]) {
            if file.extension().is_some_and(|extension| extension == "md") {
                let text = std::fs::read_to_string(file).expect("a text");
                // Blocks of code: every second part.
                let blocks = text.split("\n```").skip(1).step_by(2);
                shown.extend(blocks.flat_map(commands));
            }
        }
        assert!(shown.len() > 120, "{}", shown.len());
        let wrong: Vec<_> = (shown.iter())
            .filter_map(|command| Cli::try_parse_from(words(command)).err())
            .map(|error| error.to_string())
            .collect();
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
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
