//! `crepitus`: the command line tool. One file a verb, under `verbs`.

mod angle_table;
mod cli;
mod crash_text;
mod device_command;
mod double_click;
mod failure;
mod following;
mod interrupt;
mod keys;
mod line;
mod measures;
mod output;
mod overlay;
mod own_presets;
mod pictures;
mod progress;
mod recorded;
mod reported;
mod results;
mod safe_text;
mod screen;
mod sections;
mod shell;
mod status_line;
mod studying;
mod verbs;
mod wav;

use clap::Parser;
use cli::Cli;
use failure::Failure;
use std::env;
use std::ffi::OsString;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(command) = double_click::command() else {
        return run(env::args_os());
    };
    let code = run(command);
    double_click::keep_window();
    code
}

/// Runs a command, whose first word is the program's name.
fn run(command: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = pictures::joined(command);
    let cli = Cli::try_parse_from(&arguments).map_err(|error| {
        // The error repeats the arguments: parse them again, escaped.
        let shown = arguments
            .iter()
            .map(|argument| safe_text::message(&argument.to_string_lossy()));
        Cli::try_parse_from(shown).err().unwrap_or(error)
    });
    let cli = match cli {
        Ok(cli) => cli,
        Err(error) => return refused(&error),
    };
    match cli.verb.run(cli.json) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(cli.json),
    }
}

/// Prints the help that was asked for, or what is wrong with the arguments.
fn refused(error: &clap::Error) -> ExitCode {
    let printed = error.print().and_then(|()| io::stdout().flush());
    match printed {
        Err(failed) if !error.use_stderr() && failed.kind() != ErrorKind::BrokenPipe => {
            Failure::Work(format!("stdout cannot be written: {failed}")).report(false)
        }
        _ => ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)),
    }
}
