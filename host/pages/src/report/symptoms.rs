//! The symptoms besides crepitus: for each that a run or a recording has, its torque
//! over angle and time, its states and events, and what an examiner would note.
//!
//! A run has a column of torque for each symptom, and reports its events. A recording
//! of a device has the torque of all together and the phase of each: its events are
//! where one phase follows another.

pub(crate) mod limits;
pub(crate) mod loops;
pub(crate) mod movement;
pub(crate) mod occurrences;
pub(crate) mod path;
pub(crate) mod timeline;
pub(crate) mod words;

#[cfg(test)]
pub(crate) mod tests;

use crate::report::channels::{Sample, Setup};
use crepitus_model::render::effects::{EffectSettings, FELT_SHARE};
use crepitus_scene::static_limits;
use crepitus_scene::trace::{Column, SymptomEvent, Word};
use occurrences::Occurrences;
use path::Path;
use timeline::Timeline;
use words::Words;

/// Positions of a symptom's numbers in a row.
#[derive(Clone, Copy, Debug)]
struct Places {
    /// Torque of the symptom alone; without it that of all is read.
    torque: Option<usize>,
    phase: Option<usize>,
}

/// A symptom of a run.
#[derive(Clone, Debug)]
pub(crate) struct Symptom {
    pub(crate) words: Words,
    places: Places,
    pub(crate) path: Path,
    pub(crate) timeline: Timeline,
    pub(crate) found: Occurrences,
    state: Option<u16>,
    last_nm: f64,
}

/// The torque of all symptoms, where each has its own.
#[derive(Clone, Debug)]
pub(crate) struct Together {
    pub(crate) path: Path,
    pub(crate) line: crate::plot::Thinned,
    /// The torque of crepitus is in it.
    pub(crate) has_crepitus: bool,
}

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Symptoms {
    pub(crate) settings: EffectSettings,
    pub(crate) list: Vec<Symptom>,
    pub(crate) together: Option<Together>,
}

impl Symptom {
    fn new(words: Words, places: Places, effects: &EffectSettings) -> Self {
        let clonus = effects.clonus.as_ref();
        let beat_nm = clonus.map_or(0.0, |s| static_limits::clonus::beat_nm(s).abs());
        Self {
            words,
            places,
            path: Path::new(),
            timeline: Timeline::new(),
            found: Occurrences::new(places.torque.is_some(), FELT_SHARE * beat_nm),
            state: None,
            last_nm: 0.0,
        }
    }

    /// Returns whether its torque is that of all symptoms together.
    pub(crate) fn shows_all(&self) -> bool {
        self.places.torque.is_none()
    }

    /// Returns whether other effects are in that torque, too.
    pub(crate) fn shares_torque(&self) -> bool {
        !self.found.beats_are_counted
    }

    fn gap(&mut self) {
        self.path.gap();
        self.timeline.gap();
        self.found.gap();
        self.state = None;
    }

    fn row(&mut self, sample: &Sample, values: &[f64]) {
        let value = |at: Option<usize>| at.and_then(|at| values.get(at)).copied();
        let nm = value(self.places.torque).unwrap_or(sample.torque);
        let phase = value(self.places.phase);
        // A phase that is no number: the device was not armed.
        if !nm.is_finite() || !sample.angle.is_finite() || phase.is_some_and(f64::is_nan) {
            self.gap();
            return;
        }
        if let Some(phase) = phase {
            // A small whole number.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            self.phase(phase.round() as u16, sample, nm);
        } else {
            self.keep_state(sample.time, nm);
        }
        self.path.push(sample.angle, sample.omega, nm);
        self.timeline.push(sample.time, nm);
        self.found.row(sample.time, sample.angle, nm);
        self.last_nm = nm;
    }

    /// A phase by its number; where nothing else reports events, what it begins with.
    fn phase(&mut self, phase: u16, sample: &Sample, nm: f64) {
        let before = self.state.replace(phase);
        self.timeline.state(sample.time, phase);
        if !self.shows_all() {
            return;
        }
        let word = match before {
            Some(before) => self.words.word_between(before, phase),
            None => None,
        };
        let beat = (self.words.effect() == "clonus" && phase == 1)
            .then_some(Word::Beat)
            .filter(|_| self.found.beats_are_counted && self.last_nm == 0.0 && nm != 0.0);
        for word in word.into_iter().chain(beat) {
            self.noted(&SymptomEvent {
                time_s: sample.time,
                effect: self.words.effect(),
                word,
                angle_rad: sample.angle,
                omega_rad_s: sample.omega,
                torque_before_nm: self.last_nm,
                torque_after_nm: nm,
            });
        }
    }

    /// Keeps the state that the events gave, where rows have no phase.
    fn keep_state(&mut self, time_s: f64, nm: f64) {
        // A wall that is left again: the torque falls below its cap at once.
        let yields = self.words.effect() == "range-limit" && self.state == Some(2);
        if yields && nm.abs() < self.last_nm.abs() {
            self.state = Some(1);
        }
        self.timeline.state(time_s, self.state.unwrap_or(0));
    }

    /// An event that a run reports.
    fn event(&mut self, event: &SymptomEvent) {
        // The torques of such an event are of a whole beat: those of the rows show it.
        if matches!(event.word, Word::Weak | Word::Unfelt) {
            return;
        }
        if self.places.phase.is_none()
            && let Some(state) = self.words.state_after(event.word)
        {
            self.state = Some(state);
            self.timeline.state(event.time_s, state);
        }
        for nm in [event.torque_before_nm, event.torque_after_nm] {
            self.path.push(event.angle_rad, event.omega_rad_s, nm);
            self.timeline.push(event.time_s, nm);
        }
        self.noted(event);
    }

    fn noted(&mut self, event: &SymptomEvent) {
        if self.words.name(event.word).is_some() {
            self.timeline.event(event);
            self.found.event(event);
        }
    }
}

impl Symptoms {
    /// Those that have a column; `None` without any.
    pub(crate) fn new(setup: &Setup) -> Option<Self> {
        let at = |name: &str| setup.columns.iter().position(|c: &Column| c.name == name);
        let total = at("torque_nm");
        let mut list = Vec::new();
        for words in Words::all() {
            let spec = words.spec;
            let places = Places {
                torque: at(spec.column),
                phase: spec.phases.and_then(|phases| at(phases.column)),
            };
            let of_all = places.phase.is_some() && total.is_some();
            if places.torque.is_some() || of_all {
                list.push(Symptom::new(words, places, &setup.effects));
            }
        }
        // The torque of all is its own where there is nothing else, crepitus neither.
        if let [symptom] = &mut list[..] {
            symptom.found.beats_are_counted |= at("phase").is_none();
        }
        let own = list.iter().filter(|symptom| !symptom.shows_all()).count();
        let together = (own > 1 || (own == 1 && total.is_some())).then(|| Together {
            path: Path::new(),
            line: crate::plot::Thinned::new(Timeline::LINE),
            has_crepitus: total.is_some(),
        });
        (!list.is_empty()).then_some(Self {
            settings: setup.effects,
            list,
            together,
        })
    }

    /// Rows are missing before the next one.
    pub(crate) fn gap(&mut self) {
        for symptom in &mut self.list {
            symptom.gap();
        }
        if let Some(together) = &mut self.together {
            together.path.gap();
        }
    }

    /// Takes a row, of which the sample is a part.
    pub(crate) fn row(&mut self, sample: &Sample, values: &[f64]) {
        for symptom in &mut self.list {
            symptom.row(sample, values);
        }
        if let Some(together) = &mut self.together {
            let own = self.list.iter().filter_map(|symptom| symptom.places.torque);
            let own_nm: f64 = own.filter_map(|at| values.get(at)).sum();
            let crepitus_nm = if together.has_crepitus {
                sample.torque
            } else {
                0.0
            };
            let nm = own_nm + crepitus_nm;
            together.path.push(sample.angle, sample.omega, nm);
            together.line.push(sample.time, nm);
        }
    }

    /// Takes an event that a run reports.
    pub(crate) fn event(&mut self, event: &SymptomEvent) {
        let mut of = self.list.iter_mut();
        if let Some(symptom) = of.find(|symptom| symptom.words.effect() == event.effect)
            && event.time_s.is_finite()
        {
            symptom.event(event);
        }
    }

    /// The run is over.
    pub(crate) fn finish(mut self) -> Self {
        for symptom in &mut self.list {
            symptom.timeline = std::mem::replace(&mut symptom.timeline, Timeline::new()).finish();
        }
        self
    }
}
