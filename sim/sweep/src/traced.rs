//! Runs with a trace file each.

use crate::parts::scratch_file;
use crate::plan::Plan;
use crate::pool::{Ended, Stop};
use crate::row::Row;
use crepitus_scene::output::TraceCsv;
use crepitus_scene::run::columns;
use crepitus_scene::{Observer, RunError, run};
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use tempfile::NamedTempFile;

/// Observer that writes each row and checks the stop flag.
struct Trace<'s> {
    csv: TraceCsv<BufWriter<NamedTempFile>>,
    stop: &'s Stop,
}

impl Observer for Trace<'_> {
    type Error = Ended;

    fn row(&mut self, values: &[f64]) -> Result<(), Ended> {
        self.csv.row(values).map_err(Ended::Failed)
    }

    fn progress(&mut self, _: f64) -> Result<(), Ended> {
        self.stop.check()
    }
}

/// Folders of traces.
#[derive(Clone, Debug)]
pub struct Traces {
    /// Complete traces, named by the number of their point.
    pub(crate) folder: PathBuf,
    /// Incomplete files.
    pub(crate) scratch: PathBuf,
}

/// Runs a point and writes its trace, whole or not at all.
///
/// # Errors
/// [`Ended`].
pub fn traced(plan: &Plan, point: u64, to: &Traces, stop: &Stop) -> Result<Row, Ended> {
    stop.check()?;
    plan.run(point, |scene| {
        let failed = |e: io::Error| RunError::Observer(Ended::Failed(e));
        let file = scratch_file(&to.scratch).map_err(failed)?;
        let csv = TraceCsv::new(BufWriter::new(file), columns(scene)).map_err(failed)?;
        let mut trace = Trace { csv, stop };
        let summary = run(scene, &mut trace)?;
        let mut file = trace.csv.into_inner();
        file.flush().map_err(failed)?;
        let file = file.into_inner().map_err(|e| failed(e.into_error()))?;
        file.persist(to.folder.join(format!("{point:010}.csv")))
            .map_err(|e| failed(e.error))?;
        Ok(summary)
    })
}
