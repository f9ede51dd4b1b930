//! `crepitus-faults`: plants the faults of `faults.toml` one at a time and
//! writes which hard cases and which of the model's tests detect them; those of
//! `firmware.toml` with the emulator's tests.

mod firmware_run;
mod mutants_run;

use clap::Parser;
use crepitus_tools::faults::fault::Fault;
use crepitus_tools::faults::outcome::{Outcome, fingerprint};
use crepitus_tools::faults::trial::{TrialError, Workshop};
use crepitus_tools::faults::{fault, page, tree};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Plants faults in a copy of the sources and reports the checks that detect them.
#[derive(Parser)]
#[command(
    after_help = "Example: cargo run -p crepitus-tools --bin crepitus-faults -- --only period-in-f32\n\n\
    CREPITUS_CARGO names the cargo that builds the copy. A run that was interrupted goes on where it ended."
)]
struct Arguments {
    /// Try only this fault; may be given several times.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// List the faults and exit.
    #[arg(long)]
    list: bool,
    /// Plant the faults of the drive's firmware instead of those of the model.
    #[arg(long)]
    firmware: bool,
    /// Try every mutant that `cargo mutants` lists of this crate: model, device or protocol.
    #[arg(long, value_name = "CRATE", conflicts_with_all = ["only", "list", "firmware", "cases_only", "page"])]
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
    /// Run the hard cases only, and leave the model's tests to a later run.
    #[arg(long)]
    cases_only: bool,
    /// Root of the repository.
    #[arg(long, value_name = "DIR", default_value = ".")]
    root: PathBuf,
    /// Scratch folder: the copy, its build, results so far.
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
    if let Some(folder) = &arguments.mutants {
        return mutants_run::work(arguments, folder);
    }
    if arguments.firmware {
        return firmware_run::work(arguments);
    }
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
    let mut bench = Bench {
        arguments,
        scratch: &scratch,
        faults: &all,
        workshop: None,
    };
    let mut outcomes = Vec::new();
    for (number, fault) in (1..).zip(&all) {
        let print = fingerprint(sources, fault);
        let known_so_far = Outcome::load(&known, &fault.name, print);
        let outcome = if wanted(&fault.name) {
            let outcome = bench.complete(number, fault, print, known_so_far, &known)?;
            println!("{}", page::line(&outcome));
            outcome
        } else if let Some(outcome) = known_so_far {
            outcome
        } else {
            continue;
        };
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
            || (outcome.tested && outcome.test.is_none() && fault.unseen_by_tests.is_none())
    });
    Ok(if unexplained {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    })
}

/// Tries faults without a result; built when first needed.
struct Bench<'a> {
    arguments: &'a Arguments,
    scratch: &'a Path,
    faults: &'a [Fault],
    workshop: Option<Workshop>,
}

impl Bench<'_> {
    fn workshop(&mut self) -> Result<&Workshop, TrialError> {
        let open = if let Some(open) = self.workshop.take() {
            open
        } else {
            let all = self.faults.len();
            eprintln!("building with {all} faults; with none in force, all must hold");
            let cargo = std::env::var("CREPITUS_CARGO").unwrap_or_else(|_| "cargo".to_owned());
            let (root, tests) = (&self.arguments.root, !self.arguments.cases_only);
            Workshop::open(root, self.scratch, &cargo, self.faults, tests)?
        };
        Ok(self.workshop.insert(open))
    }

    /// The outcome of a fault, with its `known` results.
    fn complete(
        &mut self,
        number: usize,
        fault: &Fault,
        print: u64,
        known: Option<Outcome>,
        folder: &Path,
    ) -> Result<Outcome, Box<dyn Error>> {
        let (begun, all) = (Instant::now(), self.faults.len());
        let mut outcome = if let Some(outcome) = known {
            outcome
        } else {
            let outcome = self.workshop()?.try_cases(number, fault, print)?;
            outcome.save(folder)?;
            outcome
        };
        if !outcome.tested && !self.arguments.cases_only {
            self.workshop()?.try_tests(number, &mut outcome)?;
            outcome.save(folder)?;
        }
        let took = begun.elapsed().as_secs();
        if took > 0 {
            eprintln!("{number:2}/{all} {} ({took} s)", fault.name);
        }
        Ok(outcome)
    }
}
