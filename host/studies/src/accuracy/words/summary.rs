//! `summary.json` of a study.

use super::AccuracyOutcome;
use crate::accuracy::Study;
use crate::machine::{self, Machine};
use crepitus_scene::cpu_time::CLOCK;
use serde::Serialize;

/// Version of this form.
const SUMMARY_VERSION: u32 = 1;

/// A study without its points.
#[derive(Serialize)]
pub(super) struct Summary<'a> {
    #[serde(rename = "summary_version")]
    version: u32,
    crepitus_version: &'static str,
    /// Computer on which the times were measured.
    host: String,
    /// Its processor, and the build.
    machine: Machine,
    /// Clock of these times.
    clock: &'static str,
    quick: bool,
    precisions: Vec<&'static str>,
    points: usize,
    #[serde(flatten)]
    study: &'a Study,
}

impl<'a> Summary<'a> {
    pub(super) fn new(of: &AccuracyOutcome<'a>) -> Self {
        Self {
            version: SUMMARY_VERSION,
            crepitus_version: env!("CARGO_PKG_VERSION"),
            host: machine::host(),
            machine: Machine::here(),
            clock: CLOCK,
            quick: of.is_quick,
            precisions: of.precisions.iter().map(|p| p.name()).collect(),
            points: of.study.points.len(),
            study: of.study,
        }
    }
}
