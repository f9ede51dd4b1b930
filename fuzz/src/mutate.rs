//! Changes of an input that bytes alone rarely hit: the same motion on another
//! rung of the ladder, another key of a scene, a commit that switches an effect on and a
//! shaft that turns under torque. What one input has found, every rung and every effect is then
//! tried with.

use crepitus_model::parameters::ParameterSpec;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Restart};
use crepitus_plant::effects::EFFECTS;
use crepitus_protocol::parameters::{Kind, PARAMETERS, Parameter};
use fastrand::Rng;

/// One change in so many is one of these.
const ONE_IN: u32 = 4;

/// Makes the change in one case of four, where the result fits: the new size. `data` has room
/// for `max_size` bytes, of which `size` are the input.
pub fn apply(
    data: &mut [u8],
    (size, max_size): (usize, usize),
    seed: u32,
    change: impl FnOnce(&[u8], u32) -> Option<Vec<u8>>,
) -> Option<usize> {
    if !seed.is_multiple_of(ONE_IN) {
        return None;
    }
    let changed = change(data.get(..size)?, seed / ONE_IN)?;
    if changed.len() > max_size {
        return None;
    }
    data.get_mut(..changed.len())?.copy_from_slice(&changed);
    Some(changed.len())
}

/// Another convention, solver and precision: see `Rung::of`.
pub fn other_rung(data: &[u8], seed: u32) -> Option<Vec<u8>> {
    let [convention, solver, precision, _] = seed.to_le_bytes();
    let mut changed = data.to_vec();
    let rung = changed.get_mut(..3)?;
    rung.copy_from_slice(&[convention, solver, precision]);
    Some(changed)
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

/// Encoding of the operations of a target of the device.
struct Operations {
    /// Bytes before the first operation.
    head: usize,
    /// Up to the values of a commit.
    commit: fn(&mut Rng) -> Vec<u8>,
    /// Operations without values: arming, a shaft that turns.
    others: fn(&mut Rng) -> Vec<u8>,
}

/// Operations of `drive.rs`.
const DRIVE: Operations = Operations {
    head: crate::drive::HEAD_BYTES,
    commit: |random| vec![3, random.u8(..)],
    others: |random| match random.usize(..3) {
        0 => vec![8],
        _ => vec![2, random.u8(..), random.u8(..)],
    },
};

/// Operations of `chain.rs`, where nothing was saved.
const CHAIN: Operations = Operations {
    head: 1,
    commit: |random| vec![1, random.u8(..) % 3, 5, 0],
    others: |random| match random.usize(..4) {
        0 => vec![4, random.u8(..) % 3],
        1 => vec![3, random.u8(..) % 3, random.u8(..), random.u8(..)],
        _ => vec![0, random.u8(..), random.u8(..)],
    },
};

/// Some more operations of `drive.rs`.
pub fn drive(data: &[u8], seed: u32) -> Option<Vec<u8>> {
    Some(more_operations(data, &DRIVE, seed))
}

/// Some more operations of `chain.rs`.
pub fn chain(data: &[u8], seed: u32) -> Option<Vec<u8>> {
    Some(more_operations(data, &CHAIN, seed))
}

/// Some more operations before all others, or behind them.
fn more_operations(data: &[u8], operations: &Operations, seed: u32) -> Vec<u8> {
    let mut random = Rng::with_seed(u64::from(seed));
    let mut more = Vec::new();
    for _ in 0..=random.usize(..4) {
        if random.usize(..2) == 0 {
            more.extend((operations.commit)(&mut random));
            more.extend(values_of_an_effect(&mut random));
        } else {
            more.extend((operations.others)(&mut random));
        }
    }
    let (head, rest) = data.split_at(operations.head.min(data.len()));
    if random.usize(..2) == 0 {
        [head, &more, rest].concat()
    } else {
        [head, rest, &more].concat()
    }
}

/// Values as `link_inputs.rs` reads them: an effect that is switched on, and two of its
/// parameters.
fn values_of_an_effect(random: &mut Rng) -> Vec<u8> {
    let groups: Vec<&str> = PARAMETERS
        .iter()
        .filter(|parameter| is_switch(parameter))
        .map(|parameter| parameter.group)
        .collect();
    let group = groups.get(random.usize(..groups.len())).copied();
    let all = (0_u8..).zip(PARAMETERS);
    let of_group: Vec<_> = all.filter(|(_, p)| Some(p.group) == group).collect();
    let switch = of_group.iter().filter(|(_, p)| is_switch(p));
    let mut values = vec![3];
    values.extend(switch.flat_map(|(place, _)| [*place, 1]));
    for _ in 0..2 {
        if let Some((place, parameter)) = of_group.get(random.usize(..of_group.len())) {
            match parameter.kind {
                Kind::Choice(_) => values.extend([*place, random.u8(..) % 3]),
                Kind::Number(_) => {
                    let wide = [random.u8(..), random.u8(..)];
                    let how = random.u8(..) % 240;
                    values.extend([*place, how]);
                    if how >= 120 {
                        values.extend(wide);
                    }
                }
            }
        }
    }
    values
}

/// Returns whether the parameter switches an effect on and off.
fn is_switch(parameter: &Parameter) -> bool {
    matches!(parameter.kind, Kind::Choice(choice) if choice.names == ["off", "on"])
}

/// Keys of a scene that a solver and the effects have, each with values that are allowed.
fn keys() -> Vec<(String, Vec<String>)> {
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
    for spec in EFFECTS {
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
    use super::{
        Convention, DRIVE, PARAMETERS, Parameter, Rng, Solver, apply, is_switch, keys,
        more_operations, other_key, other_rung, values_of_an_effect,
    };
    use crate::bytes::Bytes;
    use crate::link_inputs;
    use crate::rung::Rung;
    use crepitus_scene::{Overrides, Scene};
    use std::collections::HashSet;
    use std::path::Path;

    #[test]
    fn every_key_is_one_of_a_scene() {
        let text = include_str!("../corpus/scene/seed-set");
        for (name, least) in [
            ("effects.crepitus.", 7),
            ("effects.hand.", 2),
            ("solver.", 3),
        ] {
            let count = keys()
                .iter()
                .filter(|(path, _)| path.starts_with(name))
                .count();
            assert!(count >= least, "{name}: {count} keys");
        }
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
    fn one_change_in_four_is_made_where_it_fits() {
        let mut data = [1, 2, 3, 4, 5, 0];
        assert_eq!(apply(&mut data, (5, 6), 5, other_rung), None);
        assert_eq!(apply(&mut data, (2, 6), 4, other_rung), None, "no rung");
        assert_eq!(
            apply(&mut data, (5, 6), 4 * 0x0906_0700, other_rung),
            Some(5)
        );
        assert_eq!(data, [0, 7, 6, 4, 5, 0]);
        let longer = |data: &[u8], _| Some([data, &[9]].concat());
        assert_eq!(apply(&mut data, (5, 5), 0, longer), None);
        assert_eq!(apply(&mut data, (5, 6), 0, longer), Some(6));
    }

    #[test]
    fn a_key_is_set_once() {
        let first = other_key(b"version = 1", 0).expect("text");
        let again = other_key(&first, 0).expect("text");
        assert_eq!(first, again);
        assert!(first.ends_with(b"#set solver.kind=\"euler\"\n"));
        assert_eq!(other_key(b"\xff", 0), None);
    }

    /// Each is read as it was meant: an effect is on, and it is armed.
    #[test]
    fn every_effect_is_switched_on() {
        let mut on = HashSet::new();
        for seed in 0..2_000 {
            let values = values_of_an_effect(&mut Rng::with_seed(seed));
            let mut bytes = Bytes::new(&values);
            let values = link_inputs::values(&mut bytes);
            assert!(bytes.is_empty());
            let changed = PARAMETERS
                .iter()
                .zip(values.0)
                .filter(|(p, v)| *v != p.default());
            on.extend(changed.filter(|(p, _)| is_switch(p)).map(|(p, _)| p.group));
        }
        let off = |p: &&Parameter| is_switch(p) && p.default() == 0.0;
        let mut effects = PARAMETERS.iter().filter(off).map(|p| p.group);
        assert!(effects.all(|effect| on.contains(effect)), "{on:?}");
    }

    #[test]
    fn more_operations_leave_the_others_as_they_are() {
        let data = [1, 2, 3, 4, 5, 6, 7, 8];
        for seed in 0..100 {
            let more = more_operations(&data, &DRIVE, seed);
            assert!(more.len() > data.len());
            assert_eq!(more[..5], data[..5]);
            assert!(more.ends_with(&data[5..]) || more.starts_with(&data));
        }
    }

    #[test]
    fn all_rungs_are_reached() {
        let mut rungs = HashSet::new();
        for n in 0..10_000_u32 {
            let data = other_rung(&[7; 64], n.wrapping_mul(0x9e37_79b9)).expect("a rung");
            let rung = Rung::of(&mut Bytes::new(&data));
            rungs.insert((
                rung.settings.convention.name(),
                rung.solver.name(),
                rung.double,
            ));
        }
        let ladder: usize = Convention::ALL
            .into_iter()
            .map(|convention| {
                let solvers = Solver::ALL.into_iter();
                let fit = solvers.filter(|s| s.refusal(convention).is_none());
                fit.map(|s| 1 + usize::from(s.single_refusal().is_none()))
                    .sum::<usize>()
            })
            .sum();
        assert_eq!(rungs.len(), ladder);
    }
}
