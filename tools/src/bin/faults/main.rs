//! `crepitus-faults`: plants the faults of `tools/faults` one at a time, and records which test
//! notices each.

mod mutants_run;

use clap::Parser;
use crepitus_tools::faults::patch::Fault;
use crepitus_tools::faults::trial::Workshop;
use crepitus_tools::faults::{page, patch};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Plants faults in a copy of the sources, and records in their patches which tests detect them.
#[derive(Parser)]
#[command(
    after_help = "Example: cargo run -p crepitus-tools --bin crepitus-faults -- period-in-f32\n\n\
    CREPITUS_CARGO names the cargo that builds the copy. After a run that was interrupted, --missing tries the rest."
)]
struct Arguments {
    /// Try only these faults.
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Try only the faults of this folder of tools/faults.
    #[arg(long, value_name = "AREA")]
    area: Option<String>,
    /// Try only faults without a result, or whose patch has changed since.
    #[arg(long)]
    missing: bool,
    /// List the faults and exit.
    #[arg(long)]
    list: bool,
    /// Try every mutant that `cargo mutants` lists of this crate: model, device or protocol.
    #[arg(long, value_name = "CRATE", conflicts_with_all = ["names", "area", "missing", "list"])]
    mutants: Option<String>,
    /// Arguments of `cargo test` for the tests that are to notice mutants, instead of the
    /// crate's own and those that compare with it; may be given several times.
    #[arg(
        long,
        value_name = "ARGUMENTS",
        requires = "mutants",
        allow_hyphen_values = true
    )]
    tests: Vec<String>,
    /// Root of the repository.
    #[arg(long, value_name = "DIR", default_value = ".")]
    root: PathBuf,
    /// Scratch folder: the copy, its build, results of mutants so far.
    #[arg(long, value_name = "DIR", default_value = "target/faults")]
    scratch: PathBuf,
}

fn main() -> ExitCode {
    match work(&Arguments::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("crepitus-faults: {error}");
            ExitCode::FAILURE
        }
    }
}

fn work(arguments: &Arguments) -> Result<ExitCode, Box<dyn Error>> {
    if let Some(folder) = &arguments.mutants {
        return mutants_run::work(arguments, folder);
    }
    let all = patch::all(&arguments.root)?;
    let (names, area) = (&arguments.names, arguments.area.as_ref());
    let is_known = |name: &&String| all.iter().any(|fault| fault.name == **name);
    if let Some(unknown) = names.iter().find(|name| !is_known(name)) {
        eprintln!("crepitus-faults: no fault `{unknown}`; --list shows all");
        return Ok(ExitCode::from(2));
    }
    let is_wanted = |fault: &Fault| {
        (names.is_empty() || names.contains(&fault.name))
            && area.is_none_or(|area| fault.area == *area)
    };
    let mut wanted: Vec<Fault> = all.into_iter().filter(is_wanted).collect();
    if wanted.is_empty() {
        eprintln!("crepitus-faults: there is no such fault; --list shows all");
        return Ok(ExitCode::from(2));
    }
    wanted.retain(|fault| !arguments.missing || fault.result.is_none());
    if arguments.list {
        for fault in &wanted {
            println!("{:10} {:34} {}", fault.area, fault.name, fault.what);
        }
        return Ok(ExitCode::SUCCESS);
    }
    let has_holes = !wanted.is_empty() && try_all(arguments, wanted)?;
    let file = arguments.root.join(page::FILE);
    std::fs::write(&file, page::page(&patch::all(&arguments.root)?))?;
    println!("wrote {}", file.display());
    Ok(if has_holes {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    })
}

/// Tries faults, records their results and prints a line a fault. Returns whether one is a hole.
fn try_all(arguments: &Arguments, mut faults: Vec<Fault>) -> Result<bool, Box<dyn Error>> {
    let cargo = std::env::var("CREPITUS_CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut workshop = Workshop::open(&arguments.root, &arguments.scratch, &cargo)?;
    // A package is built again after each of its faults: together with the next one, if that is in
    // the same package.
    faults.sort_by(|a, b| a.changed_files().cmp(b.changed_files()));
    eprintln!("without a fault all tests must pass");
    for fault in &faults {
        workshop.baseline(fault)?;
    }
    let (mut has_holes, all) = (false, faults.len());
    for (number, mut fault) in (1..).zip(faults) {
        let begun = Instant::now();
        fault.result = workshop.attempt(&fault)?;
        fault.record(&arguments.root)?;
        let took = begun.elapsed().as_secs();
        eprintln!("{number:3}/{all} {} ({took} s)", fault.name);
        println!("{}", page::line(&fault));
        has_holes |= page::is_hole(&fault);
    }
    Ok(has_holes)
}
