//! Who is put to the test: a rung of the ladder under a convention, in a
//! precision.

use crepitus_model::Convention;
use crepitus_model::solver::Solver;
use crepitus_scene::scene::Precision;

/// A rung under a convention, in a precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Subject {
    /// The rung.
    pub solver: Solver,
    /// How a slip ends.
    pub convention: Convention,
    /// What it computes in.
    pub precision: Precision,
}

impl Subject {
    /// Every combination that has a meaning.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for convention in Convention::ALL {
            for solver in Solver::ALL {
                if solver.refusal(convention).is_some() {
                    continue;
                }
                let precisions = Precision::ALL
                    .into_iter()
                    .filter(|p| *p == Precision::F64 || solver.single_refusal().is_none());
                all.extend(precisions.map(|precision| Self {
                    solver,
                    convention,
                    precision,
                }));
            }
        }
        all
    }

    /// What the firmware renders: `frozen`, the break located, in f32.
    pub fn is_firmware(self) -> bool {
        self.convention == Convention::Frozen
            && self.solver == Solver::ExactEvents
            && self.precision == Precision::F32
    }
}
