//! Place and form of a table in its file: which line has the names, what separates cells, and the
//! header of an OpenSim file.

use super::cells::{Cells, Quote, Separator};
use super::{Header, Names, Problem, TableError};

/// Most lines of one name that spans lines, in quotes.
const NAME_LINES: usize = 8;

/// Separators of a line of names, the most certain first.
const OF_NAMES: [Separator; 6] = [
    Separator::Tab,
    Separator::Comma,
    Separator::Semicolon,
    Separator::Bar,
    Separator::Tabs,
    Separator::Blanks,
];

/// Separators of rows: one that leaves room for empty cells first.
const OF_ROWS: [Separator; 6] = [
    Separator::Tab,
    Separator::Comma,
    Separator::Semicolon,
    Separator::Bar,
    Separator::Blanks,
    Separator::Tabs,
];

/// Units as people write them over a column, in small letters without brackets.
const UNITS: &str = "s sec secs second seconds ms msec msecs millisecond milliseconds us µs min h \
                     deg degree degrees ° rad radian radians nm n-m n·m n.m n*m deg/s deg/sec °/s rad/s rad/sec n hz mm m v";

/// A line with its number.
pub(super) type Line = (u64, String);

/// Form of a table.
#[derive(Debug)]
pub(super) struct Layout {
    pub(super) names: Vec<String>,
    pub(super) names_line: u64,
    pub(super) units: Vec<String>,
    pub(super) separator: Separator,
    pub(super) header: Option<Header>,
    /// Index of the first line below names and units.
    pub(super) next: usize,
    pub(super) notes: Vec<String>,
}

/// Returns a unit in small letters without its brackets.
pub(super) fn bare_unit(text: &str) -> String {
    let brackets = |c: char| matches!(c, '[' | ']' | '(' | ')' | '<' | '>') || c.is_whitespace();
    text.trim_matches(brackets).to_lowercase()
}

pub(super) fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    ["#", "%", "//"]
        .into_iter()
        .any(|mark| line.starts_with(mark))
}

fn is_number(cell: &str) -> bool {
    cell.parse::<f64>().is_ok() || super::number::with_comma(cell).is_some()
}

pub(super) fn find(head: &[Line], wanted: Names<'_>) -> Result<Layout, TableError> {
    let filled = |from: usize| {
        let lines = head.iter().enumerate().skip(from);
        lines
            .filter(|(_, (_, text))| !text.trim().is_empty())
            .map(|(at, _)| at)
    };
    let Some(first) = filled(0).next() else {
        return Err(TableError {
            line: None,
            problem: Problem::Empty,
        });
    };
    let end = head.iter().position(|(_, text)| {
        let padding = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '"');
        text.trim_matches(padding).eq_ignore_ascii_case("endheader")
    });
    let (at, header) = if let Some(end) = end {
        let (before, _) = head.split_at(end);
        let Some(at) = filled(end + 1).next() else {
            return Err(TableError {
                line: head.last().map(|(line, _)| *line),
                problem: Problem::NoNames,
            });
        };
        (at, Some(Header::of(before)))
    } else {
        let at = match wanted {
            Names::FirstLine => first_line(head),
            Names::Holding(wanted) => holding(head, wanted).or_else(|| over_numbers(head)),
        };
        (at.unwrap_or(first), None)
    };
    Ok(of_names(head, at, (first, header), wanted))
}

/// The layout of the names in line `at`.
fn of_names(
    head: &[Line],
    at: usize,
    (first, header): (usize, Option<Header>),
    wanted: Names<'_>,
) -> Layout {
    let (text, length) = whole_line(head, at);
    let mut rows = head
        .iter()
        .enumerate()
        .skip(at + length)
        .filter(|(_, (_, text))| !text.trim().is_empty() && !is_comment(text));
    let below = rows.next();
    let units_row = below.filter(|(_, (_, text))| is_units(text));
    let row = if units_row.is_some() {
        rows.next()
    } else {
        below
    };
    let row_text = row.map(|(_, (_, text))| text.as_str());
    let pair = pair(&text, row_text, wanted);
    let Pair {
        names,
        of_names,
        of_rows,
    } = pair;
    let mut units = Vec::new();
    let mut notes = Vec::new();
    let names_line = head.get(at).map_or(0, |(line, _)| *line);
    if header.is_none() && at > first {
        notes.push(format!(
            "the names of the columns are in line {names_line}, the lines above are left out"
        ));
    }
    let is_plain = if header.is_some() {
        of_names == of_rows && matches!(of_names, Separator::Tab | Separator::Blanks)
    } else {
        of_names == Separator::Comma && of_rows == Separator::Comma
    };
    if of_names != of_rows {
        notes.push(format!(
            "the names are separated by {}, the rows by {}",
            of_names.name(),
            of_rows.name()
        ));
    } else if !is_plain && names.len() > 1 {
        notes.push(format!("cells are separated by {}", of_rows.name()));
    }
    let mut next = at + length;
    if let Some((place, (line, text))) = units_row {
        next = place + 1;
        let mut cells = Cells::default();
        for separator in [of_rows, of_names] {
            if cells.split(text, separator).is_ok() && cells.len() >= names.len() {
                units = cells.iter().take(names.len()).map(str::to_owned).collect();
                break;
            }
        }
        notes.push(format!("line {line} has the units of the columns"));
    }
    Layout {
        names,
        names_line,
        units,
        separator: of_rows,
        header,
        next,
        notes,
    }
}

struct Pair {
    names: Vec<String>,
    of_names: Separator,
    of_rows: Separator,
}

/// The separators of names and rows under which both have as many cells, and the names those that
/// are wanted.
fn pair(text: &str, row: Option<&str>, wanted: Names<'_>) -> Pair {
    let mut best: Option<(usize, Pair)> = None;
    let (mut names, mut cells) = (Cells::default(), Cells::default());
    for of_names in OF_NAMES {
        if names.split(text, of_names).is_err() || names.len() < 2 {
            continue;
        }
        let here = count(&names, wanted);
        let of_rows = row.map_or(Some((of_names, trimmed(&names))), |row| {
            // The separator of the names first, if it gives an empty cell a place.
            let own =
                Some(of_names).filter(|of_names| OF_ROWS.iter().take(4).any(|s| s == of_names));
            own.into_iter().chain(OF_ROWS).find_map(|separator| {
                cells.split(row, separator).ok()?;
                let (n, r) = (trimmed(&names), trimmed(&cells));
                let fits = cells.len() == names.len() || n == r;
                (fits && cells.len() > 1).then_some((separator, n.max(r)))
            })
        });
        // Names that are there count most, rows that fit next, a usual separator last.
        let (score, of_rows, width) = match of_rows {
            Some((separator, width)) => (2 * here + 1, separator, width),
            None => (2 * here, of_names, names.len()),
        };
        if best.as_ref().is_none_or(|(most, _)| score > *most) {
            let names = names.iter().take(width).map(str::to_owned).collect();
            let found = Pair {
                names,
                of_names,
                of_rows,
            };
            best = Some((score, found));
        }
    }
    best.map_or_else(
        || Pair {
            names: vec![text.trim().trim_matches('"').to_owned()],
            of_names: Separator::Comma,
            of_rows: Separator::Comma,
        },
        |(_, pair)| pair,
    )
}

/// Cells up to the last that is not empty.
fn trimmed(cells: &Cells) -> usize {
    let filled = cells.iter().enumerate().filter(|(_, c)| !c.is_empty());
    filled.map(|(at, _)| at + 1).last().unwrap_or(0)
}

/// Number of wanted names among the cells.
fn count(cells: &Cells, wanted: Names<'_>) -> usize {
    match wanted {
        Names::FirstLine => 0,
        Names::Holding(wanted) => wanted
            .iter()
            .filter(|name| cells.iter().any(|cell| cell == **name))
            .count(),
    }
}

/// A line of names with those that follow it in quotes, without a sign of a comment before it, and
/// how many lines it has.
fn whole_line(head: &[Line], at: usize) -> (String, usize) {
    let line = head.get(at).map_or("", |(_, text)| text.as_str());
    let bare = line.trim_start_matches(['#', '%', ' ']);
    let bare = if is_comment(line) { bare } else { line };
    let mut text = bare.to_owned();
    let mut cells = Cells::default();
    let is_open = |text: &str, cells: &mut Cells| {
        OF_NAMES
            .into_iter()
            .take(4)
            .any(|separator| cells.split(text, separator) == Err(Quote::Unclosed))
    };
    let mut length = 1;
    while length < NAME_LINES && is_open(&text, &mut cells) {
        let Some((_, more)) = head.get(at + length) else {
            break;
        };
        text.push(' ');
        text.push_str(more);
        length += 1;
    }
    if is_open(&text, &mut cells) {
        return (bare.to_owned(), 1);
    }
    (text, length)
}

/// The first line that is neither blank nor a comment, nor a spreadsheet's `sep=;`.
fn first_line(head: &[Line]) -> Option<usize> {
    head.iter().position(|(_, text)| {
        let text = text.trim();
        !(text.is_empty() || is_comment(text) || text.starts_with("sep=") && text.len() <= 5)
    })
}

/// The line with the most of the wanted names, the first of them.
fn holding(head: &[Line], wanted: &[&str]) -> Option<usize> {
    let mut cells = Cells::default();
    let mut best = (0, None);
    for at in 0..head.len() {
        let (text, _) = whole_line(head, at);
        let most = OF_NAMES
            .into_iter()
            .filter_map(|separator| {
                cells.split(&text, separator).ok()?;
                Some(count(&cells, Names::Holding(wanted))).filter(|_| cells.len() > 1)
            })
            .max()
            .unwrap_or(0);
        if most > best.0 {
            best = (most, Some(at));
        }
        if most == wanted.len() {
            break;
        }
    }
    best.1
}

/// The line over the first two rows of numbers.
fn over_numbers(head: &[Line]) -> Option<usize> {
    let mut cells = Cells::default();
    let mut width = |text: &str, separator| {
        cells.split(text, separator).ok()?;
        let numbers = cells.iter().filter(|cell| is_number(cell)).count();
        (cells.len() > 1 && 2 * numbers >= cells.len()).then_some(cells.len())
    };
    let filled: Vec<usize> = (0..head.len())
        .filter(|at| {
            head.get(*at)
                .is_some_and(|(_, text)| !text.trim().is_empty())
        })
        .collect();
    let text = |at: usize| head.get(at).map_or("", |(_, text)| text.as_str());
    let row = filled.array_windows().position(|[one, two]| {
        OF_ROWS.into_iter().any(|separator| {
            let first = width(text(*one), separator);
            first.is_some() && first == width(text(*two), separator)
        })
    })?;
    let above = row.checked_sub(1)?;
    let is_unit_row = filled.get(above).is_some_and(|at| is_units(text(*at)));
    let above = if is_unit_row {
        above.checked_sub(1)?
    } else {
        above
    };
    filled.get(above).copied()
}

/// Returns whether a line has no number, and at least one unit.
fn is_units(text: &str) -> bool {
    let mut cells = Cells::default();
    OF_ROWS.into_iter().any(|separator| {
        cells.split(text, separator).is_ok()
            && cells.len() > 1
            && !cells.iter().any(is_number)
            && cells
                .iter()
                .map(bare_unit)
                .any(|unit| UNITS.split(' ').any(|known| known == unit))
    })
}
