//! Sums of a journal.

use crate::corpus::MotionKind;
use crate::journal::{Counts, PIECE, Row};
use crepitus_model::Convention;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The sums of a journal.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Counts by convention and motion.
    cells: Vec<(Convention, MotionKind, Counts)>,
    /// Inconsistencies.
    pub faults: Vec<String>,
}

impl Summary {
    /// Adds up pieces, and checks their consistency.
    pub fn of(pieces: &[Vec<Row>]) -> Self {
        let mut faults = Vec::new();
        let mut cells: Vec<_> = Convention::ALL
            .into_iter()
            .flat_map(|c| {
                MotionKind::ALL
                    .into_iter()
                    .map(move |m| (c, m, Counts::default()))
            })
            .collect();
        for (expected, piece) in (0..).zip(pieces) {
            let mut cases = 0;
            for row in piece {
                let c = &row.counts;
                cases += c.cases;
                if row.piece != expected {
                    faults.push(format!("piece {} stands where {expected} must", row.piece));
                }
                if c.agreed + c.undecidable + c.disagreed != c.cases {
                    faults.push(format!(
                        "the cases of a row of piece {expected} do not add up"
                    ));
                }
                let notable = c.undecidable + c.disagreed + c.law_broken;
                if c.notable.len() as u64 != notable {
                    faults.push(format!("piece {expected} does not name every notable case"));
                }
                for (convention, motion, sum) in &mut cells {
                    if (*convention, *motion) == (row.convention, row.motion) {
                        sum.merge(c);
                    }
                }
            }
            if cases != PIECE {
                faults.push(format!("piece {expected} has {cases} cases of {PIECE}"));
            }
        }
        Self { cells, faults }
    }

    /// All counts that `wanted` picks.
    pub fn sum(&self, wanted: impl Fn(Convention, MotionKind) -> bool) -> Counts {
        let mut sum = Counts::default();
        for (convention, motion, counts) in &self.cells {
            if wanted(*convention, *motion) {
                sum.merge(counts);
            }
        }
        sum
    }

    /// Tables in Markdown: by convention and motion, and of what is notable.
    pub fn markdown(&self) -> String {
        let mut text = String::from(
            "| convention | motion | cases | events | agree | of these by conditioning | undecidable | disagree | \
             sign law broken | worst time error |\n|---|---|---|---|---|---|---|---|---|---|\n",
        );
        let mut row = |convention: &str, motion: &str, c: &Counts| {
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "| {convention} | {motion} | {} | {} | {} | {} | {} | {} | {} | {:.1e} |",
                c.cases,
                c.events,
                c.agreed,
                c.conditioned,
                c.undecidable,
                c.disagreed,
                c.law_broken,
                c.worst
            );
        };
        for convention in Convention::ALL {
            for motion in MotionKind::ALL {
                let sum = self.sum(|c, m| (c, m) == (convention, motion));
                row(&format!("`{}`", convention.name()), motion.name(), &sum);
            }
            let sum = self.sum(|c, _| c == convention);
            row(&format!("**`{}`**", convention.name()), "all", &sum);
        }
        let all = self.sum(|_, _| true);
        row("**all**", "all", &all);
        text.push_str("\n| verdict | cases | the first of them |\n|---|---|---|\n");
        let mut classes: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (number, class) in all.notable.iter().filter_map(|n| n.split_once(':')) {
            classes.entry(class).or_default().push(number);
        }
        for (class, mut numbers) in classes {
            numbers.sort_by_key(|n| n.parse::<u64>().unwrap_or(u64::MAX));
            let first = numbers
                .iter()
                .take(6)
                .copied()
                .collect::<Vec<_>>()
                .join(", ");
            let _ = writeln!(text, "| {class} | {} | {first} |", numbers.len());
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::{self, Tally};

    /// Two whole pieces that agree in everything.
    fn pieces() -> Vec<Vec<Row>> {
        (0..2)
            .map(|piece| {
                let mut rows = Tally::new(piece).rows().to_vec();
                rows[0].counts.cases = PIECE;
                rows[0].counts.agreed = PIECE;
                rows
            })
            .collect()
    }

    #[test]
    fn a_sound_journal_adds_up() {
        let summary = Summary::of(&pieces());
        assert!(summary.faults.is_empty(), "{:?}", summary.faults);
        let all = summary.sum(|_, _| true);
        assert_eq!((all.cases, all.agreed), (2 * PIECE, 2 * PIECE));
        assert!(summary.markdown().contains("| **all** | all | 500 |"));
    }

    #[test]
    fn whatever_is_missing_is_noticed() {
        let change: [fn(&mut Vec<Vec<Row>>); 4] = [
            |p| p[1][0].counts.cases -= 1,
            |p| p[1][0].counts.agreed -= 1,
            |p| p[1][0].counts.law_broken = 1,
            |p| drop(p.remove(0)),
        ];
        for change in change {
            let mut changed = pieces();
            change(&mut changed);
            assert!(!Summary::of(&changed).faults.is_empty());
        }
    }

    #[test]
    fn a_file_without_a_row_lacks_the_piece() {
        let path = std::env::temp_dir().join(format!("crosscheck-{}.csv", std::process::id()));
        std::fs::write(&path, format!("{}\n", journal::HEADER)).unwrap();
        for piece in pieces() {
            journal::append(&path, &piece).unwrap();
        }
        assert_eq!(journal::read(&path).unwrap(), pieces());
        let text = std::fs::read_to_string(&path).unwrap();
        let without: Vec<&str> = text
            .lines()
            .enumerate()
            .filter(|(i, _)| *i != 20)
            .map(|(_, l)| l)
            .collect();
        std::fs::write(&path, without.join("\n")).unwrap();
        assert_eq!(journal::read(&path).unwrap(), pieces()[..1]);
        std::fs::remove_file(path).unwrap();
    }
}
