//! `crepitus-faults`: plants the faults of `faults.toml` one at a time and
//! writes which hard cases and which of the model's tests notice them.

use clap::Parser;
use crepitus_faults::outcome::{Outcome, fingerprint};
use crepitus_faults::trial::Workshop;
use crepitus_faults::{fault, page, tree};
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Plants faults in a copy of the sources and reports what notices them.
#[derive(Parser)]
#[command(
    after_help = "Example: cargo run -p crepitus-faults -- --only period-in-f32\n\n\
    CREPITUS_CARGO names the cargo that builds the copy. A run that was interrupted goes on where it ended."
)]
struct Arguments {
    /// Try only this fault; may be given several times.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// List the faults and end.
    #[arg(long)]
    list: bool,
    /// Root of the repository.
    #[arg(long, value_name = "DIR", default_value = ".")]
    root: PathBuf,
    /// Scratch folder: the copy, its build, what is known so far.
    #[arg(long, value_name = "DIR", default_value = "target/faults")]
    scratch: PathBuf,
    /// Write the page of all faults here.
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
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
    let all = fault::all()?;
    if arguments.list {
        for fault in &all {
            println!("{:28} {}", fault.name, fault.what);
        }
        return Ok(ExitCode::SUCCESS);
    }
    if let Some(unknown) = arguments
        .only
        .iter()
        .find(|name| !all.iter().any(|fault| fault.name == **name))
    {
        eprintln!("crepitus-faults: no fault `{unknown}`; --list shows all");
        return Ok(ExitCode::from(2));
    }
    let wanted = |name: &String| arguments.only.is_empty() || arguments.only.contains(name);
    let scratch = std::path::absolute(&arguments.scratch)?;
    let known = scratch.join("known");
    std::fs::create_dir_all(&known)?;
    let sources = tree::fingerprint(&arguments.root)?;
    let mut workshop: Option<Workshop> = None;
    let mut outcomes = Vec::new();
    for (number, fault) in (1..).zip(&all) {
        let print = fingerprint(sources, fault);
        let outcome = match Outcome::load(&known, &fault.name, print) {
            Some(outcome) => outcome,
            None if !wanted(&fault.name) => continue,
            None => {
                let open = match workshop.take() {
                    Some(open) => open,
                    None => {
                        eprintln!(
                            "building with {} faults; without any in force, all must hold",
                            all.len()
                        );
                        let cargo =
                            std::env::var("CREPITUS_CARGO").unwrap_or_else(|_| "cargo".to_owned());
                        Workshop::open(&arguments.root, &scratch, &cargo, &all)?
                    }
                };
                let begun = Instant::now();
                let outcome = workshop.insert(open).try_fault(number, fault, print)?;
                outcome.save(&known)?;
                let (all, took) = (all.len(), begun.elapsed().as_secs());
                eprintln!("{number:2}/{all} {} ({took} s)", fault.name);
                outcome
            }
        };
        if wanted(&fault.name) {
            println!("{}", page::line(&outcome));
        }
        outcomes.push((fault.clone(), outcome));
    }
    println!("{}", page::totals(&outcomes));
    if let Some(file) = &arguments.page {
        if outcomes.len() < all.len() {
            let left = all.len() - outcomes.len();
            return Err(format!("no page: {left} faults are not tried yet").into());
        }
        std::fs::write(file, page::page(&outcomes))?;
        println!("wrote {}", file.display());
    }
    let unexplained = outcomes.iter().any(|(fault, outcome)| {
        (outcome.noticed_by().next().is_none() && fault.unseen_by_cases.is_none())
            || (outcome.test.is_none() && fault.unseen_by_tests.is_none())
    });
    Ok(if unexplained {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    })
}
