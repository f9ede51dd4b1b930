//! `crepitus-knee-page`: builds the page's file of `sim/knee`, or compares it with the one that is committed.

use clap::Parser;
use crepitus_tools::knee_page::{FILE, build};
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

/// Build the knee of the page, and write it to host/panel/assets/knee.wasm.
///
/// Exit codes: 0 all is well, 1 the committed file is another one, 2 bad usage or a failed build.
#[derive(Debug, Parser)]
#[command(name = "crepitus-knee-page", version)]
struct Cli {
    /// Write nothing: compare with the committed file.
    #[arg(long)]
    check: bool,
    /// Root of the repository.
    #[arg(long, value_name = "DIR", default_value = ".")]
    root: PathBuf,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    match work(&cli) {
        Ok(code) => code,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

fn work(cli: &Cli) -> Result<ExitCode, String> {
    let built = build(&cli.root).map_err(|error| error.to_string())?;
    let file = cli.root.join(FILE);
    if !cli.check {
        fs::write(&file, &built).map_err(|error| format!("{}: {error}", file.display()))?;
        println!("wrote {}, {} bytes", file.display(), built.len());
        return Ok(ExitCode::SUCCESS);
    }
    let committed = fs::read(&file).unwrap_or_default();
    if committed == built {
        println!("{FILE} is what its sources build, {} bytes", built.len());
        return Ok(ExitCode::SUCCESS);
    }
    eprintln!(
        "{FILE} has {} bytes, its sources build {} others: `cargo run -p crepitus-tools --bin crepitus-knee-page` \
         writes them",
        committed.len(),
        built.len()
    );
    Ok(ExitCode::from(1))
}
