//! The symptoms in the words of a clinic.

use crepitus_model::render::effects::symptom::ClinicWords;
use crepitus_model::render::effects::{EffectSpec, SYMPTOMS};
use crepitus_scene::trace::Word;

/// A symptom as a report names it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Words {
    /// Description of the effect.
    pub(crate) spec: &'static EffectSpec,
    clinic: &'static ClinicWords,
}

impl Words {
    /// Words of all symptoms, in the order of the table of effects.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        SYMPTOMS.iter().map(|(spec, clinic)| Self { spec, clinic })
    }

    /// Name of the effect.
    pub(crate) fn effect(&self) -> &'static str {
        self.spec.name
    }

    /// Title above the charts of the effect.
    pub(crate) fn title(&self) -> &'static str {
        self.clinic.title
    }

    /// States of the symptom, in the order of the numbers of its phases.
    pub(crate) fn states(&self) -> &'static [&'static str] {
        self.clinic.states
    }

    /// Returns whether events lead from one state to another.
    pub(crate) fn has_changes(&self) -> bool {
        !self.clinic.changes.is_empty()
    }

    /// Name of an event; `None` if a clinic has none for it.
    pub(crate) fn name(&self, word: Word) -> Option<&'static str> {
        let changes = self
            .clinic
            .changes
            .iter()
            .map(|(.., word, name)| (*word, *name));
        let mut all = changes.chain(self.clinic.within.iter().copied());
        all.find(|(of, _)| *of == word).map(|(_, name)| name)
    }

    /// All its events with their names, each once.
    pub(crate) fn named(&self) -> Vec<(Word, &'static str)> {
        let changes = self
            .clinic
            .changes
            .iter()
            .map(|(.., word, name)| (*word, *name));
        let mut named: Vec<(Word, &'static str)> = Vec::new();
        for (word, name) in changes.chain(self.clinic.within.iter().copied()) {
            if named.iter().all(|(known, _)| *known != word) {
                named.push((word, name));
            }
        }
        named
    }

    /// The state after an event.
    pub(crate) fn state_after(&self, word: Word) -> Option<u16> {
        let of = self.clinic.changes.iter().find(|(.., by, _)| *by == word);
        of.map(|(_, to, ..)| *to)
    }

    /// The event between two states.
    pub(crate) fn word_between(&self, from: u16, to: u16) -> Option<Word> {
        let of = self
            .clinic
            .changes
            .iter()
            .find(|(a, b, ..)| (*a, *b) == (from, to));
        of.map(|(_, _, word, _)| *word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symptom_has_a_word_for_each_of_its_phases() {
        for words in Words::all() {
            let phases = words.spec.phases.expect("a symptom has phases").names;
            assert_eq!(words.states().len(), phases.len(), "{}", words.effect());
            for (from, to, ..) in words.clinic.changes {
                let known = |state: &u16| usize::from(*state) < phases.len();
                assert!(from != to && known(from) && known(to), "{}", words.effect());
            }
        }
    }
}
