//! `crepitus-image`: gates firmware images.

mod run;

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;

/// Examine firmware images: sizes, load addresses, the worst stack, and what
/// interrupts can reach.
///
/// Exit codes: 0 all is well, 1 a check fails, 2 bad usage or bad input.
#[derive(Debug, Parser)]
#[command(name = "crepitus-image", version, arg_required_else_help = true)]
#[command(after_help = "\
Examples:
  crepitus-image check                            every image of firmware/budget.toml
  crepitus-image check drive --elf drive=a.elf    one image, built elsewhere
  crepitus-image check --bless                    record the sizes as they are now
  crepitus-image look a.elf --root TIM3           what one function reaches, without a budget")]
struct Cli {
    /// Print JSON for machines instead of text for people.
    #[arg(long, global = true)]
    json: bool,

    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Examine images against the budget file.
    Check(CheckArguments),
    /// List what functions of an image reach: calls, frames, loops, panics.
    Look(LookArguments),
}

#[derive(Debug, Args)]
struct CheckArguments {
    /// Images of the budget file; all if none is named.
    images: Vec<String>,
    /// The budget file.
    #[arg(long, default_value = "firmware/budget.toml", value_name = "FILE")]
    budget: PathBuf,
    /// Take an image from another place than the budget file says.
    #[arg(long = "elf", value_name = "IMAGE=FILE", value_parser = image_and_file)]
    elves: Vec<(String, PathBuf)>,
    /// Write the sizes as they are now into the budget file, and nothing else.
    #[arg(long)]
    bless: bool,
}

#[derive(Debug, Args)]
struct LookArguments {
    /// The image.
    elf: PathBuf,
    /// Functions to look from; every handler of the vector table if none is named.
    #[arg(long = "root", value_name = "FUNCTION")]
    roots: Vec<String>,
}

fn image_and_file(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((image, file)) if !image.is_empty() && !file.is_empty() => {
            Ok((image.to_owned(), PathBuf::from(file)))
        }
        _ => Err("IMAGE=FILE expected, for example drive=target/drive".to_owned()),
    }
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let outcome = match &cli.verb {
        Verb::Check(arguments) => run::check(arguments, cli.json),
        Verb::Look(arguments) => run::look(arguments, cli.json),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}
