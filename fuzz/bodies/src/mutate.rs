//! Changes of an input that bytes alone rarely hit: the same motion on another
//! rung of the ladder, another key of a scene. What one input has found, every
//! rung and every effect is then tried with.

use crepitus_model::parameters::{ParameterSpec, Tabled};
use crepitus_model::render::effects::SPECS;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, Restart};

/// One change in so many is one of these.
pub const ONE_IN: u32 = 4;

/// Another convention, solver and precision: see `Rung::of`.
pub fn other_rung(data: &mut [u8], seed: u32) {
    let [_, convention, solver, precision] = seed.to_le_bytes();
    for (byte, new) in data.iter_mut().zip([convention, solver, precision]) {
        *byte = new;
    }
}

/// The text of a scene with one key set to another value, in a line that the
/// target reads as `--set`; `None` where the bytes are no text.
pub fn other_key(data: &[u8], seed: u32) -> Option<Vec<u8>> {
    let text = std::str::from_utf8(data).ok()?;
    let keys = keys();
    let seed = usize::try_from(seed).ok()?;
    let (path, values) = keys.get(seed % keys.len())?;
    let value = values.get(seed / keys.len() % values.len())?;
    let set = format!("#set {path}=");
    let kept = text.lines().filter(|line| !line.starts_with(&set));
    let mut lines: Vec<_> = kept.collect();
    let new = format!("{set}{value}");
    lines.push(&new);
    Some((lines.join("\n") + "\n").into_bytes())
}

/// Keys of a scene that a solver and the model's effects have, each with values
/// that are allowed.
pub fn keys() -> Vec<(String, Vec<String>)> {
    let names = |names: &[&str]| names.iter().map(|n| format!("{n:?}")).collect::<Vec<_>>();
    let mut solvers = Solver::ALL.map(Solver::name).to_vec();
    solvers.push("reference");
    let mut keys = vec![
        ("solver.kind".to_owned(), names(&solvers)),
        ("solver.precision".to_owned(), names(&["f32", "f64"])),
        ("solver.step_s".to_owned(), vec!["5e-5".to_owned()]),
        (
            "device".to_owned(),
            vec!["true".to_owned(), "false".to_owned()],
        ),
        (
            "effects.crepitus.convention".to_owned(),
            names(&Convention::ALL.map(Convention::name)),
        ),
        (
            "effects.crepitus.restart".to_owned(),
            names(&Restart::ALL.map(Restart::name)),
        ),
    ];
    let numbers = |name: &str, parameters: &[ParameterSpec]| {
        let key = |p: &ParameterSpec| {
            let values = [p.default, p.min, p.max, f64::midpoint(p.min, p.max)];
            let key = format!("effects.{name}.{}", p.key);
            (key, values.map(|v| format!("{v:?}")).to_vec())
        };
        parameters.iter().map(key).collect::<Vec<_>>()
    };
    keys.extend(numbers("crepitus", Parameters::TABLE));
    for spec in SPECS {
        keys.extend(numbers(spec.name, spec.parameters));
        keys.extend(spec.choices.iter().map(|choice| {
            let key = format!("effects.{}.{}", spec.name, choice.key);
            (key, names(choice.names))
        }));
    }
    keys
}

#[cfg(test)]
mod tests {
    use super::{keys, other_key, other_rung};
    use crate::bytes::Bytes;
    use crate::rung::Rung;
    use crepitus_scene::{Overrides, Scene};
    use std::collections::HashSet;
    use std::path::Path;

    #[test]
    fn every_key_is_one_of_a_scene() {
        let text = include_str!("../../corpus/scene/seed-set");
        for (path, values) in keys() {
            for value in values {
                let overrides = Overrides {
                    set: vec![(path.clone(), value.clone())],
                    ..Overrides::default()
                };
                if let Err(e) = Scene::parse(Path::new("scene.toml"), text, &overrides) {
                    // Alone a value may break a rule, or need another effect.
                    let message = e.message;
                    assert!(!message.contains("no such"), "{path}={value}: {message}");
                }
            }
        }
    }

    #[test]
    fn a_key_is_set_once() {
        let first = other_key(b"version = 1", 0).expect("text");
        let again = other_key(&first, 0).expect("text");
        assert_eq!(first, again);
        assert!(first.ends_with(b"#set solver.kind=\"euler\"\n"));
        assert_eq!(other_key(b"\xff", 0), None);
    }

    #[test]
    fn all_rungs_are_reached() {
        let mut rungs = HashSet::new();
        for n in 0..10_000_u32 {
            let mut data = [7; 64];
            other_rung(&mut data, n.wrapping_mul(0x9e37_79b9));
            let rung = Rung::of(&mut Bytes::new(&data));
            rungs.insert((
                rung.settings.convention.name(),
                rung.solver.name(),
                rung.double,
            ));
        }
        let ladder: usize = super::Convention::ALL
            .into_iter()
            .map(|convention| {
                let solvers = super::Solver::ALL.into_iter();
                let fit = solvers.filter(|s| s.refusal(convention).is_none());
                fit.map(|s| 1 + usize::from(s.single_refusal().is_none()))
                    .sum::<usize>()
            })
            .sum();
        assert_eq!(rungs.len(), ladder);
    }
}
