//! Recipe of a sweep: everything that repeats it, in its folder.

use crate::sweep::design::{Design, DesignError, Points, Sampled};
use crate::sweep::{Axis, Plan};
use crepitus_scene::Overrides;
use serde::{Deserialize, Serialize};

/// Scene, changes and design of a sweep, with the program that ran it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// Commit that the program was built from, if it is known.
    pub crepitus_commit: Option<String>,
    /// Text of the scene, as it was given.
    pub scene_toml: String,
    /// Scene with the changes and with every default written out, before a point's values.
    pub scene_as_run: String,
    /// Recording that the motion is read from.
    pub data: Option<Data>,
    /// Changes in every run: those of `--set` and of other flags.
    pub overrides: Overrides,
    /// Points.
    pub design: Drawing,
}

/// Recording of a motion.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Data {
    /// Whole path of the file.
    pub file: String,
    /// SHA-256 of its content, in hex digits.
    pub sha256: String,
}

/// Design as a file has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Drawing {
    /// Every combination of the axes' values.
    Grid {
        /// Axes.
        vary: Vec<Axis>,
    },
    /// A Latin hypercube.
    Latin {
        /// Axes.
        vary: Vec<Axis>,
        /// Number of points.
        count: u64,
        /// Seed.
        seed: u64,
    },
    /// Sobol's sequence with a digital shift.
    Sobol {
        /// Axes.
        vary: Vec<Axis>,
        /// Number of points.
        count: u64,
        /// Seed.
        seed: u64,
    },
    /// Points of another program, in a file of their own beside this.
    Listed {
        /// The points.
        #[serde(skip)]
        points: Option<Points>,
    },
}

impl Recipe {
    /// Returns the recipe of a plan, for a program of this commit.
    pub fn of(plan: &Plan, commit: Option<&str>) -> Self {
        Self {
            crepitus_commit: commit.map(str::to_owned),
            scene_toml: plan.source.text.clone(),
            scene_as_run: plan.as_run.clone(),
            data: plan.data.clone(),
            overrides: plan.overrides.clone(),
            design: Drawing::of(&plan.design),
        }
    }
}

impl Drawing {
    fn of(design: &Design) -> Self {
        match design.clone() {
            Design::Grid(vary) => Self::Grid { vary },
            Design::LatinHypercube(Sampled { axes, count, seed }) => Self::Latin {
                vary: axes,
                count,
                seed,
            },
            Design::Sobol(Sampled { axes, count, seed }) => Self::Sobol {
                vary: axes,
                count,
                seed,
            },
            Design::Listed(points) => Self::Listed {
                points: Some(points),
            },
        }
    }

    /// Returns the points that have a file of their own.
    pub(crate) const fn points(&self) -> Option<&Points> {
        match self {
            Self::Listed { points } => points.as_ref(),
            _ => None,
        }
    }

    /// Returns the design; that of listed points has no axis until they have been read.
    ///
    /// # Errors
    /// [`DesignError`].
    pub(crate) fn design(&self) -> Result<Design, DesignError> {
        let sampled = |vary: &[Axis], count, seed| Sampled {
            axes: vary.to_vec(),
            count,
            seed,
        };
        match self {
            Self::Grid { vary } => Design::grid(vary.clone()),
            Self::Latin { vary, count, seed } => {
                Design::latin_hypercube(sampled(vary, *count, *seed))
            }
            Self::Sobol { vary, count, seed } => Design::sobol(sampled(vary, *count, *seed)),
            Self::Listed { points } => {
                let points = points.clone().ok_or(DesignError::NoAxis)?;
                Ok(Design::Listed(points))
            }
        }
    }
}
