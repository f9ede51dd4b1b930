//! A scene: its text, what was changed in it, and what came of both.

use crate::{errors, values};
use crepitus_scene::shipped::{self, Shipped};
use crepitus_scene::{Overrides, SceneError};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyType};
use std::path::{Path, PathBuf};

/// Stands for the file of a scene without one.
const DICT: &str = "<dict>";
const TEXT: &str = "<toml>";

/// Everything that decides a run, checked: motion, solver, effects, output.
///
/// A scene does not change; `with_` and `set` make another one.
#[pyclass(frozen, module = "crepitus")]
#[derive(Clone)]
pub(crate) struct Scene {
    source: Source,
    overrides: Overrides,
    pub(crate) checked: crepitus_scene::Scene,
}

/// The text before any change, and the file that names it.
#[derive(Clone)]
struct Source {
    file: PathBuf,
    text: String,
    is_dict: bool,
}

impl Scene {
    fn of(source: Source, overrides: Overrides) -> PyResult<Self> {
        let checked = crepitus_scene::Scene::parse(&source.file, &source.text, &overrides)
            .map_err(|error| errors::scene(error, source.is_dict))?;
        Ok(Self {
            source,
            overrides,
            checked,
        })
    }

    /// A file, the name of a scene that ships, or the `summary.json` of a run.
    fn at(path: &Path, overrides: Overrides) -> PyResult<Self> {
        let failed = |error: SceneError| errors::scene(error, false);
        let checked = shipped::scene(path, &overrides).map_err(failed)?;
        let text = if path.extension().is_some_and(|e| e == "json") {
            let unchanged = shipped::scene(path, &Overrides::default()).map_err(failed)?;
            unchanged.as_run
        } else if let (false, Some(shipped)) = (path.exists(), Shipped::find(path)) {
            shipped.text.to_owned()
        } else {
            std::fs::read_to_string(path)?
        };
        let source = Source {
            file: checked.file.clone(),
            text,
            is_dict: false,
        };
        Ok(Self {
            source,
            overrides,
            checked,
        })
    }

    /// Its text before any change.
    pub(crate) fn text(&self) -> shipped::Source {
        shipped::Source::of_text(self.source.file.clone(), self.source.text.clone())
    }

    /// What was changed in it.
    pub(crate) const fn changes(&self) -> &Overrides {
        &self.overrides
    }

    /// A refusal in the form of the scene's own errors.
    pub(crate) fn refused(&self, key: &str, message: String) -> PyErr {
        let error = SceneError {
            file: self.checked.file.clone(),
            origin: None,
            key: key.to_owned(),
            message,
        };
        errors::scene(error, self.source.is_dict)
    }
}

/// Changes as the tool's flags have them. Numbers are checked by the scene.
fn overrides(
    solver: Option<String>,
    step: Option<f64>,
    precision: Option<String>,
    as_device: bool,
    set: Option<&Bound<'_, PyDict>>,
) -> PyResult<Overrides> {
    let mut pairs = Vec::new();
    for (path, object) in set.into_iter().flatten() {
        let path: String = path
            .extract()
            .map_err(|_| PyTypeError::new_err("set: expected texts as keys"))?;
        let value = values::value(&object, &path)?.to_string();
        pairs.push((path, value));
    }
    Ok(Overrides {
        solver,
        step: step.map(|step| toml::Value::Float(step).to_string()),
        precision,
        as_device,
        set: pairs,
    })
}

/// Both changes: where they touch the same key, the later one counts.
fn merged(first: &Overrides, then: Overrides) -> Overrides {
    let sets = |key: &str| {
        let (table, _) = key.split_once('.').unwrap_or((key, ""));
        then.set
            .iter()
            .any(|(path, _)| path == key || path == table)
    };
    let kept = |flag: &Option<String>, key| flag.clone().filter(|_| !sets(key));
    let mut set = first.set.clone();
    let solver = then.solver.or_else(|| kept(&first.solver, "solver.kind"));
    let step = then.step.or_else(|| kept(&first.step, "solver.step_s"));
    let precision = then
        .precision
        .or_else(|| kept(&first.precision, "solver.precision"));
    let as_device = then.as_device || (first.as_device && !sets("device"));
    set.extend(then.set);
    Overrides {
        solver,
        step,
        precision,
        as_device,
        set,
    }
}

#[pymethods]
impl Scene {
    /// A scene from a file, the name of one that ships, the `summary.json` of a run, a
    /// dict, or another scene. Raises `SceneError`.
    #[new]
    #[pyo3(signature = (source, *, solver=None, step=None, precision=None, as_device=false, set=None))]
    fn new(
        source: &Bound<'_, PyAny>,
        solver: Option<String>,
        step: Option<f64>,
        precision: Option<String>,
        as_device: bool,
        set: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let changes = overrides(solver, step, precision, as_device, set)?;
        if let Ok(scene) = source.cast::<Self>() {
            return scene.get().changed(changes);
        }
        if let Ok(dict) = source.cast::<PyDict>() {
            let source = Source {
                file: DICT.into(),
                text: toml::to_string(&values::table(dict)?)
                    .map_err(|error| PyTypeError::new_err(error.to_string()))?,
                is_dict: true,
            };
            return Self::of(source, changes);
        }
        if !source.is_instance_of::<PyString>() && !source.hasattr("__fspath__")? {
            let kind = source.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "a scene is a path, the name of one that ships, a dict or a Scene, not {kind}"
            )));
        }
        Self::at(&source.extract::<PathBuf>()?, changes)
    }

    /// A scene from TOML text; `file` names it in errors, and is the place from which a
    /// recording's path is relative.
    #[classmethod]
    #[pyo3(signature = (text, file=None))]
    fn from_toml(_: &Bound<'_, PyType>, text: String, file: Option<PathBuf>) -> PyResult<Self> {
        let source = Source {
            file: file.unwrap_or_else(|| TEXT.into()),
            text,
            is_dict: false,
        };
        Self::of(source, Overrides::default())
    }

    /// This scene with another solver, step (s), precision, as the device renders it, or
    /// with other values at keys of the file.
    #[pyo3(signature = (*, solver=None, step=None, precision=None, as_device=false, set=None))]
    fn with_(
        &self,
        solver: Option<String>,
        step: Option<f64>,
        precision: Option<String>,
        as_device: bool,
        set: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        self.changed(overrides(solver, step, precision, as_device, set)?)
    }

    /// This scene with another value at a key, such as `effects.crepitus.preset`.
    fn set(&self, key: String, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let value = values::value(value, &key)?.to_string();
        self.changed(Overrides {
            set: vec![(key, value)],
            ..Overrides::default()
        })
    }

    /// The scene as it runs, as TOML: changes applied, every default written out.
    #[getter]
    fn toml(&self) -> &str {
        &self.checked.as_run
    }

    /// The file that errors name.
    #[getter]
    fn file(&self) -> String {
        self.checked.file.display().to_string()
    }

    /// Title, one line.
    #[getter]
    fn title(&self) -> &str {
        &self.checked.title
    }

    /// What it shows.
    #[getter]
    fn description(&self) -> Option<&str> {
        self.checked.description.as_deref()
    }

    /// Length of the run, s.
    #[getter]
    fn duration_s(&self) -> f64 {
        self.checked.duration_s
    }

    /// Kind of the motion.
    #[getter]
    fn motion(&self) -> &'static str {
        self.checked.motion_kind.name()
    }

    /// Name of the solver.
    #[getter]
    fn solver(&self) -> &'static str {
        self.checked.solver.name()
    }

    /// The solver's step, s; of `reference`, the time between rows.
    #[getter]
    fn step_s(&self) -> f64 {
        self.checked.step_s()
    }

    /// Names of the effects.
    #[getter]
    fn effects(&self) -> Vec<&'static str> {
        self.checked.effects().iter().map(|e| e.name).collect()
    }

    /// What may be wrong with it.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.checked.warnings.clone()
    }

    fn __repr__(&self) -> String {
        let scene = &self.checked;
        format!(
            "<Scene {:?} from {}: {} s of {}, {} at {} s, effects: {}>",
            scene.title,
            scene.file.display(),
            scene.duration_s,
            scene.motion_kind.name(),
            scene.solver.name(),
            scene.step_s(),
            self.effects().join(", ")
        )
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.checked.as_run == other.checked.as_run && self.checked.file == other.checked.file
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.checked.as_run.hash(&mut hasher);
        hasher.finish()
    }

    /// For `pickle` and `copy`: other processes get the text, not the file.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, State)> {
        let rebuild = py.get_type::<Self>().getattr("_rebuilt")?;
        let o = &self.overrides;
        let flags = (
            o.solver.clone(),
            o.step.clone(),
            o.precision.clone(),
            o.as_device,
        );
        let source = &self.source;
        let (file, text) = (source.file.clone(), source.text.clone());
        Ok((rebuild, (file, text, source.is_dict, flags, o.set.clone())))
    }

    #[staticmethod]
    fn _rebuilt(
        file: PathBuf,
        text: String,
        is_dict: bool,
        flags: Flags,
        set: Vec<(String, String)>,
    ) -> PyResult<Self> {
        let (solver, step, precision, as_device) = flags;
        let overrides = Overrides {
            solver,
            step,
            precision,
            as_device,
            set,
        };
        Self::of(
            Source {
                file,
                text,
                is_dict,
            },
            overrides,
        )
    }
}

type Flags = (Option<String>, Option<String>, Option<String>, bool);
type State = (PathBuf, String, bool, Flags, Vec<(String, String)>);

impl Scene {
    fn changed(&self, changes: Overrides) -> PyResult<Self> {
        let Overrides {
            solver: None,
            step: None,
            precision: None,
            as_device: false,
            set,
        } = &changes
        else {
            return Self::of(self.source.clone(), merged(&self.overrides, changes));
        };
        if set.is_empty() {
            // A recording is not read again.
            return Ok(self.clone());
        }
        Self::of(self.source.clone(), merged(&self.overrides, changes))
    }
}
