//! Events of a coupled run, and what the tank pays of symptoms.

use super::held_back::{TankAccounting, TankTotals};
use super::stages::Notice;
use crate::scene::Scene;
use crate::trace::{EventRecord, SymptomEvent};
use crepitus_model::render::effects::EffectSpec;
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

/// Reports of a tick: there are hardly ever any, so a tick only collects them.
pub(super) struct Heard<F> {
    pub(super) events: Vec<Event<F>>,
    pub(super) notices: Vec<(&'static EffectSpec, Notice<F>)>,
}

impl<F> Heard<F> {
    pub(super) fn new() -> Self {
        Self {
            events: Vec::new(),
            notices: Vec::new(),
        }
    }

    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.events.is_empty() && self.notices.is_empty()
    }
}

/// Puts the events of symptoms on record, and what the tank pays of them.
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

    pub(super) fn note<F: Real>(
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
