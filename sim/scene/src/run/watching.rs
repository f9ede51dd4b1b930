//! A device without a joint: it only looks, and its symptoms and other effects act.

use super::any_device::{Device, Span};
use super::command::{Command, Stage};
use super::held_back::TankTotals;
use super::recorder::{Happened, Heard, Recorder};
use super::sensor::Sensor;
use super::stages::{Rendering, Retiming};
use super::tally::Tally;
use crate::scene::Scene;
use crate::walk::Cut;
use crepitus_model::Real;
use crepitus_model::render::{ShaftEstimate, Shown};
use crepitus_plant::chain::Body;

/// A device that only looks.
#[derive(Clone)]
pub(super) struct Watching<F, P, S> {
    stages: P,
    sensor: S,
    recorder: Recorder,
    retiming: Retiming,
    heard: Heard<F>,
    shown: Shown<F>,
}

impl<F: Real, P: Rendering<F>, S: Sensor<F>> Watching<F, P, S> {
    /// A device with these stages, which begins with this output.
    pub(super) fn new(scene: &Scene, sensor: S, stages: P, shown: Shown<F>) -> Self {
        Self {
            stages,
            sensor,
            recorder: Recorder::new(scene),
            retiming: Retiming::new(scene, scene.step_s()),
            heard: Heard::new(),
            shown,
        }
    }
}

impl<F: Real, P: Rendering<F>, S: Sensor<F>> Device for Watching<F, P, S> {
    fn boxed(&self) -> Box<dyn Device> {
        Box::new(self.clone())
    }

    fn shown(&self) -> Shown<f64> {
        self.shown.to_f64()
    }

    fn command(&self, stages: &mut [Stage]) -> Command {
        Command::of(&self.shown, self.stages.asked_nm(), 0.0, stages)
    }

    fn tank(&self) -> TankTotals {
        self.recorder.tank()
    }

    fn tick(
        &mut self,
        start_s: f64,
        (from, to): (&Body, &Body),
        stages: &mut [Stage],
        events: &mut Vec<Happened>,
    ) -> Command {
        let seen = self.sensor.see(from, to);
        self.stages.tick(
            &ShaftEstimate::taken(&seen, self.sensor.place(to)),
            &mut self.shown,
            &mut self.heard,
        );
        if !self.heard.is_empty() {
            self.recorder
                .note_all((start_s, (from, to)), &mut self.heard, events);
        }
        let turned_rad = to.angle_rad - from.angle_rad;
        Command::of(&self.shown, self.stages.asked_nm(), turned_rad, stages)
    }

    #[cold]
    fn tick_in_parts(
        &mut self,
        tick: &Span,
        cuts: &[Cut],
        stages: &mut [Stage],
        events: &mut Vec<Happened>,
    ) -> Command {
        let parts = tick.parts(cuts);
        let mut jump_nm = F::ZERO;
        for (left, part) in (0..parts.len()).rev().zip(&parts) {
            let Span { from, to, .. } = part;
            let seen = self.sensor.see(from, to);
            self.recorder.step_s = part.length_s;
            self.retiming.ticks_of(part.length_s);
            self.shown = self.stages.tick_part(
                &ShaftEstimate::taken(&seen, self.sensor.place(to)),
                (&self.retiming, left == 0, jump_nm),
                &mut self.heard,
            );
            self.recorder
                .note_all((part.start_s, (from, to)), &mut self.heard, events);
            jump_nm = self.shown.jump_nm;
        }
        self.recorder.step_s = tick.length_s;
        self.retiming.ticks_of(tick.length_s);
        self.stages.retime(&self.retiming);
        let turned_rad = tick.to.angle_rad - tick.from.angle_rad;
        Command::of(&self.shown, self.stages.asked_nm(), turned_rad, stages)
    }

    fn write(&self, row: &mut Vec<f64>) {
        self.sensor.write(row);
    }

    fn is_finite(&self) -> bool {
        true
    }

    fn finish(self: Box<Self>, _: f64) -> Option<(Tally, u64)> {
        None
    }
}
