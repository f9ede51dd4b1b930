//! Cases and subjects that the command line asks for.

use super::Arguments;
use crate::failure::Failure;
use crepitus_model::Convention;
use crepitus_scene::scene::Precision;
use crepitus_studies::stability::{Case, Plan, Rung, Subject, catalogue};

pub(super) fn plan(arguments: &Arguments) -> Result<Plan, Failure> {
    Ok(Plan {
        cases: cases(arguments)?,
        subjects: subjects(arguments)?,
    })
}

/// Those that are named, long or not; else all, the long ones if asked for.
fn cases(arguments: &Arguments) -> Result<Vec<Case>, Failure> {
    if arguments.cases.is_empty() {
        let all = catalogue::all().into_iter();
        return Ok(all.filter(|case| arguments.long || !case.long).collect());
    }
    let mut cases: Vec<Case> = Vec::new();
    for name in &arguments.cases {
        let case = catalogue::find(name).map_err(|near| {
            let near = if near.is_empty() {
                String::new()
            } else {
                ["; near it are: ", &near.join(", ")].concat()
            };
            Failure::Input(format!(
                "--case {name}: there is no such case{near}; `crepitus stability --list` lists all"
            ))
        })?;
        if cases.iter().all(|other| other.id != case.id) {
            cases.push(case);
        }
    }
    Ok(cases)
}

fn subjects(arguments: &Arguments) -> Result<Vec<Subject>, Failure> {
    let solvers = chosen("solver", &arguments.solvers, &Rung::all(), Rung::name)?;
    let conventions = chosen(
        "convention",
        &arguments.conventions,
        &Convention::ALL,
        Convention::name,
    )?;
    let subjects: Vec<Subject> = Subject::all()
        .into_iter()
        .filter(|subject| {
            let precision = arguments.precision.as_deref();
            solvers.contains(&subject.solver)
                && conventions.contains(&subject.convention)
                && precision.is_none_or(|name| subject.precision.name() == name)
        })
        .collect();
    if subjects.is_empty() {
        // All chosen combinations are refused.
        let single = arguments.precision.as_deref() == Some(Precision::F32.name());
        let pairs = conventions
            .iter()
            .flat_map(|c| solvers.iter().map(|s| (*s, *c)));
        let reasons: Vec<String> = pairs
            .filter_map(|(solver, convention)| {
                let name = solver.name();
                match solver.refusal(convention) {
                    Some(reason) => Some(format!(
                        "{name} has no meaning under {}: {reason}",
                        convention.name()
                    )),
                    None => solver
                        .single_refusal()
                        .filter(|_| single)
                        .map(|reason| format!("{name} is refused in f32: {reason}")),
                }
            })
            .collect();
        return Err(Failure::Input(reasons.join("\n")));
    }
    Ok(subjects)
}

/// The items of these names, all if there are none.
fn chosen<T: Copy>(
    option: &str,
    names: &[String],
    all: &[T],
    name_of: impl Fn(T) -> &'static str,
) -> Result<Vec<T>, Failure> {
    if names.is_empty() {
        return Ok(all.to_vec());
    }
    names
        .iter()
        .map(|name| {
            let found = all.iter().copied().find(|item| name_of(*item) == name);
            found.ok_or_else(|| {
                let allowed: Vec<_> = all.iter().map(|item| name_of(*item)).collect();
                Failure::Input(format!(
                    "--{option} {name}: allowed are {}",
                    allowed.join(", ")
                ))
            })
        })
        .collect()
}
