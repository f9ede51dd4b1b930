//! The printed form of a study: its answer first, and no more than a screen holds. `--all` prints the rest.

use clap::Args;

/// Lines that are printed without `--all`.
pub(crate) const LINES: usize = 25;

/// Columns of a terminal that text fills.
pub(crate) const WIDTH: usize = 100;

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

/// The words in lines that fit.
pub(crate) fn wrapped(paragraph: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in paragraph.split_whitespace() {
        if let Some(line) = lines.last_mut() {
            let length = line.chars().count();
            if length == 0 {
                line.push_str(word);
            } else if length + 1 + word.chars().count() <= width {
                line.push(' ');
                line.push_str(word);
            } else {
                lines.push(word.to_owned());
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fit_and_lose_no_word() {
        let words = "ωn·h ".repeat(60);
        let lines = wrapped(&words, 80);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|line| line.chars().count() <= 80));
        assert_eq!(lines.join(" "), words.trim_end());
        assert_eq!(wrapped("", 80), [""]);
    }

    #[test]
    fn what_does_not_fit_is_counted() {
        let rows = |count: usize| "row\n".repeat(count);
        let short = screen("Yes.", &rows(3), "report: x");
        assert_eq!(short, "Yes.\n\nrow\nrow\nrow\n\nreport: x\n");
        for (count, hidden) in [(21, 0), (22, 2), (100, 80)] {
            let text = screen("Yes.", &rows(count), "report: x");
            assert_eq!(text.lines().count(), LINES, "{text}");
            let said = format!("… and {hidden} lines more: --all");
            assert_eq!(text.contains(&said), hidden > 0, "{text}");
        }
        for (count, hidden) in [(25, 0), (26, 2)] {
            let text = All { all: false }.limited(&rows(count));
            assert_eq!(text.lines().count(), LINES, "{text}");
            assert_eq!(text.contains(&more(hidden)), hidden > 0, "{text}");
            assert_eq!(All { all: true }.limited(&rows(count)), rows(count));
        }
        let long = screen(&"word ".repeat(2000), &rows(9), "report: x");
        assert!(
            long.ends_with("… and 9 lines more: --all\n\nreport: x\n"),
            "{long}"
        );
    }
}
