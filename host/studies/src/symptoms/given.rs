//! A symptom and its settings.

use crepitus_ladder::subject::forms;
use crepitus_model::parameters::Chosen;
use crepitus_model::render::effects::{EffectSettings, EffectSpec, SPECS};
use crepitus_scene::reference::symptoms::{Keys, NAMES};
use std::fmt;

/// A symptom with some of its parameters; the rest has its defaults. Keys are
/// those of scene files, of a side in full: `flexion_loss`.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// Name in scene files.
    pub effect: &'static str,
    /// Numbers by key.
    pub numbers: Vec<(&'static str, f64)>,
    /// Options by key.
    pub choices: Vec<(&'static str, &'static str)>,
}

impl Given {
    /// A symptom at its defaults but for these.
    pub fn new(
        effect: &'static str,
        numbers: &[(&'static str, f64)],
        choices: &[(&'static str, &'static str)],
    ) -> Self {
        Self {
            effect,
            numbers: numbers.to_vec(),
            choices: choices.to_vec(),
        }
    }

    /// Every symptom at its defaults, in each form of its law.
    pub fn all() -> Vec<Self> {
        let symptoms = SPECS.iter().filter(|spec| NAMES.contains(&spec.name));
        symptoms
            .flat_map(|spec| match forms(spec) {
                None => vec![Self::new(spec.name, &[], &[])],
                Some(choice) => {
                    let names = choice.names.iter();
                    names
                        .map(|form| Self::new(spec.name, &[], &[(choice.key, *form)]))
                        .collect()
                }
            })
            .collect()
    }

    /// The form of its law, if it has several.
    pub fn form(&self) -> Option<&'static str> {
        let choice = forms(self.spec()?)?;
        let chosen = self.choices.iter().find(|(key, _)| *key == choice.key);
        let default = choice.names.get(usize::from(choice.default)).copied();
        chosen.map_or(default, |(_, name)| Some(*name))
    }

    /// Name of the effect, with the form in brackets: `cogwheel (space)`.
    pub fn name(&self) -> String {
        match self.form() {
            Some(form) => format!("{} ({form})", self.effect),
            None => self.effect.to_owned(),
        }
    }

    /// Place in the table of effects; beyond the last if there is no such effect.
    pub fn place(&self) -> usize {
        let found = SPECS.iter().position(|spec| spec.name == self.effect);
        found.unwrap_or(SPECS.len())
    }

    fn spec(&self) -> Option<&'static EffectSpec> {
        SPECS.get(self.place())
    }

    /// The numbers and options of all its parameters, in the order of the table.
    fn chosen(&self) -> (Vec<f64>, Vec<u8>) {
        let Some(spec) = self.spec() else {
            return (Vec::new(), Vec::new());
        };
        let numbers = spec
            .parameters
            .iter()
            .map(|parameter| self.number(parameter.key).unwrap_or_default());
        let options = spec.choices.iter().map(|choice| {
            let named = self.choice(choice.key);
            let place = named.and_then(|name| choice.names.iter().position(|n| *n == name));
            place
                .and_then(|place| u8::try_from(place).ok())
                .unwrap_or(choice.default)
        });
        (numbers.collect(), options.collect())
    }

    /// The settings of a device with nothing else.
    pub fn settings(&self) -> EffectSettings {
        Self::settings_of(std::slice::from_ref(self))
    }

    /// The settings of a device with these symptoms and nothing else.
    pub fn settings_of(symptoms: &[Self]) -> EffectSettings {
        let chosen: Vec<_> = symptoms.iter().map(|s| (s.effect, s.chosen())).collect();
        EffectSettings::given(|name| {
            let (_, (numbers, options)) = chosen.iter().find(|(effect, _)| *effect == name)?;
            Some(Chosen { numbers, options })
        })
    }
}

impl Keys for Given {
    /// The given number, or else the device's default: the reference has its own.
    fn number(&self, key: &str) -> Option<f64> {
        let given = self.numbers.iter().find(|(known, _)| *known == key);
        given.map(|(_, number)| *number).or_else(|| {
            let mut specs = self.spec()?.parameters.iter();
            specs.find(|spec| spec.key == key).map(|spec| spec.default)
        })
    }

    fn choice(&self, key: &str) -> Option<&str> {
        let given = self.choices.iter().find(|(known, _)| *known == key);
        given.map(|(_, name)| *name).or_else(|| {
            let choice = self.spec()?.choices.iter().find(|spec| spec.key == key)?;
            choice.names.get(usize::from(choice.default)).copied()
        })
    }
}

impl fmt::Display for Given {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.effect)?;
        let mut separator = " with ";
        for (key, name) in &self.choices {
            write!(f, "{separator}{key} = {name}")?;
            separator = ", ";
        }
        for (key, number) in &self.numbers {
            write!(f, "{separator}{key} = {number}")?;
            separator = ", ";
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symptom_is_there_in_each_form() {
        let names: Vec<String> = Given::all().iter().map(Given::name).collect();
        assert_eq!(
            names,
            [
                "range-limit",
                "lead-pipe",
                "cogwheel (time)",
                "cogwheel (space)",
                "spasticity (catch)",
                "spasticity (reflex)",
                "clasp-knife (angle)",
                "clasp-knife (torque)",
                "clonus",
                "texture"
            ]
        );
        assert_eq!(Given::new("cogwheel", &[], &[]).name(), "cogwheel (time)");
    }

    #[test]
    fn settings_are_those_of_the_keys() {
        let given = Given::new(
            "spasticity",
            &[("gain_nm_per_rad", 1.5)],
            &[("form", "reflex"), ("muscles", "flexors")],
        );
        let settings = given.settings().spasticity.unwrap();
        assert_eq!((settings.form, settings.muscles), (1, 1));
        assert_eq!(settings.gain_nm_per_rad, 1.5);
        assert_eq!(settings.threshold_deg, 75.0);
        let texture = Given::new("texture", &[("pitch_deg", 2.0)], &[]);
        let both = Given::settings_of(&[given.clone(), texture]);
        assert_eq!(both.texture.unwrap().pitch_deg, 2.0);
        assert_eq!(both.spasticity, Some(settings));
        assert_eq!(
            given.to_string(),
            "spasticity with form = reflex, muscles = flexors, gain_nm_per_rad = 1.5"
        );
    }
}
