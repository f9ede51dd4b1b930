//! A run with a plant: device → actuator → chain → boundary, tick by tick. The
//! shaft does what comes of it.

use super::any_device::{Device, Span};
use super::command::{Command, Stage};
use super::device::{bare_joint, bare_symptoms, device};
use super::held_back::Beyond;
use super::reached::Reached;
use super::recorder::Happened;
use super::stepping::{CHECK_STEPS, PROGRESS_STEPS, next_stop};
use super::tally::TorqueTally;
use super::watch::{Ended, Stopped, Watch};
use super::{Diverged, RunError, Totals, steps};
use crate::any_joint::Precise;
use crate::scene::Scene;
use crate::walk::{Cut, Walk};
use crepitus_model::solver::Solver;
use crepitus_plant::Motion;
use crepitus_plant::actuator::Ideal;
use crepitus_plant::assembly::PlantVisitor;
use crepitus_plant::boundary::MotionStep;
use crepitus_plant::chain::{Body, Impacts};
use crepitus_plant::energy_balance::EnergyBalance;
use crepitus_plant::mechanics::{Driven, Mechanics};
use crepitus_plant::rigid_shaft::RigidShaft;
use std::borrow::Borrow;
use std::marker::PhantomData;

/// The totals of a plant.
pub(super) struct PlantTotals {
    /// The balance of its mechanics and its motor.
    pub(super) balance: EnergyBalance,
    /// Sources of the work of the rendered torque.
    pub(super) rendering: Rendering,
    /// Torque at the hand, mean of each tick, without impacts; `None` for a released leg.
    pub(super) felt: Option<TorqueTally>,
    /// The impacts, if a part of the plant can have any.
    pub(super) impacts: Option<Impacts>,
    /// The largest impulse of impacts that the hand felt in a tick, N·m·s.
    pub(super) struck_nms: f64,
    pub(super) warnings: Vec<String>,
}

/// The work that the actuator takes out of the mechanics, and its parts, J.
pub(super) struct Rendering {
    /// Work of the model's torque, held over each tick.
    pub(super) held: f64,
    /// Work of the torque that each stage adds.
    pub(super) stages: Vec<(&'static str, f64)>,
    /// Work of the torque that guards and limits of a device take away; none without one.
    pub(super) limits: Option<f64>,
    /// Work of the torque that there was.
    pub(super) absorbed: f64,
}

/// The name of the column of what the hand feels: a scene with a plant has it
/// unless nobody holds the leg.
pub const FELT_COLUMN: &str = "hand_torque_nm";

/// The name of the column of the impulse that the hand gets from impacts in a
/// tick, which [`FELT_COLUMN`] leaves out: a plant that can have impacts has it.
pub const STRUCK_COLUMN: &str = "hand_impact_nms";

/// Runs a scene with a plant.
pub(super) fn simulate<F: Precise>(
    scene: &Scene,
    solver: Solver,
    watch: &mut dyn Watch,
) -> Result<Totals, Ended> {
    scene.compose(Coupling::<F> {
        scene,
        solver,
        watch,
        precision: PhantomData,
    })?
}

/// Couples a device to whatever plant the scene calls for.
struct Coupling<'a, F> {
    scene: &'a Scene,
    solver: Solver,
    watch: &'a mut dyn Watch,
    precision: PhantomData<F>,
}

impl<F: Precise> Coupling<'_, F> {
    /// Runs this device on this plant.
    fn run<M: Driven, D: Device>(self, plant: M, device: D) -> Result<Totals, Ended> {
        let scene = self.scene;
        let run = Run::new(scene, plant, device, first_felt_nm(scene)?);
        run.go(scene, walk::<_, F>(scene, &scene.motion), self.watch)
    }
}

impl<F: Precise> PlantVisitor for Coupling<'_, F> {
    type Output = Result<Totals, Ended>;

    fn visit<M: Driven>(self, plant: M) -> Self::Output {
        let (scene, solver, step_s) = (self.scene, self.solver, self.scene.step_s());
        if let Some(device) = bare_joint::<F>(scene, solver, step_s, &plant.shaft())? {
            self.run(plant, device)
        } else {
            let device = device::<F>(scene, solver, step_s, &plant.shaft())?;
            self.run(plant, device)
        }
    }

    fn visit_rigid(self, plant: RigidShaft<Ideal>) -> Self::Output {
        let scene = self.scene;
        match bare_symptoms::<F>(scene, scene.step_s(), &plant.shaft())? {
            Some(device) => self.run(plant, device),
            None => self.visit(plant),
        }
    }
}

/// Walk through a motion in steps of a scene's plant, for a device that computes in `F`.
pub(super) fn walk<W: Borrow<Motion>, F: Precise>(scene: &Scene, motion: W) -> Walk<W> {
    let part_s = scene.step_s() / f64::from(scene.substeps);
    Walk::new(motion, part_s).in_parts::<F>()
}

/// A plant with its device.
#[derive(Clone)]
pub(super) struct Run<M, D> {
    device: D,
    pub(super) plant: M,
    stages: Vec<Stage>,
    tick_s: f64,
    /// Voltage for the coil, which its PWM loads with the next tick.
    coil_v: f64,
    /// Whether a tick is split where the motion breaks: a device samples on its ticks.
    splits: bool,
    /// Breaks of the motion within the tick.
    cuts: Vec<Cut>,
    /// A symptom can give energy.
    has_tank: bool,
    /// Torque that the hand feels in the first tick, N·m; it stands in the first row, too.
    first_felt_nm: f64,
}

/// No shaft turns as far or as fast, rad and rad/s, but one that diverges; well below the
/// root of the largest number in single precision.
const FASTEST: f64 = 1e15;

impl<M: Driven, D: Device> Run<M, D> {
    /// Couples the device of a scene to its plant; the hand feels `first_felt_nm` in the first tick, N·m.
    pub(super) fn new(scene: &Scene, plant: M, device: D, first_felt_nm: f64) -> Self {
        Self {
            has_tank: scene.gives_energy(),
            first_felt_nm,
            device,
            plant,
            stages: Stage::listed(scene),
            tick_s: scene.step_s(),
            coil_v: 0.0,
            splits: !scene.is_device && scene.encoder.is_none(),
            cuts: Vec::new(),
        }
    }

    /// The run before its first tick.
    pub(super) fn begun(&mut self) -> Reached {
        Reached {
            n: 0,
            time_s: 0.0,
            tick_s: self.tick_s,
            shaft: self.plant.shaft(),
            command: self.device.command(&mut self.stages),
            felt_nm: self.first_felt_nm,
            struck_nms: 0.0,
            felt: TorqueTally::default(),
            most_struck_nms: 0.0,
            held_j: 0.0,
            limited_j: 0.0,
            beyond: Beyond::new(),
            fastest_rad_s: 0.0,
        }
    }

    /// Returns whether a state is NaN, infinite, or soon will be, and which: a shaft that is not finite makes
    /// an object so, and one whose square overflows makes the plant's other states so.
    pub(super) fn diverged(&self, scene: &Scene, by_s: f64) -> Option<Diverged> {
        let shaft = self.plant.shaft();
        let fits = |x: f64| x.abs() < FASTEST;
        let shaft_fits = fits(shaft.angle_rad) && fits(shaft.omega_rad_s);
        if self.device.is_finite() && shaft_fits {
            return None;
        }
        if !shaft_fits {
            return Some(Diverged::Shaft {
                by_s,
                step_s: self.tick_s,
            });
        }
        let swing = scene
            .crepitus
            .map_or(0.0, |c| c.settings.parameters.natural_rad_s());
        Some(Diverged::Object {
            solver: scene.solver.name(),
            by_s,
            radians_per_step: swing * self.tick_s,
        })
    }

    fn go(
        mut self,
        scene: &Scene,
        mut walk: Walk<&Motion>,
        watch: &mut dyn Watch,
    ) -> Result<Totals, Ended> {
        let (steps, every) = steps(scene);
        let every = watch.wants_rows().then_some(every);
        let parts = scene.substeps;
        let mut at = self.begun();
        let mut row = Vec::new();
        let mut events = Vec::new();
        let mut stop = 0;
        loop {
            if M::IS_RIGID && parts == 1 {
                let (stages, events) = (&mut self.stages, &mut events);
                self.device
                    .go_ahead(&mut self.plant, &mut walk, &mut at, stop, stages, events);
            }
            if events.is_empty() {
                at.note_speed(at.shaft.omega_rad_s);
                if at.n == stop {
                    self.stop(scene, &at, (steps, every), &mut row, watch)?;
                    if at.n == steps {
                        break;
                    }
                    stop = next_stop(at.n, steps, every);
                    if M::IS_RIGID {
                        continue;
                    }
                }
                self.tick(&mut at, &mut walk, parts, &mut events);
            }
            if !events.is_empty() {
                // As a row, an event holds numbers.
                if let Some(diverged) = self.diverged(scene, at.time_s) {
                    return Err(RunError::Diverged(diverged));
                }
                tell(&mut events, watch)?;
            }
            at.end_tick(walk.time_s());
        }
        let time_s = at.time_s;
        let tank = self.device.tank();
        let (tally, crowded_steps) = Box::new(self.device).finish(time_s).unzip();
        Ok(Totals {
            steps,
            end_s: time_s,
            tally,
            fastest_rad_s: at.fastest_rad_s,
            crowded_steps: crowded_steps.unwrap_or(0),
            tank,
            beyond: at.beyond,
            plant: Some(PlantTotals {
                balance: self.plant.balance(),
                rendering: Rendering {
                    held: at.held_j,
                    stages: self
                        .stages
                        .iter()
                        .filter(|stage| stage.acts_on_joint)
                        .map(|s| (s.spec.name, s.work_j))
                        .collect(),
                    limits: scene.is_device.then_some(at.limited_j),
                    absorbed: self.plant.absorbed_j(),
                },
                felt: scene.is_held().then_some(at.felt),
                impacts: self.plant.impacts(),
                struck_nms: at.most_struck_nms,
                warnings: self.plant.warnings(),
            }),
        })
    }

    /// A tick of the mechanics and of the device.
    #[inline(always)]
    #[expect(
        clippy::inline_always,
        reason = "the loop's own, with nothing but the loop around it"
    )]
    pub(super) fn tick(
        &mut self,
        at: &mut Reached,
        walk: &mut Walk<impl Borrow<Motion>>,
        parts: u32,
        events: &mut Vec<Happened>,
    ) {
        at.n += 1;
        let before = at.shaft;
        self.plant.command(at.command.torque_nm, self.coil_v);
        self.coil_v = at.command.coil_v;
        let felt_before = self.plant.felt_nms();
        let struck_before = self.plant.struck_nms();
        let (after, next) = self.advance(walk, parts, before);
        at.shaft = next;
        let mut felt_nms = self.plant.felt_nms() - felt_before;
        if !M::IS_RIGID {
            at.struck_nms = self.plant.struck_nms() - struck_before;
            felt_nms -= at.struck_nms;
            if at.struck_nms.abs() > at.most_struck_nms {
                at.most_struck_nms = at.struck_nms.abs();
            }
        }
        let turned_rad = after.angle_rad - before.angle_rad;
        at.note_motion(felt_nms, turned_rad);
        at.limited_j += at.command.taken_nm * turned_rad;
        at.command = self.render(at.time_s, (before, after), events);
    }

    /// Work before some ticks only: the state is checked, its row is written, and progress
    /// told of.
    #[cold]
    fn stop(
        &self,
        scene: &Scene,
        at: &Reached,
        (steps, every): (u64, Option<u64>),
        row: &mut Vec<f64>,
        watch: &mut dyn Watch,
    ) -> Result<(), Ended> {
        let is_row = every.is_some_and(|every| at.n.is_multiple_of(every));
        // Before its row: a trace holds numbers.
        if (is_row || at.n.is_multiple_of(CHECK_STEPS) || at.n == steps)
            && let Some(diverged) = self.diverged(scene, at.time_s)
        {
            return Err(RunError::Diverged(diverged));
        }
        if is_row {
            self.row(scene, at, scene.is_held(), row);
            watch.row(row)?;
        }
        if at.n.is_multiple_of(PROGRESS_STEPS) {
            watch.progress(at.time_s)?;
        }
        Ok(())
    }

    /// Row of the trace, with what the hand feels if somebody holds the leg.
    pub(super) fn row(&self, scene: &Scene, at: &Reached, is_held: bool, row: &mut Vec<f64>) {
        let shaft = self.plant.shaft();
        row.clear();
        row.extend([at.time_s, shaft.angle_rad, shaft.omega_rad_s]);
        self.write(scene, row);
        if is_held {
            row.push(at.felt_nm);
            row.extend(self.plant.impacts().map(|_| at.struck_nms));
        }
    }

    /// One tick of the device, in which the shaft has gone from one state to the next: its next
    /// command.
    #[inline]
    fn render(
        &mut self,
        start_s: f64,
        (from, to): (Body, Body),
        events: &mut Vec<Happened>,
    ) -> Command {
        let stages = &mut self.stages;
        if self.cuts.is_empty() {
            return self.device.tick(start_s, (&from, &to), stages, events);
        }
        let span = Span {
            start_s,
            length_s: self.tick_s,
            from,
            to,
        };
        let command = self.device.tick_in_parts(&span, &self.cuts, stages, events);
        self.cuts.clear();
        command
    }

    /// Writes the columns of the device and of the plant.
    fn write(&self, scene: &Scene, row: &mut Vec<f64>) {
        self.device.write(row);
        let shown = self.device.shown();
        for stage in &self.stages {
            row.push(shown.added.get(stage.place).unwrap_or(0.0));
            let phase = stage.spec.phases.map(|_| shown.phases.get(stage.spec));
            row.extend(phase.map(f64::from));
        }
        if self.has_tank {
            row.push(shown.held_back);
        }
        if scene.is_device {
            row.extend([shown.torque_nm, f64::from(shown.limit as u8)]);
        }
        self.plant.write(row);
    }

    /// The plant through one tick; the shaft at its end, before and after a jump there.
    #[inline]
    fn advance(
        &mut self,
        walk: &mut Walk<impl Borrow<Motion>>,
        parts: u32,
        from: Body,
    ) -> (Body, Body) {
        let mut shaft = (from, from);
        if self.splits {
            for _ in 0..parts {
                shaft = walk.advance_in_parts(&mut self.plant, &mut self.cuts);
            }
        } else {
            for _ in 0..parts {
                shaft = walk.advance(&mut self.plant);
            }
        }
        shaft
    }
}

/// Passes the events of a tick on, in the order of time.
#[cold]
fn tell(events: &mut Vec<Happened>, watch: &mut dyn Watch) -> Result<(), Stopped> {
    events.sort_by(|a, b| a.time_s().total_cmp(&b.time_s()));
    for event in events.drain(..) {
        match event {
            Happened::Joint(event) => watch.event(&event)?,
            Happened::Symptom(event) => watch.symptom(&event)?,
        }
    }
    Ok(())
}

/// Torque that the hand feels in the first tick, N·m: a plant that is thrown away goes
/// through it.
pub(super) fn first_felt_nm(scene: &Scene) -> Result<f64, crepitus_model::SettingsError> {
    let mut plant = scene.assemble()?;
    let tick_s = scene.step_s();
    let mut walk = Walk::new(&scene.motion, tick_s);
    plant.command(0.0, 0.0);
    let (from, to) = walk.step();
    plant.advance(&MotionStep {
        length_s: tick_s,
        from,
        to,
    });
    Ok((plant.felt_nms() - plant.struck_nms()) / tick_s)
}

#[cfg(test)]
mod tests;
