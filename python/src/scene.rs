//! Scene with overrides.

use crate::{errors, values};
use crepitus_scene::shipped::Source;
use crepitus_scene::{Overrides, SceneError};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyType};
use std::path::PathBuf;

/// File name of a scene without a file.
const DICT: &str = "<dict>";
const TEXT: &str = "<toml>";

/// Everything that decides a run, checked: motion, solver, effects, output.
///
/// A scene does not change; `with_` and `set` make another one.
#[pyclass(frozen, module = "crepitus")]
#[derive(Clone)]
pub(crate) struct Scene {
    pub(crate) source: Source,
    /// Whether it was made from a dict, so that errors name no lines.
    pub(crate) is_dict: bool,
    pub(crate) overrides: Overrides,
    pub(crate) checked: crepitus_scene::Scene,
}

impl Scene {
    fn of(source: Source, is_dict: bool, overrides: Overrides) -> PyResult<Self> {
        let checked = source
            .scene(&overrides)
            .map_err(|error| errors::scene(error, is_dict))?;
        Ok(Self {
            source,
            is_dict,
            overrides,
            checked,
        })
    }

    /// Returns an error in the form of the scene's own ones.
    pub(crate) fn refused(&self, key: &str, message: String) -> PyErr {
        let error = SceneError {
            file: self.checked.file.clone(),
            origin: None,
            key: key.to_owned(),
            message,
        };
        errors::scene(error, self.is_dict)
    }
}

/// Returns overrides like those of the tool's flags. The scene checks the numbers.
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

/// Merges overrides; the later ones win.
fn merged(first: &Overrides, then: Overrides) -> Overrides {
    let mut both = first.clone();
    forget(&mut both, then.set.iter().map(|(path, _)| path.as_str()));
    both.solver = then.solver.or(both.solver);
    both.step = then.step.or(both.step);
    both.precision = then.precision.or(both.precision);
    both.as_device |= then.as_device;
    both.set.extend(then.set);
    both
}

/// Removes the flags that would take precedence over a value at one of these keys.
pub(crate) fn forget<'p>(overrides: &mut Overrides, paths: impl Iterator<Item = &'p str>) {
    for path in paths {
        let is = |key: &str| path == key || path == "solver";
        overrides.solver.take_if(|_| is("solver.kind"));
        overrides.step.take_if(|_| is("solver.step_s"));
        overrides.precision.take_if(|_| is("solver.precision"));
        overrides.as_device &= path != "device";
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
            let text = toml::to_string(&values::table(dict)?)
                .map_err(|error| PyTypeError::new_err(error.to_string()))?;
            return Self::of(Source::of_text(DICT.into(), text), true, changes);
        }
        if !source.is_instance_of::<PyString>() && !source.hasattr("__fspath__")? {
            let kind = source.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "a scene is a path, the name of one that ships, a dict or a Scene, not {kind}"
            )));
        }
        let path: PathBuf = source.extract()?;
        let source = Source::find(&path).map_err(|error| errors::scene(error, false))?;
        Self::of(source, false, changes)
    }

    /// A scene from TOML text; `file` names it in errors, and is the place from which a
    /// recording's path is relative.
    #[classmethod]
    #[pyo3(signature = (text, file=None))]
    fn from_toml(_: &Bound<'_, PyType>, text: String, file: Option<PathBuf>) -> PyResult<Self> {
        let file = file.unwrap_or_else(|| TEXT.into());
        Self::of(Source::of_text(file, text), false, Overrides::default())
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

    /// This scene with a motion of samples, s and rad, for as long as they last.
    fn with_motion(
        &self,
        time_s: PyReadonlyArray1<'_, f64>,
        angle_rad: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Self> {
        let numbers = |array: &PyReadonlyArray1<'_, f64>| -> toml::Value {
            array.as_array().iter().copied().collect::<Vec<_>>().into()
        };
        let mut text: toml::Table = (self.source.text)
            .parse()
            .map_err(|error: toml::de::Error| PyValueError::new_err(error.to_string()))?;
        let times = time_s.as_array();
        let duration_s = match (times.first(), times.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        };
        let mut motion = toml::Table::new();
        motion.insert("kind".to_owned(), "recording".into());
        motion.insert("time_s".to_owned(), numbers(&time_s));
        motion.insert("angle_rad".to_owned(), numbers(&angle_rad));
        text.insert("motion".to_owned(), motion.into());
        if duration_s > 0.0 && duration_s.is_finite() {
            text.insert("duration_s".to_owned(), duration_s.into());
        }
        let text =
            toml::to_string(&text).map_err(|error| PyValueError::new_err(error.to_string()))?;
        let mut overrides = self.overrides.clone();
        let is_replaced =
            |path: &str| path == "duration_s" || path.split('.').next() == Some("motion");
        overrides.set.retain(|(path, _)| !is_replaced(path));
        let source = Source::of_text(self.source.file.clone(), text);
        Self::of(source, true, overrides)
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

    /// Description, if there is one.
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

    /// Warnings about questionable values.
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

    fn _repr_html_(slf: Bound<'_, Self>) -> PyResult<Bound<'_, PyAny>> {
        let html = slf.py().import("crepitus._html")?;
        html.call_method1("scene", (slf,))
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

    /// Supports `pickle` and `copy`: other processes get the text, not the file.
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
        Ok((rebuild, (file, text, self.is_dict, flags, o.set.clone())))
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
        Self::of(Source::of_text(file, text), is_dict, overrides)
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
            return Self::of(
                self.source.clone(),
                self.is_dict,
                merged(&self.overrides, changes),
            );
        };
        if set.is_empty() {
            // A recording is not read again.
            return Ok(self.clone());
        }
        Self::of(
            self.source.clone(),
            self.is_dict,
            merged(&self.overrides, changes),
        )
    }
}
