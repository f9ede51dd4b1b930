//! The symptoms besides crepitus, solved from event to event.
//!
//! A second implementation of the laws that the device steps at 20 kHz, written
//! from the equations alone, so that each checks the other. The motion is
//! prescribed and known in closed form, so every state of a law ends where a
//! known function of time meets a limit: there is no step, and nothing to
//! converge.
//!
//! | to find | look in |
//! |---|---|
//! | the play that most symptoms are made of, and its limits | `play`, `limit` |
//! | where a state ends | `guard` |
//! | the loop over events and pieces of the motion | `runner` |
//! | a law and how it is read | the file of its name |
//!
//! Events and torques are those that one symptom asks for on its own. The tank that pays for
//! those that give energy is in [`ListedSymptoms`]; a device's limit on the sum is no part of it.

mod clasp_knife;
mod clonus;
mod cogwheel;
mod delayed_response;
mod guard;
mod keys;
mod limit;
mod listed;
mod play;
mod range_limit;
mod reflex;
mod rigidity;
mod runner;
mod stretch_catch;
mod texture;

pub use keys::{Keys, SymptomError};
pub use listed::{ListedSymptoms, NamedEvent, Paid};

use clasp_knife::ClaspKnife;
use clonus::Clonus;
use cogwheel::Cogwheel;
pub use crepitus_model::render::effects::symptom::Word;
use crepitus_plant::Motion;
use keys::Reader;
use play::{End, Mode, PlayAction};
use range_limit::walls;
use reflex::Reflex;
use rigidity::LeadPipe;
use runner::{Law, Run, Runner};
use std::fmt::Debug;
use stretch_catch::StretchCatch;
use texture::Texture;

/// The kind of an action of a play with ℓ = 0, from the mode it was in.
fn of_one_sided(action: PlayAction, was: Mode) -> Word {
    match (action, was) {
        (PlayAction::Meet(End::Lower), _) => Word::Slack,
        (PlayAction::Meet(End::Upper), _) => Word::Flow,
        (PlayAction::Turn, Mode::Flow(End::Lower)) => Word::Take,
        (PlayAction::Turn, _) => Word::Turn,
    }
}

/// The kind of an action of a play with two like limits.
fn of_two_sided(action: PlayAction) -> Word {
    match action {
        PlayAction::Meet(_) => Word::Flow,
        PlayAction::Turn => Word::Turn,
    }
}

/// An event of a symptom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymptomEvent {
    /// Time since the start of the run, s.
    pub time_s: f64,
    /// Kind of the event.
    pub kind: Word,
    /// Angle φ, rad.
    pub angle_rad: f64,
    /// Velocity Ω just after, rad/s.
    pub omega_rad_s: f64,
    /// The symptom's torque just before, N·m.
    pub torque_before_nm: f64,
    /// The symptom's torque just after, N·m.
    pub torque_after_nm: f64,
    /// P of a catch, N·m.
    pub peak_nm: Option<f64>,
}

/// Names of the symptoms, as in scene files.
pub const NAMES: [&str; 7] = [
    "range-limit",
    "lead-pipe",
    "cogwheel",
    "spasticity",
    "clasp-knife",
    "clonus",
    "texture",
];

/// A symptom on a prescribed motion.
#[derive(Debug)]
pub struct Symptom<'a> {
    /// Parts of the symptom, which never have torque together: the two walls of
    /// `range-limit`.
    parts: Vec<Box<dyn Run + 'a>>,
    /// The symptom gives energy: a tank pays for it.
    is_active: bool,
}

impl<'a> Symptom<'a> {
    /// The symptom `name`, armed without torque at the start of `motion`. A key
    /// that is not given has its default.
    ///
    /// # Errors
    /// [`SymptomError`] for an unknown name or choice, and for a number that
    /// the law cannot take.
    pub fn new(name: &str, keys: &dyn Keys, motion: &'a Motion) -> Result<Self, SymptomError> {
        let effect = NAMES.iter().find(|known| **known == name);
        let effect = effect.ok_or_else(|| SymptomError::Unknown(name.to_owned()))?;
        let reader = &Reader { effect, keys };
        let mut is_active = *effect == "clonus";
        let parts = match *effect {
            "range-limit" => walls(reader)?
                .into_iter()
                .map(|(wall, sign)| part(wall, sign, motion))
                .collect(),
            "lead-pipe" => vec![part(LeadPipe::read(reader)?, 1.0, motion)],
            "cogwheel" => vec![part(Cogwheel::read(reader)?, 1.0, motion)],
            "texture" => vec![part(Texture::read(reader)?, 1.0, motion)],
            muscular @ ("spasticity" | "clasp-knife" | "clonus") => {
                let s = reader.muscles()?;
                let is_reflex = muscular == "spasticity"
                    && reader.choice("form", ("catch", false), &[("reflex", true)])?;
                is_active |= is_reflex;
                vec![match (muscular, is_reflex) {
                    ("clasp-knife", _) => part(ClaspKnife::read(reader, s)?, s, motion),
                    ("clonus", _) => part(Clonus::read(reader, s)?, s, motion),
                    (_, true) => part(Reflex::read(reader, s)?, s, motion),
                    (_, false) => part(StretchCatch::read(reader, s)?, s, motion),
                }]
            }
            unknown => return Err(SymptomError::Unknown(unknown.to_owned())),
        };
        Ok(Self { parts, is_active })
    }

    /// Advances to `to_s` and returns every event on the way, in order.
    pub fn advance(&mut self, to_s: f64) -> Vec<SymptomEvent> {
        let mut events = Vec::new();
        for part in &mut self.parts {
            part.advance(to_s, &mut events);
        }
        if self.parts.len() > 1 {
            events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        }
        events
    }

    /// The torque that it asks for where it has been advanced to, N·m.
    pub fn torque_nm(&self) -> f64 {
        self.parts.iter().map(|part| part.torque_nm()).sum()
    }
}

fn part<'a, L>(law: L, sign: f64, motion: &'a Motion) -> Box<dyn Run + 'a>
where
    L: Law + Debug + 'a,
    L::Action: Debug,
{
    Box::new(Runner::new(law, sign, motion))
}
