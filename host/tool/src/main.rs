//! `crepitus`: the command line tool. One file a verb, under `verbs`.

mod cli;
mod crash_text;
mod device_command;
mod failure;
mod following;
mod interrupt;
mod keys;
mod line;
mod output;
mod overlay;
mod own_presets;
mod pictures;
mod progress;
mod recorded;
mod reported;
mod results;
mod safe_text;
mod sections;
mod shell;
mod status_line;
mod studying;
mod verbs;
mod wav;

use clap::Parser;
use cli::Cli;
use std::env;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = pictures::joined(env::args_os());
    let cli = Cli::try_parse_from(&arguments).unwrap_or_else(|error| {
        // The error repeats the arguments: parse them again, escaped.
        let shown = arguments
            .iter()
            .map(|argument| safe_text::message(&argument.to_string_lossy()));
        Cli::try_parse_from(shown).err().unwrap_or(error).exit()
    });
    match cli.verb.run(cli.json) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(cli.json),
    }
}
