//! The subject of a test: a rung of the ladder under a convention, in a
//! precision.

use crepitus_model::Convention;
use crepitus_model::solver::Solver;
use crepitus_scene::scene::Precision;
use std::fmt;

/// A solver: a rung of the ladder, in steps, or the event-driven reference,
/// without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rung {
    /// Rung of the ladder, in steps.
    Ladder(Solver),
    /// Event by event on the true motion, in f64.
    Reference,
}

impl Rung {
    /// All of them, the reference last.
    pub fn all() -> Vec<Self> {
        let ladder = Solver::ALL.map(Self::Ladder);
        [&ladder[..], &[Self::Reference]].concat()
    }

    /// Name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ladder(solver) => solver.name(),
            Self::Reference => "reference",
        }
    }

    /// The solver in steps.
    fn stepped(self) -> Option<Solver> {
        match self {
            Self::Ladder(solver) => Some(solver),
            Self::Reference => None,
        }
    }

    /// The rung of a frozen joint that a device changes while it runs: the reference has none.
    pub(super) fn of_a_device(self) -> Solver {
        self.stepped().unwrap_or(Solver::Exact)
    }

    /// Reason why it has no meaning under a convention, or `None`.
    pub fn refusal(self, convention: Convention) -> Option<&'static str> {
        self.stepped()?.refusal(convention)
    }

    /// Returns whether it needs the prescribed motion itself.
    pub fn needs_exact_motion(self) -> bool {
        self.stepped().is_some_and(Solver::needs_exact_motion)
    }

    /// Reason why it has no meaning in f32, or `None`.
    pub fn single_refusal(self) -> Option<&'static str> {
        match self {
            Self::Ladder(solver) => solver.single_refusal(),
            Self::Reference => Some("it is the measure of all others, in f64"),
        }
    }
}

/// A rung under a convention, in a precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Subject {
    /// The rung.
    pub solver: Rung,
    /// Convention for the end of a slip.
    pub convention: Convention,
    /// Precision of the solver.
    pub precision: Precision,
}

impl Subject {
    /// Every combination with a meaning.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for convention in Convention::ALL {
            for solver in Rung::all() {
                if solver.refusal(convention).is_some() {
                    continue;
                }
                let in_f32 = solver.single_refusal().is_none();
                let precisions = Precision::ALL.into_iter();
                let precisions = precisions.filter(|p| in_f32 || *p == Precision::F64);
                all.extend(precisions.map(|precision| Self {
                    solver,
                    convention,
                    precision,
                }));
            }
        }
        all
    }

    /// Returns whether it is the firmware's: `frozen`, the break located, in f32.
    pub fn is_firmware(self) -> bool {
        self.convention == Convention::Frozen
            && self.solver == Rung::Ladder(Solver::ExactEvents)
            && self.precision == Precision::F32
    }
}

/// `exact-events, frozen, f32`.
impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = [
            self.solver.name(),
            self.convention.name(),
            self.precision.name(),
        ];
        f.write_str(&names.join(", "))
    }
}
