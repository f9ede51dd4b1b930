//! One line of a table as its cells.

use std::ops::Range;

/// Separator between the cells of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// A tab; each one ends a cell.
    Tab,
    /// Any number of tabs; an empty cell cannot be written.
    Tabs,
    /// `|`
    Bar,
    /// Any number of blanks, tabs among them; an empty cell cannot be written.
    Blanks,
}

impl Separator {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Tabs => "one or more tabs",
            Self::Bar => "vertical bars",
            Self::Blanks => "blanks",
        }
    }

    const fn matches(self, found: char) -> bool {
        match self {
            Self::Comma => found == ',',
            Self::Semicolon => found == ';',
            Self::Tab | Self::Tabs => found == '\t',
            Self::Bar => found == '|',
            Self::Blanks => matches!(found, ' ' | '\t'),
        }
    }

    /// Returns whether one after the other separates no empty cell.
    const fn is_repeated(self) -> bool {
        matches!(self, Self::Tabs | Self::Blanks)
    }
}

/// Error of a quoted cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quote {
    /// The line ends before the closing quote.
    Unclosed,
    /// Text follows the closing quote.
    TextBehind,
}

/// The cells of a line, without blanks around them and without quotes.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    text: String,
    places: Vec<Range<usize>>,
}

impl Cells {
    /// Takes the cells of another line.
    pub(super) fn split(&mut self, line: &str, separator: Separator) -> Result<(), Quote> {
        self.text.clear();
        self.places.clear();
        if line.contains('"') {
            return self.split_quoted(line, separator);
        }
        match separator {
            Separator::Blanks => line.split_whitespace().for_each(|cell| self.push(cell)),
            Separator::Tabs => line
                .split('\t')
                .filter(|cell| !cell.trim().is_empty())
                .for_each(|cell| self.push(cell)),
            _ => line
                .split(|found| separator.matches(found))
                .for_each(|cell| self.push(cell)),
        }
        Ok(())
    }

    fn split_quoted(&mut self, line: &str, separator: Separator) -> Result<(), Quote> {
        let mut rest = line;
        loop {
            if separator.is_repeated() {
                rest = rest.trim_start_matches(|found| separator.matches(found));
                if rest.is_empty() {
                    return Ok(());
                }
            }
            let start = rest.trim_start_matches(|found: char| {
                found.is_whitespace() && !separator.matches(found)
            });
            let cell_and_rest = if let Some(inner) = start.strip_prefix('"') {
                let (cell, behind) = closed(inner).ok_or(Quote::Unclosed)?;
                self.push(&cell);
                let (padding, rest) = cut(behind, separator);
                if !padding.trim().is_empty() {
                    return Err(Quote::TextBehind);
                }
                rest
            } else {
                let (cell, rest) = cut(rest, separator);
                self.push(cell);
                rest
            };
            match cell_and_rest {
                Some(next) => rest = next,
                None => return Ok(()),
            }
        }
    }

    fn push(&mut self, cell: &str) {
        let start = self.text.len();
        self.text.push_str(cell.trim());
        self.places.push(start..self.text.len());
    }

    /// Takes away empty cells at the end beyond a width.
    pub(super) fn cut_padding(&mut self, width: usize) {
        while self.places.len() > width && self.places.last().is_some_and(Range::is_empty) {
            self.places.pop();
        }
    }

    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    /// A cell; empty beyond the last.
    pub(super) fn get(&self, index: usize) -> &str {
        self.places
            .get(index)
            .and_then(|place| self.text.get(place.clone()))
            .unwrap_or_default()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &str> + Clone {
        (0..self.len()).map(|index| self.get(index))
    }
}

/// The cell up to its closing quote, and what follows that.
fn closed(inner: &str) -> Option<(String, &str)> {
    let (mut cell, mut rest) = (String::new(), inner);
    loop {
        let (text, behind) = rest.split_once('"')?;
        cell.push_str(text);
        match behind.strip_prefix('"') {
            Some(next) => {
                cell.push('"');
                rest = next;
            }
            None => return Some((cell, behind)),
        }
    }
}

fn cut(text: &str, separator: Separator) -> (&str, Option<&str>) {
    match text.split_once(|found| separator.matches(found)) {
        Some((cell, rest)) => (cell, Some(rest)),
        None => (text, None),
    }
}

/// A list as people write it on a command line: commas separate, quotes hold a cell with commas
/// together, also within it (`ours="their, column"`).
///
/// # Errors
/// The text of an unclosed quote.
pub fn list(text: &str) -> Result<Vec<String>, String> {
    let (mut parts, mut part, mut rest) = (Vec::new(), String::new(), text);
    while let Some(at) = rest.find([',', '"']) {
        let (before, behind) = rest.split_at(at);
        part.push_str(before);
        if let Some(inner) = behind.strip_prefix('"') {
            let (cell, next) =
                closed(inner).ok_or_else(|| format!("{behind}: the quote is not closed"))?;
            part.push_str(&cell);
            rest = next;
        } else {
            parts.push(std::mem::take(&mut part));
            rest = behind.strip_prefix(',').unwrap_or_default();
        }
    }
    part.push_str(rest);
    parts.push(part);
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(line: &str, separator: Separator) -> Result<Vec<String>, Quote> {
        let mut cells = Cells::default();
        cells.split(line, separator)?;
        Ok(cells.iter().map(str::to_owned).collect())
    }

    #[test]
    fn cells_are_what_stands_between_separators() {
        for (line, separator, expected) in [
            ("a, b ,", Separator::Comma, &["a", "b", ""][..]),
            ("a;b,c", Separator::Semicolon, &["a", "b,c"]),
            ("a\t\tb", Separator::Tab, &["a", "", "b"]),
            ("a\t\tb c", Separator::Tabs, &["a", "b c"]),
            ("  a  b\tc ", Separator::Blanks, &["a", "b", "c"]),
            ("\"a, b\",c", Separator::Comma, &["a, b", "c"]),
            (" \"a\"\"b\" ,\"\"", Separator::Comma, &["a\"b", ""]),
            ("5\"x,c", Separator::Comma, &["5\"x", "c"]),
            ("\"a b\"  c", Separator::Blanks, &["a b", "c"]),
            ("\"a\"\t\"b\"", Separator::Tab, &["a", "b"]),
            ("a\t\t\"b\"", Separator::Tab, &["a", "", "b"]),
        ] {
            assert_eq!(split(line, separator).unwrap(), expected, "{line:?}");
        }
    }

    #[test]
    fn quotes_are_closed_and_nothing_follows_them() {
        let comma = Separator::Comma;
        assert_eq!(split("1,\"fine", comma), Err(Quote::Unclosed));
        assert_eq!(split("1,\"a\"\"", comma), Err(Quote::Unclosed));
        assert_eq!(split("1,\"a\"b,2", comma), Err(Quote::TextBehind));
    }

    #[test]
    fn a_name_with_a_comma_stands_in_quotes() {
        let both = ["t=time", "torque=T, N·m"];
        assert_eq!(list("t=time,torque=\"T, N·m\"").unwrap(), both);
        assert_eq!(list("t=time,\"torque=T, N·m\"").unwrap(), both);
        assert!(list("t=\"time").unwrap_err().contains("not closed"));
    }
}
