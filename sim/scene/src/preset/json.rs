//! A preset as JSON, for programs.

use super::{Disorder, Evidence, Judgement, Level, Preset, PresetValue, Setting};
use crepitus_files::json_path;
use serde_json::{Map, Value, json};
use std::path::Path;

impl Preset {
    /// Texts and grades, every setting of its effects, and the values that its file gives
    /// with unit and evidence; `file` is where it was read from.
    pub fn to_json(&self, file: Option<&Path>) -> Value {
        let effects: Map<String, Value> = self
            .effects()
            .map(|effect| {
                let settings = self.settings_of(effect).into_iter();
                let settings: Map<_, _> = settings
                    .map(|(key, setting)| (key.to_owned(), value_json(setting)))
                    .collect();
                (effect.name.to_owned(), settings.into())
            })
            .collect();
        let values: Vec<_> = self
            .values
            .iter()
            .map(|v| {
                json!({
                    "effect": v.effect,
                    "key": v.key,
                    "value": value_json(v.setting),
                    "unit": v.unit(),
                    "evidence": v.evidence.map(Evidence::name),
                })
            })
            .collect();
        json!({
            "name": self.name,
            "title": self.title,
            "disorder": self.disorder.map(Disorder::name),
            "severity": self.severity,
            "level": self.level.map(Level::name),
            "feel": self.feel,
            "evidence": self.evidence.map(Evidence::name),
            "source": self.source,
            "judged": self.judgements().iter().map(judged).collect::<Vec<_>>(),
            "file": file.map(json_path),
            "effects": effects,
            "values": values,
        })
    }
}

impl PresetValue {
    /// The unit, if there is one to show.
    pub fn unit(&self) -> Option<&'static str> {
        match self.setting {
            Setting::Number(_, spec) => Some(spec.unit).filter(|unit| *unit != "1"),
            Setting::Option(_) => None,
        }
    }
}

fn judged(judgement: &Judgement) -> Value {
    json!({
        "study": judgement.study,
        "date": judgement.date,
        "clinicians": judgement.clinicians,
        "ratings": judgement.ratings,
        "statistic": judgement.statistic,
        "sha256": judgement.sha256,
    })
}

fn value_json(setting: Setting) -> Value {
    match setting {
        Setting::Number(x, _) => json!(x),
        Setting::Option(name) => json!(name),
    }
}
