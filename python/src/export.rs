//! A recording as a Parquet file.

use crate::errors;
use crate::signals::Signals;
use crepitus_files::output::{Inputs, NewFile};
use crepitus_recording::{Damage, Recording, parquet_writer};
use pyo3::exceptions::{PyNotImplementedError, PyOSError};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Writes a recording as a Parquet file, whole or not at all; returns its number of rows.
#[pyfunction]
pub(crate) fn export_parquet(
    py: Python<'_>,
    recording: PathBuf,
    to: PathBuf,
    force: bool,
) -> PyResult<u64> {
    let Some(write) = parquet_writer() else {
        return Err(PyNotImplementedError::new_err(
            "this package was built without Parquet: build it with its default features",
        ));
    };
    py.detach(|| {
        let failed = |error: &dyn ToString| PyOSError::new_err(error.to_string());
        let source = Recording::open(&recording, Damage::Refuse)
            .map_err(|error| errors::device(error.to_string()))?;
        let file = NewFile::create(&to, force, &Inputs::of([&recording]))
            .map_err(|error| failed(&error))?;
        let mut signals = Signals::new();
        let mut raised = None;
        let rows = write(&source, file.as_file(), &mut |_| {
            raised = signals.check().err();
            raised.is_none()
        });
        match (rows, raised) {
            (_, Some(raised)) => Err(raised),
            (rows, None) => {
                let rows = rows.map_err(|error| failed(&error))?;
                file.persist().map_err(|error| failed(&error))?;
                Ok(rows)
            }
        }
    })
}
