//! Plan of a sweep: a scene, its overrides and a design.

use crate::sweep::design::Design;
use crate::sweep::pool::{Threads, most_at_once};
use crate::sweep::recipe::Data;
use crate::sweep::row::Row;
use crepitus_files::json_path;
use crepitus_files::output::hex;
use crepitus_scene::run::RunError;
use crepitus_scene::shipped::Source;
use crepitus_scene::{Overrides, Scene, SceneError, Summary};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Plan of a sweep. Equal plans have equal rows, on any computer.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(super) source: Source,
    pub(super) overrides: Overrides,
    pub(super) design: Design,
    identity: Identity,
    /// Scene before a point's values, with every default written out.
    pub(super) as_run: String,
    /// Recording of the scene.
    pub(super) data: Option<Data>,
    /// Path of the recording, where it is not the scene's.
    data_file: Option<String>,
    /// The most points of a thread at once.
    at_once: u64,
}

/// Identity of a sweep; a folder with another one is refused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the program: other versions may have other numbers.
    pub crepitus_version: String,
    /// The scene file.
    pub scene: String,
    /// Title of the scene.
    pub title: String,
    /// Varied keys.
    pub paths: Vec<String>,
    /// Number of runs.
    pub runs: u64,
    /// Seed of sampled points.
    pub design_seed: Option<u64>,
    /// SHA-256 of scene, overrides, recording and points.
    pub sha256: String,
}

impl Identity {
    /// Returns the SHA-256 of everything that tells this sweep from another, in hex digits.
    #[must_use]
    pub fn id(&self) -> String {
        let mut sha = Sha256::new();
        let mut add = |text: &str| {
            sha.update((text.len() as u64).to_le_bytes());
            sha.update(text);
        };
        add(&self.crepitus_version);
        add(&self.scene);
        add(&self.title);
        add(&self.paths.join("\n"));
        add(&self.runs.to_string());
        add(&format!("{:?}", self.design_seed));
        add(&self.sha256);
        hex(&sha.finalize())
    }
}

/// Part `number` of `of` of a sweep. The parts are disjoint, complete and of sizes that differ by
/// at most one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: u64,
    of: u64,
}

impl Shard {
    /// The whole sweep.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Creates shard `number`, from 1, of `of`.
    ///
    /// # Errors
    /// A text, if `number` is not in 1 to `of`.
    pub fn new(number: u64, of: u64) -> Result<Self, String> {
        if (1..=of).contains(&number) {
            Ok(Self { number, of })
        } else {
            Err(format!(
                "there is no part {number} of {of}: they are counted from 1"
            ))
        }
    }

    /// Returns the points of the shard, of a sweep with `runs` points.
    pub fn points(self, runs: u64) -> Range<u64> {
        let upto = |part: u64| {
            let point = u128::from(runs) * u128::from(part) / u128::from(self.of);
            u64::try_from(point).unwrap_or(runs)
        };
        upto(self.number - 1)..upto(self.number)
    }
}

/// Formats the shard as `I/N`.
impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// Parses `I/N`.
impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts = text.split_once('/');
        let number = |text: &str| text.trim().parse::<u64>().ok();
        match parts.and_then(|(i, n)| Some((number(i)?, number(n)?))) {
            Some((i, n)) => Self::new(i, n),
            None => Err("expected I/N, for example 3/16".to_owned()),
        }
    }
}

impl Plan {
    /// Creates the plan of a scene. Checks the scene, and some of the points, so that a misspelt
    /// key is an error and not a table of failed runs.
    ///
    /// # Errors
    /// [`SceneError`] of the scene, or of the first point if every point that was tried is invalid.
    pub fn new(source: Source, overrides: Overrides, design: Design) -> Result<Self, SceneError> {
        Self::with_data(source, overrides, design, None)
    }

    /// Creates the plan of a scene whose recording is at another path.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(super) fn with_data(
        source: Source,
        overrides: Overrides,
        design: Design,
        data_file: Option<&Path>,
    ) -> Result<Self, SceneError> {
        // A text of JSON is one of TOML.
        let data_file = data_file.map(|file| serde_json::Value::from(json_path(file)).to_string());
        let scene = source.scene(&moved(&overrides, data_file.as_deref()))?;
        let mut plan = Self {
            identity: Identity {
                crepitus_version: env!("CARGO_PKG_VERSION").to_owned(),
                scene: source.file.display().to_string(),
                title: scene.title.clone(),
                paths: design.paths().into_iter().map(str::to_owned).collect(),
                runs: design.runs(),
                design_seed: design.seed(),
                sha256: String::new(),
            },
            source,
            overrides,
            design,
            as_run: scene.as_run.clone(),
            data: scene.data.as_ref().map(|data| Data {
                file: json_path(&data.file),
                sha256: data.sha256.clone(),
            }),
            data_file,
            at_once: 1,
        };
        plan.identity.sha256 = plan.digest(&scene);
        if let Some(scene) = plan.first_scene()? {
            plan.at_once = most_at_once(&scene);
        }
        Ok(plan)
    }

    /// Returns the identity.
    pub const fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Returns the number of runs.
    pub const fn runs(&self) -> u64 {
        self.identity.runs
    }

    /// Returns the scene of a point.
    ///
    /// # Errors
    /// [`SceneError`] if the values of the point are invalid.
    pub fn scene(&self, point: u64) -> Result<Scene, SceneError> {
        let values = self.design.point(point);
        self.scene_with(self.design.paths().into_iter().zip(values))
    }

    /// Returns the files that the scene is read from.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let data = self.data.as_ref().map(|data| PathBuf::from(&data.file));
        [Some(self.source.file.clone()), data]
            .into_iter()
            .flatten()
            .collect()
    }

    /// Runs a point by `run`. A failed run gives a row with its reason.
    ///
    /// # Errors
    /// Those of the observer.
    pub fn run<E>(
        &self,
        point: u64,
        run: impl FnOnce(&Scene) -> Result<Summary, RunError<E>>,
    ) -> Result<Row, E> {
        match self.begin(point) {
            Ok((row, scene)) => finish(row, || run(&scene)),
            Err(row) => Ok(row),
        }
    }

    /// Returns the row of a point, without results, and its scene; the row alone, with the reason, if there is
    /// no scene.
    pub(crate) fn begin(&self, point: u64) -> Result<(Row, Scene), Row> {
        let values = self.design.point(point);
        let paths = self.design.paths();
        let mut row = Row::of_point(point, &paths, &values, self.design.seed());
        match self.scene_with(paths.into_iter().zip(values)) {
            Ok(scene) => Ok((row, scene)),
            Err(e) => {
                row.add(Err(e.to_string()));
                Err(row)
            }
        }
    }

    /// Returns so many threads, with the number of points that each takes at once: several where they may be run
    /// together.
    pub const fn threads(&self, count: usize) -> Threads {
        Threads {
            count,
            at_once: self.at_once,
        }
    }

    fn scene_with<'p>(
        &self,
        point: impl Iterator<Item = (&'p str, String)>,
    ) -> Result<Scene, SceneError> {
        let point = point.map(|(path, value)| (path.to_owned(), value));
        let mut overrides = moved(&self.overrides, self.data_file.as_deref());
        overrides.set.extend(point);
        self.source.scene(&overrides)
    }

    /// Returns the first valid scene of some points; the error is that of the first point.
    fn first_scene(&self) -> Result<Option<Scene>, SceneError> {
        /// Number of points that are tried, spread over the sweep.
        const TRIED: u64 = 64;
        let tried = TRIED.min(self.runs());
        let points = (0..tried).map(|i| i * (self.runs() / tried.max(1)));
        let mut first = None;
        for point in points {
            match self.scene(point) {
                Ok(scene) => return Ok(Some(scene)),
                Err(e) => first = first.or(Some(e)),
            }
        }
        first.map_or(Ok(None), Err)
    }

    fn digest(&self, scene: &Scene) -> String {
        let mut sha = Sha256::new();
        let mut add = |text: &str| {
            sha.update((text.len() as u64).to_le_bytes());
            sha.update(text);
        };
        add(&self.source.text);
        add(&format!("{:?}", self.overrides));
        add(scene.data.as_ref().map_or("", |data| data.sha256.as_str()));
        add(&format!("{:?}", self.design));
        hex(&sha.finalize())
    }
}

/// Returns overrides with the recording at another path, as TOML.
fn moved(overrides: &Overrides, data_file: Option<&str>) -> Overrides {
    let mut overrides = overrides.clone();
    if let Some(file) = data_file {
        overrides.set.retain(|(path, _)| path != "motion.file");
        (overrides.set).push(("motion.file".to_owned(), file.to_owned()));
    }
    overrides
}

/// Adds the outcome of a run to its row, or the reason of its failure.
///
/// # Errors
/// Those of the observer.
pub(crate) fn finish<E>(
    mut row: Row,
    run: impl FnOnce() -> Result<Summary, RunError<E>>,
) -> Result<Row, E> {
    // A defect in one run is not to end a million others.
    row.add(match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Ok(summary)) => Ok(summary),
        Ok(Err(RunError::Observer(e))) => return Err(e),
        Ok(Err(RunError::Settings(e))) => Err(e.to_string()),
        Ok(Err(RunError::Diverged(e))) => Err(e.to_string()),
        Ok(Err(_)) => Err("the run failed".to_owned()),
        Err(_) => Err("a defect of the program: the run panicked".to_owned()),
    });
    Ok(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_disjoint_and_complete_and_even() {
        for runs in [0, 1, 2, 9, 10, 100, 1_000_000_007] {
            for of in [1, 2, 3, 7, 10, 64] {
                let mut next = 0;
                for number in 1..=of {
                    let points = Shard::new(number, of).unwrap().points(runs);
                    assert_eq!(points.start, next);
                    let size = points.end - points.start;
                    assert!(size == runs / of || size == runs / of + 1);
                    next = points.end;
                }
                assert_eq!(next, runs);
            }
        }
        assert!(
            Shard::new(0, 3).is_err() && Shard::new(4, 3).is_err() && Shard::new(1, 0).is_err()
        );
    }
}
