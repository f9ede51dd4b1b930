//! The knee: presets and parameters. Every change is one commit.

use super::DeviceThread;
use super::lessons::Held;
use crate::hello;
use crate::lesson::{HEALTHY, Knee, Lesson};
use crate::live::Pain;
use crate::request::SavePreset;
use crate::shared::Outcome;
use crepitus_client::{Client, Transport};
use crepitus_files::names;
use crepitus_protocol::parameters::PARAMETERS;
use crepitus_protocol::{DeviceSettings, Revision, Values};
use crepitus_scene::preset::{self, Disorder, Preset};
use crepitus_scene::scene::caps_warning;
use crepitus_scene::values::{is_of_knee, knee, preset_of, with_preset};
use serde_json::{Value, json};
use std::iter::once;

/// Longest name that is made of a title; a number may follow it.
const MOST_NAME: usize = 40;

impl<T: Transport> DeviceThread<'_, T> {
    pub(super) fn apply(&mut self, name: &str, add: bool) -> Outcome {
        self.check_open()?;
        let preset = self.preset_of(name)?;
        self.commit(|now| with_preset(now, &preset, add))?;
        self.restart_examination();
        self.preset = (!add).then(|| (name.to_owned(), self.committed));
        self.publish_parameters();
        self.warn_of_caps();
        Ok(Value::Null)
    }

    /// Applies the knee of a trial, which nobody sees.
    pub(super) fn apply_unseen(&mut self, name: &str) -> Result<(), String> {
        let preset = self.preset_of(name)?;
        self.commit(|now| with_preset(now, &preset, false))?;
        self.preset = Some((name.to_owned(), self.committed));
        Ok(())
    }

    /// A preset that ships, one of the user's own, or the healthy knee.
    pub(super) fn preset_of(&self, name: &str) -> Result<Preset, String> {
        if name == HEALTHY {
            return Ok(Preset::default());
        }
        if let Some(preset) = preset::find(name) {
            return Ok(preset.clone());
        }
        let mut own = self.program.own_presets().into_iter();
        own.find(|preset| preset.name == name).ok_or_else(|| {
            format!("there is no preset {name:?}: reload the page for the current list")
        })
    }

    /// Applies the next knee on the scale of its disorder.
    pub(super) fn change_severity(&mut self, worse: bool) -> Outcome {
        self.check_open()?;
        let name = self.knee_name();
        let now = name.as_deref().and_then(preset::find);
        let now = now.ok_or("choose a disorder of the list first: this knee has no scale")?;
        let at_its_end = if worse {
            "there is no worse form of this knee"
        } else {
            "there is no milder form of this knee"
        };
        let next = now.neighbour(worse).ok_or(at_its_end)?;
        self.apply(&next.name, false)
    }

    pub(super) fn set(&mut self, changes: &[(u8, f64)]) -> Outcome {
        self.check_open()?;
        let revision = self.client.set(changes);
        let revision = revision.map_err(|error| self.explained(error))?;
        self.reload_parameters();
        self.warn_of_caps();
        Ok(json!({ "revision": revision.0 }))
    }

    /// Tells pages if the effects can ask for more than the device shows.
    fn warn_of_caps(&mut self) {
        let Ok(settings) = DeviceSettings::of(&self.values) else {
            return;
        };
        let joint = settings.crepitus.as_ref().map(|joint| &joint.parameters);
        let warning = caps_warning(&settings.effects, joint, &settings.limits, &settings.range);
        self.message = warning.or(self.message.take());
    }

    pub(super) fn reset(&mut self) -> Outcome {
        self.check_open()?;
        self.commit(|now| {
            let mut values = *now;
            for parameter in PARAMETERS.iter().filter(|p| is_of_knee(p.group)) {
                values.set(parameter.id, parameter.default());
            }
            values
        })?;
        Ok(Value::Null)
    }

    /// Commits other values, based on those of now.
    fn commit(&mut self, change: impl Fn(&Values) -> Values) -> Result<(), String> {
        let commit = |client: &mut Client<T>| {
            let (base, now) = client.parameters()?;
            client.commit(base, &change(&now))
        };
        let committed = commit(&mut self.client).map_err(|error| self.explained(error));
        self.reload_parameters();
        committed.map(|_| ())
    }

    pub(super) fn save_preset(&mut self, what: &SavePreset) -> Outcome {
        self.check_open()?;
        let mut preset = knee(&self.values)
            .map_err(|error| format!("the device's parameters are invalid: {error:?}"))?;
        if preset.effects().next().is_none() {
            return Err(
                "every effect of the knee is off, so there is nothing to save: switch one on first"
                    .to_owned(),
            );
        }
        let some = |text: &str| Some(text.trim().to_owned()).filter(|text| !text.is_empty());
        preset.title = some(&what.title);
        preset.feel = some(&what.feel);
        preset.severity = some(&what.severity);
        preset.source = some(&what.source);
        preset.disorder = match &what.disorder {
            None => None,
            Some(name) => {
                let found = Disorder::ALL.into_iter().find(|d| d.name() == name);
                Some(found.ok_or_else(|| format!("there is no disorder {name:?}"))?)
            }
        };
        let name = match what.name.as_str() {
            "" => self.file_name(&what.title),
            name => name.to_owned(),
        };
        self.program.save_preset(&name, &preset, what.replace)?;
        self.publish_presets();
        self.publish_parameters();
        Ok(json!({ "name": name }))
    }

    /// Name for the file of a preset with this title, which no preset has.
    fn file_name(&self, title: &str) -> String {
        let name = names::plain(title, MOST_NAME);
        let name = if name.is_empty() { "knee" } else { &name };
        let own = self.program.own_presets();
        names::free(name, |name| {
            let is_own = own.iter().any(|preset| preset.name == name);
            is_own || name == HEALTHY || preset::find(name).is_some()
        })
    }

    /// Reads the parameters that are committed.
    pub(super) fn reload_parameters(&mut self) {
        if let Ok((revision, values)) = self.client.parameters() {
            let before = std::mem::replace(&mut self.values, values);
            self.committed = revision;
            self.pain = Pain::of(&values);
            self.publish_parameters();
            self.examine(&before);
        }
    }

    /// The recording that is running gets the parameters of a revision.
    pub(super) fn announce_parameters(&mut self, revision: Revision) {
        if let Some(recorded) = &mut self.recording {
            recorded.announce(revision, &self.values);
        }
    }

    pub(super) fn publish_presets(&mut self) {
        self.own = self.program.own_presets();
        let presets = hello::presets(&self.own);
        self.publish(|latest| &mut latest.presets, &json!({ "presets": presets }));
    }

    pub(super) fn publish_parameters(&mut self) {
        let is_hidden = self.is_hidden();
        if let Some(hand) = &self.hand {
            hand.set_blind(is_hidden);
        }
        let message = if is_hidden {
            json!({ "hidden": true })
        } else {
            let values: Vec<_> = self
                .values
                .iter()
                .map(|(p, value)| json!([p.id, value]))
                .collect();
            json!({
                "revision": self.committed.0,
                "values": values,
                "preset": self.knee_name(),
            })
        };
        self.publish(
            |latest| &mut latest.parameters,
            &json!({ "parameters": message }),
        );
        self.publish_knee();
    }

    /// Tells the teacher's own phone the knee on the device and the one to come, also in a blind trial.
    pub(super) fn publish_knee(&self) {
        let knee_of = |name: &str| match name {
            HEALTHY => Ok(Knee::healthy()),
            name => self.preset_of(name).map(|preset| Knee::from(&preset)),
        };
        // In an experiment whoever runs it is blind, too.
        let is_shown = !self.experiment.is_hidden(self.now_s);
        let now = self.knee_name().filter(|_| is_shown);
        let now = now.and_then(|name| knee_of(&name).ok());
        let coming = self.lesson.as_ref().map(Held::lesson);
        let coming = coming.filter(|lesson| !lesson.ended() && !lesson.began());
        let next = coming.map(Lesson::knee);
        let message = json!({ "knee": { "now": now, "next": next } });
        self.publish(|latest| &mut latest.knee, &message);
    }

    /// Name of the preset whose knee the device has: of the one applied last, or else of the first with these numbers.
    fn knee_name(&self) -> Option<String> {
        let applied = self.preset.as_ref();
        if let Some((name, _)) = applied.filter(|(_, revision)| *revision == self.committed) {
            return Some(name.clone());
        }
        let healthy = Preset {
            name: HEALTHY.to_owned(),
            ..Preset::default()
        };
        let all = once(&healthy).chain(preset::shipped()).chain(&self.own);
        preset_of(&self.values, all).map(|preset| preset.name.clone())
    }

    pub(super) fn check_open(&self) -> Result<(), String> {
        if self.is_hidden() {
            return Err(
                "a blind trial is running: end the lesson or leave the session first".to_owned(),
            );
        }
        Ok(())
    }

    /// Returns whether pages must not see which knee it is.
    pub(super) fn is_hidden(&self) -> bool {
        let held = self.lesson.as_ref();
        held.is_some_and(|held| held.is_hidden(self.now_s)) || self.experiment.is_hidden(self.now_s)
    }
}
