//! Runs of a symptom's scene in three ways, and what is read off them.

use crepitus_plant::Extremes;
use crepitus_scene::run::columns;
use crepitus_scene::trace::SymptomEvent;
use crepitus_scene::{Observer, Overrides, Scene, run};
use std::convert::Infallible;
use std::path::Path;

/// Time between the rows of a run, s.
const ROW_S: f64 = 5e-5;

/// Way of running a scene, and the tolerances within which it keeps its promises.
pub(crate) struct Way {
    pub(crate) name: &'static str,
    set: &'static [(&'static str, &'static str)],
    solver: Option<&'static str>,
    /// An event's angle.
    pub(crate) angle_rad: f64,
    /// Lateness of a decision that depends on the velocity, s.
    pub(crate) late_s: f64,
    /// A torque.
    pub(crate) torque_nm: f64,
    pub(crate) is_counted: bool,
}

/// `reference`, the device's stepping, and that behind its encoder.
pub(crate) const WAYS: [Way; 3] = [
    Way {
        name: "reference",
        set: &[],
        solver: Some("reference"),
        angle_rad: 1e-9,
        late_s: 1e-9,
        torque_nm: 1e-9,
        is_counted: false,
    },
    Way {
        name: "20 kHz, f32",
        set: &[("solver.precision", "\"f32\"")],
        solver: None,
        angle_rad: 1e-6,
        late_s: 1e-6,
        torque_nm: 5e-5,
        is_counted: false,
    },
    Way {
        name: "behind counts",
        set: &[
            ("solver.precision", "\"f32\""),
            ("effects.encoder.lines", "512"),
        ],
        solver: None,
        // A count.
        angle_rad: 3.567e-5,
        late_s: 10e-3,
        torque_nm: 5e-5,
        is_counted: true,
    },
];

/// A scene that ships.
pub(crate) fn shipped(way: &Way, name: &str) -> PromiseRun {
    shipped_with(way, name, &[])
}

/// A scene that ships, with some keys set.
pub(crate) fn shipped_with(way: &Way, name: &str, set: &[(&str, &str)]) -> PromiseRun {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let file = folder.join(format!("{name}.toml"));
    let text = std::fs::read_to_string(&file).unwrap();
    found(way, &file, &text, set)
}

/// A scene of this length, of the keys of its motion and the tables of its effects.
pub(crate) fn of(way: &Way, duration_s: f64, motion_and_effects: &str) -> PromiseRun {
    let text = format!(
        "version = 1\ntitle = \"a promise\"\nduration_s = {duration_s:?}\n\
         solver.kind = \"exact-events\"\nsolver.step_s = 5e-5\n[motion]\n{motion_and_effects}\n"
    );
    found(way, Path::new("promise.toml"), &text, &[])
}

fn found(way: &Way, file: &Path, text: &str, set: &[(&str, &str)]) -> PromiseRun {
    let own = |(key, value): &(&str, &str)| ((*key).to_owned(), (*value).to_owned());
    let mut overrides = Overrides {
        solver: way.solver.map(str::to_owned),
        set: way.set.iter().chain(set).map(own).collect(),
        ..Overrides::default()
    };
    let row_s = ROW_S.to_string();
    overrides
        .set
        .push(("output.trace_step_s".to_owned(), row_s));
    let scene = Scene::parse(file, text, &overrides)
        .unwrap_or_else(|error| panic!("{}: {error}", way.name));
    let mut found = PromiseRun {
        names: columns(&scene).iter().map(|c| c.name).collect(),
        ..PromiseRun::default()
    };
    let Ok(_) = run(&scene, &mut found) else {
        panic!("{}: did not run", way.name);
    };
    found
}

/// A run.
#[derive(Default)]
pub(crate) struct PromiseRun {
    names: Vec<&'static str>,
    rows: Vec<Vec<f64>>,
    pub(crate) events: Vec<SymptomEvent>,
}

impl Observer for PromiseRun {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        self.rows.push(values.to_vec());
        Ok(())
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Infallible> {
        self.events.push(*event);
        Ok(())
    }
}

impl PromiseRun {
    fn place(&self, name: &str) -> usize {
        let place = self.names.iter().position(|n| *n == name);
        place.unwrap_or_else(|| panic!("{name} of {:?}", self.names))
    }

    pub(crate) fn column(&self, name: &str) -> Vec<f64> {
        let place = self.place(name);
        self.rows.iter().map(|row| row[place]).collect()
    }

    pub(crate) fn highest(&self, name: &str) -> f64 {
        self.span(name, 0.0, f64::INFINITY).1
    }

    /// The lowest and the highest value of a column between two times.
    pub(crate) fn span(&self, name: &str, from_s: f64, to_s: f64) -> (f64, f64) {
        let place = self.place(name);
        let rows = self
            .rows
            .iter()
            .filter(|row| (from_s..to_s).contains(&row[0]));
        let Extremes { low, high }: Extremes<f64> = rows.map(|row| row[place]).collect();
        (low, high)
    }

    /// A column at a time, linear between rows.
    pub(crate) fn at(&self, name: &str, time_s: f64) -> f64 {
        let place = self.place(name);
        let after = self.rows.partition_point(|row| row[0] <= time_s);
        let (a, b) = (&self.rows[after - 1], &self.rows[after]);
        a[place] + (b[place] - a[place]) * (time_s - a[0]) / (b[0] - a[0])
    }

    /// ∫T dφ, row by row.
    fn works_j(&self, name: &str, from_s: f64, to_s: f64) -> impl Iterator<Item = f64> {
        let (place, angle) = (self.place(name), self.place("angle_rad"));
        let half_s = 0.5 * ROW_S;
        self.rows.windows(2).filter_map(move |pair| {
            let is_within = pair[0][0] > from_s - half_s && pair[1][0] < to_s + half_s;
            let torque_nm = f64::midpoint(pair[0][place], pair[1][place]);
            is_within.then(|| torque_nm * (pair[1][angle] - pair[0][angle]))
        })
    }

    /// Work that a torque has taken from the hand between two times, J.
    pub(crate) fn work_j(&self, name: &str, from_s: f64, to_s: f64) -> f64 {
        self.works_j(name, from_s, to_s).sum()
    }

    /// The most that a torque has given back in one go, J.
    pub(crate) fn most_returned_j(&self, name: &str) -> f64 {
        let (mut taken, mut most_taken, mut returned) = (0.0, 0.0_f64, 0.0_f64);
        for work_j in self.works_j(name, f64::NEG_INFINITY, f64::INFINITY) {
            taken += work_j;
            most_taken = most_taken.max(taken);
            returned = returned.max(most_taken - taken);
        }
        returned
    }

    pub(crate) fn first(&self, word: &str) -> SymptomEvent {
        let event = self.events.iter().find(|e| e.word.name() == word);
        *event.unwrap_or_else(|| panic!("no {word}"))
    }

    pub(crate) fn times(&self, word: &str) -> Vec<f64> {
        let own = self.events.iter().filter(|e| e.word.name() == word);
        own.map(|e| e.time_s).collect()
    }

    pub(crate) fn words_within(&self, from_s: f64, to_s: f64) -> Vec<&'static str> {
        let own = self
            .events
            .iter()
            .filter(|e| (from_s..to_s).contains(&e.time_s));
        own.map(|e| e.word.name()).collect()
    }
}

/// Asserts that two numbers agree.
#[track_caller]
pub(crate) fn near(found: f64, expected: f64, within: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= within,
        "{found} for {expected}: {error:e} > {within:e}"
    );
}
