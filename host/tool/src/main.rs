//! `crepitus`: the command line tool. One file a verb, under `verbs`.

mod cli;
mod failure;
mod following;
mod interrupt;
mod keys;
mod line;
mod pictures;
mod progress;
mod recorded;
mod safe_text;
mod sections;
mod shipped;
mod simulated;
mod status_line;
mod studying;
mod told;
mod verbs;

use clap::Parser;
use cli::{Cli, Verb};
use std::env;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::try_parse().unwrap_or_else(|error| {
        // The library repeats what it does not understand.
        let shown = env::args_os().map(|argument| safe_text::message(&argument.to_string_lossy()));
        Cli::try_parse_from(shown).err().unwrap_or(error).exit()
    });
    let result = match &cli.verb {
        Verb::Demo(arguments) => verbs::demo::demo(arguments, cli.json),
        Verb::Devices => verbs::devices::devices(cli.json),
        Verb::Info(arguments) => verbs::info::info(arguments, cli.json),
        Verb::Doctor(arguments) => verbs::doctor::doctor(arguments, cli.json),
        Verb::Params(arguments) => verbs::params::params(arguments, cli.json),
        Verb::Zero(arguments) => verbs::control::zero(&arguments.device, cli.json),
        Verb::Arm(arguments) => verbs::control::arm(arguments, cli.json),
        Verb::Disarm(arguments) => verbs::control::disarm(&arguments.device, cli.json),
        Verb::Stop(arguments) => verbs::control::stop(&arguments.device, cli.json),
        Verb::ClearFault(arguments) => verbs::control::clear_fault(&arguments.device, cli.json),
        Verb::Stream(arguments) => verbs::stream::stream(arguments, cli.json),
        Verb::Record(arguments) => verbs::record::record(arguments, cli.json),
        Verb::Report(arguments) => verbs::report::report(arguments, cli.json),
        Verb::ServeSim(arguments) => verbs::serve_sim::serve_sim(arguments, cli.json),
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
