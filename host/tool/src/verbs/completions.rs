//! `crepitus completions SHELL`.

use crate::cli::{Cli, Shell};
use crate::failure::{Failure, print};
use clap::CommandFactory;
use clap_complete::shells;

/// Prints the completion script.
pub(crate) fn completions(shell: Shell) -> Result<(), Failure> {
    let (mut command, mut script) = (Cli::command(), Vec::new());
    let name = "crepitus";
    match shell {
        Shell::Bash => clap_complete::generate(shells::Bash, &mut command, name, &mut script),
        Shell::Elvish => clap_complete::generate(shells::Elvish, &mut command, name, &mut script),
        Shell::Fish => clap_complete::generate(shells::Fish, &mut command, name, &mut script),
        Shell::Powershell => {
            clap_complete::generate(shells::PowerShell, &mut command, name, &mut script);
        }
        Shell::Zsh => clap_complete::generate(shells::Zsh, &mut command, name, &mut script),
    }
    print(&String::from_utf8_lossy(&script))
}
