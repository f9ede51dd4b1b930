//! The symptoms that a scene lists.

use super::{Keys, NAMES, Symptom, SymptomError, SymptomEvent};
use crate::reference::tank::{STEP_S, Tank};
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

/// Torque of a symptom that gives energy, at the end of a step of the tank.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paid {
    /// Name of the symptom.
    pub effect: &'static str,
    /// The end of the step, s.
    pub end_s: f64,
    /// Length of the step, s.
    pub step_s: f64,
    /// The torque that it asks for, N·m.
    pub asked_nm: f64,
    /// The part of that which the tank pays, N·m.
    pub paid_nm: f64,
}

/// All symptoms of a scene, on its motion, and the tank that pays for those that give energy.
#[derive(Debug)]
pub struct ListedSymptoms<'a> {
    symptoms: Vec<(&'static str, Symptom<'a>)>,
    motion: &'a Motion,
    tank: Tank,
    time_s: f64,
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
        Ok(Self {
            symptoms,
            motion,
            tank: Tank::FULL,
            time_s: 0.0,
        })
    }

    /// Advances all to `to_s` and returns every event on the way, in the order
    /// of time; at one time, in that of the scene's effects. `on_paid` receives what the tank
    /// pays on the way.
    pub fn advance(&mut self, to_s: f64, on_paid: &mut dyn FnMut(&Paid)) -> Vec<NamedEvent> {
        let mut events = Vec::new();
        if self.symptoms.iter().any(|(_, symptom)| symptom.is_active) {
            while self.time_s < to_s {
                self.step(to_s, &mut events, on_paid);
            }
        }
        self.follow(to_s, &mut events);
        self.time_s = to_s;
        events.sort_by(|a, b| a.event.time_s.total_cmp(&b.event.time_s));
        events
    }

    /// Each symptom's name and torque, N·m, where all have been advanced to:
    /// the columns of a row. Of one that gives energy it is what the tank pays.
    pub fn torques(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let share = self.tank.share();
        self.symptoms.iter().map(move |(effect, symptom)| {
            let paid = if symptom.is_active { share } else { 1.0 };
            (*effect, paid * symptom.torque_nm())
        })
    }

    /// Share of the torque asked for that the tank holds back; `None` if no symptom gives
    /// energy, and 0 while none asks for torque.
    pub fn held_back(&self) -> Option<f64> {
        let mut active = self.active().peekable();
        active.peek()?;
        let asks = active.any(|(_, nm)| nm != 0.0);
        Some(if asks { 1.0 - self.tank.share() } else { 0.0 })
    }

    /// Those that give energy, and the torques that they ask for, N·m.
    fn active(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let active = self.symptoms.iter().filter(|(_, s)| s.is_active);
        active.map(|(effect, symptom)| (*effect, symptom.torque_nm()))
    }

    fn follow(&mut self, to_s: f64, events: &mut Vec<NamedEvent>) {
        for (effect, symptom) in &mut self.symptoms {
            let own = symptom.advance(to_s).into_iter();
            events.extend(own.map(|event| NamedEvent { effect, event }));
        }
    }

    /// A step of the tank, at most to `to_s` and within a piece of the motion.
    fn step(&mut self, to_s: f64, events: &mut Vec<NamedEvent>, on_paid: &mut dyn FnMut(&Paid)) {
        let start_s = self.time_s;
        let piece = self.motion.piece(start_s);
        let end_s = (start_s + STEP_S).min(to_s).min(piece.end_s);
        let end_s = end_s.max(start_s.next_up());
        let step_s = end_s - start_s;
        let power_w = |symptoms: &Self, time_s: f64| {
            let (_, omega_rad_s) = piece.angle_and_velocity(time_s);
            omega_rad_s * symptoms.active().map(|(_, nm)| nm).sum::<f64>()
        };
        let start_w = power_w(self, start_s);
        let middle_s = start_s + 0.5 * step_s;
        self.follow(middle_s, events);
        let middle_w = power_w(self, middle_s);
        self.follow(end_s, events);
        let end_w = power_w(self, end_s);
        self.tank.advance(step_s, [start_w, middle_w, end_w]);
        self.time_s = end_s;
        let share = self.tank.share();
        for (effect, asked_nm) in self.active() {
            on_paid(&Paid {
                effect,
                end_s,
                step_s,
                asked_nm,
                paid_nm: share * asked_nm,
            });
        }
    }
}
