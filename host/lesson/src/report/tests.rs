use super::*;
use std::collections::BTreeSet;
use std::path::Path;

/// The file that the panel's tables are merged from.
#[test]
fn the_file_of_texts_is_that_of_the_keys() {
    let table = |language: fn(&Key) -> &'static str| {
        let texts = KEYS
            .iter()
            .map(|key| (key.key.to_owned(), language(key).into()));
        serde_json::Value::Object(texts.collect())
    };
    let both = serde_json::json!({ "en": table(|key| key.en), "de": table(|key| key.de) });
    let made = serde_json::to_string_pretty(&both).unwrap() + "\n";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("report-strings.json");
    if std::env::var_os("CREPITUS_BLESS").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    assert!(
        std::fs::read_to_string(&path).is_ok_and(|text| text == made),
        "CREPITUS_BLESS=1 cargo test -p crepitus-lesson --lib report"
    );
}

#[test]
fn keys_are_unique_and_both_languages_have_the_same_values() {
    let keys: BTreeSet<_> = KEYS.iter().map(|key| key.key).collect();
    assert_eq!(keys.len(), KEYS.len());
    let values = |text: &str| -> BTreeSet<String> {
        let parts = text.split('{').skip(1);
        parts
            .filter_map(|part| Some(part.split_once('}')?.0.to_owned()))
            .collect()
    };
    for key in KEYS {
        assert!(!key.en.is_empty() && !key.de.is_empty(), "{}", key.key);
        assert_eq!(values(key.en), values(key.de), "{}", key.key);
    }
}

#[test]
fn every_disorder_and_level_has_a_text() {
    let has = |key: &str| KEYS.iter().any(|k| k.key == key);
    for finding in Finding::all() {
        assert!(has(&format!("report.disorder.{}", finding.name())));
    }
    for level in crepitus_scene::preset::Level::ALL {
        assert!(has(&format!("report.level.{}", level.name())));
    }
}

#[test]
fn numbers_are_in_the_readers_language() {
    let german = |key: &str| {
        let found = KEYS.iter().find(|k| k.key == key);
        found.unwrap().de.to_owned()
    };
    let words = Words(&german);
    assert_eq!(words.number(-0.254, 2), "−0,25");
    assert_eq!(words.number(-0.001, 2), "0,00");
    assert_eq!(words.mean(None), "–");
}
