//! The symptoms that a scene lists.

use super::{Keys, NAMES, Symptom, SymptomError, SymptomEvent};
use crepitus_plant::Motion;
use crepitus_plant::assembly::Listed;

/// An effect of a scene has numbers by the keys of its parameters, and choices.
impl Keys for Listed {
    fn number(&self, key: &str) -> Option<f64> {
        let specs = self.effect.parameters.iter();
        let mut numbers = specs.zip(&self.given.numbers);
        numbers.find_map(|(spec, number)| (spec.key == key).then_some(*number))
    }

    fn choice(&self, key: &str) -> Option<&str> {
        let specs = self.effect.choices.iter();
        let (spec, place) = specs
            .zip(&self.given.choices)
            .find(|(spec, _)| spec.key == key)?;
        spec.names.get(usize::from(*place)).copied()
    }
}

/// An event and the symptom that it is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedEvent {
    /// Name of the symptom, as in scene files.
    pub effect: &'static str,
    /// The event.
    pub event: SymptomEvent,
}

/// All symptoms of a scene, on its motion.
#[derive(Debug)]
pub struct ListedSymptoms<'a> {
    symptoms: Vec<(&'static str, Symptom<'a>)>,
}

impl<'a> ListedSymptoms<'a> {
    /// The symptoms among `listed`, in this order; other effects are left out.
    ///
    /// # Errors
    /// [`SymptomError`] for numbers that a law cannot take.
    pub fn new(listed: &[Listed], motion: &'a Motion) -> Result<Self, SymptomError> {
        let symptoms = listed
            .iter()
            .filter(|l| NAMES.contains(&l.effect.name))
            .map(|l| Ok((l.effect.name, Symptom::new(l.effect.name, l, motion)?)))
            .collect::<Result<_, SymptomError>>()?;
        Ok(Self { symptoms })
    }

    /// Advances all to `to_s` and returns every event on the way, in the order
    /// of time; at one time, in that of the scene's effects.
    pub fn advance(&mut self, to_s: f64) -> Vec<NamedEvent> {
        let mut events = Vec::new();
        for (effect, symptom) in &mut self.symptoms {
            let own = symptom.advance(to_s).into_iter();
            events.extend(own.map(|event| NamedEvent { effect, event }));
        }
        events.sort_by(|a, b| a.event.time_s.total_cmp(&b.event.time_s));
        events
    }

    /// Each symptom's name and torque, N·m, where all have been advanced to:
    /// the columns of a row.
    pub fn torques(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.symptoms
            .iter()
            .map(|(effect, symptom)| (*effect, symptom.torque_nm()))
    }
}
