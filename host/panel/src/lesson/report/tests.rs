use super::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The panel's texts of a language.
fn texts(language: &str) -> BTreeMap<String, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../panel/assets/strings");
    let text = std::fs::read_to_string(folder.join(language).with_extension("json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn both_languages_have_every_text_with_the_same_values() {
    let values = |text: &str| -> BTreeSet<String> {
        let parts = text.split('{').skip(1);
        parts
            .filter_map(|part| Some(part.split_once('}')?.0.to_owned()))
            .collect()
    };
    let (english, german) = (texts("en"), texts("de"));
    for (key, text) in english.iter().filter(|(key, _)| key.starts_with("report.")) {
        assert_eq!(values(text), values(&german[key]), "{key}");
    }
}

#[test]
fn every_disorder_and_level_has_a_text() {
    let english = texts("en");
    let has = |key: &str| english.contains_key(key);
    for finding in Finding::all() {
        assert!(has(&format!("report.disorder.{}", finding.name())));
    }
    for level in crepitus_scene::preset::Level::ALL {
        assert!(has(&format!("report.level.{}", level.name())));
    }
}

#[test]
fn numbers_are_in_the_readers_language() {
    let texts = texts("de");
    let german = |key: &str| texts[key].clone();
    let words = Words(&german);
    assert_eq!(words.number(-0.254, 2), "−0,25");
    assert_eq!(words.number(-0.001, 2), "0,00");
    assert_eq!(words.mean(None), "–");
}
