//! Presets: a knee with a disorder, as one file.
//!
//! ```toml
//! title = "Lead-pipe rigidity, UPDRS 2"
//! disorder = "rigidity"            # see Disorder
//! severity = "UPDRS 2: mild to moderate"
//! level = "moderate"               # mild, moderate, severe: see Level
//! feel = "what a hand feels, in one line"
//! evidence = "estimate"            # sourced, derived, estimate
//! source = "where the numbers are from, in one line"
//!
//! [effects.lead-pipe]              # as in a scene; what is left out is at its default
//! torque_nm = 1.2
//! presliding_deg = 1.5
//!
//! [evidence_of.lead-pipe]          # where it is not that of the whole
//! presliding_deg = "sourced"
//!
//! [[judged]]                       # by clinicians: see `judged`
//! ```
//!
//! A user's own file has the same form, and may leave out all but the effects. A scene
//! takes an effect's values with `preset = "NAME"`; so may a preset, of those before it.

mod disorder;
mod json;
pub mod judged;
mod severity;
mod shipped;

pub use crate::effects::is_disorder;
pub use disorder::{Disorder, Evidence, Level};
pub use judged::Judgement;
pub use shipped::{FILES, Joint, PresetFile, find, joints, shipped, similar_name};

use crate::device_checks::{caps_warning, convention_refusal};
use crate::document::{Document, Section, quoted, text_of};
use crate::effects::{self, Crepitus, Start, effect_settings};
use crate::error::SceneError;
use crepitus_model::Parameters;
use crepitus_model::control::device_limits::{LimitSettings, RangeSettings};
use crepitus_model::parameters::{ParameterSpec, Tabled};
use crepitus_model::render::effects::EffectSettings;
use crepitus_plant::assembly::Listed;
use crepitus_plant::effect::{Effect, Part};
use std::fmt::Write;
use std::path::Path;

/// Texts of a preset, and the most characters that each may have.
const TEXTS: [(&str, usize); 4] = [
    ("title", 60),
    ("severity", 100),
    ("feel", 120),
    ("source", 200),
];

/// A knee with a disorder: the values of a device's effects, and what they are.
#[derive(Clone, Debug, Default)]
pub struct Preset {
    /// File name without `.toml`.
    pub name: String,
    /// Title, one line.
    pub title: Option<String>,
    /// Group.
    pub disorder: Option<Disorder>,
    /// Grade, in the words of its scale.
    pub severity: Option<String>,
    /// Severity on the scale that all disorders share.
    pub level: Option<Level>,
    /// Sensation to feel for.
    pub feel: Option<String>,
    /// Strength of the evidence for the whole.
    pub evidence: Option<Evidence>,
    /// Source of the numbers.
    pub source: Option<String>,
    /// Judgements by clinicians, in the file; [`Self::judgements`] has those of the user's folder, too.
    pub judged: Vec<Judgement>,
    /// The stick-slip object, if it is one of its effects.
    pub crepitus: Option<Crepitus>,
    /// All other effects, in the order of the table.
    pub listed: Vec<Listed>,
    /// The values that the file gives, itself or by a preset that it builds on.
    pub values: Vec<PresetValue>,
}

/// A value that a preset gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PresetValue {
    /// The effect.
    pub effect: &'static str,
    /// The parameter or choice.
    pub key: &'static str,
    /// The value itself.
    pub setting: Setting,
    /// Origin, if the file says it.
    pub evidence: Option<Evidence>,
}

/// A number with its description, or the name of an option.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Setting {
    /// A number.
    Number(f64, &'static ParameterSpec),
    /// An option.
    Option(&'static str),
}

/// The presets that a preset can build on.
#[derive(Clone, Copy)]
enum Presets<'p> {
    /// All that ship.
    Shipped,
    /// These, of those that ship.
    Only(&'p [Preset]),
}

impl<'p> Presets<'p> {
    fn list(self) -> &'p [Preset] {
        match self {
            Self::Shipped => shipped(),
            Self::Only(presets) => presets,
        }
    }

    fn starts(self) -> Vec<Start<'p>> {
        self.list().iter().filter_map(Preset::start).collect()
    }
}

/// The presets that the effects of a scene may start from.
pub(crate) fn starts() -> Vec<Start<'static>> {
    Presets::Shipped.starts()
}

impl Preset {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// [`SceneError`] with line, key, cause and valid values.
    pub fn read(file: &Path) -> Result<Self, SceneError> {
        Self::parse(file, &text_of(file)?)
    }

    /// Checks the text of a file, which errors name.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(file: &Path, text: &str) -> Result<Self, SceneError> {
        Self::build_on(Presets::Shipped, file, text)
    }

    /// A preset that can build on these.
    fn build_on(known: Presets<'_>, file: &Path, text: &str) -> Result<Self, SceneError> {
        let document = Document::parse(file, text)?;
        let root = document.section();
        let [title, severity, feel, source] = TEXTS.map(|(key, most)| line(&root, key, most));
        let disorders = Disorder::ALL.map(|d| (d.name(), d));
        let disorder = root.optional_choice("disorder", &disorders)?;
        let levels = Level::ALL.map(|l| (l.name(), l));
        let level = root.optional_choice("level", &levels)?;
        let evidence = root.optional_choice("evidence", &evidences())?;
        let section = root.section("effects")?;
        let effects::Effects {
            crepitus,
            encoder,
            listed,
        } = effects::read_alone(&section, &|| known.starts())?;
        if encoder.is_some() {
            return Err(no_knee(&section.section("encoder")?));
        }
        for Listed { effect, .. } in &listed {
            if !matches!(effect.part, Part::Stage(_)) {
                return Err(no_knee(&section.section(effect.name)?));
            }
        }
        if crepitus.is_none() && listed.is_empty() {
            return Err(
                section.error("there is no effect here: a preset has one or more [effects.NAME]")
            );
        }
        let mut preset = Self {
            name: file
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            title: title?,
            disorder,
            severity: severity?,
            level,
            feel: feel?,
            evidence,
            source: source?,
            judged: judged::judgements(&root)?,
            crepitus,
            listed,
            values: Vec::new(),
        };
        preset.check(&section)?;
        preset.values = preset.values_of(&root, &section, known)?;
        root.finish()?;
        Ok(preset)
    }

    /// The preset as effects start from it; `None` if it does not ship.
    fn start(&self) -> Option<Start<'_>> {
        let mut names = FILES.iter().map(|file| file.name);
        Some(Start {
            name: names.find(|name| self.name == *name)?,
            crepitus: self.crepitus.as_ref(),
            listed: &self.listed,
        })
    }

    /// Effects of the preset, in the order of the table.
    pub fn effects(&self) -> impl Iterator<Item = &'static Effect> {
        let joint = self
            .crepitus
            .as_ref()
            .map(|_| &crepitus_plant::effects::crepitus::EFFECT);
        joint
            .into_iter()
            .chain(self.listed.iter().map(|l| l.effect))
    }

    /// Returns whether it has an effect.
    pub fn has(&self, effect: &str) -> bool {
        self.effects().any(|e| e.name == effect)
    }

    /// Settings of its effects besides the joint.
    pub fn effect_settings(&self) -> EffectSettings {
        effect_settings(&self.listed)
    }

    /// The joint's numbers.
    pub fn joint(&self) -> Option<&Parameters> {
        self.crepitus.as_ref().map(|c| &c.settings.parameters)
    }

    /// The preset as a file, with every value of its effects, so that it means the same
    /// whatever a default will be. It reads back to the same bits.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        // Writing to a String cannot fail.
        for (key, line) in [
            ("title", self.title.as_deref()),
            ("disorder", self.disorder.map(Disorder::name)),
            ("severity", self.severity.as_deref()),
            ("level", self.level.map(Level::name)),
            ("feel", self.feel.as_deref()),
            ("evidence", self.evidence.map(Evidence::name)),
            ("source", self.source.as_deref()),
        ] {
            if let Some(line) = line {
                let _ = writeln!(text, "{key} = {}", quoted(line));
            }
        }
        for effect in self.effects() {
            let gap = if text.is_empty() { "" } else { "\n" };
            let _ = writeln!(text, "{gap}[effects.{}]", effect.name);
            for (key, setting) in self.settings_of(effect) {
                let _ = match setting {
                    Setting::Number(x, _) => writeln!(text, "{key} = {x:?}"),
                    Setting::Option(name) => writeln!(text, "{key} = {}", quoted(name)),
                };
            }
        }
        for judgement in &self.judged {
            let _ = write!(text, "\n{}", judgement.to_toml());
        }
        text
    }

    /// Warns of effects that can ask for more than a device at its defaults shows.
    pub fn caps_warning(&self) -> Option<String> {
        let (limits, range) = (LimitSettings::default(), RangeSettings::default());
        caps_warning(&self.effect_settings(), self.joint(), &limits, &range)
    }

    /// Checks what a device renders: each effect by itself, then all of them.
    fn check(&self, effects: &Section<'_>) -> Result<(), SceneError> {
        if let Some(crepitus) = &self.crepitus
            && let Some(why) = convention_refusal(&crepitus.settings)
        {
            return Err(effects.section("crepitus")?.error(why));
        }
        for listed in &self.listed {
            let alone = effect_settings(std::slice::from_ref(listed));
            if let Err(error) = alone.check_knee(None) {
                let own = effects.section(listed.effect.name)?;
                return Err(own.error(error.to_string()));
            }
        }
        let together = self.effect_settings().check_knee(self.joint());
        together.map_err(|error| effects.error(error.to_string()))
    }

    /// The values that the file gives, with their evidence.
    fn values_of(
        &self,
        root: &Section<'_>,
        effects: &Section<'_>,
        known: Presets<'_>,
    ) -> Result<Vec<PresetValue>, SceneError> {
        let exceptions = root.optional_section("evidence_of")?;
        let mut values = Vec::new();
        for effect in self.effects() {
            let own = effects.section(effect.name)?;
            let excepted = match &exceptions {
                Some(exceptions) => exceptions.optional_section(effect.name)?,
                None => None,
            };
            let base = own.optional_text("preset")?;
            let base = base.and_then(|name| known.list().iter().find(|preset| preset.name == name));
            for (key, setting) in self.settings_of(effect) {
                let inherited = base.and_then(|base| base.value(effect.name, key));
                let evidence = match effects::written_as(&own, effect, key) {
                    Some(written) => {
                        let exception = match &excepted {
                            Some(excepted) => excepted.optional_choice(written, &evidences())?,
                            None => None,
                        };
                        exception.or(self.evidence)
                    }
                    None => match inherited {
                        Some(inherited) => inherited.evidence,
                        None => continue,
                    },
                };
                values.push(PresetValue {
                    effect: effect.name,
                    key,
                    setting,
                    evidence,
                });
            }
            if let Some(excepted) = &excepted {
                excepted.finish()?;
            }
        }
        if let Some(exceptions) = &exceptions {
            exceptions.finish()?;
        }
        Ok(values)
    }

    /// A value that the file gives.
    fn value(&self, effect: &str, key: &str) -> Option<&PresetValue> {
        let is_it = |value: &&PresetValue| value.effect == effect && value.key == key;
        self.values.iter().find(is_it)
    }

    /// All choices and numbers of one of its effects.
    pub fn settings_of(&self, effect: &Effect) -> Vec<(&'static str, Setting)> {
        let numbers = |values: &[f64]| -> Vec<_> {
            let table = effect.parameters.iter().zip(values);
            table
                .map(|(spec, value)| (spec.key, Setting::Number(*value, spec)))
                .collect()
        };
        if let Some(Crepitus { settings, .. }) = &self.crepitus
            && effect.name == crepitus_plant::effects::crepitus::EFFECT.name
        {
            let mut all = vec![
                ("convention", Setting::Option(settings.convention.name())),
                ("restart", Setting::Option(settings.restart.name())),
            ];
            all.extend(numbers(&settings.parameters.values()));
            return all;
        }
        let Some(listed) = self.listed.iter().find(|l| l.effect.name == effect.name) else {
            return Vec::new();
        };
        let choices = effect.choices.iter().zip(&listed.given.choices);
        let mut all: Vec<_> = choices
            .filter_map(|(choice, place)| {
                let name = choice.names.get(usize::from(*place))?;
                Some((choice.key, Setting::Option(name)))
            })
            .collect();
        all.extend(numbers(&listed.given.numbers));
        all
    }
}

fn evidences() -> [(&'static str, Evidence); 3] {
    Evidence::ALL.map(|e| (e.name(), e))
}

/// A text of one line.
fn line(section: &Section<'_>, key: &str, most: usize) -> Result<Option<String>, SceneError> {
    let Some(text) = section.optional_text(key)? else {
        return Ok(None);
    };
    let text = text.trim();
    if text.is_empty() || text.chars().any(char::is_control) {
        return Err(section.key_error(key, "one line of text is wanted"));
    }
    let count = text.chars().count();
    if count > most {
        return Err(section.key_error(
            key,
            format!("{count} characters are too many: one line of up to {most} is allowed"),
        ));
    }
    Ok(Some(text.to_owned()))
}

/// An effect of the mechanics or the sensor.
fn no_knee(own: &Section<'_>) -> SceneError {
    own.error(
        "a preset is a knee's disorders as the device renders them, not its leg, motor or sensor: leave this out, or \
         make it a scene with `version = 1`",
    )
}

#[cfg(test)]
mod tests;
