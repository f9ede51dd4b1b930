//! The examination of the knee that is on the device: its measures, its steps, and what was missed.

use super::DeviceThread;
use super::hand::Hand;
use super::lessons::Held;
use crepitus_client::Transport;
use crepitus_knee::Examination;
use crepitus_knee::examination::{Finding, Measure, Step};
use crepitus_protocol::{DeviceSettings, Values};
use serde_json::{Value, json};
use std::time::Instant;

/// The examination under way.
pub(super) struct Examined {
    pub(super) examination: Examination,
    /// That of a person who has let go of the leg, while a simulated examiner moves it.
    left: Option<Examination>,
    /// Whether a person moves the leg.
    pub(super) by_person: bool,
    pub(super) published_at: Instant,
}

impl Examined {
    /// Nothing is examined yet.
    pub(super) fn new(by_person: bool, now: Instant) -> Self {
        Self {
            examination: Examination::default(),
            left: None,
            by_person,
            published_at: now,
        }
    }

    /// Goes on with the examination of a person who takes the leg again, and begins that of another mover.
    fn change_mover(&mut self, by_person: bool, values: &Values) {
        self.by_person = by_person;
        let known = self.left.take().filter(|_| by_person);
        let next = known.unwrap_or_else(|| examination_of(values));
        let before = std::mem::replace(&mut self.examination, next);
        self.left = (!by_person).then_some(before);
    }
}

impl<T: Transport> DeviceThread<'_, T> {
    /// Returns whether a person moves the leg, whose speed and steps are judged, and not the examiner of a
    /// simulated device: at a brace always, otherwise while a hand has it.
    fn person_moves(&self) -> bool {
        self.hand.as_ref().is_none_or(Hand::has_leg)
    }

    /// Changes the examination if somebody else moves the leg now; returns whether it is a person.
    pub(super) fn notice_mover(&mut self) -> bool {
        let by_person = self.person_moves();
        if by_person != self.examined.by_person {
            self.examined.change_mover(by_person, &self.values);
            self.publish_examination();
            self.publish_target();
        }
        by_person
    }

    /// Begins the examination of the knee that is on the device.
    pub(super) fn restart_examination(&mut self) {
        self.examined.examination = examination_of(&self.values);
        self.examined.left = None;
        self.publish_examination();
    }

    /// Keeps what was missed of a knee that an answer has revealed: it may be felt again, beside a healthy one. What a
    /// person has examined counts, or else what the simulated examiner has.
    pub(super) fn keep_findings(&mut self) {
        let examined = &self.examined;
        let left = examined.left.as_ref();
        let examination = left.unwrap_or(&examined.examination);
        let by_person = examined.by_person || left.is_some();
        let findings: Vec<_> = examination.findings().map(shown).collect();
        if let Some(held) = &mut self.lesson {
            let trial = held.lesson().trial();
            let kept = json!({ "trial": trial, "by_person": by_person, "findings": findings });
            held.keep_findings(kept);
        }
        self.publish_examination();
    }

    /// Begins it if these values are of another knee than those now.
    pub(super) fn examine(&mut self, before: &Values) {
        let knee = |values: &Values| {
            let settings = DeviceSettings::of(values).ok()?;
            Some((settings.effects, settings.crepitus.is_some()))
        };
        if knee(before) != knee(&self.values) {
            self.restart_examination();
        }
    }

    pub(super) fn publish_examination(&mut self) {
        self.examined.published_at = Instant::now();
        let masks = self.masks();
        let examination = &self.examined.examination;
        let measures = Measure::ALL.map(|measure| {
            let is_hidden = masks.torque && measure.spec().is_of_torque;
            examination
                .measure(measure)
                .filter(|_| !is_hidden)
                .map(rounded)
        });
        let steps = Step::ALL.map(|step| {
            let is_done = examination.has_done(step);
            json!({ "step": step.name(), "done": is_done })
        });
        // What shows a knee tells which one it is.
        let findings = (!masks.states).then(|| examination.findings().map(shown).collect());
        let message = json!({ "examination": {
            "by_person": self.examined.by_person,
            "measures": measures,
            "steps": steps,
            "findings": findings.map(Value::Array),
            "of_answer": self.lesson.as_ref().and_then(Held::findings),
        } });
        self.publish(|latest| &mut latest.examination, &message);
    }
}

/// The examination of a knee that has not begun.
fn examination_of(values: &Values) -> Examination {
    DeviceSettings::of(values).map_or_else(
        |_| Examination::default(),
        |settings| Examination::new(&settings.effects, settings.crepitus.is_some()),
    )
}

fn shown(finding: Finding) -> Value {
    let [reached, needed] = finding.outcome.numbers();
    json!({
        "effect": finding.sign.effect,
        "step": finding.sign.step.name(),
        "outcome": finding.outcome.name(),
        "reached": reached.map(rounded),
        "needed": needed.map(rounded),
    })
}

/// Of more digits there would be a message every time.
fn rounded(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}
