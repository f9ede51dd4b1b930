//! The symptoms in the words of a clinic, and how their states follow each other.

use crepitus_model::render::effects::{EffectSpec, SPECS};
use crepitus_scene::trace::Word;

/// A symptom as a report names it.
#[derive(Debug)]
pub(crate) struct Words {
    /// Name of the effect.
    pub(crate) effect: &'static str,
    /// Above its charts.
    pub(crate) title: &'static str,
    /// Its states, in the order of the numbers of its phases; the first one is at
    /// rest.
    pub(crate) states: &'static [&'static str],
    /// From one state to another: the event that says so, and its name.
    pub(crate) changes: &'static [Step],
    /// Events within a state.
    pub(crate) within: &'static [(Word, &'static str)],
}

/// From a state to another, by an event with this name.
pub(crate) type Step = (u16, u16, Word, &'static str);

/// All symptoms, in the order of the table of effects.
pub(crate) const SYMPTOMS: [Words; 7] = [
    Words {
        effect: "range-limit",
        title: "End of the range of motion",
        states: &["free in the range", "in the end-feel", "the end yields"],
        changes: &[
            (0, 1, Word::Contact, "end of the range met"),
            (1, 2, Word::Cap, "the end yields"),
            (1, 0, Word::Leave, "out of the end"),
            (2, 0, Word::Leave, "out of the end"),
        ],
        within: &[],
    },
    Words {
        effect: "lead-pipe",
        title: "Lead-pipe rigidity",
        states: &["resistance builds up or turns over", "even resistance"],
        changes: &[],
        within: &[],
    },
    Words {
        effect: "cogwheel",
        title: "Cogwheel rigidity",
        states: &["between two teeth", "at a tooth"],
        changes: &[(0, 1, Word::Catch, "catch"), (1, 0, Word::Give, "give")],
        within: &[],
    },
    Words {
        effect: "spasticity",
        title: "Spasticity",
        states: &[
            "silent",
            "caught",
            "the reflex answers",
            "the reflex at its largest",
        ],
        changes: &[
            (0, 1, Word::Catch, "catch"),
            (1, 0, Word::Rearm, "can catch again"),
            (0, 2, Word::Onset, "the reflex begins"),
            (2, 3, Word::Cap, "at its largest"),
            (3, 2, Word::Uncap, "falls again"),
            (2, 0, Word::Offset, "the reflex ends"),
        ],
        within: &[],
    },
    Words {
        effect: "clasp-knife",
        title: "Clasp-knife phenomenon",
        states: &["relaxed", "resistance builds up", "collapsed"],
        changes: &[
            (0, 1, Word::Onset, "resistance begins"),
            (1, 2, Word::Release, "collapse"),
            (1, 0, Word::Back, "turned back before"),
            (2, 0, Word::Rearm, "can build again"),
        ],
        within: &[],
    },
    Words {
        effect: "clonus",
        title: "Clonus",
        states: &[
            "no beats",
            "beating",
            "held without beats",
            "let go: the last beat runs out",
        ],
        changes: &[
            (0, 1, Word::Start, "quick stretch"),
            (1, 2, Word::Done, "beats are over"),
            (1, 0, Word::Stop, "let go"),
            (1, 3, Word::Stop, "let go"),
            (3, 1, Word::Start, "quick stretch"),
        ],
        within: &[(Word::Beat, "beat")],
    },
    Words {
        effect: "texture",
        title: "Rough joint",
        states: &["held at an asperity", "slides"],
        changes: &[],
        within: &[(Word::Snap, "snap over an asperity")],
    },
];

impl Words {
    /// Its description in the model.
    pub(crate) fn spec(&self) -> Option<&'static EffectSpec> {
        SPECS.iter().find(|spec| spec.name == self.effect)
    }

    /// Name of an event; `None` if a clinic has none for it.
    pub(crate) fn name(&self, word: Word) -> Option<&'static str> {
        let changes = self.changes.iter().map(|(.., word, name)| (*word, *name));
        let mut all = changes.chain(self.within.iter().copied());
        all.find(|(of, _)| *of == word).map(|(_, name)| name)
    }

    /// All its events with their names, each once.
    pub(crate) fn named(&self) -> Vec<(Word, &'static str)> {
        let changes = self.changes.iter().map(|(.., word, name)| (*word, *name));
        let mut named: Vec<(Word, &'static str)> = Vec::new();
        for (word, name) in changes.chain(self.within.iter().copied()) {
            if named.iter().all(|(known, _)| *known != word) {
                named.push((word, name));
            }
        }
        named
    }

    /// The state after an event.
    pub(crate) fn state_after(&self, word: Word) -> Option<u16> {
        let of = self.changes.iter().find(|(.., by, _)| *by == word);
        of.map(|(_, to, ..)| *to)
    }

    /// The event between two states.
    pub(crate) fn word_between(&self, from: u16, to: u16) -> Option<Word> {
        let of = self
            .changes
            .iter()
            .find(|(a, b, ..)| (*a, *b) == (from, to));
        of.map(|(_, _, word, _)| *word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::render::effects::IS_SYMPTOM;

    #[test]
    fn every_symptom_has_a_word_for_each_of_its_phases() {
        let symptoms = SPECS.iter().zip(IS_SYMPTOM).filter(|(_, is)| **is);
        let names: Vec<&str> = symptoms.map(|(spec, _)| spec.name).collect();
        assert_eq!(names, SYMPTOMS.each_ref().map(|words| words.effect));
        for words in &SYMPTOMS {
            let spec = words.spec().expect("an effect");
            let phases = spec.phases.expect("a symptom has phases").names;
            assert_eq!(words.states.len(), phases.len(), "{}", words.effect);
            for (from, to, ..) in words.changes {
                let known = |state: &u16| usize::from(*state) < phases.len();
                assert!(from != to && known(from) && known(to), "{}", words.effect);
            }
        }
    }
}
