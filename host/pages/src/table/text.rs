//! A table on a terminal.

use crate::table::{Column, Table, groups};
use std::fmt::Write;

/// Number of spaces between columns.
const GAP: usize = 2;

impl<R> Table<'_, R> {
    /// The columns that have a heading, rounded and aligned; without a line of
    /// headings if all are empty.
    pub fn to_text(&self) -> String {
        let columns: Vec<_> = self.for_people().collect();
        let texts: Vec<Vec<String>> = (0..self.rows.len())
            .map(|row| {
                let kept = self.remark_of(row).map_or(columns.len(), |(from, _)| from);
                let kept = columns.iter().take(kept);
                kept.map(|(_, column)| column.text(row)).collect()
            })
            .collect();
        let mut widths: Vec<usize> = columns
            .iter()
            .enumerate()
            .map(|(place, (heading, _))| {
                let cells = texts.iter().filter_map(|row| row.get(place));
                let cells = cells.map(|cell| cell.chars().count());
                cells.max().unwrap_or(0).max(heading.chars().count())
            })
            .collect();
        let mut text = group_line(&columns, &mut widths);
        let headings: Vec<_> = columns.iter().map(|c| c.0.to_owned()).collect();
        if headings.iter().any(|heading| !heading.is_empty()) {
            push_line(&mut text, &columns, &widths, &headings, "");
        }
        for (row, cells) in texts.iter().enumerate() {
            let remark = self.remark_of(row).map_or("", |(_, remark)| remark);
            push_line(&mut text, &columns, &widths, cells, remark);
        }
        text
    }
}

/// The headings of groups, and room for them; nothing without groups.
fn group_line(columns: &[(&str, &Column)], widths: &mut [usize]) -> String {
    if columns.iter().all(|(_, column)| column.group.is_empty()) {
        return String::new();
    }
    let mut line = String::new();
    let mut place = 0;
    for (heading, count) in groups(columns) {
        let Some(widths) = widths.get_mut(place..place + count) else {
            break;
        };
        let width = widths.iter().sum::<usize>() + GAP * (count - 1);
        let more = heading.chars().count().saturating_sub(width);
        if let Some(first) = widths.first_mut() {
            *first += more;
        }
        let width = width + more;
        // Writing to a String cannot fail.
        let _ = write!(line, "{heading:^width$}{:GAP$}", "");
        place += count;
    }
    line.trim_end().to_owned() + "\n"
}

fn push_line(
    text: &mut String,
    columns: &[(&str, &Column)],
    widths: &[usize],
    cells: &[String],
    remark: &str,
) {
    let mut line = String::new();
    for ((cell, width), (_, column)) in cells.iter().zip(widths).zip(columns) {
        let _ = if column.right {
            write!(line, "{cell:>width$}{:GAP$}", "")
        } else {
            write!(line, "{cell:width$}{:GAP$}", "")
        };
    }
    line.push_str(remark);
    text.push_str(line.trim_end());
    text.push('\n');
}
