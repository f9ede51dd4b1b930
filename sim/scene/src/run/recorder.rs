//! Events of a coupled run, and what the tank pays of symptoms.

use super::held_back::{TankAccounting, TankTotals};
use crate::scene::Scene;
use crate::trace::{EventRecord, SymptomEvent};
use crepitus_model::render::effects::symptom::Change;
use crepitus_model::render::effects::{EffectSpec, Observe};
use crepitus_model::{Event, Real};
use crepitus_plant::chain::Body;

/// An event of a tick.
pub(super) enum Happened {
    Joint(EventRecord),
    Symptom(SymptomEvent),
}

impl Happened {
    pub(super) fn time_s(&self) -> f64 {
        match self {
            Self::Joint(event) => event.time_s,
            Self::Symptom(event) => event.time_s,
        }
    }
}

/// Report of a symptom from within a tick.
#[derive(Clone)]
pub(super) enum Notice<F> {
    /// An event of it.
    Change(Change<F>),
    /// The symptom asks for a torque, and the tank pays so much of it, N·m.
    Paid { asked_nm: F, paid_nm: F },
}

/// Reports of a tick: there are hardly ever any, so a tick only collects them. The joint acts
/// first, so its events are before all notices.
#[derive(Clone)]
pub(super) struct Heard<F> {
    pub(super) events: Vec<Event<F>>,
    pub(super) notices: Vec<(&'static EffectSpec, Notice<F>)>,
    /// A beat or a reflex is under way: its end is of interest, too.
    is_paying: bool,
}

impl<F> Heard<F> {
    pub(super) fn new() -> Self {
        Self {
            events: Vec::new(),
            notices: Vec::new(),
            is_paying: false,
        }
    }

    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.events.is_empty() && self.notices.is_empty()
    }
}

impl<F: Real> Observe<F> for Heard<F> {
    const LISTENS: bool = true;

    #[cold]
    fn change(&mut self, effect: &'static EffectSpec, change: Change<F>) {
        self.notices.push((effect, Notice::Change(change)));
    }

    /// One that asks for nothing is of interest once, at the end of what it asked for.
    #[inline]
    fn paid(&mut self, effect: &'static EffectSpec, asked_nm: F, paid_nm: F) {
        if asked_nm != F::ZERO || self.is_paying {
            self.notices
                .push((effect, Notice::Paid { asked_nm, paid_nm }));
        }
    }
}

/// Puts the events of symptoms on record, and what the tank pays of them.
#[derive(Clone)]
pub(super) struct Recorder {
    pub(super) step_s: f64,
    play_events: bool,
    tank: TankAccounting,
}

impl Recorder {
    pub(super) fn new(scene: &Scene) -> Self {
        Self {
            step_s: scene.step_s(),
            play_events: scene.play_events,
            tank: TankAccounting::default(),
        }
    }

    /// Puts on record all notices of a tick that began at `start_s`, or of a part of one.
    #[cold]
    pub(super) fn note_all<F: Real>(
        &mut self,
        (start_s, (from, to)): (f64, (&Body, &Body)),
        heard: &mut Heard<F>,
        events: &mut Vec<Happened>,
    ) {
        for (effect, notice) in heard.notices.drain(..) {
            self.note((start_s, from, to), effect, &notice, events);
        }
        heard.is_paying = self.tank.is_paying();
    }

    fn note<F: Real>(
        &mut self,
        (start_s, from, to): (f64, &Body, &Body),
        effect: &'static EffectSpec,
        notice: &Notice<F>,
        events: &mut Vec<Happened>,
    ) {
        let change = match notice {
            Notice::Change(change) => change,
            Notice::Paid { asked_nm, paid_nm } => {
                let paid = (asked_nm.to_f64(), paid_nm.to_f64());
                let tick = (start_s + self.step_s, self.step_s);
                if let Some(ended) = self.tank.paid(effect.name, paid, tick) {
                    events.push(Happened::Symptom(SymptomEvent {
                        time_s: tick.0,
                        effect: effect.name,
                        word: ended.word,
                        angle_rad: to.angle_rad,
                        omega_rad_s: to.omega_rad_s,
                        torque_before_nm: ended.asked_nm,
                        torque_after_nm: ended.paid_nm,
                    }));
                }
                return;
            }
        };
        if change.word.is_of_play() && !self.play_events {
            return;
        }
        let fraction = change.fraction.to_f64();
        let faster = to.omega_rad_s - from.omega_rad_s;
        let bend_rad = 0.5 * faster * self.step_s;
        let travel_rad = to.angle_rad - from.angle_rad;
        events.push(Happened::Symptom(SymptomEvent {
            time_s: start_s + fraction * self.step_s,
            effect: effect.name,
            word: change.word,
            angle_rad: from.angle_rad + fraction * (travel_rad - bend_rad * (1.0 - fraction)),
            omega_rad_s: from.omega_rad_s + faster * fraction,
            torque_before_nm: change.before_nm.to_f64(),
            torque_after_nm: change.after_nm.to_f64(),
        }));
    }

    /// Account of what the tank held back so far.
    pub(super) fn tank(&self) -> TankTotals {
        self.tank.totals()
    }
}
