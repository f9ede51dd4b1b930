//! `summary.json` of a study.

use super::plan::Studied;
use crate::studying;
use crepitus_scene::cpu_time::CLOCK;
use crepitus_studies::accuracy::Study;
use serde::Serialize;

/// Version of this form.
const SUMMARY_VERSION: u32 = 1;

/// A study without its points.
#[derive(Serialize)]
pub(super) struct Summary<'a> {
    #[serde(rename = "summary_version")]
    version: u32,
    pub(super) crepitus_version: &'static str,
    /// Computer on which the times were measured.
    host: String,
    /// Clock of these times.
    clock: &'static str,
    quick: bool,
    precisions: Vec<&'static str>,
    points: usize,
    #[serde(flatten)]
    study: &'a Study,
}

impl<'a> Summary<'a> {
    pub(super) fn new(quick: bool, studied: &Studied, study: &'a Study) -> Self {
        Self {
            version: SUMMARY_VERSION,
            crepitus_version: env!("CARGO_PKG_VERSION"),
            host: studying::host(),
            clock: CLOCK,
            quick,
            precisions: studied.plan.precisions.iter().map(|p| p.name()).collect(),
            points: study.points.len(),
            study,
        }
    }

    /// Computer, clock and build of the measured times.
    pub(super) fn measured_on(&self) -> String {
        studying::measured_on(&self.host)
    }
}
