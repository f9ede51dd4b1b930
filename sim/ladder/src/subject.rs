//! The measured subjects.

use crepitus_model::Convention;
use crepitus_model::render::effects::SPECS;
use crepitus_model::solver::Solver;

/// Code that the device could run in every tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Subject {
    /// A rung of the ladder under a convention.
    Rung(Convention, Solver),
    /// `exact-events` with an input check.
    Checked(Convention),
    /// The firmware's renderer: `frozen` with `exact-events`, input check, the
    /// ramp of a commit and the turn-back guard.
    Renderer,
    /// Counts of the motor's encoder to angle and speed.
    Encoder,
    /// The effect at this place of the model's table.
    Effect(usize),
    /// The loop of the motor's current.
    CurrentLoop,
}

/// Subjects that are not rungs.
const DEVICE: [Subject; 5] = [
    Subject::Checked(Convention::Frozen),
    Subject::Checked(Convention::Paper),
    Subject::Checked(Convention::Physical),
    Subject::Renderer,
    Subject::Encoder,
];

impl Subject {
    /// All subjects: each rung under every convention where it has a meaning,
    /// then the device's other code.
    pub fn all() -> impl Iterator<Item = Self> {
        let rungs = Convention::ALL.into_iter().flat_map(|convention| {
            Solver::ALL
                .into_iter()
                .filter(move |solver| solver.refusal_in::<f32>(convention).is_none())
                .map(move |solver| Self::Rung(convention, solver))
        });
        rungs
            .chain(DEVICE)
            .chain((0..SPECS.len()).map(Self::Effect))
            .chain([Self::CurrentLoop])
    }

    /// Its name: of a rung as in scene files, of an effect as in `crepitus
    /// effects`, of others as in the model's documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rung(_, solver) => solver.name(),
            Self::Checked(_) => "input check",
            Self::Renderer => "renderer",
            Self::Encoder => "encoder",
            Self::Effect(place) => SPECS.get(place).map_or("", |spec| spec.name),
            Self::CurrentLoop => "current loop",
        }
    }

    /// The convention of its joint, if it has one.
    pub fn convention(self) -> Option<Convention> {
        match self {
            Self::Rung(convention, _) | Self::Checked(convention) => Some(convention),
            Self::Renderer => Some(Convention::Frozen),
            _ => None,
        }
    }

    /// Its index among all.
    pub(crate) fn code(self) -> u32 {
        (0..)
            .zip(Self::all())
            .find(|(_, subject)| *subject == self)
            .map_or(u32::MAX, |(code, _)| code)
    }

    /// The subject of this index.
    pub(crate) fn of_code(code: u32) -> Option<Self> {
        (0..)
            .zip(Self::all())
            .find(|(n, _)| *n == code)
            .map(|(_, subject)| subject)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::vec::Vec;

    #[test]
    fn each_rung_is_there_under_each_convention_that_allows_it() {
        let rungs = |convention| {
            Subject::all()
                .filter(|subject| matches!(subject, Subject::Rung(c, _) if *c == convention))
                .count()
        };
        assert_eq!(Convention::ALL.map(rungs), [4, 9, 10]);
    }

    #[test]
    fn a_code_is_of_one_subject() {
        let all: Vec<_> = Subject::all().collect();
        let codes: HashSet<_> = all.iter().map(|subject| subject.code()).collect();
        assert_eq!(codes.len(), all.len());
        for subject in &all {
            assert_eq!(Subject::of_code(subject.code()), Some(*subject));
        }
        let beyond = codes.into_iter().max().unwrap() + 1;
        assert_eq!(Subject::of_code(beyond), None);
    }
}
