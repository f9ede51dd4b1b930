//! The effects of an armed device, tick by tick.

use crepitus_model::render::effects::symptom::{Change, Word};
use crepitus_model::render::effects::{
    EffectSettings, EffectSpec, Phases, SwitchedEffects, Timing,
};
use crepitus_model::render::input_check::{InputCheck, InputLimits};
use crepitus_model::render::position::{Position, Sensing};
use crepitus_model::render::{Addition, Check, Limit, ShaftEstimate, Shown};
use crepitus_model::{Real, Sample, ShaftStep};

pub(crate) const TICK_S: f64 = 5e-5;
pub(crate) const SLEW_NM: f64 = 100.0 * TICK_S;

/// Settings in which one symptom is on.
macro_rules! on {
    ($symptom:ident: $settings:expr) => {
        crepitus_model::render::effects::EffectSettings {
            $symptom: Some($settings),
            ..Default::default()
        }
    };
}
pub(crate) use on;

pub(crate) fn timing(sensing: Sensing) -> Timing {
    Timing {
        step_s: TICK_S,
        delay_ticks: 2,
        sensing,
    }
}

/// Effects of an armed device.
pub(crate) struct Rig<F: Real> {
    pub(crate) effects: SwitchedEffects<F>,
    pub(crate) check: InputCheck<F>,
    pub(crate) settings: EffectSettings,
    pub(crate) timing: Timing,
    /// Events of the last tick, each with the share of the tick at which it happened.
    pub(crate) words: Vec<(Word, f64)>,
    /// The torque just before and after each, N·m.
    pub(crate) torques_nm: Vec<(f64, f64)>,
    pub(crate) settling: bool,
    phases: Phases,
    /// Jump of the torque in the last tick, N·m.
    pub(crate) jump_nm: f64,
    /// Reason before the symptoms of the next tick, and after those of the last one.
    pub(crate) limit: Limit,
    /// Share that the tank held back in the last tick.
    pub(crate) held_back: f64,
}

impl<F: Real> Rig<F> {
    pub(crate) fn new(settings: EffectSettings, sensing: Sensing, from_rad: f64) -> Self {
        let timing = timing(sensing);
        let mut rig = Self {
            effects: SwitchedEffects::new(F::from_f64(SLEW_NM), &timing),
            check: InputCheck::new(&InputLimits::device(TICK_S), F::from_f64(TICK_S), F::ZERO),
            settings: EffectSettings::default(),
            timing,
            words: Vec::new(),
            torques_nm: Vec::new(),
            settling: false,
            phases: Phases::default(),
            jump_nm: 0.0,
            limit: Limit::None,
            held_back: 0.0,
        };
        rig.commit(settings);
        rig.effects.rest(&sensing.position(from_rad));
        rig
    }

    pub(crate) fn commit(&mut self, settings: EffectSettings) {
        let now = (&self.settings, &self.timing);
        let changes = settings.changes(&self.timing, now).unwrap();
        self.effects.change(&changes, F::from_f64(SLEW_NM));
        self.settings = settings;
    }

    pub(crate) fn tick(&mut self, sample: Sample<F>, place: Position<F>) -> f64 {
        let input = self.check.check(&sample);
        let seen = ShaftEstimate {
            sample,
            omega_rad_s: F::ZERO,
            place,
            is_driven: true,
        };
        let mut shown = Shown {
            limit: self.limit,
            ..Shown::nothing()
        };
        self.words.clear();
        self.torques_nm.clear();
        let (words, torques_nm) = (&mut self.words, &mut self.torques_nm);
        self.effects.tick(
            &seen,
            &input,
            &mut shown,
            &mut |_: &'static EffectSpec, change: Change<F>| {
                words.push((change.word, change.fraction.to_f64()));
                torques_nm.push((change.before_nm.to_f64(), change.after_nm.to_f64()));
            },
        );
        self.settling = shown.settling;
        self.phases = shown.phases;
        self.jump_nm = shown.jump_nm.to_f64();
        self.limit = shown.limit;
        self.held_back = shown.held_back.to_f64();
        shown.torque_nm.to_f64()
    }

    /// The phase of the only symptom, unless it is at rest.
    pub(crate) fn phase(&self) -> Option<&'static str> {
        self.phases.named().next().map(|(_, name)| name)
    }

    /// A tick over which the velocity changes linearly.
    pub(crate) fn step(&mut self, from: (f64, f64), to: (f64, f64), travel_rad: f64) -> f64 {
        let shaft = ShaftStep {
            delta_phi_rad: F::from_f64(travel_rad),
            omega_start_rad_s: F::from_f64(from.1),
            omega_end_rad_s: F::from_f64(to.1),
        };
        self.tick(Sample::Taken(shaft), self.timing.sensing.position(to.0))
    }

    /// Along a motion from 0 s on: (s, rad, N·m) at the ticks, and words with their times.
    pub(crate) fn run(&mut self, end_s: f64, motion: impl Fn(f64) -> (f64, f64)) -> Run {
        let mut run = Run::default();
        for n in 0..(end_s / TICK_S).round() as u32 {
            let from_s = f64::from(n) * TICK_S;
            let (from, to) = (motion(from_s), motion(from_s + TICK_S));
            let nm = self.step(from, to, to.0 - from.0);
            run.rows.push((from_s + TICK_S, to.0, nm));
            if run.phases.last() != Some(&self.phase()) {
                run.phases.push(self.phase());
            }
            let times = self
                .words
                .iter()
                .map(|(word, f)| (*word, from_s + f * TICK_S));
            run.words.extend(times);
        }
        run
    }
}

#[derive(Default)]
pub(crate) struct Run {
    pub(crate) rows: Vec<(f64, f64, f64)>,
    pub(crate) words: Vec<(Word, f64)>,
    /// One after the other.
    pub(crate) phases: Vec<Option<&'static str>>,
}

impl Run {
    pub(crate) fn times(&self, word: Word) -> Vec<f64> {
        let of = self.words.iter().filter(|(w, _)| *w == word);
        of.map(|(_, time_s)| *time_s).collect()
    }

    pub(crate) fn at(&self, time_s: f64) -> f64 {
        self.rows[(time_s / TICK_S).round() as usize - 1].2
    }
}

/// Constant speed from this angle on, deg and deg/s.
pub(crate) fn ramp(from_deg: f64, deg_s: f64) -> impl Fn(f64) -> (f64, f64) {
    let omega = deg_s.to_radians();
    move |t| (from_deg.to_radians() + omega * t, omega)
}

pub(crate) fn only<F: Real>(settings: EffectSettings, from_deg: f64) -> Rig<F> {
    Rig::new(settings, Sensing::IDEAL, from_deg.to_radians())
}

pub(crate) fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} for {expected}");
}
