//! A sweep: a scene, and the points of it that are run.

use crate::design::Design;
use crate::row::Row;
use crepitus_scene::run::RunError;
use crepitus_scene::shipped::Source;
use crepitus_scene::{Overrides, Scene, SceneError, Summary};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A sweep. Two programs that have the same one have the same rows.
#[derive(Clone, Debug)]
pub struct Plan {
    source: Source,
    overrides: Overrides,
    design: Design,
    identity: Identity,
}

/// What a sweep is known by: another one in its place is refused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the program: other versions may have other numbers.
    pub crepitus_version: String,
    /// The scene file.
    pub scene: String,
    /// Its title.
    pub title: String,
    /// Keys that are varied.
    pub paths: Vec<String>,
    /// How many runs.
    pub runs: u64,
    /// Seed of points that are drawn.
    pub design_seed: Option<u64>,
    /// SHA-256 of scene, overrides, recording and points.
    pub sha256: String,
}

/// One of `of` parts of a sweep: disjoint, together everything, as even as they can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: u64,
    of: u64,
}

impl Shard {
    /// Part `number`, from 1, of `of`.
    ///
    /// # Errors
    /// A text, if there is no such part.
    pub fn new(number: u64, of: u64) -> Result<Self, String> {
        if (1..=of).contains(&number) {
            Ok(Self { number, of })
        } else {
            Err(format!(
                "there is no part {number} of {of}: they are counted from 1"
            ))
        }
    }

    /// Its points, of this many.
    pub fn points(self, runs: u64) -> Range<u64> {
        let upto = |part: u64| {
            let point = u128::from(runs) * u128::from(part) / u128::from(self.of);
            u64::try_from(point).unwrap_or(runs)
        };
        upto(self.number - 1)..upto(self.number)
    }
}

impl Plan {
    /// A sweep of a scene. The scene is read and checked as it is; and some of the points,
    /// so that a misspelt key is an error and not a table of failed runs.
    ///
    /// # Errors
    /// What is wrong with the scene, or with every point that was tried.
    pub fn new(source: Source, overrides: Overrides, design: Design) -> Result<Self, SceneError> {
        let scene = source.scene(&overrides)?;
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
        };
        plan.identity.sha256 = plan.digest(&scene);
        plan.check_points()?;
        Ok(plan)
    }

    /// What it is known by.
    pub const fn identity(&self) -> &Identity {
        &self.identity
    }

    /// How many runs.
    pub const fn runs(&self) -> u64 {
        self.identity.runs
    }

    /// The scene of a point.
    ///
    /// # Errors
    /// What the values of the point make wrong.
    pub fn scene(&self, point: u64) -> Result<Scene, SceneError> {
        let values = self.design.point(point);
        self.scene_with(self.design.paths().into_iter().zip(values))
    }

    /// Runs a point by `run`. What goes wrong with the run is a row, too.
    ///
    /// # Errors
    /// Those of the observer.
    pub fn run<E>(
        &self,
        point: u64,
        run: impl FnOnce(&Scene) -> Result<Summary, RunError<E>>,
    ) -> Result<Row, E> {
        let values = self.design.point(point);
        let paths = self.design.paths();
        let mut row = Row::of_point(point, &paths, &values, self.design.seed());
        let scene = match self.scene_with(paths.into_iter().zip(values)) {
            Ok(scene) => scene,
            Err(e) => {
                row.add(Err(e.to_string()));
                return Ok(row);
            }
        };
        // A defect in one run is not to end a million others.
        let outcome = catch_unwind(AssertUnwindSafe(|| run(&scene)));
        row.add(match outcome {
            Ok(Ok(summary)) => Ok(summary),
            Ok(Err(RunError::Observer(e))) => return Err(e),
            Ok(Err(RunError::Settings(e))) => Err(e.to_string()),
            Ok(Err(RunError::Diverged(e))) => Err(e.to_string()),
            Ok(Err(_)) => Err("the run failed".to_owned()),
            Err(_) => Err("a defect of the program: the run panicked".to_owned()),
        });
        Ok(row)
    }

    fn scene_with<'p>(
        &self,
        point: impl Iterator<Item = (&'p str, String)>,
    ) -> Result<Scene, SceneError> {
        let point = point.map(|(path, value)| (path.to_owned(), value));
        let mut overrides = self.overrides.clone();
        overrides.set.extend(point);
        self.source.scene(&overrides)
    }

    /// The error of the first point, if no point of some is a scene.
    fn check_points(&self) -> Result<(), SceneError> {
        /// Points that are tried, from all over the sweep.
        const TRIED: u64 = 64;
        let tried = TRIED.min(self.runs());
        let points = (0..tried).map(|i| i * (self.runs() / tried.max(1)));
        let mut first = None;
        for point in points {
            match self.scene(point) {
                Ok(_) => return Ok(()),
                Err(e) => first = first.or(Some(e)),
            }
        }
        first.map_or(Ok(()), Err)
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
        let mut text = String::with_capacity(64);
        for byte in sha.finalize() {
            // Writing to a String cannot fail.
            let _ = write!(text, "{byte:02x}");
        }
        text
    }
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
