//! `crepitus-faults`: plants the faults of `tools/faults` one at a time, and says which test
//! notices each.

mod mutants_run;

use clap::Parser;
use crepitus_tools::faults::outcome::Outcome;
use crepitus_tools::faults::patch::Fault;
use crepitus_tools::faults::trial::Workshop;
use crepitus_tools::faults::{page, patch, tree};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Plants faults in a copy of the sources and reports the tests that detect them.
#[derive(Parser)]
#[command(
    after_help = "Example: cargo run -p crepitus-tools --bin crepitus-faults -- period-in-f32\n\n\
    CREPITUS_CARGO names the cargo that builds the copy. A run that was interrupted goes on where it ended."
)]
struct Arguments {
    /// Try only these faults.
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Try only the faults of this folder of tools/faults.
    #[arg(long, value_name = "AREA")]
    area: Option<String>,
    /// List the faults and exit.
    #[arg(long)]
    list: bool,
    /// Write the page of all faults here.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["names", "area"])]
    page: Option<PathBuf>,
    /// Try every mutant that `cargo mutants` lists of this crate: model, device or protocol.
    #[arg(long, value_name = "CRATE", conflicts_with_all = ["names", "area", "list", "page"])]
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
    /// Scratch folder: the copy, its build, results so far.
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
    let wanted: Vec<Fault> = all.into_iter().filter(is_wanted).collect();
    if wanted.is_empty() {
        eprintln!("crepitus-faults: there is no such fault; --list shows all");
        return Ok(ExitCode::from(2));
    }
    if arguments.list {
        for fault in &wanted {
            println!("{:10} {:34} {}", fault.area, fault.name, fault.what);
        }
        return Ok(ExitCode::SUCCESS);
    }
    let tried = try_all(arguments, wanted)?;
    println!("{}", page::totals(&tried));
    if let Some(file) = &arguments.page {
        std::fs::write(file, page::page(&tried))?;
        println!("wrote {}", file.display());
    }
    Ok(if tried.iter().any(page::is_hole) {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    })
}

/// Tries the faults that have no result yet, and prints a line a fault.
fn try_all(arguments: &Arguments, faults: Vec<Fault>) -> Result<Vec<page::Tried>, Box<dyn Error>> {
    let known = arguments.scratch.join("known");
    std::fs::create_dir_all(&known)?;
    let sources = tree::fingerprint(&arguments.root)?;
    let load = |fault: &Fault| Outcome::load(&known, &fault.name, fault.fingerprint(sources));
    let cargo = std::env::var("CREPITUS_CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let mut workshop = Workshop::open(&arguments.root, &arguments.scratch, &cargo)?;
    eprintln!("without a fault all tests must pass");
    for fault in faults.iter().filter(|fault| load(fault).is_none()) {
        workshop.baseline(fault)?;
    }
    let (mut tried, all) = (Vec::new(), faults.len());
    for (number, fault) in (1..).zip(faults) {
        let outcome = if let Some(outcome) = load(&fault) {
            outcome
        } else {
            let begun = Instant::now();
            let outcome = workshop.attempt(&fault)?;
            // A build may fail for other reasons, too.
            if outcome != Outcome::DoesNotBuild {
                outcome.save(&known, &fault.name, fault.fingerprint(sources))?;
            }
            let took = begun.elapsed().as_secs();
            eprintln!("{number:3}/{all} {} ({took} s)", fault.name);
            outcome
        };
        let result = (fault, outcome);
        println!("{}", page::line(&result));
        tried.push(result);
    }
    Ok(tried)
}
