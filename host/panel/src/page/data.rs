//! Data of the page: texts, presets, the numbers that it needs by name, the knee itself.

use super::PageError;
use super::base64::base64;
use crate::hello;
use crate::strings::{LANGUAGES, Strings};
use crepitus_knee::examination::{Step, signs};
use crepitus_knee::page::OUTCOMES;
use crepitus_protocol::Values;
use crepitus_protocol::parameters::find;
use crepitus_scene::preset::{self, Preset};
use crepitus_scene::values::{is_of_knee, with_preset};
use serde_json::{Map, Value, json};

/// The model as WebAssembly.
const WASM: &[u8] = include_bytes!("../../assets/knee.wasm");

/// The script of the browser's sound, which is no module of the page.
const WORKLET: &str = include_str!("../../assets/sound-worklet.js");

/// Texts of the page alone.
pub(super) const TEXTS: [(&str, &str); 2] = [
    ("en", include_str!("../../assets/page/en.json")),
    ("de", include_str!("../../assets/page/de.json")),
];

/// Beginnings of keys that are made while the page runs.
pub(super) const DYNAMIC: [&str; 9] = [
    "disorder.",
    "evidence.",
    "finding.",
    "flow.",
    "group.",
    "level.",
    "measure.",
    "preset.",
    "step.",
];

/// Parameters of a knee that the page needs by name.
const NAMED: [&str; 8] = [
    "crepitus.render",
    "crepitus.stiffness_nm_per_rad",
    "crepitus.static_torque_nm",
    "crepitus.kinetic_torque_nm",
    "range-limit.extension_limit_deg",
    "range-limit.extension_torque_nm",
    "range-limit.flexion_limit_deg",
    "range-limit.flexion_torque_nm",
];

/// Parameters of a brace whose defaults the page needs.
const OF_BRACE: [&str; 4] = [
    "limits.torque_nm",
    "range.fade_deg",
    "range.least_deg",
    "range.most_deg",
];

/// All of it as JSON without a `<`, which could end its tag. `sources`: the code that names the texts
/// it uses.
///
/// # Errors
/// [`PageError::NoLanguage`].
pub(super) fn json(language: Option<&str>, sources: &str) -> Result<String, PageError> {
    let data = json!({
        "texts": texts(language, sources)?,
        "presets": presets(),
        "disorders": hello::disorders(),
        "states": hello::states(),
        "healthy": healthy(),
        "ids": ids(),
        "brace": brace(),
        "measures": hello::measures(),
        "steps": Step::ALL.map(Step::name),
        "outcomes": OUTCOMES,
        "worklet": WORKLET,
        "wasm": base64(WASM),
    });
    Ok(data.to_string().replace('<', "\\u003c"))
}

/// Presets that ship, each with the effects that its signs are of.
fn presets() -> Value {
    let mut all = hello::presets(&[]);
    let described = all.as_array_mut().into_iter().flatten();
    for (described, preset) in described.zip(preset::shipped()) {
        let signs = signs(&preset.effect_settings(), preset.joint().is_some());
        described["signs"] = signs.map(|sign| sign.effect).collect();
    }
    all
}

/// The texts of a language, or of all.
fn texts(language: Option<&str>, sources: &str) -> Result<Map<String, Value>, PageError> {
    let mut all = Map::new();
    for (name, own) in TEXTS {
        if language.is_some_and(|language| language != name) {
            continue;
        }
        let mut texts = Strings::of(name).into_texts();
        texts.retain(|key, _| {
            DYNAMIC.iter().any(|prefix| key.starts_with(prefix))
                || sources.contains(&format!("\"{key}\""))
        });
        // A test reads every file.
        let own: Map<String, Value> = serde_json::from_str(own).unwrap_or_default();
        texts.extend(own);
        all.insert(name.to_owned(), texts.into());
    }
    match language {
        Some(language) if all.is_empty() => Err(PageError::NoLanguage(language.to_owned())),
        _ => Ok(all),
    }
}

/// Languages of the page.
pub(super) fn languages() -> impl Iterator<Item = &'static str> {
    LANGUAGES.iter().map(|(name, _)| *name)
}

/// Every parameter of a knee without a symptom, `[id, value]` each.
fn healthy() -> Vec<Value> {
    let values = with_preset(&Values::default(), &Preset::default(), false);
    let of_knee = (values.iter()).filter(|(parameter, _)| is_of_knee(parameter.group));
    of_knee
        .map(|(parameter, value)| json!([parameter.id, value]))
        .collect()
}

/// Ids of the parameters that the page needs by name.
fn ids() -> Map<String, Value> {
    let ids = NAMED.iter().filter_map(|name| Some((name, find(name)?.0)));
    ids.map(|(name, id)| ((*name).to_owned(), id.into()))
        .collect()
}

/// Defaults of a brace by name.
fn brace() -> Map<String, Value> {
    let values = Values::default();
    let named = OF_BRACE
        .iter()
        .filter_map(|name| Some((name, find(name)?.0)));
    named
        .map(|(name, id)| ((*name).to_owned(), json!(values.get(id))))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_knee::Page;
    use std::collections::BTreeSet;

    fn parsed(language: Option<&str>) -> Value {
        serde_json::from_str(&json(language, "\"hidden\"").unwrap()).unwrap()
    }

    #[test]
    fn every_language_of_the_panel_has_the_texts_of_the_page() {
        let keys = |text: &str| -> BTreeSet<String> {
            let texts: Map<String, Value> = serde_json::from_str(text).unwrap();
            texts.into_iter().map(|(key, _)| key).collect()
        };
        assert!(TEXTS.iter().map(|(name, _)| *name).eq(languages()));
        let [(_, english), others @ ..] = TEXTS;
        assert!(keys(english).len() > 10);
        for (language, text) in others {
            assert_eq!(keys(text), keys(english), "{language}");
        }
    }

    #[test]
    fn the_page_has_the_texts_that_it_uses_and_no_others() {
        let data = parsed(None);
        for language in languages() {
            let texts = data["texts"][language].as_object().unwrap();
            assert!(texts.contains_key("hidden") && texts.contains_key("flow.stick"));
            assert!(!texts.contains_key("control.zero"));
        }
        let german = parsed(Some("de"));
        assert_eq!(german["texts"].as_object().unwrap().len(), 1);
        let error = json(Some("xx"), "").unwrap_err();
        assert_eq!(error, PageError::NoLanguage("xx".to_owned()));
    }

    #[test]
    fn numbers_that_the_page_needs_are_there() {
        let data = parsed(None);
        assert_eq!(data["ids"].as_object().unwrap().len(), NAMED.len());
        assert_eq!(data["brace"].as_object().unwrap().len(), OF_BRACE.len());
        assert_eq!(data["brace"]["limits.torque_nm"], 4.5);
        assert_eq!(data["brace"]["range.fade_deg"], 5.0);
        let healthy: BTreeSet<_> = (data["healthy"].as_array().unwrap().iter())
            .map(|pair| pair[0].as_u64().unwrap())
            .collect();
        // What a preset changes has a value to go back to.
        for preset in data["presets"].as_array().unwrap() {
            for pair in preset["values"].as_array().unwrap() {
                assert!(healthy.contains(&pair[0].as_u64().unwrap()), "{preset}");
            }
        }
    }

    /// The page has the findings by number only, in the order of these effects.
    #[test]
    fn signs_are_those_that_the_knee_of_the_page_finds() {
        let data = parsed(None);
        let mut page = Box::new(Page::new());
        for preset in data["presets"].as_array().unwrap() {
            page.begin().unwrap();
            for pair in preset["values"].as_array().unwrap() {
                let id = u32::try_from(pair[0].as_u64().unwrap()).unwrap();
                assert!(page.set(id, pair[1].as_f64().unwrap()), "{preset}");
            }
            page.commit().unwrap();
            let signs = preset["signs"].as_array().unwrap();
            assert_eq!(page.findings().count as usize, signs.len(), "{preset}");
            assert!(!signs.is_empty(), "{preset}");
            // A sign is of one of its effects.
            let effects = preset["effects"].as_array().unwrap();
            assert!(signs.iter().all(|sign| effects.contains(sign)), "{preset}");
        }
    }

    #[test]
    fn no_tag_of_the_page_is_ended() {
        assert!(!json(None, "").unwrap().contains('<'));
    }
}
