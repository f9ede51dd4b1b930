//! # Tables
//!
//! A table is defined once, a column beside what stands in it, and becomes a
//! file or a page:
//!
//! ```text
//!                      ┌─> to_csv       named columns, all digits
//! rows ──> Table::of ──┼─> Serialize    the same names and numbers, as JSON
//!          .column(…)  ├─> to_text      columns with a heading, rounded, aligned
//!          .headed(…)  ├─> to_markdown  the same headings and numbers
//!                      └─> to_html      the same, with powers of ten as on paper
//! ```
//!
//! ```
//! use crepitus_pages::table::{Table, show};
//! let speeds = [("slow", 0.25), ("fast", 3.0)];
//! let table = Table::of(&speeds)
//!     .column("name", |row| row.0).headed("speed")
//!     .column("omega_rad_s", |row| row.1).headed("rad/s").rounded(show::fixed::<1>);
//! assert_eq!(table.to_csv(), "name,omega_rad_s\nslow,0.25\nfast,3.0\n");
//! assert_eq!(table.to_text(), "speed  rad/s\nslow     0.2\nfast     3.0\n");
//! ```

mod cell;
mod html;
mod markdown;
pub mod show;
mod text;

pub use cell::Cell;
use serde::{Serialize, Serializer};

/// A table over `rows`: columns for files, for people, or for both.
#[derive(Clone, Debug)]
pub struct Table<'r, R> {
    rows: &'r [R],
    columns: Vec<Column>,
    group: &'static str,
    remarks: Option<Remarks>,
}

#[derive(Clone, Debug)]
struct Column {
    /// Name in files; none if the column is for people only.
    name: Option<&'static str>,
    /// Heading for people; none if the column is for files only.
    heading: Option<String>,
    /// Heading over this and its neighbours of the same group.
    group: &'static str,
    right: bool,
    show: Option<show::Show>,
    cells: Vec<Cell>,
}

/// Texts that replace, for people, the cells of a row from a column on.
#[derive(Clone, Debug)]
struct Remarks {
    from: usize,
    texts: Vec<Option<String>>,
}

impl<'r, R> Table<'r, R> {
    /// No columns yet.
    pub fn of(rows: &'r [R]) -> Self {
        Self {
            rows,
            columns: Vec::new(),
            group: "",
            remarks: None,
        }
    }

    /// Adds a column for files; the unit is part of the name.
    #[must_use]
    pub fn column<C: Into<Cell>>(self, name: &'static str, cell: impl Fn(&'r R) -> C) -> Self {
        self.push(Some(name), None, &|row| cell(row).into())
    }

    /// Adds a column for people only. Text in it is aligned to the left;
    /// [`Self::right`] changes that.
    #[must_use]
    pub fn people<C: Into<Cell>>(
        self,
        heading: impl Into<String>,
        cell: impl Fn(&'r R) -> C,
    ) -> Self {
        self.push(None, Some(heading.into()), &|row| cell(row).into())
    }

    /// Adds a column. Not generic over the cell: hundreds of columns would be compiled one by one.
    fn push(
        mut self,
        name: Option<&'static str>,
        heading: Option<String>,
        cell: &dyn Fn(&'r R) -> Cell,
    ) -> Self {
        let cells: Vec<Cell> = self.rows.iter().map(cell).collect();
        self.columns.push(Column {
            name,
            heading,
            group: self.group,
            right: cells.iter().any(Cell::is_number),
            show: None,
            cells,
        });
        self
    }

    /// Shows the last column to people, too, under this heading.
    #[must_use]
    pub fn headed(self, heading: impl Into<String>) -> Self {
        self.last(|column| column.heading = Some(heading.into()))
    }

    /// Rounds the numbers and counts of the last column for people.
    #[must_use]
    pub fn rounded(self, show: show::Show) -> Self {
        self.last(|column| column.show = Some(show))
    }

    /// Aligns the last column to the right.
    #[must_use]
    pub fn right(self) -> Self {
        self.last(|column| column.right = true)
    }

    /// Aligns the last column to the left, as text is anyway.
    #[must_use]
    pub fn left(self) -> Self {
        self.last(|column| column.right = false)
    }

    fn last(mut self, change: impl FnOnce(&mut Column)) -> Self {
        if let Some(column) = self.columns.last_mut() {
            change(column);
        }
        self
    }

    /// The columns from here on stand under a common heading.
    #[must_use]
    pub fn group(mut self, heading: &'static str) -> Self {
        self.group = heading;
        self
    }

    /// Gives rows a remark, which people see in place of the row's cells from here
    /// on: why there are none.
    #[must_use]
    pub fn remark(mut self, text: impl Fn(&'r R) -> Option<String>) -> Self {
        self.remarks = Some(Remarks {
            from: self.for_people().count(),
            texts: self.rows.iter().map(text).collect(),
        });
        self
    }

    /// CSV (RFC 4180): a header and a line a row. Numbers read back to the
    /// same bits; an unknown number is `nan`, a missing cell empty.
    pub fn to_csv(&self) -> String {
        let names: Vec<_> = self.for_files().map(|(name, _)| name).collect();
        let mut text = names.join(",") + "\n";
        for row in 0..self.rows.len() {
            for (place, (_, column)) in self.for_files().enumerate() {
                if place > 0 {
                    text.push(',');
                }
                column.cell(row).push_csv(&mut text);
            }
            text.push('\n');
        }
        text
    }

    /// The rows as objects with the names and numbers of the CSV form. In
    /// JSON what is missing or not finite is `null`. A table serialises as the
    /// list of them.
    pub fn objects(&self) -> impl Iterator<Item = impl Serialize> {
        (0..self.rows.len()).map(|row| Object { table: self, row })
    }

    fn for_files(&self) -> impl Iterator<Item = (&'static str, &Column)> {
        self.columns
            .iter()
            .filter_map(|column| Some((column.name?, column)))
    }

    fn for_people(&self) -> impl Iterator<Item = (&str, &Column)> {
        self.columns
            .iter()
            .filter_map(|column| Some((column.heading.as_deref()?, column)))
    }

    /// The remark of a row, and the place of the first column it replaces.
    fn remark_of(&self, row: usize) -> Option<(usize, &str)> {
        let remarks = self.remarks.as_ref()?;
        Some((remarks.from, remarks.texts.get(row)?.as_deref()?))
    }
}

struct Object<'t, 'r, R> {
    table: &'t Table<'r, R>,
    row: usize,
}

impl<R> Serialize for Object<'_, '_, R> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let cells = self.table.for_files();
        serializer.collect_map(cells.map(|(name, column)| (name, column.cell(self.row))))
    }
}

impl<R> Serialize for Table<'_, R> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.objects())
    }
}

impl Column {
    fn cell(&self, row: usize) -> &Cell {
        self.cells.get(row).unwrap_or(&Cell::Missing)
    }

    fn text(&self, row: usize) -> String {
        self.cell(row).to_text(self.show)
    }
}

/// Neighbours of the same group: heading and number of columns.
fn groups<'c>(columns: &[(&str, &'c Column)]) -> Vec<(&'c str, usize)> {
    columns
        .chunk_by(|a, b| a.1.group == b.1.group)
        .map(|group| (group.first().map_or("", |c| c.1.group), group.len()))
        .collect()
}

#[cfg(test)]
mod tests;
