//! Recordings of a bench.

use crate::failure::Failure;
use clap::{Args, ValueHint};
use crepitus_files::input;
use crepitus_identify::actuator::Series;
use std::path::{Path, PathBuf};

/// Which recordings.
#[derive(Debug, Args)]
pub(super) struct Recordings {
    /// Recording of a chirp on a bench, instead of one that the device plays: columns t_s, volts, amperes.
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    from: Option<PathBuf>,

    /// Recording of the chirp with the added mass, with the same columns.
    #[arg(long, value_name = "FILE", requires = "from", requires = "added_mass_g",
          value_hint = ValueHint::FilePath)]
    from_added: Option<PathBuf>,
}

/// Series that were measured.
#[derive(Debug)]
pub(super) struct Measured {
    /// Series without an added mass.
    pub(super) bare: Series,
    /// Series with the added mass, if it was measured.
    pub(super) with_added: Option<Series>,
}

impl Recordings {
    /// The files.
    pub(super) fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.from.iter().chain(&self.from_added)
    }

    /// Reads them, if files are named.
    pub(super) fn read(&self, needs_second: bool) -> Result<Option<Measured>, Failure> {
        let Some(from) = &self.from else {
            return Ok(None);
        };
        if needs_second && self.from_added.is_none() {
            return Err(Failure::input(
                "--added-mass-g needs the recording of the chirp with that mass: --from-added FILE",
            ));
        }
        Ok(Some(Measured {
            bare: series(from)?,
            with_added: self.from_added.as_deref().map(series).transpose()?,
        }))
    }
}

fn series(path: &Path) -> Result<Series, Failure> {
    let table = input::read(path, input::TABLE_BYTES)
        .map_err(|error| Failure::Input(format!("{}: cannot be read: {error}", path.display())))?;
    Series::from_csv(table.as_slice())
        .map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
}
