//! Results of all faults, as a page of the book.

use crate::faults::outcome::Outcome;
use crate::faults::patch::Fault;
use std::fmt::Write;

/// Page of all faults, from the root of the repository.
pub const FILE: &str = "docs/generated/planted-faults.md";

/// Command that tries faults.
pub const COMMAND: &str = "cargo run -p crepitus-tools --bin crepitus-faults";

/// One fault in a line.
pub fn line(fault: &Fault) -> String {
    let name = &fault.name;
    match (&fault.result, &fault.unseen) {
        (Some(Outcome::Noticed(by)), _) => format!("{name}: noticed by {by}"),
        (Some(Outcome::NotNoticed), Some(why)) => format!("{name}: cannot be noticed: {why}"),
        (Some(Outcome::NotNoticed), None) => format!("{name}: NOT NOTICED"),
        (None, _) => format!(
            "{name}: NO RESULT: its patch was not tried as it is (`{COMMAND} -- {name}`), \
             or does not build (logs/{name}-*.txt)"
        ),
    }
}

/// Returns whether something has to be done: the fault has no result, or it is not noticed and
/// nobody says why.
pub fn is_hole(fault: &Fault) -> bool {
    match fault.result {
        Some(Outcome::Noticed(_)) => false,
        Some(Outcome::NotNoticed) => fault.unseen.is_none(),
        None => true,
    }
}

/// The page, of faults in the order of their areas.
pub fn page(faults: &[Fault]) -> String {
    let mut text = format!(
        "# Planted faults\n\n\
         Made by `{COMMAND}`, which applies one patch of [`tools/faults`](../../tools/faults) at a\n\
         time to a copy of the sources, runs the test that the patch names, and writes the result into the patch. A test that never fails\n\
         shows nothing; this page shows which test fails for what. Faults of the firmware are in images that the emulator runs: modelled\n\
         silicon, not hardware. `cargo test -p crepitus-tools --test faults` compares this page with the patches.\n\n"
    );
    let noticed = |fault: &&Fault| matches!(fault.result, Some(Outcome::Noticed(_)));
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{} planted faults: {} are noticed, {} not tried.\n",
        faults.len(),
        faults.iter().filter(noticed).count(),
        faults.iter().filter(|fault| fault.result.is_none()).count()
    );
    let not_noticed = |fault: &&Fault| fault.result == Some(Outcome::NotNoticed);
    for fault in faults.iter().filter(not_noticed) {
        let why = fault.unseen.as_deref().unwrap_or("a hole");
        let _ = writeln!(text, "- `{}` is not noticed: {why}", fault.name);
    }
    for area in faults.chunk_by(|a, b| a.area == b.area) {
        let name = area.first().map_or("", |fault| fault.area.as_str());
        let _ = writeln!(
            text,
            "\n## {name}\n\n| fault | what is wrong | file | noticed by |\n|---|---|---|---|"
        );
        for fault in area {
            let what = fault.what.replace('|', "\\|");
            let files: Vec<&str> = fault.changed_files().collect();
            let files = if files.is_empty() {
                "the image".to_owned()
            } else {
                files.join(", ")
            };
            let by = match &fault.result {
                Some(Outcome::Noticed(by)) => format!("`{by}`"),
                Some(Outcome::NotNoticed) => "nothing".to_owned(),
                None => "not tried".to_owned(),
            };
            let _ = writeln!(text, "| `{}` | {what} | {files} | {by} |", fault.name);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn tried(area: &str, name: &str, why: &str, result: Option<Outcome>) -> Fault {
        let file = format!("tools/faults/{area}/{name}.patch");
        let text = format!("What: |a sign|\n{why}\n\n--- a/model/a.rs\n+++ b/model/a.rs\n");
        let mut fault = Fault::parse(Path::new(&file), &text).unwrap();
        fault.result = result;
        fault
    }

    #[test]
    fn a_page_says_what_noticed_and_why_not() {
        let noticed = Outcome::Noticed("laws: mirror".to_owned());
        let (test, nothing) = ("Noticed-by: -p a", Outcome::NotNoticed);
        let all = [
            tried("firmware", "pin", test, Some(noticed)),
            tried("model", "new", test, None),
            tried("model", "open", test, Some(nothing.clone())),
            tried("model", "silent", "Unseen: no change", Some(nothing)),
        ];
        assert_eq!(all.each_ref().map(is_hole), [false, true, true, false]);
        let lines = all.each_ref().map(line);
        assert_eq!(lines[0], "pin: noticed by laws: mirror");
        assert!(lines[1].contains("-- new`"), "{}", lines[1]);
        assert_eq!(lines[2], "open: NOT NOTICED");
        assert_eq!(lines[3], "silent: cannot be noticed: no change");
        let text = page(&all);
        for part in [
            "4 planted faults: 1 are noticed, 1 not tried.",
            "- `open` is not noticed: a hole\n- `silent` is not noticed: no change\n",
            "## firmware\n\n| fault ",
            "| `pin` | \\|a sign\\| | model/a.rs | `laws: mirror` |\n\n## model\n",
            "| `new` | \\|a sign\\| | model/a.rs | not tried |\n",
            "| `open` | \\|a sign\\| | model/a.rs | nothing |\n",
        ] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
    }
}
