//! Results of all faults, as a page of the book.

use crate::faults::fault::Fault;
use crate::faults::outcome::Outcome;
use std::collections::BTreeSet;
use std::fmt::Write;

/// One fault in a line.
pub fn line(outcome: &Outcome) -> String {
    let cases: Vec<&str> = outcome.noticed_by().map(|case| case.id.as_str()).collect();
    let cases = if cases.is_empty() {
        "no case".to_owned()
    } else {
        cases.join(" ")
    };
    let test = match (&outcome.test, outcome.tested) {
        (Some(test), _) => test,
        (None, true) => "no test of the model",
        (None, false) => "tests not run",
    };
    format!("{}: {cases}; {test}", outcome.name)
}

/// Number of faults that are noticed, in a line.
pub fn totals(outcomes: &[(Fault, Outcome)]) -> String {
    let by_cases = outcomes.iter().filter(|(_, o)| o.noticed_by().count() > 0);
    let tested = outcomes.iter().filter(|(_, o)| o.tested).count();
    let by_tests = outcomes.iter().filter(|(_, o)| o.test.is_some()).count();
    let tests = match tested {
        0 => "the model's tests were not run".to_owned(),
        all if all == outcomes.len() => format!("the model's tests {by_tests}"),
        some => format!("the model's tests {by_tests} of the {some} that they were run on"),
    };
    format!(
        "{} planted faults: the catalogue notices {}; {tests}.",
        outcomes.len(),
        by_cases.count(),
    )
}

/// The page.
pub fn page(outcomes: &[(Fault, Outcome)]) -> String {
    let mut text = String::from(
        "# Planted faults\n\n\
         Made by `cargo run -p crepitus-tools --bin crepitus-faults -- --page docs/generated/planted-faults.md`, which puts one fault at a time into a\n\
         copy of the model and runs the [hard cases](hard-cases.md) and the model's tests on it. A check that never\n\
         fails shows nothing; this page shows which check fails for what.\n\n",
    );
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{}\n", totals(outcomes));
    unseen(&mut text, outcomes);
    text.push_str("\n## Fault by fault\n\n| fault | what is wrong | hard cases | first test of the model |\n|---|---|---|---|\n");
    for (fault, outcome) in outcomes {
        let ids: Vec<&str> = outcome.noticed_by().map(|case| case.id.as_str()).collect();
        let cases = match ids.as_slice() {
            [] => "none".to_owned(),
            [a, b, c, _, rest @ ..] if !rest.is_empty() => {
                format!("{a} {b} {c} and {} more", rest.len() + 1)
            }
            few => few.join(" "),
        };
        let unseen = if outcome.tested { "none" } else { "not run" };
        let test = outcome.test.as_deref().unwrap_or(unseen);
        let _ = writeln!(
            text,
            "| `{}` | {} ({}) | {cases} | {test} |",
            fault.name, fault.what, fault.file
        );
    }
    matrix(&mut text, outcomes);
    text
}

/// The faults that one side does not detect, with the reason.
fn unseen(text: &mut String, outcomes: &[(Fault, Outcome)]) {
    for (fault, outcome) in outcomes {
        let sides = [
            (
                outcome.noticed_by().count() == 0,
                "the hard cases",
                &fault.unseen_by_cases,
            ),
            (
                outcome.tested && outcome.test.is_none(),
                "the model's tests",
                &fault.unseen_by_tests,
            ),
        ];
        for (_, who, why) in sides.into_iter().filter(|(is_unseen, ..)| *is_unseen) {
            let why = why.as_deref().unwrap_or("a hole");
            let _ = writeln!(text, "- `{}` is not noticed by {who}: {why}", fault.name);
        }
    }
}

/// The matrix: a line a fault, a column a case that detects some fault.
fn matrix(text: &mut String, outcomes: &[(Fault, Outcome)]) {
    let ids: BTreeSet<&str> = outcomes
        .iter()
        .flat_map(|(_, outcome)| outcome.noticed_by())
        .map(|case| case.id.as_str())
        .collect();
    let width = outcomes
        .iter()
        .map(|(f, _)| f.name.len())
        .max()
        .unwrap_or(0);
    text.push_str("\n## Fault × case\n\nColumns are the cases that notice something, their numbers from top to bottom.\n\n```text\n");
    let longest = ids.iter().map(|id| id.len()).max().unwrap_or(0);
    for place in 1..longest {
        let digits: String = ids
            .iter()
            .map(|id| id.chars().nth(place).unwrap_or(' '))
            .collect();
        let _ = writeln!(
            text,
            "{:width$} {digits} tests",
            if place == 1 { "H" } else { "" }
        );
    }
    for (fault, outcome) in outcomes {
        let marks: String = ids
            .iter()
            .map(|id| {
                let notices = outcome.noticed_by().any(|case| case.id == *id);
                if notices { '#' } else { '·' }
            })
            .collect();
        let test = match (&outcome.test, outcome.tested) {
            (Some(_), _) => '#',
            (None, true) => '·',
            (None, false) => '?',
        };
        let _ = writeln!(text, "{:width$} {marks} {test}", fault.name);
    }
    text.push_str("```\n");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faults::outcome::CaseOutcome;

    fn tried(name: &str, noticed: bool) -> (Fault, Outcome) {
        let fault = Fault {
            name: name.to_owned(),
            what: "a sign".to_owned(),
            file: "model/src/solver/frozen.rs".to_owned(),
            text: "+".to_owned(),
            with: "-".to_owned(),
            unseen_by_cases: (!noticed).then(|| "nothing changes".to_owned()),
            unseen_by_tests: None,
        };
        let case = |id: &str, found: bool| CaseOutcome {
            id: id.to_owned(),
            found: found.then(|| "broken: other torque bits".to_owned()),
        };
        let outcome = Outcome {
            name: name.to_owned(),
            fingerprint: 1,
            tested: true,
            cases: vec![case("H01", false), case("H10", noticed)],
            test: noticed.then(|| "laws: mirror".to_owned()),
        };
        (fault, outcome)
    }

    #[test]
    fn a_page_says_what_noticed_and_why_not() {
        let outcomes = [tried("sign", true), tried("silent", false)];
        let text = page(&outcomes);
        assert!(text.contains("2 planted faults: the catalogue notices 1; the model's tests 1."));
        assert!(
            text.contains("| `sign` | a sign (model/src/solver/frozen.rs) | H10 | laws: mirror |")
        );
        assert!(text.contains("- `silent` is not noticed by the hard cases: nothing changes"));
        assert!(text.contains("- `silent` is not noticed by the model's tests: a hole"));
        let mut later = tried("later", true);
        (later.1.tested, later.1.test) = (false, None);
        let untested = page(&[later]);
        assert!(
            untested.contains("the model's tests were not run") && untested.contains("| not run |")
        );
        assert!(!untested.contains("a hole"), "{untested}");
        assert!(
            text.contains("H      1 tests\n       0 tests\nsign   # #\nsilent · ·\n"),
            "{text}"
        );
    }
}
