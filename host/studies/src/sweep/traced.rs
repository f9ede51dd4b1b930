//! Runs with a trace file each.

use crate::sweep::plan::Plan;
use crate::sweep::pool::{Ended, Stop, Unseen};
use crate::sweep::row::Row;
use crate::sweep::store_error::{StoreError, at};
use crepitus_files::output::{Hashed, OwnedFolder, temporary_in};
use crepitus_scene::output::TraceCsv;
use crepitus_scene::run::{columns, is_stepless};
use crepitus_scene::{Observer, RunError, run};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
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

/// Folder of traces, named by the numbers of their points.
#[derive(Clone, Debug)]
pub struct Traces {
    folder: Arc<Mutex<OwnedFolder>>,
    path: PathBuf,
}

/// Name of the trace of a point.
fn name_of(point: u64) -> String {
    format!("{point:010}.csv")
}

/// Parses the point from the name of a trace.
fn point_of(name: &str) -> Option<u64> {
    let point = name.strip_suffix(".csv")?.parse().ok()?;
    (name_of(point) == name).then_some(point)
}

impl Traces {
    /// Opens the folder for the traces of these points.
    ///
    /// # Errors
    /// If there is a file of one of these names that no run of this program has written.
    pub(crate) fn open(folder: OwnedFolder, points: &[Range<u64>]) -> Result<Self, StoreError> {
        let path = folder.path().to_owned();
        let is_wanted = |point: u64| points.iter().any(|points| points.contains(&point));
        let mut there = Vec::new();
        for entry in fs::read_dir(&path).map_err(at(&path))? {
            let name = entry.map_err(at(&path))?.file_name();
            there.extend(name.into_string().ok());
        }
        there.retain(|name| point_of(name).is_some_and(is_wanted));
        there.sort();
        folder.check(&there)?;
        Ok(Self {
            folder: Arc::new(Mutex::new(folder)),
            path,
        })
    }

    fn put(&self, file: NamedTempFile, point: u64) -> io::Result<()> {
        let file = Hashed::of(file.into_temp_path())?;
        let mut folder = self.folder.lock().unwrap_or_else(PoisonError::into_inner);
        folder.put(file, &name_of(point)).map_err(io::Error::other)
    }
}

/// Runs a point and writes its trace, whole or not at all.
///
/// # Errors
/// [`Ended`].
pub fn traced(plan: &Plan, point: u64, to: &Traces, stop: &Stop) -> Result<Row, Ended> {
    stop.check()?;
    plan.run(point, |scene| {
        let failed = |e: io::Error| RunError::Observer(Ended::Failed(e));
        let file = temporary_in(&to.path).map_err(failed)?;
        let csv = TraceCsv::new(BufWriter::new(file), columns(scene)).map_err(failed)?;
        let mut trace = Trace { csv, stop };
        let summary = run(scene, &mut trace)?;
        let mut file = trace.csv.into_inner();
        file.flush().map_err(failed)?;
        let file = file.into_inner().map_err(|e| failed(e.into_error()))?;
        to.put(file, point).map_err(failed)?;
        // A row is one of its point, to the bit, whether there is a trace or not.
        if is_stepless(scene) {
            run(scene, &mut Unseen(stop))
        } else {
            Ok(summary)
        }
    })
}
