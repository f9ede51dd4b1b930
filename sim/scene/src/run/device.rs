//! The device of a coupled run: sensor and pipeline, one tick at a time, behind
//! one call, so that the loop around them is the same for all.

use super::held_back::{TankAccounting, TankTotals};
use super::sensor::{Encoded, Ideal, Sensor};
use super::stages::{self, HasJoint, Notice, Rendering, Retiming};
use super::stepping::StepAccounting;
use super::tally::Tally;
use crate::any_joint::{AnyJoint, Precise};
use crate::scene::Scene;
use crate::trace::{Column, ColumnKind, EventRecord, SymptomEvent};
use crate::walk::Cut;
use crepitus_model::joint::shaft::Linear;
use crepitus_model::render::effects::EffectSpec;
use crepitus_model::render::input_check::Sample;
use crepitus_model::render::{Bare, ShaftEstimate, Shown};
use crepitus_model::solver::locate::Locate;
use crepitus_model::solver::{LocatorVisitor, Solver, with_frozen_locator};
use crepitus_model::{Real, Settings, SettingsError, StickSlip, Validated};
use crepitus_plant::chain::Body;
use std::cell::RefCell;

/// Output of a scene's device: the commanded torque, and the
/// number of the [limit](crepitus_model::render::Limit) that held it back.
pub(super) const COLUMNS: [Column; 2] = [
    Column {
        name: "shown_nm",
        kind: ColumnKind::Number,
    },
    Column {
        name: "limit",
        kind: ColumnKind::Whole,
    },
];

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

/// Puts the events of symptoms on record, and what the tank pays of them.
struct Recorder {
    step_s: f64,
    play_events: bool,
    tank: TankAccounting,
}

impl Recorder {
    fn new(scene: &Scene) -> Self {
        Self {
            step_s: scene.step_s(),
            play_events: scene.play_events,
            tank: TankAccounting::default(),
        }
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
}

/// A tick, or a part of one, and what the shaft does in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) start_s: f64,
    pub(super) length_s: f64,
    pub(super) from: Body,
    pub(super) to: Body,
}

impl Span {
    /// Parts of the span, between breaks of the motion; one at its start only tells what it starts
    /// with.
    fn parts(&self, cuts: &[Cut]) -> Vec<Self> {
        let mut parts = Vec::with_capacity(cuts.len() + 1);
        let mut rest = *self;
        for cut in cuts {
            let length_s = cut.time_s - rest.start_s;
            if length_s > 0.0 {
                parts.push(Self {
                    length_s,
                    to: cut.before,
                    ..rest
                });
            }
            rest.start_s = cut.time_s;
            rest.length_s -= length_s;
            rest.from = cut.after;
        }
        parts.push(rest);
        parts
    }
}

/// The device's renderer, on the shaft as measured.
pub(super) trait Device {
    /// Output from now to the end of the next tick.
    fn shown(&self) -> Shown<f64>;

    /// One tick, which began at `start_s` and in which the shaft moved so. What
    /// happens is added to `events`, of each effect in the order of time.
    fn tick(&mut self, start_s: f64, from: &Body, to: &Body, events: &mut Vec<Happened>);

    /// One tick of a bare solver, in the parts that the motion breaks it into.
    fn tick_in_parts(&mut self, tick: &Span, cuts: &[Cut], events: &mut Vec<Happened>);

    /// Writes its columns.
    fn write(&self, row: &mut Vec<f64>);

    /// Torque before the limits of a device, N·m; without one that which is shown.
    fn asked_nm(&self) -> f64;

    /// Account of what the tank held back so far.
    fn tank(&self) -> TankTotals;

    /// Returns whether its state is still numbers.
    fn is_finite(&self) -> bool;

    /// Completes the energy balance of the object, if there is one, and returns in how many
    /// steps it had as many events as a step may have.
    fn finish(self: Box<Self>, time_s: f64) -> Option<(Tally, u64)>;
}

/// The device that a scene calls for, on a shaft that begins like this.
pub(super) fn device<F: Precise>(
    scene: &Scene,
    solver: Solver,
    step_s: f64,
    shaft: &Body,
) -> Result<Box<dyn Device>, SettingsError> {
    let Some(encoder) = &scene.encoder else {
        return with_sensor::<F, _>(scene, solver, step_s, shaft, Ideal);
    };
    // A drive starts as on a shaft at rest, whatever its motion.
    let moving = !scene.is_device;
    let seen = Body {
        omega_rad_s: if moving { shaft.omega_rad_s } else { 0.0 },
        ..*shaft
    };
    let sensor = Encoded::<F>::new(encoder, step_s, &seen)?;
    with_sensor::<F, _>(scene, solver, step_s, shaft, sensor)
}

fn with_sensor<F: Precise, S: Sensor<F> + 'static>(
    scene: &Scene,
    solver: Solver,
    step_s: f64,
    shaft: &Body,
    sensor: S,
) -> Result<Box<dyn Device>, SettingsError> {
    let Some(crepitus) = &scene.crepitus else {
        return if scene.is_device {
            Ok(watching(
                scene,
                shaft,
                sensor,
                stages::drive(scene, step_s, ())?,
            ))
        } else {
            Ok(watching(
                scene,
                shaft,
                sensor,
                stages::bare(scene, step_s, ())?,
            ))
        };
    };
    let maker = Maker {
        scene,
        settings: crepitus.settings,
        step_s,
        shaft: *shaft,
        sensor,
    };
    if !scene.is_device {
        let omega = F::from_f64(shaft.omega_rad_s);
        let joint = AnyJoint::new(&crepitus.settings, solver, step_s, omega)?;
        let stages = stages::bare(scene, step_s, Bare(joint))?;
        return Ok(maker.joined(stages));
    }
    with_frozen_locator::<F, _>(solver, maker)
}

/// A device that only looks.
fn watching<F: Real, P: Rendering<F> + 'static, S: Sensor<F> + 'static>(
    scene: &Scene,
    shaft: &Body,
    sensor: S,
    mut stages: P,
) -> Box<dyn Device> {
    let shown = first(scene, &mut stages, F::ZERO, (shaft, &sensor));
    Box::new(Watching {
        stages,
        sensor,
        recorder: Recorder::new(scene),
        retiming: Retiming::new(scene, scene.step_s()),
        shown,
    })
}

/// Boxes whatever joint the scene calls for.
struct Maker<'a, S> {
    scene: &'a Scene,
    settings: Validated<Settings>,
    step_s: f64,
    shaft: Body,
    sensor: S,
}

/// Boxes a device with the joint that the drive renders.
impl<F: Real, S: Sensor<F> + 'static> LocatorVisitor<F> for Maker<'_, S> {
    type Output = Result<Box<dyn Device>, SettingsError>;

    fn visit<L: Locate<F, Shape = Linear>>(self) -> Self::Output {
        let joint = stages::crepitus::<F, L>(self.scene, &self.settings, self.step_s)?;
        let stages = stages::drive(self.scene, self.step_s, joint)?;
        Ok(self.joined(stages))
    }
}

impl<S: 'static> Maker<'_, S> {
    fn joined<F: Real, P: HasJoint<F> + 'static>(self, mut stages: P) -> Box<dyn Device>
    where
        S: Sensor<F>,
    {
        let mut accounting =
            StepAccounting::new::<F>(&self.settings, self.step_s, self.shaft.omega_rad_s);
        let torque_nm = stages.joint().torque_nm();
        accounting.tally.shown(torque_nm.to_f64());
        let start = (&self.shaft, &self.sensor);
        let shown = first::<F>(self.scene, &mut stages, torque_nm, start);
        Box::new(Joined {
            stages,
            sensor: self.sensor,
            recorder: Recorder::new(self.scene),
            retiming: Retiming::new(self.scene, self.step_s),
            accounting,
            shown,
        })
    }
}

/// Output before the first tick: of a bare solver, what its stages make
/// of the shaft as it begins; of a drive, which was there before, nothing.
fn first<F: Real>(
    scene: &Scene,
    stages: &mut impl Rendering<F>,
    torque_nm: F,
    (shaft, sensor): (&Body, &impl Sensor<F>),
) -> Shown<F> {
    let place = sensor.place(shaft);
    stages.rest(&place);
    let shown = Shown {
        torque_nm,
        model_torque_nm: torque_nm,
        ..Shown::nothing()
    };
    if scene.is_device {
        return shown;
    }
    let seen = ShaftEstimate {
        sample: Sample::Lost,
        omega_rad_s: F::from_f64(shaft.omega_rad_s),
        place,
        is_driven: true,
    };
    stages.begin(&seen, shown)
}

/// A device with a joint.
struct Joined<F, P, S> {
    stages: P,
    sensor: S,
    recorder: Recorder,
    retiming: Retiming,
    accounting: StepAccounting,
    shown: Shown<F>,
}

impl<F: Real, P: HasJoint<F>, S: Sensor<F>> Device for Joined<F, P, S> {
    fn shown(&self) -> Shown<f64> {
        self.shown.to_f64()
    }

    fn asked_nm(&self) -> f64 {
        let asked_nm = self.stages.asked_nm();
        asked_nm.unwrap_or(self.shown.torque_nm).to_f64()
    }

    fn tank(&self) -> TankTotals {
        self.recorder.tank.totals()
    }

    fn tick(&mut self, start_s: f64, from: &Body, to: &Body, events: &mut Vec<Happened>) {
        let seen = self.sensor.see(from, to);
        let (accounting, recorder) = (&mut self.accounting, &mut self.recorder);
        let events = RefCell::new(events);
        self.shown = self.stages.tick(
            &ShaftEstimate::taken(&seen, self.sensor.place(to)),
            &mut |event| {
                let event = accounting.event(start_s, &seen, &event);
                events.borrow_mut().push(Happened::Joint(event));
            },
            &mut |effect, notice| {
                let events = &mut events.borrow_mut();
                recorder.note((start_s, from, to), effect, &notice, events);
            },
        );
        let joint = self.stages.joint();
        if let Some(held_nm) = self.stages.held_nm() {
            let held_nm = held_nm.to_f64();
            self.accounting.hold(&seen, start_s, joint, held_nm);
        } else {
            let restarts = self.stages.restarts();
            self.accounting.end_tick(&seen, start_s, joint, restarts);
        }
    }

    fn tick_in_parts(&mut self, tick: &Span, cuts: &[Cut], events: &mut Vec<Happened>) {
        let parts = tick.parts(cuts);
        let (accounting, events) = (&mut self.accounting, RefCell::new(events));
        let recorder = &mut self.recorder;
        let mut jump_nm = F::ZERO;
        for (left, part) in (0..parts.len()).rev().zip(&parts) {
            let Span { from, to, .. } = part;
            let seen = self.sensor.see(from, to);
            recorder.step_s = part.length_s;
            accounting.step_s = part.length_s;
            self.retiming.ticks_of(part.length_s);
            let is_last = left == 0;
            self.shown = self.stages.tick_part(
                &ShaftEstimate::taken(&seen, self.sensor.place(to)),
                (&self.retiming, is_last, jump_nm),
                &mut |event| {
                    let event = accounting.event(part.start_s, &seen, &event);
                    events.borrow_mut().push(Happened::Joint(event));
                },
                &mut |effect, notice| {
                    let events = &mut events.borrow_mut();
                    recorder.note((part.start_s, from, to), effect, &notice, events);
                },
            );
            jump_nm = self.shown.jump_nm;
            if is_last {
                accounting.end_step(&seen, self.stages.joint());
            } else {
                accounting.end_part(&seen, self.stages.joint());
            }
        }
        accounting.step_s = tick.length_s;
        recorder.step_s = tick.length_s;
        self.retiming.ticks_of(tick.length_s);
        self.stages.retime(&self.retiming);
    }

    fn write(&self, row: &mut Vec<f64>) {
        let joint = self.stages.joint();
        row.extend([
            f64::from(joint.phase().sign()),
            joint.theta_rad().to_f64(),
            joint.theta_dot_rad_s().to_f64(),
            joint.torque_nm().to_f64(),
        ]);
        self.sensor.write(row);
    }

    fn is_finite(&self) -> bool {
        let joint = self.stages.joint();
        joint.theta_rad().is_finite() && joint.theta_dot_rad_s().is_finite()
    }

    fn finish(mut self: Box<Self>, time_s: f64) -> Option<(Tally, u64)> {
        self.accounting.finish(time_s, self.stages.joint());
        let crowded = self.accounting.crowded_steps;
        Some((self.accounting.tally, crowded))
    }
}

/// A device that only looks.
struct Watching<F, P, S> {
    stages: P,
    sensor: S,
    recorder: Recorder,
    retiming: Retiming,
    shown: Shown<F>,
}

impl<F: Real, P: Rendering<F>, S: Sensor<F>> Device for Watching<F, P, S> {
    fn shown(&self) -> Shown<f64> {
        self.shown.to_f64()
    }

    fn asked_nm(&self) -> f64 {
        let asked_nm = self.stages.asked_nm();
        asked_nm.unwrap_or(self.shown.torque_nm).to_f64()
    }

    fn tank(&self) -> TankTotals {
        self.recorder.tank.totals()
    }

    fn tick(&mut self, start_s: f64, from: &Body, to: &Body, events: &mut Vec<Happened>) {
        let seen = self.sensor.see(from, to);
        let recorder = &mut self.recorder;
        self.shown = self.stages.tick(
            &ShaftEstimate::taken(&seen, self.sensor.place(to)),
            &mut |_| {},
            &mut |effect, notice| recorder.note((start_s, from, to), effect, &notice, events),
        );
    }

    fn tick_in_parts(&mut self, tick: &Span, cuts: &[Cut], events: &mut Vec<Happened>) {
        let parts = tick.parts(cuts);
        let recorder = &mut self.recorder;
        let mut jump_nm = F::ZERO;
        for (left, part) in (0..parts.len()).rev().zip(&parts) {
            let Span { from, to, .. } = part;
            let seen = self.sensor.see(from, to);
            recorder.step_s = part.length_s;
            self.retiming.ticks_of(part.length_s);
            self.shown = self.stages.tick_part(
                &ShaftEstimate::taken(&seen, self.sensor.place(to)),
                (&self.retiming, left == 0, jump_nm),
                &mut |_| {},
                &mut |effect, notice| {
                    recorder.note((part.start_s, from, to), effect, &notice, events);
                },
            );
            jump_nm = self.shown.jump_nm;
        }
        recorder.step_s = tick.length_s;
        self.retiming.ticks_of(tick.length_s);
        self.stages.retime(&self.retiming);
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
