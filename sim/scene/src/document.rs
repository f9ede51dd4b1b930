//! A TOML document in which every value knows where it came from.
//!
//! The parser is the `toml` crate's; what this adds is that errors can name
//! the line of the key they are about, and that values given on the command
//! line (`--set PATH=VALUE`) take the place of those in the file.

mod section;
mod writer;

pub(crate) use section::{Range, Section};
pub(crate) use writer::quoted;

use crate::error::{Origin, SceneError};
use crepitus_files::characters::first_look_alike;
use crepitus_files::input;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// A value and its origin.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) origin: Origin,
    pub(crate) value: Value,
}

/// Values that TOML can hold, as far as scenes use them.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Text(String),
    /// A whole or a decimal number; scenes do not tell them apart.
    Number(f64),
    Flag(bool),
    List(Vec<Node>),
    Table(BTreeMap<String, Node>),
    /// Something that no key of a scene takes: its type's name.
    Other(&'static str),
}

/// Keys that were left out, and what they were taken to be.
pub(crate) type Defaults = RefCell<Vec<(String, Value)>>;

/// The text of a file.
pub(crate) fn text_of(file: &Path) -> Result<String, SceneError> {
    let whole = |message: String| SceneError {
        file: file.to_owned(),
        origin: None,
        key: String::new(),
        message,
    };
    input::read_to_string(file, input::TEXT_BYTES)
        .map_err(|e| whole(format!("cannot be read: {e}")))
}

/// A scene file's text as a tree.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    file: PathBuf,
    root: BTreeMap<String, Node>,
    defaults: Defaults,
}

/// An override as errors repeat it: one line, and no long one.
fn shortened(flag: &str) -> String {
    const LONGEST: usize = 80;
    let line = flag.replace('\n', "\\n");
    match line.char_indices().nth(LONGEST) {
        None => line,
        Some((end, _)) => format!("{}…", line.get(..end).unwrap_or_default()),
    }
}

impl Document {
    /// Parses `text`, which stands in `file`.
    pub(crate) fn parse(file: &Path, text: &str) -> Result<Self, SceneError> {
        let lines = Lines::of(text);
        let error = |span: Option<std::ops::Range<usize>>, message: &str| {
            let advice = span.clone().and_then(|span| advice(text, span.start));
            SceneError {
                file: file.to_owned(),
                origin: span.map(|s| Origin::Line(lines.line(s.start))),
                key: String::new(),
                message: format!(
                    "this is not valid TOML: {}",
                    advice.unwrap_or_else(|| message.trim_end().to_owned())
                ),
            }
        };
        let table = DeTable::parse(text).map_err(|e| error(e.span(), e.message()))?;
        Ok(Self {
            file: file.to_owned(),
            root: table_of(table.get_ref(), &|start| Origin::Line(lines.line(start))),
            defaults: Defaults::default(),
        })
    }

    /// Puts `value` (TOML, or plain text where that is no TOML) at the dotted
    /// `path`, whether there was something or not.
    pub(crate) fn set(&mut self, flag: &str, path: &str, value: &str) -> Result<(), SceneError> {
        let origin = Origin::Override(shortened(flag));
        let refuse = |message: String| SceneError {
            file: self.file.clone(),
            origin: Some(origin.clone()),
            key: path.to_owned(),
            message,
        };
        let parsed = format!("value = {value}");
        let value = match DeTable::parse(&parsed) {
            Ok(table) => table
                .get_ref()
                .get("value")
                .map(|v| value_of(v.get_ref(), &|_| origin.clone())),
            Err(_) => Some(Value::Text(value.to_owned())),
        };
        let value = value.ok_or_else(|| refuse("this is not a value".to_owned()))?;
        let mut names = path.split('.').peekable();
        let mut table = &mut self.root;
        while let Some(name) = names.next() {
            if name.is_empty() {
                return Err(refuse(
                    "a path is names with points between them, such as solver.step_s".to_owned(),
                ));
            }
            if names.peek().is_none() {
                let node = Node {
                    origin: origin.clone(),
                    value,
                };
                table.insert(name.to_owned(), node);
                return Ok(());
            }
            let node = table.entry(name.to_owned()).or_insert_with(|| Node {
                origin: origin.clone(),
                value: Value::Table(BTreeMap::new()),
            });
            let Value::Table(inner) = &mut node.value else {
                return Err(SceneError {
                    file: self.file.clone(),
                    origin: Some(origin),
                    key: path.to_owned(),
                    message: format!("`{name}` is not a table that could hold further names"),
                });
            };
            table = inner;
        }
        Ok(())
    }

    /// Takes the value at the dotted `path` away, if there is one.
    pub(crate) fn remove(&mut self, path: &str) {
        let mut table = &mut self.root;
        let mut names = path.split('.').peekable();
        while let Some(name) = names.next() {
            if names.peek().is_none() {
                table.remove(name);
                return;
            }
            match table.get_mut(name).map(|n| &mut n.value) {
                Some(Value::Table(inner)) => table = inner,
                _ => return,
            }
        }
    }

    /// The whole document as a section to read keys from.
    pub(crate) fn section(&self) -> Section<'_> {
        Section::new(&self.file, String::new(), None, &self.root, &self.defaults)
    }

    /// The document with every default that was noted, as TOML.
    pub(crate) fn resolved(&self) -> String {
        let mut whole = self.clone();
        for (path, value) in self.defaults.borrow().iter() {
            whole.put(path, value.clone());
        }
        writer::text(&whole.root)
    }

    /// Puts a value at a path; tables on the way are made.
    fn put(&mut self, path: &str, value: Value) {
        let origin = Origin::Override("default".to_owned());
        let mut table = &mut self.root;
        let mut names = path.split('.').peekable();
        while let Some(name) = names.next() {
            let node = |value| Node {
                origin: origin.clone(),
                value,
            };
            if names.peek().is_none() {
                table.insert(name.to_owned(), node(value));
                return;
            }
            let inner = table
                .entry(name.to_owned())
                .or_insert_with(|| node(Value::Table(BTreeMap::new())));
            let Value::Table(inner) = &mut inner.value else {
                return;
            };
            table = inner;
        }
    }
}

/// Explains the error at a byte of a text by a character in its line that only looks like one of
/// TOML, or by a backslash in double quotes, as paths of Windows have it.
fn advice(text: &str, at: usize) -> Option<String> {
    let at = (0..=at.min(text.len()))
        .rev()
        .find(|at| text.is_char_boundary(*at))?;
    let (before, after) = text.split_at(at);
    let start = before.rfind('\n').map_or(0, |end| end + 1);
    let end = after.find('\n').map_or(text.len(), |end| at + end);
    let line = text.get(start..end)?;
    if let Some((column, found)) = first_look_alike(line) {
        return Some(format!(
            "column {column} has {}, write {}",
            found.name, found.write
        ));
    }
    let mut quoted = false;
    let mut chars = line.chars().enumerate().peekable();
    while let Some((place, c)) = chars.next() {
        match c {
            '\'' | '#' if !quoted => return None,
            '"' => quoted = !quoted,
            '\\' if quoted => {
                let next = chars.next().map(|(_, next)| next);
                let is_escape = next.is_some_and(|next| "btnfre\"\\".contains(next));
                if !is_escape {
                    return Some(format!(
                        "column {} has a backslash (\\), which begins an escape between double quotes; write a \
                         path with single quotes ('C:\\Users\\knee.csv') or with forward slashes \
                         (\"C:/Users/knee.csv\")",
                        place + 1
                    ));
                }
            }
            _ => {}
        }
    }
    None
}

/// Line numbers of byte positions.
struct Lines {
    starts: Vec<usize>,
}

impl Lines {
    fn of(text: &str) -> Self {
        let breaks = text.match_indices('\n').map(|(at, _)| at + 1);
        Self {
            starts: std::iter::once(0).chain(breaks).collect(),
        }
    }

    /// The line of a byte, from 1.
    fn line(&self, byte: usize) -> usize {
        self.starts.partition_point(|&start| start <= byte)
    }
}

fn table_of(table: &DeTable<'_>, origin: &dyn Fn(usize) -> Origin) -> BTreeMap<String, Node> {
    table
        .iter()
        .map(|(key, value)| {
            let node = Node {
                origin: origin(key.span().start),
                value: value_of(value.get_ref(), origin),
            };
            (key.get_ref().to_string(), node)
        })
        .collect()
}

fn value_of(value: &DeValue<'_>, origin: &dyn Fn(usize) -> Origin) -> Value {
    match value {
        DeValue::String(s) => Value::Text(s.to_string()),
        DeValue::Integer(i) => match i64::from_str_radix(i.as_str(), i.radix()) {
            #[expect(clippy::cast_precision_loss, reason = "nearest is meant")]
            Ok(n) => Value::Number(n as f64),
            Err(_) => Value::Other("integer beyond 64 bits"),
        },
        DeValue::Float(x) => match x.as_str().parse() {
            Ok(x) => Value::Number(x),
            Err(_) => Value::Other("unreadable number"),
        },
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Array(items) => Value::List(
            items
                .iter()
                .map(|item| Node {
                    origin: origin(item.span().start),
                    value: value_of(item.get_ref(), origin),
                })
                .collect(),
        ),
        DeValue::Table(table) => Value::Table(table_of(table, origin)),
        other @ DeValue::Datetime(_) => Value::Other(other.type_str()),
    }
}
