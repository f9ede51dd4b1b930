//! Texts of the page, by language: a file each, and nothing else to change for another.

use serde_json::{Map, Value};

/// Languages, with their files; the first is the default.
pub(crate) const LANGUAGES: [(&str, &str); 2] = [
    ("en", include_str!("../assets/strings/en.json")),
    ("de", include_str!("../assets/strings/de.json")),
];

/// The texts of a language.
pub(crate) struct Strings {
    texts: Map<String, Value>,
}

impl Strings {
    /// Returns the strings of this language, or of the default.
    pub(crate) fn of(language: &str) -> Self {
        let found = LANGUAGES.iter().find(|(name, _)| *name == language);
        let (_, text) = found.unwrap_or(&LANGUAGES[0]);
        // A test reads every file.
        Self {
            texts: serde_json::from_str(text).unwrap_or_default(),
        }
    }

    /// All texts by their keys.
    pub(crate) fn into_texts(self) -> Map<String, Value> {
        self.texts
    }

    /// The text of a key; the key itself if there is none.
    pub(crate) fn text(&self, key: &str) -> String {
        let text = self.texts.get(key).and_then(Value::as_str);
        text.unwrap_or(key).to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::STATES;
    use crepitus_knee::examination::{Measure, Step};
    use crepitus_protocol::parameters::PARAMETERS;
    use crepitus_scene::preset::Disorder;
    use std::collections::BTreeSet;

    fn keys(language: &str) -> BTreeSet<String> {
        let texts = Strings::of(language).texts;
        let is_own = |key: &&String| !key.starts_with("preset.");
        texts.keys().filter(is_own).cloned().collect()
    }

    /// Names without a text would be shown by their identifiers.
    #[test]
    fn what_a_device_has_is_named() {
        let known = keys("en");
        let groups = PARAMETERS.iter().map(|p| format!("group.{}", p.group));
        let states = STATES
            .iter()
            .map(|state| format!("state.{}.{}", state.effect, state.phase));
        let disorders = Disorder::ALL.map(|disorder| format!("disorder.{}", disorder.name()));
        let measures = Measure::ALL.map(|measure| format!("measure.{}", measure.name()));
        let steps = Step::ALL.map(|step| format!("step.{}", step.name()));
        let named = groups.chain(states).chain(disorders);
        for key in named.chain(measures).chain(steps) {
            assert!(known.contains(&key), "{key}");
        }
    }

    #[test]
    fn every_language_has_every_text() {
        let english = keys("en");
        assert!(english.len() > 100);
        for (language, text) in LANGUAGES {
            assert!(
                serde_json::from_str::<Map<String, Value>>(text).is_ok(),
                "{language}"
            );
            assert_eq!(keys(language), english, "{language}");
            for (key, text) in Strings::of(language).texts {
                assert!(text.as_str().is_some_and(|text| !text.is_empty()), "{key}");
            }
        }
    }
}
