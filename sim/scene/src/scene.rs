//! A scene: everything that decides a run, checked.

mod data_file;
mod device;
mod motion;
mod plausible_angles;
mod recorded_motion;
mod solver;
mod stages;
mod variants;

pub use crate::device_checks::caps_warning;
pub use crate::effects::Crepitus;
pub use data_file::DataFile;
pub use motion::MotionKind;
pub use solver::{Precision, SolverChoice};

use crate::document::{Document, Range, Section, Value, text_of};
use crate::effects;
use crate::error::SceneError;
use crate::preset;
use crate::reference::symptoms::NAMES;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::{Convention, SettingsError};
use crepitus_plant::actuator::Actuator;
use crepitus_plant::assembly::{Listed, PlantVisitor, assemble, assemble_with, boundary, compose};
use crepitus_plant::boundary::Boundary;
use crepitus_plant::chain::{Body, Chain};
use crepitus_plant::effect::{Context, Effect, Given};
use crepitus_plant::{Motion, Plant};
use serde::{Deserialize, Serialize};
use solver::{REFERENCE, read_solver, read_trace_step};
use std::path::{Path, PathBuf};

/// The only version of scene files so far.
pub const SCENE_VERSION: u32 = 1;

/// A validated scene.
#[derive(Clone, Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "keys of a file, and what a simulated device does with it"
)]
pub struct Scene {
    /// The file that it was read from.
    pub file: PathBuf,
    /// Title, one line.
    pub title: String,
    /// Description.
    pub description: Option<String>,
    /// Length of the run, s.
    pub duration_s: f64,
    /// Name of the kind of motion, as the file writes it.
    pub motion_kind: MotionKind,
    /// The shaft's motion.
    pub motion: Motion,
    /// Whether on a simulated device the leg begins straight, at 0°, where the zero is set, and is led to the
    /// motion's start. No key of a file, and nothing to a run.
    pub begins_straight: bool,
    /// Whether on a simulated device an examiner moves the leg who chooses the motion by the knee that the device
    /// renders, where the scene's is one of strokes. No key of a file, and nothing to a run.
    pub has_examiner: bool,
    /// Seed of everything random, if the scene has any.
    pub seed: Option<u64>,
    /// Solver that integrates the joint.
    pub solver: SolverChoice,
    /// The drive's whole pipeline renders, not the solver alone.
    pub is_device: bool,
    /// The stick-slip object, if the scene calls for it.
    pub crepitus: Option<Crepitus>,
    /// The encoder, if the scene calls for it.
    pub encoder: Option<EncoderSettings>,
    /// All other effects that it calls for, in the order of the table.
    pub listed: Vec<Listed>,
    /// Steps of the plant in one of the solver.
    pub substeps: u32,
    /// Time between rows of the trace, s.
    pub trace_step_s: f64,
    /// Events of the play elements under the symptoms are wanted, too.
    pub play_events: bool,
    /// The recording that the motion is read from.
    pub data: Option<DataFile>,
    /// The scene as it is run, as TOML: overrides applied, every default
    /// written out, the path of a recording made whole.
    pub as_run: String,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Overrides of a scene by the command line.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Overrides {
    /// Another solver.
    pub solver: Option<String>,
    /// Another step, as TOML.
    pub step: Option<String>,
    /// Another precision.
    pub precision: Option<String>,
    /// Render as the device does.
    pub as_device: bool,
    /// PATH=VALUE pairs.
    pub set: Vec<(String, String)>,
}

impl Scene {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// [`SceneError`] with position, key, cause and valid values.
    pub fn read(file: &Path, overrides: &Overrides) -> Result<Self, SceneError> {
        Self::parse(file, &text_of(file)?, overrides)
    }

    /// Checks the text of a scene file; `file` names it in errors and is the
    /// place from which a recording's path is relative.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn parse(file: &Path, text: &str, overrides: &Overrides) -> Result<Self, SceneError> {
        let mut document = Document::parse(file, text)?;
        overrides.apply(&mut document)?;
        let root = document.section();

        check_version(&root)?;
        let title = title(&root)?;
        let description = root
            .optional_text("description")?
            .map(|d| d.trim().to_owned());
        let duration_s = root.number("duration_s", Range::above(0.0, 1e7))?;
        let motion = motion::read(&root.section("motion")?, duration_s)?;
        let solver_section = root.section("solver")?;
        let (solver, substeps) = read_solver(&solver_section)?;
        let effects = effects::read(root.optional_section("effects")?.as_ref(), &preset::starts)?;
        let is_device = root.flag("device")?;
        let output = root.optional_section("output")?;
        let trace_step_s = read_trace_step(output.as_ref(), &solver_section, solver, duration_s)?;
        let play_events = match &output {
            Some(output) => output.flag("play_events")?,
            None => false,
        };
        if let Some(output) = &output {
            output.finish()?;
        }
        root.finish()?;
        root.note("output.trace_step_s", Value::Number(trace_step_s));
        root.note("output.play_events", Value::Flag(play_events));

        let is_solved = |name: &str| solver == SolverChoice::Reference && NAMES.contains(&name);
        let listed = effects.listed.iter().map(|l| l.effect.name);
        let mut stepped: Vec<_> = listed.filter(|name| !is_solved(name)).collect();
        if effects.encoder.is_some() {
            stepped.push("encoder");
        }
        if solver == SolverChoice::Reference && !stepped.is_empty() {
            return Err(solver_section.key_error(
                "kind",
                format!(
                    "\"reference\" has no step, and knows a joint's symptoms alone: choose another solver, or leave \
                     out {}",
                    tables(&stepped)
                ),
            ));
        }
        check_released(&root, motion.kind, &effects.listed)?;
        stages::check_each(&root, &effects.listed)?;
        if is_device {
            device::check(&root, &effects, solver)?;
        }
        check_rung(&solver_section, solver, &effects, &stepped)?;
        if substeps > 1 && effects.listed.is_empty() && !is_device {
            return Err(solver_section.key_error(
                "substeps",
                "there is no plant to step: leave it out, or add an effect of the plant",
            ));
        }
        let mut warnings = motion.warnings;
        if let Some(crepitus) = &effects.crepitus {
            warnings.extend(sampled_motion_warning(crepitus, motion.ripple_rad_s2));
            let encoder = effects.encoder.as_ref();
            warnings.extend(encoder.and_then(|encoder| device::guard_refusal(crepitus, encoder)));
        }
        warnings.extend(device::compensation_warning(&effects.listed));
        let mut scene = Self {
            file: file.to_owned(),
            title,
            description,
            duration_s,
            motion_kind: motion.kind,
            motion: motion.motion,
            begins_straight: false,
            has_examiner: false,
            seed: motion.seed,
            solver,
            is_device,
            crepitus: effects.crepitus,
            encoder: effects.encoder,
            listed: effects.listed,
            substeps,
            trace_step_s,
            play_events,
            data: motion.data,
            as_run: document.resolved(),
            warnings,
        };
        scene.assemble().map_err(|e| root.error(e.to_string()))?;
        scene
            .check_stages()
            .map_err(|e| root.error(e.to_string()))?;
        let caps = device::caps_warning_of(&scene);
        scene.warnings.extend(caps);
        Ok(scene)
    }

    /// The step of the solver; of `reference`, the time between rows, s.
    pub fn step_s(&self) -> f64 {
        match self.solver {
            SolverChoice::Reference => self.trace_step_s,
            SolverChoice::Ladder { step_s, .. } => step_s,
        }
    }

    /// The plant.
    ///
    /// # Errors
    /// [`SettingsError`] if a number of the motor does not go with the step.
    pub fn assemble(&self) -> Result<Plant, SettingsError> {
        let tick_s = self.step_s();
        assemble(&self.listed, &self.context(tick_s), !self.is_held())
    }

    /// Runs `visitor` with the plant, of the types that this scene calls for.
    ///
    /// # Errors
    /// As [`Self::assemble`].
    pub(crate) fn compose<V: PlantVisitor>(&self, visitor: V) -> Result<V::Output, SettingsError> {
        let context = self.context(self.step_s());
        compose(&self.listed, &context, !self.is_held(), visitor)
    }

    /// The plant with an actuator of the caller, which has its own device
    /// with this tick: of the effects, those of the mechanics.
    pub fn assemble_with<A: Actuator>(&self, tick_s: f64, actuator: A) -> Plant<A> {
        let context = self.context(tick_s);
        assemble_with(&self.listed, &context, !self.is_held(), actuator)
    }

    /// The boundary that holds the leg of a device with this tick, where the motion begins at `start`.
    pub fn boundary(&self, tick_s: f64, start: Body, chain: &dyn Chain) -> Box<dyn Boundary> {
        let context = Context {
            start,
            ..self.context(tick_s)
        };
        boundary(&self.listed, &context, !self.is_held(), chain)
    }

    fn context(&self, tick_s: f64) -> Context {
        Context {
            tick_s,
            gravity_rad: None,
            single: matches!(
                self.solver,
                SolverChoice::Ladder {
                    precision: Precision::F32,
                    ..
                }
            ),
            start: self.start(),
        }
    }

    /// State of the shaft at the start of the motion.
    pub fn start(&self) -> Body {
        crate::walk::body(&self.motion.piece(0.0), 0.0)
    }

    /// The motion for as long as it takes: one that ends comes to rest where
    /// the scene ends; see [`Motion::resting_after`].
    pub fn endless_motion(&self) -> Motion {
        self.motion.clone().resting_after(self.duration_s)
    }

    /// Parameters of an effect of the plant, or its defaults.
    pub fn given(&self, effect: &Effect) -> Given {
        self.listed
            .iter()
            .find(|l| l.effect.name == effect.name)
            .map_or_else(|| Given::defaults(effect), |l| l.given.clone())
    }

    /// Returns whether it has a plant or a device, so that the shaft does what comes of
    /// it; otherwise the motion prescribes it.
    pub fn is_coupled(&self) -> bool {
        self.is_device || (self.solver != SolverChoice::Reference && !self.listed.is_empty())
    }

    /// Returns whether the motion, or a hand after it, holds the leg.
    pub fn is_held(&self) -> bool {
        self.motion_kind != MotionKind::Released
    }
}

/// The title, or the name of the file without its ending, which is noted.
fn title(root: &Section<'_>) -> Result<String, SceneError> {
    if let Some(title) = root.optional_text("title")? {
        return Ok(title.to_owned());
    }
    let name = root.file().file_stem().unwrap_or_default();
    let title = name.to_string_lossy().into_owned();
    root.note("title", Value::Text(title.clone()));
    Ok(title)
}

/// Effects as a scene file names them.
fn tables(effects: &[&str]) -> String {
    let tables: Vec<_> = effects.iter().map(|n| format!("[effects.{n}]")).collect();
    tables.join(", ")
}

/// Rejects a rung that does not support this scene.
fn check_rung(
    section: &Section<'_>,
    solver: SolverChoice,
    effects: &effects::Effects,
    stepped: &[&str],
) -> Result<(), SceneError> {
    let SolverChoice::Ladder {
        solver: rung,
        precision,
        ..
    } = solver
    else {
        return Ok(());
    };
    let refuse = |key: &str, reason: &str| {
        let name = rung.name();
        Err(section.key_error(key, format!("\"{name}\" is refused: {reason}")))
    };
    if let Some(crepitus) = &effects.crepitus
        && let Some(reason) = rung.refusal(crepitus.settings.convention)
    {
        return refuse("kind", reason);
    }
    if precision == Precision::F32
        && let Some(reason) = rung.single_refusal()
    {
        return refuse("precision", reason);
    }
    if rung.needs_exact_motion() && !stepped.is_empty() {
        let reason = format!(
            "it takes the shaft's acceleration from the prescribed motion, and what a sensor or a plant \
             makes of that motion is not exact enough: choose another solver, or leave out {}",
            tables(stepped)
        );
        return refuse("kind", &reason);
    }
    Ok(())
}

/// Validates a released leg: it needs a limb and excludes a hand.
fn check_released(
    root: &Section<'_>,
    kind: MotionKind,
    listed: &[Listed],
) -> Result<(), SceneError> {
    let has = |name: &str| listed.iter().any(|l| l.effect.name == name);
    if kind != MotionKind::Released {
        return Ok(());
    }
    let refuse = |message: &str| Err(root.section("motion")?.key_error("kind", message));
    if !has("limb") {
        return refuse("\"released\" needs [effects.limb]: there is no leg to fall");
    }
    if has("hand") {
        return refuse("\"released\" means that nobody holds the leg: leave [effects.hand] out");
    }
    Ok(())
}

fn check_version(root: &Section<'_>) -> Result<(), SceneError> {
    let problem = if root.has("version") {
        let version = root.number("version", Range::closed(0.0, 1e9))?;
        if version == f64::from(SCENE_VERSION) {
            return Ok(());
        }
        format!("{version} is not known: this program reads version {SCENE_VERSION}")
    } else {
        format!("this key is missing: a scene needs `version = {SCENE_VERSION}` as its first line")
    };
    Err(root.key_error("version", problem))
}

impl Overrides {
    fn apply(&self, document: &mut Document) -> Result<(), SceneError> {
        for (path, value) in &self.set {
            document.set(&format!("--set {path}={value}"), path, value)?;
        }
        let quoted = |name: &String| format!("\"{name}\"");
        if let Some(kind) = &self.solver {
            document.set(&format!("--solver {kind}"), "solver.kind", &quoted(kind))?;
            if kind == REFERENCE {
                // What only a stepping solver has does not come along.
                document.remove("solver.step_s");
                document.remove("solver.precision");
            }
        }
        if let Some(step) = &self.step {
            document.set(&format!("--step {step}"), "solver.step_s", step)?;
        }
        if let Some(precision) = &self.precision {
            let flag = format!("--precision {precision}");
            document.set(&flag, "solver.precision", &quoted(precision))?;
        }
        if self.as_device {
            document.set("--as-device", "device", "true")?;
        }
        Ok(())
    }
}

/// `physical` turns each kink of a recording's acceleration into torque.
fn sampled_motion_warning(crepitus: &Crepitus, ripple_rad_s2: Option<f64>) -> Option<String> {
    /// The torque from which an error is worth removing, N·m.
    const WORTH_HAVING_NM: f64 = 5e-3;
    let settings = &crepitus.settings;
    let ripple_nm = settings.parameters.inertia_kg_m2 * ripple_rad_s2?;
    (settings.convention == Convention::Physical && ripple_nm > WORTH_HAVING_NM).then(|| {
        format!(
            "under \"physical\" the torque contains J·Ω̇, and between two samples of this recording that changes \
             by up to {ripple_nm:.2} N·m (Ts is {} N·m): the joint feels the sampling; a lower cutoff_hz or \
             \"frozen\" avoids it",
            settings.parameters.static_torque_nm
        )
    })
}
