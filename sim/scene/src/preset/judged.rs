//! Judgements of a preset by people: what a realism session found.
//!
//! ```toml
//! [[judged]]
//! study = "Knees of the spring course"
//! date = "2026-11-30"
//! clinicians = 6
//! ratings = 12
//! statistic = "realism 3.8 of 5 (95 % 3.1 to 4.4)"
//! sha256 = "…"                     # of the table of ratings
//! ```
//!
//! They stand in the preset's file, or, for one that ships, in `judged/NAME.toml` of the
//! folder of the user's own presets. `crepitus experiment evidence` writes the latter.

use super::Preset;
use super::line;
use crate::document::{Document, Range, Section, quoted, text_of};
use crate::error::SceneError;
use std::env;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Names another folder of the user's own presets.
pub const FOLDER_VARIABLE: &str = "CREPITUS_PRESETS";

/// Judgement of a preset by clinicians.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judgement {
    /// Title of the study.
    pub study: String,
    /// Day on which it was evaluated.
    pub date: String,
    /// Number of clinicians.
    pub clinicians: u32,
    /// Number of ratings.
    pub ratings: u32,
    /// Finding with its interval.
    pub statistic: String,
    /// SHA-256 of the table of ratings.
    pub sha256: String,
}

impl Judgement {
    /// Reads a file of judgements.
    ///
    /// # Errors
    /// [`SceneError`] with line, key and cause.
    pub fn read(file: &Path) -> Result<Vec<Self>, SceneError> {
        let document = Document::parse(file, &text_of(file)?)?;
        let root = document.section();
        let all = judgements(&root)?;
        root.finish()?;
        Ok(all)
    }

    /// The file of the judgements of a preset that ships; `None` without a home folder.
    pub fn file(preset: &str) -> Option<PathBuf> {
        let file = own_folder()?.join("judged").join(preset);
        Some(file.with_extension("toml"))
    }

    /// As an entry of a file.
    pub fn to_toml(&self) -> String {
        let mut text = "[[judged]]\n".to_owned();
        let number = |number: u32| number.to_string();
        for (key, value) in [
            ("study", quoted(&self.study)),
            ("date", quoted(&self.date)),
            ("clinicians", number(self.clinicians)),
            ("ratings", number(self.ratings)),
            ("statistic", quoted(&self.statistic)),
            ("sha256", quoted(&self.sha256)),
        ] {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{key} = {value}");
        }
        text
    }

    /// In a line, for people.
    pub fn to_text(&self) -> String {
        let Self {
            study,
            date,
            clinicians,
            ratings,
            statistic,
            sha256,
        } = self;
        let hash = sha256.get(..12).unwrap_or(sha256);
        format!(
            "{statistic}; {clinicians} clinicians, {ratings} ratings, {study}, {date}, SHA-256 {hash}…"
        )
    }
}

/// Judgements of a file.
pub(super) fn judgements(root: &Section<'_>) -> Result<Vec<Judgement>, SceneError> {
    if !root.has("judged") {
        return Ok(Vec::new());
    }
    let sections = root.sections("judged")?;
    sections.iter().map(judgement).collect()
}

fn judgement(section: &Section<'_>) -> Result<Judgement, SceneError> {
    let text = |key: &str, most: usize| {
        let text = line(section, key, most)?;
        text.ok_or_else(|| section.key_error(key, "it is missing: a text is wanted"))
    };
    let count = |key: &str| {
        let number = section.number(key, Range::closed(1.0, 1e6))?;
        let whole = number.fract() == 0.0;
        // Checked above.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let count = number as u32;
        whole
            .then_some(count)
            .ok_or_else(|| section.key_error(key, "a whole number is wanted"))
    };
    let found = Judgement {
        study: text("study", 60)?,
        date: text("date", 10)?,
        clinicians: count("clinicians")?,
        ratings: count("ratings")?,
        statistic: text("statistic", 120)?,
        sha256: text("sha256", 64)?,
    };
    section.finish()?;
    Ok(found)
}

impl Preset {
    /// Judgements of its file and, if it ships, of the user's folder. A file there that cannot be read has
    /// none.
    pub fn judgements(&self) -> Vec<Judgement> {
        let mut all = self.judged.clone();
        if super::find(&self.name).is_some()
            && let Some(file) = Judgement::file(&self.name)
            && file.is_file()
        {
            let others = Judgement::read(&file).unwrap_or_default();
            all.extend(others.into_iter().filter(|j| !self.judged.contains(j)));
        }
        all
    }
}

/// The folder of the user's own presets: [`FOLDER_VARIABLE`], or `crepitus/presets` in the user's
/// configuration; `None` without a home folder.
pub fn own_folder() -> Option<PathBuf> {
    let variable = |name| env::var_os(name).filter(|value| !value.is_empty());
    if let Some(folder) = variable(FOLDER_VARIABLE) {
        return Some(folder.into());
    }
    let home = || variable("HOME").map(PathBuf::from);
    let configuration = if cfg!(windows) {
        variable("APPDATA").map(PathBuf::from)
    } else if cfg!(target_os = "macos") {
        home().map(|home| home.join("Library/Application Support"))
    } else {
        // A relative path in it is to be ignored.
        let xdg = variable("XDG_CONFIG_HOME").map(PathBuf::from);
        xdg.filter(|path| path.is_absolute())
            .or_else(|| home().map(|home| home.join(".config")))
    };
    configuration.map(|folder| folder.join("crepitus/presets"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judgement() -> Judgement {
        Judgement {
            study: "Knees \"of\" spring".to_owned(),
            date: "2026-11-30".to_owned(),
            clinicians: 6,
            ratings: 12,
            statistic: "realism 3.8 of 5 (95 % 3.1 to 4.4)".to_owned(),
            sha256: "0".repeat(64),
        }
    }

    fn parse(text: &str) -> Result<Preset, SceneError> {
        Preset::parse(Path::new("mine.toml"), text)
    }

    #[test]
    fn a_preset_keeps_its_judgements() {
        let text = format!("[effects.texture]\n\n{}", judgement().to_toml().repeat(2));
        let preset = parse(&text).expect("a preset");
        assert_eq!(preset.judged, [judgement(), judgement()]);
        let again = parse(&preset.to_toml()).expect("the same");
        assert_eq!(again.judged, preset.judged);
        assert_eq!(again.judgements(), preset.judged);
        let json = preset.to_json(None);
        assert_eq!(json["judged"][0]["clinicians"], 6);
    }

    #[test]
    fn what_is_wrong_with_one_is_said() {
        for (from, to, expected) in [
            ("clinicians = 6", "clinicians = 0", "clinicians"),
            ("clinicians = 6", "clinicians = 1.5", "whole number"),
            ("sha256", "sha", "sha"),
            ("ratings = 12", "", "ratings"),
        ] {
            let text = judgement().to_toml().replace(from, to);
            let error = parse(&format!("[effects.texture]\n{text}")).expect_err(to);
            assert!(error.to_string().contains(expected), "{error}");
        }
    }
}
