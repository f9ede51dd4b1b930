//! `crepitus sweep --again DIR`: the sweep of a folder, once more.

use super::{Arguments, Outcome, run_into, store_failure};
use crate::failure::{Failure, warn};
use crate::interrupt;
use crate::recorded::beside;
use crepitus_studies::sweep::{Again, Format};
use std::path::{Path, PathBuf};

pub(super) fn run(folder: &Path, arguments: &Arguments, as_json: bool) -> Result<(), Failure> {
    let again = Again::of(folder).map_err(store_failure)?;
    if let Some(difference) = again.other_program(option_env!("CREPITUS_COMMIT")) {
        warn(difference);
    }
    interrupt::listen();
    let then = again.table.as_ref();
    let format = (arguments.format)
        .or(then.map(|(format, _)| *format))
        .unwrap_or(Format::DEFAULT);
    let out = match &arguments.out {
        Some(out) => out.clone(),
        // The ending follows the name, not the slash that a shell completes.
        None if folder.file_name().is_some() => {
            beside(&folder.components().collect::<PathBuf>(), "-again")
        }
        None => {
            return Err(Failure::input(
                "--again: this path has no name to add -again to: name a folder with --out",
            ));
        }
    };
    let inputs = [folder.join("sweep.json")].into_iter();
    let outcome = run_into(&out, &again.plan, arguments, inputs, format)?;
    outcome.print(&again.plan, &out, as_json)?;
    match (&outcome, then) {
        (Outcome::Table(now, _), Some((of, sha256))) if *of == format && now.sha256 != *sha256 => {
            Err(Failure::Work(format!(
                "{} differs from the table of {}: its SHA-256 was {sha256}, and is {}",
                now.file.display(),
                folder.display(),
                now.sha256
            )))
        }
        _ => Ok(()),
    }
}
