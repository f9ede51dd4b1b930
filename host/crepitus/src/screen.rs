//! The printed form of a study: its answer first, and no more than a screen holds. `--all` prints the rest.

use clap::Args;
use crepitus_pages::words::{WIDTH, wrapped};

/// Lines that are printed without `--all`.
pub(crate) const LINES: usize = 25;

// How much is printed; shared by the studies. No doc comment: it would replace the text of the verb.
#[derive(Clone, Copy, Debug, Default, Args)]
pub(crate) struct All {
    /// Print everything, not only the answer and what a screen holds.
    #[arg(long)]
    pub(crate) all: bool,
}

impl All {
    /// The text, or as many of its lines as a screen holds.
    pub(crate) fn limited(self, text: &str) -> String {
        let count = text.lines().count();
        if self.all || count <= LINES {
            return text.to_owned();
        }
        let shown = LINES - 1;
        let lines: Vec<&str> = text.lines().take(shown).collect();
        lines.join("\n") + "\n" + &more(count - shown)
    }
}

fn more(hidden: usize) -> String {
    format!("… and {hidden} lines more: --all\n")
}

/// The answer, as much of a table as there is room for, and the last line.
pub(crate) fn screen(answer: &str, table: &str, last: &str) -> String {
    let mut lines: Vec<String> = answer
        .lines()
        .flat_map(|paragraph| wrapped(paragraph, WIDTH))
        .collect();
    lines.push(String::new());
    let room = LINES.saturating_sub(lines.len() + 2);
    let rows: Vec<&str> = table.lines().collect();
    let fits = rows.len() <= room;
    let shown = if fits { room } else { room.saturating_sub(1) };
    lines.extend(rows.iter().take(shown).map(|row| (*row).to_owned()));
    if !fits {
        lines.push(more(rows.len() - shown).trim_end().to_owned());
    }
    lines.push(String::new());
    lines.push(last.to_owned());
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_counted() {
        let rows = |count: usize| "row\n".repeat(count);
        // What a text says of lines that are left out.
        let said = |text: &str| {
            let mut lines = text.split_inclusive('\n');
            let line = lines.find(|line| line.contains("lines more"));
            line.map(str::to_owned)
        };
        let short = screen("Yes.", &rows(3), "report: x");
        assert_eq!(short, "Yes.\n\nrow\nrow\nrow\n\nreport: x\n");
        for (count, hidden) in [(21, None), (22, Some(2)), (100, Some(80))] {
            let text = screen("Yes.", &rows(count), "report: x");
            assert_eq!(text.lines().count(), LINES, "{text}");
            assert_eq!(said(&text), hidden.map(more), "{text}");
        }
        for (count, hidden) in [(25, None), (26, Some(2))] {
            let text = All { all: false }.limited(&rows(count));
            assert_eq!(text.lines().count(), LINES, "{text}");
            assert_eq!(said(&text), hidden.map(more), "{text}");
            assert_eq!(All { all: true }.limited(&rows(count)), rows(count));
        }
        let long = screen(&"word ".repeat(2000), &rows(9), "report: x");
        assert!(
            long.ends_with("… and 9 lines more: --all\n\nreport: x\n"),
            "{long}"
        );
    }
}
