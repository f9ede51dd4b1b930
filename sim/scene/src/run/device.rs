//! The device of a coupled run: sensor and pipeline, one tick at a time, behind
//! one call, so that the loop around them is the same for all.

use super::accounting::StepAccounting;
use super::any_device::{Device, Span};
use super::command::{Command, Stage};
use super::held_back::TankTotals;
use super::reached::Reached;
use super::recorder::{Happened, Heard, Recorder};
use super::sensor::{Encoded, Ideal, Sensor};
use super::stages::{self, BareStages, HasJoint, Rendering, Retiming};
use super::tally::Tally;
use super::watching::Watching;
use crate::any_joint::{AnyJoint, Precise};
use crate::scene::Scene;
use crate::trace::{Column, ColumnKind};
use crate::walk::{Cut, Walk};
use crepitus_model::joint::shaft::Linear;
use crepitus_model::render::input_check::{Checked, Sample};
use crepitus_model::render::position::Travel;
use crepitus_model::render::{Bare, ShaftEstimate, Shown};
use crepitus_model::solver::locate::Locate;
use crepitus_model::solver::{LocatorVisitor, Solver, with_frozen_locator};
use crepitus_model::{Real, Settings, SettingsError, ShaftStep, StickSlip, Validated};
use crepitus_plant::Motion;
use crepitus_plant::boundary::MotionStep;
use crepitus_plant::chain::Body;
use crepitus_plant::mechanics::Driven;

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

fn with_sensor<F: Precise, S: Sensor<F>>(
    scene: &Scene,
    solver: Solver,
    step_s: f64,
    shaft: &Body,
    sensor: S,
) -> Result<Box<dyn Device>, SettingsError> {
    let Some(crepitus) = &scene.crepitus else {
        let device: Box<dyn Device> = if scene.is_device {
            let stages = stages::drive(scene, step_s, ())?;
            Box::new(watching::<F, _, _>(scene, shaft, sensor, stages))
        } else {
            let stages = stages::bare(scene, step_s, ())?;
            Box::new(watching::<F, _, _>(scene, shaft, sensor, stages))
        };
        return Ok(device);
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
        return Ok(Box::new(maker.joined(stages)));
    }
    with_frozen_locator::<F, _>(solver, maker)
}

/// A bare solver on a shaft that it sees as it is.
pub(super) type BareJoint<F> = Joined<F, BareStages<F, Bare<AnyJoint<F>>>, Ideal>;

/// The device of a scene that has a joint alone, without a sensor; `None` if it is another one.
pub(super) fn bare_joint<F: Precise>(
    scene: &Scene,
    solver: Solver,
    step_s: f64,
    shaft: &Body,
) -> Result<Option<BareJoint<F>>, SettingsError> {
    let Some(crepitus) = &scene.crepitus else {
        return Ok(None);
    };
    if scene.is_device || scene.encoder.is_some() {
        return Ok(None);
    }
    let omega = F::from_f64(shaft.omega_rad_s);
    let joint = AnyJoint::new(&crepitus.settings, solver, step_s, omega)?;
    let stages = stages::bare(scene, step_s, Bare(joint))?;
    let maker = Maker {
        scene,
        settings: crepitus.settings,
        step_s,
        shaft: *shaft,
        sensor: Ideal,
    };
    Ok(Some(maker.joined(stages)))
}

/// Symptoms without a joint, on a shaft that they see as it is.
pub(super) type BareSymptoms<F> = Watching<F, BareStages<F, ()>, Ideal>;

/// The device of a scene that has symptoms alone, without a joint or a sensor; `None` if it is
/// another one.
pub(super) fn bare_symptoms<F: Real>(
    scene: &Scene,
    step_s: f64,
    shaft: &Body,
) -> Result<Option<BareSymptoms<F>>, SettingsError> {
    if scene.is_device || scene.encoder.is_some() || scene.crepitus.is_some() {
        return Ok(None);
    }
    let stages = stages::bare(scene, step_s, ())?;
    Ok(Some(watching(scene, shaft, Ideal, stages)))
}

/// Symptoms that look at what they see as it begins.
fn watching<F: Real, P: Rendering<F>, S: Sensor<F>>(
    scene: &Scene,
    shaft: &Body,
    sensor: S,
    mut stages: P,
) -> Watching<F, P, S> {
    let shown = first(scene, &mut stages, F::ZERO, (shaft, &sensor));
    Watching::new(scene, sensor, stages, shown)
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
impl<F: Real, S: Sensor<F>> LocatorVisitor<F> for Maker<'_, S> {
    type Output = Result<Box<dyn Device>, SettingsError>;

    fn visit<L: Locate<F, Shape = Linear>>(self) -> Self::Output {
        let joint = stages::crepitus::<F, L>(self.scene, &self.settings, self.step_s)?;
        let stages = stages::drive(self.scene, self.step_s, joint)?;
        Ok(Box::new(self.joined(stages)))
    }
}

impl<S: 'static> Maker<'_, S> {
    fn joined<F: Real, P: HasJoint<F>>(self, mut stages: P) -> Joined<F, P, S>
    where
        S: Sensor<F>,
    {
        let mut accounting =
            StepAccounting::new::<F>(&self.settings, self.step_s, self.shaft.omega_rad_s);
        let torque_nm = stages.joint().torque_nm();
        accounting.tally.shown(torque_nm.to_f64());
        let start = (&self.shaft, &self.sensor);
        let shown = first::<F>(self.scene, &mut stages, torque_nm, start);
        Joined {
            stages,
            sensor: self.sensor,
            recorder: Recorder::new(self.scene),
            retiming: Retiming::new(self.scene, self.step_s),
            accounting,
            heard: Heard::new(),
            shown,
        }
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
#[derive(Clone)]
pub(super) struct Joined<F, P, S> {
    stages: P,
    sensor: S,
    recorder: Recorder,
    retiming: Retiming,
    accounting: StepAccounting,
    heard: Heard<F>,
    shown: Shown<F>,
}

/// Puts on record what was heard in a tick, or in a part of one.
#[cold]
fn report<F: Real>(
    (accounting, recorder): (&mut StepAccounting, &mut Recorder),
    heard: &mut Heard<F>,
    (start_s, seen): (f64, &ShaftStep<F>),
    shaft: (&Body, &Body),
    events: &mut Vec<Happened>,
) {
    for event in heard.events.drain(..) {
        let event = accounting.event(start_s, seen, &event);
        events.push(Happened::Joint(event));
    }
    recorder.note_all((start_s, shaft), heard, events);
}

impl<F: Real, P: HasJoint<F>, S: Sensor<F>> Device for Joined<F, P, S> {
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

    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "a call of the loop, whose arguments and results would pass through memory"
    )]
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
            let records = (&mut self.accounting, &mut self.recorder);
            report(
                records,
                &mut self.heard,
                (start_s, &seen),
                (from, to),
                events,
            );
        }
        let joint = self.stages.joint();
        if !P::REFUSES {
            self.accounting.end_step(&seen, joint);
        } else if let Some(held_nm) = self.stages.held_nm() {
            let held_nm = held_nm.to_f64();
            self.accounting.hold(&seen, start_s, joint, held_nm);
        } else {
            let restarts = self.stages.restarts();
            self.accounting.end_tick(&seen, start_s, joint, restarts);
        }
        let turned_rad = to.angle_rad - from.angle_rad;
        Command::of(&self.shown, self.stages.asked_nm(), turned_rad, stages)
    }

    #[inline(never)]
    fn go_ahead<M: Driven>(
        &mut self,
        plant: &mut M,
        walk: &mut Walk<&Motion>,
        at: &mut Reached,
        until: u64,
        stages: &mut [Stage],
        events: &mut Vec<Happened>,
    ) {
        let Some((joint, effects)) = self.stages.in_turn() else {
            return;
        };
        if !(M::IS_RIGID && stages.is_sorted_by_key(|stage| stage.place)) {
            return;
        }
        let scale = effects.scale;
        let mut torque_nm = None;
        while at.n < until {
            let Some((from, to)) = walk.step_within() else {
                break;
            };
            at.note_speed(from.omega_rad_s);
            at.n += 1;
            plant.command(at.command.torque_nm, 0.0);
            let felt_before = plant.felt_nms();
            plant.advance(&MotionStep {
                length_s: at.tick_s,
                from,
                to,
            });
            let turned_rad = to.angle_rad - from.angle_rad;
            at.note_motion(plant.felt_nms() - felt_before, turned_rad);
            let seen = self.sensor.see(&from, &to);
            joint.step(&seen, |event| self.heard.events.push(event));
            let mut all_nm = joint.torque_nm();
            let mut symptoms_nm = 0.0;
            if !stages.is_empty() {
                let place = self.sensor.place(&to);
                let travel = Travel::plausible(&Checked::Step(seen), &place, &scale);
                for stage in &mut *stages {
                    let added = &mut self.shown.added;
                    let nm = effects.follow(stage.place, travel.as_ref(), added, &mut self.heard);
                    all_nm += nm;
                    symptoms_nm += nm.to_f64();
                    stage.goes_on(nm.to_f64(), turned_rad);
                }
            }
            torque_nm = Some(all_nm);
            at.command.goes_on(all_nm.to_f64(), symptoms_nm);
            let is_quiet = self.heard.is_empty() || {
                let records = (&mut self.accounting, &mut self.recorder);
                let start = (at.time_s, &seen);
                report(records, &mut self.heard, start, (&from, &to), events);
                events.is_empty()
            };
            self.accounting.end_step(&seen, &*joint);
            if !is_quiet {
                break;
            }
            at.end_tick(walk.time_s());
        }
        if let Some(torque_nm) = torque_nm {
            at.shaft = plant.shaft();
            self.shown = Shown {
                torque_nm,
                model_torque_nm: torque_nm,
                added: self.shown.added,
                phases: effects.phases(),
                phase: joint.phase(),
                ..Shown::nothing()
            };
        }
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
            self.accounting.step_s = part.length_s;
            self.retiming.ticks_of(part.length_s);
            let is_last = left == 0;
            self.shown = self.stages.tick_part(
                &ShaftEstimate::taken(&seen, self.sensor.place(to)),
                (&self.retiming, is_last, jump_nm),
                &mut self.heard,
            );
            let records = (&mut self.accounting, &mut self.recorder);
            let start = (part.start_s, &seen);
            report(records, &mut self.heard, start, (from, to), events);
            jump_nm = self.shown.jump_nm;
            if is_last {
                self.accounting.end_step(&seen, self.stages.joint());
            } else {
                let joint = self.stages.joint();
                let stick = || (joint.torque_nm(), joint.theta_rad());
                self.accounting.end_part(&seen, joint.phase(), stick);
            }
        }
        self.accounting.step_s = tick.length_s;
        self.recorder.step_s = tick.length_s;
        self.retiming.ticks_of(tick.length_s);
        self.stages.retime(&self.retiming);
        let turned_rad = tick.to.angle_rad - tick.from.angle_rad;
        Command::of(&self.shown, self.stages.asked_nm(), turned_rad, stages)
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
