//! The faults of the firmware, one after the other.

use crate::Arguments;
use crepitus_tools::faults::firmware;
use crepitus_tools::faults::firmware_page;
use crepitus_tools::faults::firmware_trial::{FirmwareOutcome, FirmwareWorkshop, fingerprint};
use crepitus_tools::faults::tree;
use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

/// Tries all faults that have no result yet, and writes the page.
pub(crate) fn work(arguments: &Arguments) -> Result<ExitCode, Box<dyn Error>> {
    let all = firmware::all()?;
    if arguments.list {
        for fault in &all {
            println!("{:28} {}", fault.name, fault.what);
        }
        return Ok(ExitCode::SUCCESS);
    }
    let is_known = |name: &&String| all.iter().any(|fault| fault.name == **name);
    if let Some(unknown) = arguments.only.iter().find(|name| !is_known(name)) {
        eprintln!(
            "crepitus-faults: no fault `{unknown}` of the firmware; --firmware --list shows all"
        );
        return Ok(ExitCode::from(2));
    }
    let scratch = std::path::absolute(&arguments.scratch)?;
    let known = scratch.join("known-firmware");
    std::fs::create_dir_all(&known)?;
    let sources = tree::firmware_fingerprint(&arguments.root)?;
    let (mut workshop, mut outcomes) = (None, Vec::new());
    for (number, fault) in (1..).zip(&all) {
        let print = fingerprint(sources, fault);
        let outcome = if let Some(outcome) = FirmwareOutcome::load(&known, &fault.name, print) {
            outcome
        } else if arguments.only.is_empty() || arguments.only.contains(&fault.name) {
            let begun = Instant::now();
            if workshop.is_none() {
                eprintln!("building the tests and the images; without a fault, all must hold");
                let cargo = std::env::var("CREPITUS_CARGO").unwrap_or_else(|_| "cargo".to_owned());
                workshop = Some(FirmwareWorkshop::open(&arguments.root, &scratch, &cargo)?);
            }
            let Some(open) = &mut workshop else {
                continue;
            };
            let outcome = open.try_fault(fault, print)?;
            outcome.save(&known)?;
            let took = begun.elapsed().as_secs();
            eprintln!("{number:2}/{} {} ({took} s)", all.len(), fault.name);
            outcome
        } else {
            continue;
        };
        println!("{}", firmware_page::line(&outcome));
        outcomes.push((fault.clone(), outcome));
    }
    println!("{}", firmware_page::totals(&outcomes));
    if let Some(file) = &arguments.page {
        if outcomes.len() < all.len() {
            let left = all.len() - outcomes.len();
            return Err(format!("no page: {left} faults are not tried yet").into());
        }
        std::fs::write(file, firmware_page::page(&outcomes))?;
        println!("wrote {}", file.display());
    }
    let holes = outcomes
        .iter()
        .any(|(fault, outcome)| !outcome.is_noticed() && fault.unseen.is_none());
    Ok(if holes {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    })
}
