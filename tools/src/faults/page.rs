//! Results of all faults, as a page of the book.

use crate::faults::outcome::Outcome;
use crate::faults::patch::Fault;
use std::fmt::Write;

/// A fault and its outcome.
pub type Tried = (Fault, Outcome);

/// One fault in a line.
pub fn line((fault, outcome): &Tried) -> String {
    let name = &fault.name;
    match (outcome, &fault.unseen) {
        (Outcome::Noticed(by), _) => format!("{name}: noticed by {by}"),
        (Outcome::NotNoticed, Some(why)) => format!("{name}: cannot be noticed: {why}"),
        (Outcome::NotNoticed, None) => format!("{name}: NOT NOTICED"),
        (Outcome::DoesNotBuild, _) => format!("{name}: does not build: see logs/{name}-*.txt"),
    }
}

/// Returns whether something has to be done: the fault is not noticed and nobody says why, or it
/// does not build.
pub fn is_hole((fault, outcome): &Tried) -> bool {
    match outcome {
        Outcome::Noticed(_) => false,
        Outcome::NotNoticed => fault.unseen.is_none(),
        Outcome::DoesNotBuild => true,
    }
}

/// Number of faults that are noticed, in a line.
pub fn totals(tried: &[Tried]) -> String {
    let noticed = tried.iter().filter(|(_, outcome)| is_noticed(outcome));
    format!(
        "{} planted faults: {} are noticed.",
        tried.len(),
        noticed.count()
    )
}

fn is_noticed(outcome: &Outcome) -> bool {
    matches!(outcome, Outcome::Noticed(_))
}

/// The page, of faults in the order of their areas.
pub fn page(tried: &[Tried]) -> String {
    let mut text = String::from(
        "# Planted faults\n\n\
         Made by `cargo run -p crepitus-tools --bin crepitus-faults -- --page docs/generated/planted-faults.md`, which applies one patch of\n\
         [`tools/faults`](../../tools/faults) at a time to a copy of the sources and runs the test that the patch names. A test that never\n\
         fails shows nothing; this page shows which test fails for what. Faults of the firmware are in images that the emulator runs:\n\
         modelled silicon, not hardware.\n\n",
    );
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{}\n", totals(tried));
    for (fault, _) in tried.iter().filter(|(_, outcome)| !is_noticed(outcome)) {
        let why = fault.unseen.as_deref().unwrap_or("a hole");
        let _ = writeln!(text, "- `{}` is not noticed: {why}", fault.name);
    }
    for area in tried.chunk_by(|(a, _), (b, _)| a.area == b.area) {
        let name = area.first().map_or("", |(fault, _)| fault.area.as_str());
        let _ = writeln!(
            text,
            "\n## {name}\n\n| fault | what is wrong | file | noticed by |\n|---|---|---|---|"
        );
        for (fault, outcome) in area {
            let what = fault.what.replace('|', "\\|");
            let files: Vec<&str> = fault.changed_files().collect();
            let files = if files.is_empty() {
                "the image".to_owned()
            } else {
                files.join(", ")
            };
            let by = match outcome {
                Outcome::Noticed(by) => format!("`{by}`"),
                Outcome::NotNoticed => "nothing".to_owned(),
                Outcome::DoesNotBuild => "the compiler".to_owned(),
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

    fn tried(area: &str, name: &str, why: &str, outcome: Outcome) -> Tried {
        let file = format!("tools/faults/{area}/{name}.patch");
        let text = format!("What: |a sign|\n{why}\n\n--- a/model/a.rs\n+++ b/model/a.rs\n");
        (Fault::parse(Path::new(&file), &text).unwrap(), outcome)
    }

    #[test]
    fn a_page_says_what_noticed_and_why_not() {
        let noticed = Outcome::Noticed("laws: mirror".to_owned());
        let all = [
            tried("firmware", "pin", "Noticed-by: -p a", noticed),
            tried("model", "open", "Noticed-by: -p a", Outcome::NotNoticed),
            tried("model", "silent", "Unseen: no change", Outcome::NotNoticed),
        ];
        assert_eq!(all.each_ref().map(is_hole), [false, true, false]);
        let text = page(&all);
        for part in [
            "3 planted faults: 1 are noticed.",
            "- `open` is not noticed: a hole\n- `silent` is not noticed: no change\n",
            "## firmware\n\n| fault ",
            "| `pin` | \\|a sign\\| | model/a.rs | `laws: mirror` |\n\n## model\n",
            "| `open` | \\|a sign\\| | model/a.rs | nothing |\n",
        ] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        let lines = all.each_ref().map(line);
        assert_eq!(lines[0], "pin: noticed by laws: mirror");
        assert_eq!(lines[1], "open: NOT NOTICED");
        assert_eq!(lines[2], "silent: cannot be noticed: no change");
    }
}
