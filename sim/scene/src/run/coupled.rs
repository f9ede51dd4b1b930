//! A run with a plant: device → actuator → chain → boundary, tick by tick. The
//! shaft does what comes of it.

use super::device::{Device, Happened, Span, device};
use super::held_back::Beyond;
use super::stages;
use super::stepping::{CHECK_STEPS, PROGRESS_STEPS};
use super::tally::TorqueTally;
use super::watch::{Ended, Stopped, Watch};
use super::{Diverged, RunError, Totals, steps};
use crate::any_joint::Precise;
use crate::scene::Scene;
use crate::walk::{Cut, Walk};
use crepitus_model::render::effects::{EffectSpec, SPECS};
use crepitus_model::solver::Solver;
use crepitus_plant::boundary::MotionStep;
use crepitus_plant::chain::{Body, Impacts};
use crepitus_plant::energy_balance::EnergyBalance;
use crepitus_plant::{Motion, Plant};

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

/// An effect of the device, its present torque, and its work.
struct Stage {
    spec: &'static EffectSpec,
    /// Place of the effect in the model's table.
    place: usize,
    /// True if its contribution is part of the motor's torque.
    acts_on_joint: bool,
    added_nm: f64,
    work_j: f64,
}

/// Runs a scene with a plant.
pub(super) fn simulate<F: Precise>(
    scene: &Scene,
    solver: Solver,
    watch: &mut dyn Watch,
) -> Result<Totals, Ended> {
    let tick_s = scene.step_s();
    let plant = scene.assemble()?;
    let shaft = plant.shaft();
    let settings = scene.effect_settings();
    let run = Run {
        has_tank: scene.gives_energy(),
        first_felt_nm: first_felt_nm(scene)?,
        device: device::<F>(scene, solver, tick_s, &shaft)?,
        plant,
        stages: stages::listed(scene)
            .map(|spec| {
                let place = SPECS.iter().take_while(|s| s.name != spec.name).count();
                Stage {
                    spec,
                    place,
                    acts_on_joint: settings.acts_on_joint(place),
                    added_nm: 0.0,
                    work_j: 0.0,
                }
            })
            .collect(),
        tick_s,
        coil_v: 0.0,
        splits: !scene.is_device && scene.encoder.is_none(),
        cuts: Vec::new(),
    };
    run.go::<F>(scene, watch)
}

struct Run {
    device: Box<dyn Device>,
    plant: Plant,
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

impl Run {
    /// Returns whether a state is NaN, infinite, or soon will be, and which: a shaft that is not finite makes
    /// an object so, and one whose square overflows makes the plant's other states so.
    fn diverged(&self, scene: &Scene, by_s: f64) -> Option<Diverged> {
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

    fn go<F: Precise>(mut self, scene: &Scene, watch: &mut dyn Watch) -> Result<Totals, Ended> {
        let (steps, every) = steps(scene);
        let wants_rows = watch.wants_rows();
        let parts = scene.substeps;
        let mut walk = Walk::new(&scene.motion, self.tick_s / f64::from(parts)).in_parts::<F>();
        let is_felt = scene.is_held();
        let mut felt = TorqueTally::default();
        let mut felt_nm = self.first_felt_nm;
        let has_impacts = self.plant.impacts().is_some();
        let (mut struck_nms, mut most_struck_nms) = (0.0, 0.0_f64);
        let (mut held, mut limited) = (0.0, 0.0);
        let mut beyond = Beyond::new();
        let mut fastest_rad_s: f64 = 0.0;
        let mut row = Vec::new();
        let mut events = Vec::new();
        let mut n = 0;
        let mut time_s = 0.0;
        loop {
            let before = self.plant.shaft();
            fastest_rad_s = fastest_rad_s.max(before.omega_rad_s.abs());
            let is_row = wants_rows && n % every == 0;
            // Before its row: a trace holds numbers.
            if (is_row || n % CHECK_STEPS == 0 || n == steps)
                && let Some(diverged) = self.diverged(scene, time_s)
            {
                return Err(RunError::Diverged(diverged));
            }
            if is_row {
                row.clear();
                row.extend([time_s, before.angle_rad, before.omega_rad_s]);
                self.write(scene, &mut row);
                if is_felt {
                    row.push(felt_nm);
                    if has_impacts {
                        row.push(struck_nms);
                    }
                }
                watch.row(&row)?;
            }
            if n % PROGRESS_STEPS == 0 {
                watch.progress(time_s)?;
            }
            if n == steps {
                break;
            }
            n += 1;
            let (model_nm, taken_nm) = self.command();
            let felt_before = self.plant.felt_nms();
            let struck_before = self.plant.struck_nms();
            let after = self.advance(&mut walk, parts);
            struck_nms = self.plant.struck_nms() - struck_before;
            most_struck_nms = most_struck_nms.max(struck_nms.abs());
            felt_nm = (self.plant.felt_nms() - felt_before - struck_nms) / self.tick_s;
            felt.add(felt_nm);
            let turned = after.angle_rad - before.angle_rad;
            held += model_nm * turned;
            limited += taken_nm * turned;
            for stage in &mut self.stages {
                stage.work_j += stage.added_nm * turned;
            }
            self.render(time_s, (before, after), &mut events);
            // As a row, an event holds numbers.
            if !events.is_empty()
                && let Some(diverged) = self.diverged(scene, time_s)
            {
                return Err(RunError::Diverged(diverged));
            }
            tell(&mut events, watch)?;
            time_s = walk.time_s();
            beyond.note(self.device.asked_nm(), (time_s, self.tick_s));
        }
        let tank = self.device.tank();
        let (tally, crowded_steps) = self.device.finish(time_s).unzip();
        Ok(Totals {
            steps,
            end_s: time_s,
            tally,
            fastest_rad_s,
            crowded_steps: crowded_steps.unwrap_or(0),
            tank,
            beyond,
            plant: Some(PlantTotals {
                balance: self.plant.balance(),
                rendering: Rendering {
                    held,
                    stages: self
                        .stages
                        .iter()
                        .filter(|stage| stage.acts_on_joint)
                        .map(|s| (s.spec.name, s.work_j))
                        .collect(),
                    limits: scene.is_device.then_some(limited),
                    absorbed: self.plant.absorbed_j(),
                },
                felt: is_felt.then_some(felt),
                impacts: self.plant.impacts(),
                struck_nms: most_struck_nms,
                warnings: self.plant.warnings(),
            }),
        })
    }

    /// One tick of the device, in which the shaft has gone from one state to the next.
    fn render(&mut self, start_s: f64, (from, to): (Body, Body), events: &mut Vec<Happened>) {
        if self.cuts.is_empty() {
            self.device.tick(start_s, &from, &to, events);
            return;
        }
        let span = Span {
            start_s,
            length_s: self.tick_s,
            from,
            to,
        };
        self.device.tick_in_parts(&span, &self.cuts, events);
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

    /// Commands what the device shows in the next tick. The joint's torque, and
    /// what guards and limits add to it, N·m.
    #[inline]
    fn command(&mut self) -> (f64, f64) {
        let shown = self.device.shown();
        let mut all_nm = 0.0;
        for stage in self.stages.iter_mut().filter(|stage| stage.acts_on_joint) {
            stage.added_nm = shown.added.get(stage.place).unwrap_or(0.0);
            all_nm += stage.added_nm;
        }
        self.plant.command(shown.torque_nm, self.coil_v);
        self.coil_v = shown.coil_v;
        let joint_nm = shown.model_torque_nm - shown.added.symptoms_nm();
        let taken_nm = shown.torque_nm - joint_nm - all_nm;
        (joint_nm, taken_nm)
    }

    /// The plant through one tick; the shaft at its end, before a jump there.
    #[inline]
    fn advance(&mut self, walk: &mut Walk<&Motion>, parts: u32) -> Body {
        let mut shaft = self.plant.shaft();
        if self.splits {
            self.cuts.clear();
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
fn first_felt_nm(scene: &Scene) -> Result<f64, crepitus_model::SettingsError> {
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
