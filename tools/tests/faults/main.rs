//! Planted faults as they are listed: see each module.

mod apply;
mod mutants;
