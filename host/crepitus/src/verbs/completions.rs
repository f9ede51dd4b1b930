//! `crepitus completions SHELL`.

use crate::cli::Cli;
use crate::failure::{Failure, print};
use clap::{Args, CommandFactory};
use clap_complete::Shell;

/// Print a completion script for a shell.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  crepitus completions bash \\
      > ~/.local/share/bash-completion/completions/crepitus")]
pub(crate) struct Arguments {
    /// The shell.
    shell: Shell,
}

/// Prints the completion script.
pub(crate) fn run(arguments: &Arguments, _: bool) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(
        arguments.shell,
        &mut Cli::command(),
        "crepitus",
        &mut script,
    );
    print(&String::from_utf8_lossy(&script))
}
