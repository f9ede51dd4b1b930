//! Experimental designs: the points of the axes that are run.

mod latin;
mod points;
mod sobol;

pub use points::{Points, PointsError};

use crate::sweep::axis::Axis;

/// Most runs of a sweep: more than anybody has time for, and few enough to count exactly.
pub const MOST_RUNS: u64 = 1_000_000_000;

/// Design of a sweep. Each point is a function of its number, so that any part of a sweep can be
/// run anywhere.
#[derive(Clone, Debug, PartialEq)]
pub enum Design {
    /// Every combination; the last axis is the fastest.
    Grid(Vec<Axis>),
    /// A Latin hypercube.
    LatinHypercube(Sampled),
    /// Sobol's sequence with a digital shift.
    Sobol(Sampled),
    /// The points of a file.
    Listed(Points),
}

/// Axes, number and seed of sampled points.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// Varied axes.
    pub axes: Vec<Axis>,
    /// Number of points.
    pub count: u64,
    /// Seed; another one gives other points.
    pub seed: u64,
}

/// Reason why axes make no design.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DesignError {
    /// No axis was given.
    #[error("nothing is varied: give --vary PATH=VALUES at least once, or --points FILE")]
    NoAxis,
    /// A key is varied twice.
    #[error("{0} is varied twice")]
    Twice(String),
    /// An interval of a grid has no number of values.
    #[error(
        "{0}: a grid needs to know how many values: FROM:TO:linN or FROM:TO:logN; --latin and --sobol do not"
    )]
    NoCount(String),
    /// Too many runs.
    #[error("{0} runs are more than {MOST_RUNS}, the most that a sweep takes")]
    TooMany(String),
    /// No runs.
    #[error("a sweep has at least one run")]
    NoRuns,
    /// Too many axes for Sobol's sequence.
    #[error(
        "Sobol's sequence has {most} axes here, not {given}: --latin takes any number, --points those of another program",
        most = sobol::MOST_AXES
    )]
    TooManyAxes {
        /// Number of given axes.
        given: usize,
    },
}

impl Design {
    /// Creates a grid: every combination of the axes' values.
    ///
    /// # Errors
    /// [`DesignError`].
    pub fn grid(axes: Vec<Axis>) -> Result<Self, DesignError> {
        check_axes(&axes)?;
        let mut runs = 1_u64;
        for axis in &axes {
            let count = axis
                .values
                .count()
                .ok_or_else(|| DesignError::NoCount(axis.path.clone()))?;
            runs = runs
                .checked_mul(count)
                .filter(|&runs| runs <= MOST_RUNS)
                .ok_or_else(|| DesignError::TooMany(product(&axes)))?;
        }
        Ok(Self::Grid(axes))
    }

    /// Creates a Latin hypercube.
    ///
    /// # Errors
    /// [`DesignError`].
    pub fn latin_hypercube(sampled: Sampled) -> Result<Self, DesignError> {
        check_sampled(&sampled)?;
        Ok(Self::LatinHypercube(sampled))
    }

    /// Creates a design of Sobol's sequence.
    ///
    /// # Errors
    /// [`DesignError`].
    pub fn sobol(sampled: Sampled) -> Result<Self, DesignError> {
        check_sampled(&sampled)?;
        if sampled.axes.len() > sobol::MOST_AXES {
            return Err(DesignError::TooManyAxes {
                given: sampled.axes.len(),
            });
        }
        Ok(Self::Sobol(sampled))
    }

    /// Returns the number of runs.
    pub fn runs(&self) -> u64 {
        match self {
            Self::Grid(axes) => axes.iter().filter_map(|a| a.values.count()).product(),
            Self::LatinHypercube(sampled) | Self::Sobol(sampled) => sampled.count,
            Self::Listed(points) => points.rows(),
        }
    }

    /// Returns the keys that the design varies.
    pub fn paths(&self) -> Vec<&str> {
        match self {
            Self::Grid(axes) => paths(axes),
            Self::LatinHypercube(sampled) | Self::Sobol(sampled) => paths(&sampled.axes),
            Self::Listed(points) => points.paths(),
        }
    }

    /// Returns the seed of sampled points.
    pub const fn seed(&self) -> Option<u64> {
        match self {
            Self::LatinHypercube(sampled) | Self::Sobol(sampled) => Some(sampled.seed),
            Self::Grid(_) | Self::Listed(_) => None,
        }
    }

    /// Returns the values of a point, as TOML or plain text, in the order of [`Self::paths`].
    pub fn point(&self, number: u64) -> Vec<String> {
        match self {
            Self::Grid(axes) => {
                let mut rest = number;
                let mut values: Vec<_> = axes
                    .iter()
                    .rev()
                    .map(|axis| {
                        let count = axis.values.count().unwrap_or(1).max(1);
                        let place = rest % count;
                        rest /= count;
                        axis.values.of_grid(place)
                    })
                    .collect();
                values.reverse();
                values
            }
            Self::LatinHypercube(s) => {
                s.values(|axis| latin::coordinate(s.seed, number, axis, s.count))
            }
            Self::Sobol(s) => s.values(|axis| sobol::coordinate(s.seed, number, axis)),
            Self::Listed(points) => points.row(number).to_vec(),
        }
    }
}

impl Sampled {
    fn values(&self, coordinate: impl Fn(usize) -> f64) -> Vec<String> {
        let axes = self.axes.iter().enumerate();
        axes.map(|(place, axis)| axis.values.at(coordinate(place)))
            .collect()
    }
}

fn paths(axes: &[Axis]) -> Vec<&str> {
    axes.iter().map(|axis| axis.path.as_str()).collect()
}

fn check_axes(axes: &[Axis]) -> Result<(), DesignError> {
    if axes.is_empty() {
        return Err(DesignError::NoAxis);
    }
    let twice = |i: usize| axes[..i].iter().any(|a| a.path == axes[i].path);
    match (1..axes.len()).find(|&i| twice(i)) {
        Some(i) => Err(DesignError::Twice(axes[i].path.clone())),
        None => Ok(()),
    }
}

fn check_sampled(sampled: &Sampled) -> Result<(), DesignError> {
    check_axes(&sampled.axes)?;
    match sampled.count {
        0 => Err(DesignError::NoRuns),
        count if count > MOST_RUNS => Err(DesignError::TooMany(count.to_string())),
        _ => Ok(()),
    }
}

/// The numbers of values of a grid, multiplied on paper.
fn product(axes: &[Axis]) -> String {
    let counts = axes.iter().filter_map(|a| a.values.count());
    counts
        .map(|n| n.to_string())
        .collect::<Vec<_>>()
        .join(" · ")
}

/// Hashes words by SplitMix64: each bit of the result depends on each of theirs.
fn hash(words: &[u64]) -> u64 {
    words.iter().fold(0, |state, word| {
        let mut z = (state ^ word).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes(texts: &[&str]) -> Vec<Axis> {
        texts.iter().map(|t| t.parse().unwrap()).collect()
    }

    #[test]
    fn a_grid_is_every_combination_in_order() {
        let design = Design::grid(axes(&["a=1,2", "b=x,y,z"])).unwrap();
        let points: Vec<_> = (0..design.runs())
            .map(|i| design.point(i).join(""))
            .collect();
        assert_eq!(points, ["1x", "1y", "1z", "2x", "2y", "2z"]);
    }

    #[test]
    fn drawn_points_are_within_their_axes_and_depend_on_the_seed() {
        let sampled = |seed| Sampled {
            axes: axes(&["a=1e-3:10:log", "b=-1:1", "c=x,y"]),
            count: 500,
            seed,
        };
        let make: [fn(Sampled) -> Result<Design, DesignError>; 2] =
            [Design::latin_hypercube, Design::sobol];
        for make in make {
            let (one, other) = (make(sampled(1)).unwrap(), make(sampled(2)).unwrap());
            let mut small = 0;
            for i in 0..500 {
                let point = one.point(i);
                let a: f64 = point[0].parse().unwrap();
                let b: f64 = point[1].parse().unwrap();
                assert!((1e-3..=10.0).contains(&a) && (-1.0..=1.0).contains(&b));
                assert_ne!(point, other.point(i));
                small += u32::from(a < 0.1);
            }
            // Half of the decades.
            assert!((245..=255).contains(&small), "{small}");
            let xs = (0..500).filter(|&i| one.point(i)[2] == "x").count();
            assert!((245..=255).contains(&xs), "{xs}");
        }
    }

    #[test]
    fn what_is_no_design_is_refused() {
        for (axes_of, word) in [
            (&[][..], "nothing is varied"),
            (&["a=1,2", "a=3,4"], "twice"),
            (&["a=1:2"], "how many values"),
            (&["a=1:2:lin100000", "b=1:2:lin100000"], "100000 · 100000"),
        ] {
            let error = Design::grid(axes(axes_of)).unwrap_err().to_string();
            assert!(error.contains(word), "{error}");
        }
        let many: Vec<_> = (0..22)
            .map(|i| format!("a{i}=0:1").parse().unwrap())
            .collect();
        let sampled = |count| Sampled {
            axes: many.clone(),
            count,
            seed: 0,
        };
        let error = Design::sobol(sampled(4)).unwrap_err().to_string();
        assert!(error.contains("21 axes here, not 22"), "{error}");
        assert_eq!(
            Design::latin_hypercube(sampled(0)),
            Err(DesignError::NoRuns)
        );
    }
}
