//! The measured subjects.

use crate::laws::{ENTRIES, Entry};
use crepitus_model::Convention;
use crepitus_model::parameters::{Choice, Chosen};
use crepitus_model::render::effects::{EffectSettings, EffectSpec, SPECS};
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
    /// The effect at this place of the model's table, in this [form](forms) of its
    /// law.
    Effect(usize, u8),
    /// The loop of the motor's current.
    CurrentLoop,
    /// The friction law at this place of [`ENTRIES`]. The product's own joint is a rung instead.
    Law(u8),
}

/// The choice between laws of an effect: its form, its mode, or its trigger.
/// Which muscles are affected is none: it mirrors the law.
pub fn forms(spec: &EffectSpec) -> Option<&'static Choice> {
    spec.choices.iter().find(|choice| choice.key != "muscles")
}

/// Settings of an effect in this form of its law, the rest at its defaults.
pub fn in_form(spec: &EffectSpec, form: u8) -> EffectSettings {
    let mut options = [0; 8];
    for (option, choice) in options.iter_mut().zip(spec.choices) {
        let is_form = forms(spec).is_some_and(|of| of.key == choice.key);
        *option = if is_form { form } else { choice.default };
    }
    let options = options.get(..spec.choices.len()).unwrap_or_default();
    EffectSettings::given(|name| {
        (name == spec.name).then_some(Chosen {
            numbers: &[],
            options,
        })
    })
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
    /// then the device's other code, then the friction laws.
    pub fn all() -> impl Iterator<Item = Self> {
        let rungs = Convention::ALL.into_iter().flat_map(|convention| {
            Solver::ALL
                .into_iter()
                .filter(move |solver| solver.refusal_in::<f32>(convention).is_none())
                .map(move |solver| Self::Rung(convention, solver))
        });
        rungs
            .chain(DEVICE)
            .chain((0..).zip(SPECS).flat_map(|(place, spec)| {
                let forms = forms(spec).map_or(1, |choice| choice.names.len());
                (0..).take(forms).map(move |form| Self::Effect(place, form))
            }))
            .chain([Self::CurrentLoop])
            .chain(
                (0..)
                    .zip(ENTRIES)
                    .filter(|(_, entry)| !entry.is_ours())
                    .map(|(place, _)| Self::Law(place)),
            )
    }

    /// The form of an effect's law, if it has several.
    pub fn form(self) -> Option<&'static str> {
        let Self::Effect(place, form) = self else {
            return None;
        };
        let names = forms(SPECS.get(place)?)?.names;
        names.get(usize::from(form)).copied()
    }

    /// The friction law, if it is one.
    pub fn law(self) -> Option<&'static Entry> {
        let Self::Law(place) = self else {
            return None;
        };
        ENTRIES.get(usize::from(place))
    }

    /// Name of the subject: of a rung as in scene files, of an effect as in `crepitus
    /// effects`, of a law as in [`ENTRIES`], of others as in the model's documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rung(_, solver) => solver.name(),
            Self::Checked(_) => "input check",
            Self::Renderer => "renderer",
            Self::Encoder => "encoder",
            Self::Effect(place, _) => SPECS.get(place).map_or("", |spec| spec.name),
            Self::CurrentLoop => "current loop",
            Self::Law(_) => self.law().map_or("", |entry| entry.name),
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

    /// Index of the subject among all.
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
    fn each_form_of_a_law_is_there_with_its_settings() {
        let forms: Vec<_> = Subject::all()
            .filter_map(|subject| Some((subject.name(), subject.form()?)))
            .collect();
        assert_eq!(
            forms,
            [
                ("cogwheel", "time"),
                ("cogwheel", "space"),
                ("spasticity", "catch"),
                ("spasticity", "reflex"),
                ("clasp-knife", "angle"),
                ("clasp-knife", "torque"),
                ("bone-shaping", "motor"),
                ("bone-shaping", "actuator"),
            ]
        );
        let spec = SPECS.iter().find(|spec| spec.name == "spasticity").unwrap();
        let of = |form| in_form(spec, form);
        assert_eq!([0, 1].map(|form| of(form).spasticity.unwrap().form), [0, 1]);
        assert_eq!(of(1).cogwheel, None);
        for spec in SPECS {
            assert!(spec.choices.len() <= 8, "{}", spec.name);
        }
    }

    #[test]
    fn each_law_but_our_own_is_there_by_its_name() {
        let laws: Vec<_> = Subject::all()
            .filter(|subject| matches!(subject, Subject::Law(_)))
            .collect();
        assert_eq!(laws.len(), ENTRIES.len() - Convention::ALL.len());
        for law in laws {
            let entry = law.law().unwrap();
            assert_eq!((law.name(), law.convention()), (entry.name, None));
            assert!(!entry.is_ours());
        }
        assert_eq!(
            (Subject::Law(255).law(), Subject::Law(255).name()),
            (None, "")
        );
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
