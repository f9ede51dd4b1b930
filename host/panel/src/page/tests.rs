use super::data::{DYNAMIC, TEXTS};
use super::*;
use crate::strings::Strings;
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::path::Path;

/// Bytes of the page, at most.
const MOST: usize = 400_000;

/// The content of the only tag that begins like this.
fn inside<'p>(page: &'p str, begin: &str, end: &str) -> &'p str {
    let (_, rest) = page.split_once(begin).unwrap();
    assert!(!rest.contains(begin), "{begin} is there twice");
    rest.split_once(end).unwrap().0
}

fn is_of(name: &str, extension: &str) -> bool {
    Path::new(name)
        .extension()
        .is_some_and(|it| it == extension)
}

#[test]
fn every_file_of_the_page_is_in_it_and_it_is_light() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/page");
    let files = std::fs::read_dir(folder).unwrap();
    let found: BTreeSet<_> = files
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != "knee.html" && !is_of(name, "json"))
        .map(|name| format!("page/{name}"))
        .collect();
    let known: BTreeSet<_> = FILES.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(found, known);
    for (name, _) in FILES.iter().filter(|(name, _)| is_of(name, "js")) {
        let import = name.replacen("page/", "\"./", 1) + "\";";
        let is_used = FILES.iter().any(|(_, text)| text.contains(&import));
        assert!(is_used || *name == ENTRY, "{name} is not used");
    }
    let page = knee_page(None).unwrap();
    assert!(page.len() <= MOST, "{}", page.len());
}

#[test]
fn the_hashes_of_the_policy_are_those_of_script_and_style() {
    let page = knee_page(None).unwrap();
    let policy = inside(&page, "Content-Security-Policy\" content=\"", "\"");
    for (begin, end) in [("<script>", "</script>"), ("<style>", "</style>")] {
        let hash = base64(&Sha256::digest(inside(&page, begin, end).as_bytes()));
        assert!(policy.contains(&format!("'sha256-{hash}'")), "{begin}");
    }
    assert!(policy.starts_with("default-src 'none';"));
    for word in ["unsafe-inline", "'unsafe-eval'", "http", "*", "'self'"] {
        assert!(!policy.contains(word), "{policy}");
    }
}

#[test]
fn nothing_inside_ends_a_script() {
    let page = knee_page(None).unwrap().to_ascii_lowercase();
    // Data and script.
    assert_eq!(page.matches("<script").count(), 2);
    assert_eq!(page.matches("</script").count(), 2);
    assert_eq!(page.matches("<!--").count(), 0);
}

#[test]
fn it_is_the_same_each_time_and_has_the_language_that_was_asked_for() {
    let german = knee_page(Some("de")).unwrap();
    assert_eq!(knee_page(Some("de")).unwrap(), german);
    let both = knee_page(None).unwrap();
    assert!(german.len() < both.len());
    let data = inside(&german, "id=\"data\">", "</script>");
    let data: Value = serde_json::from_str(data).unwrap();
    let languages: Vec<_> = data["texts"].as_object().unwrap().keys().collect();
    assert_eq!(languages, ["de"]);
    assert!(knee_page(Some("xx")).is_err());
}

/// The pieces of a code that stand behind one of these beginnings, up to an end.
fn behind<'c>(code: &'c str, begins: &[&str], end: &str) -> BTreeSet<&'c str> {
    let pieces = begins.iter().flat_map(|begin| code.split(*begin).skip(1));
    pieces
        .filter_map(|piece| Some(piece.split_once(end)?.0))
        .collect()
}

/// A text that the page lacks would be shown as its key.
#[test]
fn every_text_that_the_page_asks_for_is_there() {
    let script = modules::script(ENTRY, &source).unwrap();
    // That asks for no text.
    let script = script.replace("getContext(", "");
    let mut asked = behind(&script, &["text(\"", "textOr(\""], "\"");
    let attributes = ["data-text=\"", "data-label=\"", "data-title=\""];
    asked.extend(behind(TEMPLATE, &attributes, "\""));
    assert!(asked.len() > 30, "{asked:?}");
    let is_made = |key: &str| DYNAMIC.iter().any(|begin| key.starts_with(begin));
    for (language, own) in TEXTS {
        let mut texts = Strings::of(language).into_texts();
        let own: Map<String, Value> = serde_json::from_str(own).unwrap();
        for key in own.keys() {
            assert!(!texts.contains_key(key), "{key} has two texts");
            let is_used = script.contains(key) || TEMPLATE.contains(key);
            assert!(is_used || is_made(key), "{key} is not used");
        }
        texts.extend(own);
        for key in &asked {
            assert!(texts.contains_key(*key), "{language}: {key}");
        }
    }
    let made = behind(&script, &["text(`", "textOr(`"], "${");
    assert!(!made.is_empty());
    for begin in made {
        assert!(DYNAMIC.contains(&begin), "{begin}");
    }
}
