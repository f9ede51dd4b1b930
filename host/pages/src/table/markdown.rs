//! A table in Markdown: for a page of the book, and readable as it is.

use crate::table::{Column, Table};

impl<R> Table<'_, R> {
    /// The columns that have a heading, rounded. The heading of a group stands before
    /// those of its columns.
    pub fn to_markdown(&self) -> String {
        let columns: Vec<_> = self.for_people().collect();
        let mut text = line(columns.iter().map(heading));
        text.push_str(&"|---".repeat(columns.len()));
        text.push_str("|\n");
        for row in 0..self.rows.len() {
            let remark = self.remark_of(row);
            let cells = columns
                .iter()
                .enumerate()
                .map(|(place, (_, column))| match remark {
                    Some((from, text)) if place == from => text.to_owned(),
                    Some((from, _)) if place > from => String::new(),
                    _ => column.text(row),
                });
            text.push_str(&line(cells));
        }
        text
    }
}

fn heading((heading, column): &(&str, &Column)) -> String {
    match column.group {
        "" => (*heading).to_owned(),
        group => format!("{group}: {heading}"),
    }
}

fn line(cells: impl Iterator<Item = String>) -> String {
    let cells = cells.map(|cell| format!("| {} ", cell.replace('|', "\\|")));
    cells.collect::<String>() + "|\n"
}
