//! # `knee.html`: a knee to move on one page, without a program
//!
//! ```text
//! assets, assets/page ── modules ──> script ──┐
//! texts, presets, knee.wasm ── data ──────────┼──> one file, with the hashes of script and style in its policy
//! panel.css, page/knee.css ── style ──────────┘
//! ```

mod base64;
mod data;
mod error;
mod modules;

pub use error::PageError;

use crate::assets;
use base64::base64;
use sha2::{Digest, Sha256};

/// The page, with places for its parts.
const TEMPLATE: &str = include_str!("../assets/page/knee.html");

/// The module with which the page begins.
const ENTRY: &str = "page/main.js";

/// Style sheets of the page, in their order.
const STYLES: [&str; 2] = ["panel.css", "page/knee.css"];

macro_rules! files {
    ($($file:literal),* $(,)?) => {
        /// Modules and styles that are of this page alone.
        const FILES: &[(&str, &str)] = &[$((
            concat!("page/", $file),
            include_str!(concat!("../assets/page/", $file)),
        )),*];
    };
}

files![
    "data.js",
    "engine.js",
    "examination.js",
    "grip.js",
    "knee.css",
    "knee.js",
    "knees.js",
    "main.js",
    "pain.js",
    "quiz.js",
    "sample-bins.js",
];

/// Languages that the page can have.
pub fn page_languages() -> impl Iterator<Item = &'static str> {
    data::languages()
}

/// The page, with the texts of one language, or of all.
///
/// # Errors
/// [`PageError`]: there is no such language, or a file of the page has a mistake.
pub fn knee_page(language: Option<&str>) -> Result<String, PageError> {
    let script = modules::script(ENTRY, &source)?;
    let mut style = String::new();
    for file in STYLES {
        style += source(file).ok_or_else(|| PageError::Missing {
            file: "knee.html".to_owned(),
            import: file.to_owned(),
        })?;
    }
    let data = data::json(language, &(TEMPLATE.to_owned() + &script))?;
    // Also the beginning of a comment: it would keep the tag at the end from being seen.
    for (file, text, end) in [
        ("the script", &script, "</script"),
        ("the style", &style, "</style"),
    ] {
        let lower = text.to_ascii_lowercase();
        if let Some(found) = [end, "<!--"].into_iter().find(|end| lower.contains(*end)) {
            return Err(PageError::Ends {
                file: file.to_owned(),
                text: found.to_owned(),
            });
        }
    }
    let version = env!("CARGO_PKG_VERSION");
    let policy = policy(&script, &style);
    let mut page = TEMPLATE.to_owned();
    for (place, part) in [
        (
            "<!-- policy -->",
            format!("<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\" />"),
        ),
        (
            "<!-- version -->",
            format!("<meta name=\"generator\" content=\"crepitus {version}\" />"),
        ),
        ("<!-- style -->", format!("<style>{style}</style>")),
        (
            "<!-- data -->",
            format!("<script type=\"application/json\" id=\"data\">{data}</script>"),
        ),
        ("<!-- script -->", format!("<script>{script}</script>")),
    ] {
        if !page.contains(place) {
            return Err(PageError::NoPlace(place));
        }
        page = page.replacen(place, &part, 1);
    }
    Ok(page)
}

/// A module or a style sheet, of the page or of the panel.
fn source(path: &str) -> Option<&'static str> {
    let own = FILES.iter().find(|(name, _)| *name == path);
    own.map(|(_, text)| *text).or_else(|| {
        let asset = assets::find(&format!("/{path}"))?;
        std::str::from_utf8(asset.body).ok()
    })
}

/// The policy of the page: this script and this style, WebAssembly, and scripts of `data:` addresses,
/// without which a file cannot load the worklet of its sound. No address of a network.
fn policy(script: &str, style: &str) -> String {
    let hash = |text: &str| format!("'sha256-{}'", base64(&Sha256::digest(text.as_bytes())));
    format!(
        "default-src 'none'; script-src {} 'wasm-unsafe-eval' data:; style-src {}; \
         img-src data:; base-uri 'none'; form-action 'none'",
        hash(script),
        hash(style)
    )
}

#[cfg(test)]
mod tests;
