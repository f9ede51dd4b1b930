//! `crepitus`: the command line tool. One file a verb, under `verbs`.

mod cli;
mod failure;
mod interrupt;
mod progress;
mod shipped;
mod studying;
mod verbs;

use clap::Parser;
use cli::{Cli, Verb};
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match &cli.verb {
        Verb::Run(arguments) => verbs::run::run(arguments, cli.json),
        Verb::Accuracy(arguments) => verbs::accuracy::accuracy(arguments, cli.json),
        Verb::Stability(arguments) => verbs::stability::stability(arguments, cli.json),
        Verb::Effects(arguments) => verbs::effects::effects(arguments, cli.json),
        Verb::Scenes(arguments) => verbs::scenes::scenes(arguments, cli.json),
        Verb::Presets => verbs::presets::presets(cli.json),
        Verb::Completions { shell } => verbs::completions::completions(*shell),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(cli.json),
    }
}
