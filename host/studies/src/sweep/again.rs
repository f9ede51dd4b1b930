//! Repetition of a sweep from its folder.

use crate::sweep::Points;
use crate::sweep::plan::Plan;
use crate::sweep::recipe::{Drawing, Recipe};
use crate::sweep::store::{POINTS, read_about};
use crate::sweep::store_error::{StoreError, at};
use crate::sweep::table::Format;
use crepitus_scene::shipped::Source;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Sweep of a folder, to be run again.
#[derive(Debug)]
pub struct Again {
    /// Plan with the same points.
    pub plan: Plan,
    /// Table of the folder: its format and SHA-256.
    pub table: Option<(Format, String)>,
    /// Commit of the program that ran it, if it is known.
    pub commit: Option<String>,
    /// Version of that program.
    pub version: String,
}

impl Again {
    /// Reads the plan of a sweep from its folder. A recording is looked for where it was, under the path that the
    /// scene has, and in the folder itself; one with another content is refused.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn of(folder: &Path) -> Result<Self, StoreError> {
        let about = read_about(folder)?;
        let (identity, mut recipe) = (about.identity, about.recipe);
        if let Drawing::Listed { points } = &mut recipe.design {
            *points = Some(points_in(folder)?);
        }
        let plan = plan(folder, &identity.scene, &recipe)?;
        let version = identity.crepitus_version.clone();
        // The digest is that of the program's own version.
        if plan.identity().crepitus_version == version && *plan.identity() != identity {
            return Err(changed(
                folder,
                "sweep.json or points.csv was changed: they are not those of the sweep that was run",
            ));
        }
        Ok(Self {
            plan,
            table: about
                .table
                .and_then(|table| Some((Format::of_file(&table.file)?, table.sha256))),
            commit: recipe.crepitus_commit,
            version,
        })
    }

    /// Describes how this program differs from the one that ran the sweep.
    pub fn other_program(&self, commit: Option<&str>) -> Option<String> {
        let version = env!("CARGO_PKG_VERSION");
        if self.version != version {
            return Some(format!(
                "the sweep that is repeated was of crepitus {}, and this is {version}: its rows may differ",
                self.version
            ));
        }
        let (then, now) = (self.commit.as_deref()?, commit?);
        (then != now).then(|| {
            format!(
                "the sweep that is repeated was of commit {then}, and this program is of {now}: its rows may differ"
            )
        })
    }
}

fn changed(folder: &Path, why: impl Into<String>) -> StoreError {
    StoreError::Changed {
        folder: folder.to_owned(),
        why: why.into(),
    }
}

fn points_in(folder: &Path) -> Result<Points, StoreError> {
    let path = folder.join(POINTS);
    let file = File::open(&path).map_err(at(&path))?;
    Points::from_written(BufReader::new(file))
        .map_err(|why| changed(folder, format!("{POINTS}: {why}")))
}

/// Creates the plan, with the recording wherever it is now.
fn plan(folder: &Path, scene: &str, recipe: &Recipe) -> Result<Plan, StoreError> {
    let source = Source::of_text(PathBuf::from(scene), recipe.scene_toml.clone());
    let design = (recipe.design.design()).map_err(|e| changed(folder, e.to_string()))?;
    let places = match &recipe.data {
        None => Vec::new(),
        Some(data) => {
            let then = Path::new(&data.file);
            // One that is not whole would begin at the scene's file.
            let folder = std::path::absolute(folder).map_err(at(folder))?;
            let beside = then.file_name().map(|name| folder.join(name));
            [Some(then.to_owned()), beside]
                .into_iter()
                .flatten()
                .collect()
        }
    };
    let mut refusal = None;
    for place in std::iter::once(None).chain(places.into_iter().map(Some)) {
        if place.as_ref().is_some_and(|place| !place.is_file()) {
            continue;
        }
        let overrides = recipe.overrides.clone();
        let plan = Plan::with_data(source.clone(), overrides, design.clone(), place.as_deref());
        let why = match plan {
            Ok(plan) => match (&recipe.data, &plan.data) {
                (Some(then), Some(now)) if then.sha256 != now.sha256 => changed(
                    folder,
                    format!(
                        "the recording {} has changed since: its SHA-256 was {}, and is {}",
                        now.file, then.sha256, now.sha256
                    ),
                ),
                _ => return Ok(plan),
            },
            Err(error) => match (&recipe.data, &place) {
                (Some(data), None) => {
                    let why = format!(
                        "{error}; the recording was {}: put it into this folder",
                        data.file
                    );
                    changed(folder, why)
                }
                _ => StoreError::Scene(error),
            },
        };
        // The one of a file that is there tells most.
        refusal = Some(why);
    }
    Err(refusal.unwrap_or_else(|| changed(folder, "the scene cannot be read")))
}
