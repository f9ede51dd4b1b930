//! Results of all faults of the firmware, as a page of the book.

use crate::faults::firmware::FirmwareFault;
#[cfg(test)]
use crate::faults::firmware::Program;
use crate::faults::firmware_trial::FirmwareOutcome;
use std::fmt::Write;

/// One fault in a line.
pub fn line(outcome: &FirmwareOutcome) -> String {
    let board = outcome.board.as_ref().map(|what| format!(" [{what}]"));
    let tests = match (&outcome.tests[..], &board) {
        ([], None) => "nothing".to_owned(),
        (all, _) => all.join(" "),
    };
    format!("{}: {tests}{}", outcome.name, board.unwrap_or_default())
}

/// Number of faults that are noticed, in a line.
pub fn totals(outcomes: &[(FirmwareFault, FirmwareOutcome)]) -> String {
    let noticed = outcomes.iter().filter(|(_, outcome)| outcome.is_noticed());
    let board = outcomes
        .iter()
        .filter(|(_, outcome)| outcome.board.is_some());
    format!(
        "{} planted faults: {} are noticed, {} of them by the emulated board itself.",
        outcomes.len(),
        noticed.count(),
        board.count()
    )
}

/// The page.
pub fn page(outcomes: &[(FirmwareFault, FirmwareOutcome)]) -> String {
    let mut text = String::from(
        "# Planted faults of the firmware\n\n\
         Made by `cargo run -p crepitus-tools --bin crepitus-faults -- --firmware --page docs/generated/planted-firmware-faults.md`, which builds one fault at\n\
         a time into a copy of the sources and runs the emulator's tests on the image: modelled silicon, not hardware. Of the drive\n\
         those that look at [registers](registers.md), locks, outputs, tasks, protected memory, the post-mortem record and\n\
         commits run first; of comms those of its registers; the others only on what those do not notice.\n\n",
    );
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{}\n", totals(outcomes));
    for (fault, outcome) in outcomes {
        if !outcome.is_noticed() {
            let why = fault.unseen.as_deref().unwrap_or("a hole");
            let _ = writeln!(text, "- `{}` is not noticed: {why}\n", fault.name);
        }
    }
    text.push_str(
        "What the board says ends every test that runs the image on it; tests are those that fail by themselves.\n\n\
         | fault | what is wrong | the board says | tests that fail |\n|---|---|---|---|\n",
    );
    for (fault, outcome) in outcomes {
        let tests: Vec<String> = outcome
            .tests
            .iter()
            .map(|test| format!("`{test}`"))
            .collect();
        let board = outcome.board.as_deref().unwrap_or("");
        let tests = match &tests[..] {
            [a, b, c, _, rest @ ..] if !rest.is_empty() => {
                format!("{a} {b} {c} and {} more", rest.len() + 1)
            }
            few => few.join(" "),
        };
        let _ = writeln!(
            text,
            "| `{}` | {} | {board} | {tests} |",
            fault.name, fault.what
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_says_what_noticed_and_why_not() {
        let tried = |name: &str, tests: &[&str]| {
            let fault = FirmwareFault {
                program: Program::Drive,
                name: name.to_owned(),
                what: "a pin".to_owned(),
                edit: Vec::new(),
                image: None,
                unseen: None,
            };
            let outcome = FirmwareOutcome {
                name: name.to_owned(),
                fingerprint: 1,
                tests: tests.iter().map(|test| (*test).to_owned()).collect(),
                board: None,
            };
            (fault, outcome)
        };
        let outcomes = [tried("pin", &["a", "b"]), tried("silent", &[])];
        let text = page(&outcomes);
        assert!(
            text.contains(
                "2 planted faults: 1 are noticed, 0 of them by the emulated board itself."
            ),
            "{text}"
        );
        assert!(text.contains("| `pin` | a pin |  | `a` `b` |"), "{text}");
        assert!(text.contains("- `silent` is not noticed: a hole"), "{text}");
    }
}
