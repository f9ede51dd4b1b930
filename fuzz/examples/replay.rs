//! Runs a target over files: `replay TARGET < names`, with a name in each line.
//! `fuzz/places.py` builds it with coverage instrumentation.

use crepitus_fuzz::TARGETS;
use std::{env, error::Error, fs, io};

fn main() -> Result<(), Box<dyn Error>> {
    let wanted = env::args().nth(1).unwrap_or_default();
    let target = TARGETS.iter().find(|(name, _)| *name == wanted);
    let (_, body) = target.ok_or_else(|| format!("no target is named {wanted:?}"))?;
    for name in io::stdin().lines() {
        body(&fs::read(name?)?);
    }
    Ok(())
}
