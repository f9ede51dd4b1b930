//! A scene: everything that decides a run, checked.

mod effects;
mod motion;

pub use motion::MotionKind;

use crate::document::{Document, Range, Section};
use crate::error::SceneError;
use crepitus_model::encoder::EncoderSettings;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Settings, SettingsError, Validated};
use crepitus_plant::Motion;
use crepitus_plant::assembly::{Assembled, Listed, assemble};
use crepitus_plant::chain::Body;
use crepitus_plant::effect::{Context, Effect, Given, Part};
use crepitus_plant::effects::EFFECTS;
use std::path::{Path, PathBuf};

/// The only version of scene files so far.
pub const SCENE_VERSION: u32 = 1;

/// The most steps of one run, and the most rows of one trace.
const MOST_STEPS: f64 = 1e12;

/// What is to be simulated.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The file that it was read from.
    pub file: PathBuf,
    /// What it shows, in one line.
    pub title: String,
    /// What it shows, at length.
    pub description: Option<String>,
    /// Length of the run, s.
    pub duration_s: f64,
    /// Name of the kind of motion, as the file writes it.
    pub motion_kind: MotionKind,
    /// The shaft's motion.
    pub motion: Motion,
    /// Seed of everything random, if the scene has any.
    pub seed: Option<u64>,
    /// How the joint is integrated.
    pub solver: SolverChoice,
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
    /// What was odd but not wrong.
    pub warnings: Vec<String>,
}

/// The `crepitus` effect of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Crepitus {
    /// The preset it started from, if any.
    pub preset: Option<&'static str>,
    /// The settings in force.
    pub settings: Validated<Settings>,
}

/// How the joint is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolverChoice {
    /// From event to event on the true motion, in f64.
    Reference,
    /// A rung of the ladder.
    Ladder {
        /// The rung.
        solver: Solver,
        /// Its step, s.
        step_s: f64,
        /// Its precision.
        precision: Precision,
    },
}

/// The numbers that the model computes with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Single, as on the device.
    F32,
    /// Double.
    F64,
}

impl SolverChoice {
    /// Names of all solvers, cheapest first.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Solver::ALL.iter().map(|s| s.name()).chain([REFERENCE])
    }

    /// Name in scene files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Reference => REFERENCE,
            Self::Ladder { solver, .. } => solver.name(),
        }
    }
}

/// Name of the event-driven solver.
const REFERENCE: &str = "reference";

impl Precision {
    /// Both precisions, the device's first.
    pub const ALL: [Self; 2] = [Self::F32, Self::F64];

    /// Name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

/// What the command line changes in a scene.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// Another solver.
    pub solver: Option<String>,
    /// Another step, as TOML.
    pub step: Option<String>,
    /// Another precision.
    pub precision: Option<String>,
    /// PATH=VALUE pairs.
    pub set: Vec<(String, String)>,
}

impl Scene {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// [`SceneError`] says where, which key, what is wrong, what is allowed.
    pub fn read(file: &Path, overrides: &Overrides) -> Result<Self, SceneError> {
        let whole = |message: String| SceneError {
            file: file.to_owned(),
            origin: None,
            key: String::new(),
            message,
        };
        let bytes = std::fs::read(file).map_err(|e| whole(format!("cannot be read: {e}")))?;
        let text = String::from_utf8(bytes)
            .map_err(|e| whole(format!("is not UTF-8 text: {}", e.utf8_error())))?;
        Self::parse(file, &text, overrides)
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

        let version = root.number("version", Range::closed(0.0, 1e9))?;
        if version != f64::from(SCENE_VERSION) {
            return Err(root.key_error(
                "version",
                format!("{version} is not known: this program reads version {SCENE_VERSION}"),
            ));
        }
        let title = root.text("title")?.to_owned();
        let description = root
            .optional_text("description")?
            .map(|d| d.trim().to_owned());
        let duration_s = root.number("duration_s", Range::above(0.0, 1e7))?;
        let motion = motion::read(&root.section("motion")?, duration_s)?;
        let solver_section = root.section("solver")?;
        let (solver, substeps) = read_solver(&solver_section)?;
        let effects = effects::read(root.optional_section("effects")?.as_ref())?;
        let output = root.optional_section("output")?;
        let trace_step_s = read_trace_step(output.as_ref(), &solver_section, solver, duration_s)?;
        root.finish()?;

        let mut stepped: Vec<_> = effects.listed.iter().map(|l| l.effect.name).collect();
        if effects.encoder.is_some() {
            stepped.push("encoder");
        }
        if solver == SolverChoice::Reference && !stepped.is_empty() {
            let tables: Vec<_> = stepped.iter().map(|n| format!("[effects.{n}]")).collect();
            return Err(solver_section.key_error(
                "kind",
                format!(
                    "\"reference\" has no step, and knows the stick-slip object alone: choose another solver, or \
                     leave out {}",
                    tables.join(", ")
                ),
            ));
        }
        check_released(&root, motion.kind, &effects.listed)?;
        if let (Some(crepitus), SolverChoice::Ladder { solver, .. }) = (&effects.crepitus, solver)
            && let Some(reason) = solver.refusal(crepitus.settings.convention)
        {
            return Err(solver_section.key_error(
                "kind",
                format!("\"{}\" is refused: {reason}", solver.name()),
            ));
        }
        if substeps > 1 && effects.listed.is_empty() {
            return Err(solver_section.key_error(
                "substeps",
                "there is no plant to step: leave it out, or add an effect of the plant",
            ));
        }
        let mut warnings = motion.warnings;
        if let Some(crepitus) = &effects.crepitus {
            warnings.extend(sampled_motion_warning(crepitus, motion.ripple_rad_s2));
        }
        let scene = Self {
            file: file.to_owned(),
            title,
            description,
            duration_s,
            motion_kind: motion.kind,
            motion: motion.motion,
            seed: motion.seed,
            solver,
            crepitus: effects.crepitus,
            encoder: effects.encoder,
            listed: effects.listed,
            substeps,
            trace_step_s,
            warnings,
        };
        scene.assemble().map_err(|e| root.error(e.to_string()))?;
        Ok(scene)
    }

    /// The plant and the device's stages.
    ///
    /// # Errors
    /// [`SettingsError`] if a number of the device does not go with the step.
    pub fn assemble(&self) -> Result<Assembled, SettingsError> {
        let (angle_rad, omega_rad_s) = self.motion.piece(0.0).angle_and_velocity(0.0);
        let context = Context {
            tick_s: crate::run::step_s(self),
            single: matches!(
                self.solver,
                SolverChoice::Ladder {
                    precision: Precision::F32,
                    ..
                }
            ),
            start: Body {
                angle_rad,
                omega_rad_s,
            },
        };
        assemble(&self.listed, &context, !self.is_held())
    }

    /// Whether it has a plant, so that the shaft does what comes of it;
    /// otherwise the motion prescribes it.
    pub fn is_coupled(&self) -> bool {
        !self.listed.is_empty()
    }

    /// Whether the motion, or a hand after it, holds the leg.
    pub fn is_held(&self) -> bool {
        self.motion_kind != MotionKind::Released
    }

    /// The effects that the scene calls for, in the order of the table.
    pub fn effects(&self) -> Vec<&'static Effect> {
        EFFECTS
            .iter()
            .copied()
            .filter(|e| self.has(e.name))
            .collect()
    }

    /// Whether it calls for an effect.
    pub fn has(&self, effect: &str) -> bool {
        EFFECTS
            .iter()
            .find(|e| e.name == effect)
            .is_some_and(|e| match e.part {
                Part::Joint => self.crepitus.is_some(),
                Part::Sensor => self.encoder.is_some(),
                _ => self.listed.iter().any(|l| l.effect.name == effect),
            })
    }

    /// The scene with only the first `count` effects of its plant, which need
    /// none of the later ones.
    pub fn first(&self, count: usize) -> Self {
        let mut scene = self.clone();
        scene.listed.truncate(count);
        if scene.listed.is_empty() {
            scene.substeps = 1;
        }
        scene
    }

    /// The scene without an effect and without those that need it; none if
    /// its motion needs the effect.
    pub fn without(&self, effect: &Effect) -> Option<Self> {
        if effect.name == "limb" && self.motion_kind == MotionKind::Released {
            return None;
        }
        let mut scene = self.clone();
        match effect.part {
            Part::Joint => scene.crepitus = None,
            Part::Sensor => scene.encoder = None,
            _ => scene.listed.retain(|l| l.effect.name != effect.name),
        }
        scene.warnings.clear();
        if scene.listed.is_empty() {
            scene.substeps = 1;
        }
        let dependent = scene
            .effects()
            .into_iter()
            .find(|other| other.needs.iter().any(|n| n.effect == effect.name));
        match dependent {
            None => Some(scene),
            Some(other) => scene.without(other)?.without(effect),
        }
    }

    /// The scene with an effect at its defaults, and with those that it needs;
    /// none if the motion or the solver does not allow it.
    pub fn with(&self, effect: &'static Effect) -> Option<Self> {
        if self.has(effect.name) {
            return Some(self.clone());
        }
        if self.solver == SolverChoice::Reference || (!self.is_held() && effect.name == "hand") {
            return None;
        }
        let mut scene = self.clone();
        for need in effect.needs {
            scene = scene.with(crepitus_plant::effects::find(need.effect)?)?;
        }
        match effect.part {
            Part::Joint => {
                scene.crepitus = Some(Crepitus {
                    preset: None,
                    settings: Settings::default().validate().ok()?,
                });
            }
            Part::Sensor => scene.encoder = Some(EncoderSettings::default()),
            _ => {
                scene.listed.push(Listed {
                    effect,
                    given: Given::defaults(effect),
                });
                let place = |name| EFFECTS.iter().position(|e| e.name == name);
                scene.listed.sort_by_key(|l| place(l.effect.name));
            }
        }
        scene.assemble().is_ok().then_some(scene)
    }
}

/// A leg that nobody holds has to be there, and not to be held.
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
        Ok(())
    }
}

fn read_solver(section: &Section<'_>) -> Result<(SolverChoice, u32), SceneError> {
    let ladder = Solver::ALL.map(|s| (s.name(), Some(s)));
    let names: Vec<_> = ladder.into_iter().chain([(REFERENCE, None)]).collect();
    let kind = section.choice("kind", &names)?;
    let step_s = section.optional_number("step_s", Range::above(0.0, 1.0))?;
    let precisions = [Precision::F32, Precision::F64].map(|p| (p.name(), p));
    let precision = section.optional_choice("precision", &precisions)?;
    let substeps = read_substeps(section)?;
    section.finish()?;
    let choice = match kind {
        None => {
            if step_s.is_some() {
                return Err(section.key_error("step_s", "\"reference\" has no step: leave it out"));
            }
            if precision == Some(Precision::F32) {
                return Err(section.key_error("precision", "\"reference\" computes in f64 only"));
            }
            SolverChoice::Reference
        }
        Some(solver) => SolverChoice::Ladder {
            solver,
            step_s: step_s.ok_or_else(|| {
                section.key_error(
                    "step_s",
                    format!(
                        "this key is missing: \"{}\" needs a step in seconds, for example 5e-5",
                        solver.name()
                    ),
                )
            })?,
            precision: precision.unwrap_or(Precision::F64),
        },
    };
    Ok((choice, substeps))
}

/// Steps of the plant in one of the solver: the device's tick stays what it
/// is.
fn read_substeps(section: &Section<'_>) -> Result<u32, SceneError> {
    match section.optional_number("substeps", Range::closed(1.0, 1000.0))? {
        None => Ok(1),
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole and in range"
        )]
        Some(x) if x.fract() == 0.0 => Ok(x as u32),
        Some(x) => Err(section.key_error("substeps", format!("{x} is not a whole number"))),
    }
}

/// Time between trace rows: a whole number of solver steps.
fn read_trace_step(
    output: Option<&Section<'_>>,
    solver_section: &Section<'_>,
    solver: SolverChoice,
    duration_s: f64,
) -> Result<f64, SceneError> {
    /// Of `reference`, which has no step of its own: the device's tick.
    const DEFAULT_STEP_S: f64 = 5e-5;
    let wanted = match output {
        None => None,
        Some(section) => {
            let step = section.optional_number("trace_step_s", Range::above(0.0, 1e7))?;
            section.finish()?;
            step
        }
    };
    let refuse = |message: String| match (output, wanted) {
        (Some(section), Some(_)) => section.key_error("trace_step_s", message),
        _ => solver_section.key_error("step_s", message),
    };
    let step_s = match solver {
        SolverChoice::Reference => wanted.unwrap_or(DEFAULT_STEP_S),
        SolverChoice::Ladder { step_s, .. } => {
            if duration_s / step_s > MOST_STEPS {
                return Err(solver_section.key_error(
                    "step_s",
                    format!("{step_s} s makes more than {MOST_STEPS:e} steps of {duration_s} s"),
                ));
            }
            if duration_s < step_s * (1.0 - 1e-9) {
                return Err(solver_section.key_error(
                    "step_s",
                    format!("a step of {step_s} s is longer than the run of {duration_s} s"),
                ));
            }
            let wanted = wanted.unwrap_or(step_s);
            let steps = wanted / step_s;
            if steps < 0.5 || (steps - steps.round()).abs() > 1e-6 * steps {
                return Err(refuse(format!(
                    "{wanted} s is not a whole number of steps of {step_s} s"
                )));
            }
            wanted
        }
    };
    if duration_s / step_s > MOST_STEPS {
        return Err(refuse(format!(
            "{step_s} s makes more than {MOST_STEPS:e} rows of {duration_s} s"
        )));
    }
    Ok(step_s)
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
