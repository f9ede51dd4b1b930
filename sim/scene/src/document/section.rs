//! One table of a scene, read key by key.
//!
//! Each key that is asked for is remembered, so that at the end an unknown key
//! can be refused with the list of those that are allowed.

use super::{Defaults, Node, Value};
use crate::error::{Origin, SceneError};
use crate::similar::{question, similar};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// The numbers that a key takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    pub(crate) min: f64,
    pub(crate) max: f64,
    /// Whether `min` itself is allowed.
    pub(crate) includes_min: bool,
}

impl Range {
    /// Range from `min` to `max`, both allowed.
    pub(crate) const fn closed(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            includes_min: true,
        }
    }

    /// Range above `min`, up to `max`.
    pub(crate) const fn above(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            includes_min: false,
        }
    }

    fn holds(self, x: f64) -> bool {
        x <= self.max && (x > self.min || (self.includes_min && x >= self.min))
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let from = if self.includes_min { "from" } else { "above" };
        write!(f, "{from} {} up to {}", Plain(self.min), Plain(self.max))
    }
}

/// A number as a person writes it: powers of ten where they are shorter.
struct Plain(f64);

impl fmt::Display for Plain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.abs();
        if magnitude != 0.0 && !(1e-3..1e5).contains(&magnitude) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

/// A table being read.
#[derive(Debug)]
pub(crate) struct Section<'a> {
    file: &'a Path,
    path: String,
    origin: Option<&'a Origin>,
    table: &'a BTreeMap<String, Node>,
    asked: RefCell<Vec<String>>,
    defaults: &'a Defaults,
}

impl<'a> Section<'a> {
    pub(super) fn new(
        file: &'a Path,
        path: String,
        origin: Option<&'a Origin>,
        table: &'a BTreeMap<String, Node>,
        defaults: &'a Defaults,
    ) -> Self {
        Self {
            file,
            path,
            origin,
            table,
            asked: RefCell::default(),
            defaults,
        }
    }

    /// The file that the section stands in.
    pub(crate) fn file(&self) -> &'a Path {
        self.file
    }

    /// An error about the whole section.
    pub(crate) fn error(&self, message: impl Into<String>) -> SceneError {
        SceneError {
            file: self.file.to_owned(),
            origin: self.origin.cloned(),
            key: self.path.clone(),
            message: message.into(),
        }
    }

    /// An error about `key`, whether it is there or not.
    pub(crate) fn key_error(&self, key: &str, message: impl Into<String>) -> SceneError {
        SceneError {
            file: self.file.to_owned(),
            origin: self
                .table
                .get(key)
                .map(|n| &n.origin)
                .or(self.origin)
                .cloned(),
            key: self.path_of(key),
            message: message.into(),
        }
    }

    /// Returns whether there is such a key.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    /// A number that may be left out.
    pub(crate) fn optional_number(
        &self,
        key: &str,
        range: Range,
    ) -> Result<Option<f64>, SceneError> {
        let Some(node) = self.ask(key) else {
            return Ok(None);
        };
        let Value::Number(x) = node.value else {
            return Err(self.wrong_type(key, node, &format!("a number {range}")));
        };
        if range.holds(x) {
            Ok(Some(x))
        } else {
            Err(self.key_error(
                key,
                format!("{} is not allowed: a number {range} is", Plain(x)),
            ))
        }
    }

    /// A number, or its default, which is noted.
    pub(crate) fn number_or(
        &self,
        key: &str,
        range: Range,
        default: f64,
    ) -> Result<f64, SceneError> {
        let given = self.optional_number(key, range)?;
        Ok(given.unwrap_or_else(|| {
            self.note(key, Value::Number(default));
            default
        }))
    }

    /// Notes what a key was taken to be.
    pub(crate) fn note(&self, key: &str, value: Value) {
        let path = self.path_of(key);
        self.defaults.borrow_mut().push((path, value));
    }

    /// A number that has to be there.
    pub(crate) fn number(&self, key: &str, range: Range) -> Result<f64, SceneError> {
        self.optional_number(key, range)?
            .ok_or_else(|| self.missing(key, &format!("a number {range}")))
    }

    /// Numbers that may be left out.
    pub(crate) fn optional_numbers(&self, key: &str) -> Result<Option<Vec<f64>>, SceneError> {
        let Some(node) = self.ask(key) else {
            return Ok(None);
        };
        let expected = "numbers in brackets";
        let Value::List(items) = &node.value else {
            return Err(self.wrong_type(key, node, expected));
        };
        let numbers = items.iter().map(|item| match item.value {
            Value::Number(x) => Ok(x),
            _ => Err(self.wrong_type(key, item, expected)),
        });
        numbers.collect::<Result<_, _>>().map(Some)
    }

    /// A boolean, false if left out, which is noted.
    pub(crate) fn flag(&self, key: &str) -> Result<bool, SceneError> {
        match self.ask(key) {
            None => {
                self.note(key, Value::Flag(false));
                Ok(false)
            }
            Some(Node {
                value: Value::Flag(flag),
                ..
            }) => Ok(*flag),
            Some(node) => Err(self.wrong_type(key, node, "true or false")),
        }
    }

    /// A text that may be left out.
    pub(crate) fn optional_text(&self, key: &str) -> Result<Option<&'a str>, SceneError> {
        match self.ask(key) {
            None => Ok(None),
            Some(Node {
                value: Value::Text(text),
                ..
            }) => Ok(Some(text)),
            Some(node) => Err(self.wrong_type(key, node, "a text in quotes")),
        }
    }

    /// A text that has to be there.
    pub(crate) fn text(&self, key: &str) -> Result<&'a str, SceneError> {
        self.optional_text(key)?
            .ok_or_else(|| self.missing(key, "a text in quotes"))
    }

    /// One of `choices` by name, `None` if left out.
    pub(crate) fn optional_choice<T: Copy>(
        &self,
        key: &str,
        choices: &[(&str, T)],
    ) -> Result<Option<T>, SceneError> {
        let Some(text) = self.optional_text(key)? else {
            return Ok(None);
        };
        match choices.iter().find(|(name, _)| *name == text) {
            Some((_, choice)) => Ok(Some(*choice)),
            None => Err(self.key_error(
                key,
                format!(
                    "\"{text}\" is not allowed: {}",
                    one_of(choices.iter().map(|c| c.0), text)
                ),
            )),
        }
    }

    /// One of `choices` by name, or its default, which is noted.
    pub(crate) fn choice_or<T: Copy + PartialEq>(
        &self,
        key: &str,
        choices: &[(&str, T)],
        default: T,
    ) -> Result<T, SceneError> {
        let given = self.optional_choice(key, choices)?;
        Ok(given.unwrap_or_else(|| {
            for (name, _) in choices.iter().filter(|(_, choice)| *choice == default) {
                self.note(key, Value::Text((*name).to_owned()));
            }
            default
        }))
    }

    /// One of `choices` by name.
    pub(crate) fn choice<T: Copy>(
        &self,
        key: &str,
        choices: &[(&str, T)],
    ) -> Result<T, SceneError> {
        self.optional_choice(key, choices)?
            .ok_or_else(|| self.missing(key, &one_of(choices.iter().map(|c| c.0), "")))
    }

    /// A table that may be left out.
    pub(crate) fn optional_section(&self, key: &str) -> Result<Option<Section<'a>>, SceneError> {
        match self.ask(key) {
            None => Ok(None),
            Some(Node {
                value: Value::Table(table),
                origin,
            }) => Ok(Some(Section::new(
                self.file,
                self.path_of(key),
                Some(origin),
                table,
                self.defaults,
            ))),
            Some(node) => {
                Err(self.wrong_type(key, node, &format!("a table [{}]", self.path_of(key))))
            }
        }
    }

    /// A table that has to be there.
    pub(crate) fn section(&self, key: &str) -> Result<Section<'a>, SceneError> {
        self.optional_section(key)?
            .ok_or_else(|| self.missing(key, &format!("a table [{}]", self.path_of(key))))
    }

    /// A list of tables.
    pub(crate) fn sections(&self, key: &str) -> Result<Vec<Section<'a>>, SceneError> {
        let wanted = "a list of tables [{ … }, { … }]";
        let Some(node) = self.ask(key) else {
            return Err(self.missing(key, wanted));
        };
        let Value::List(items) = &node.value else {
            return Err(self.wrong_type(key, node, wanted));
        };
        items
            .iter()
            .enumerate()
            .map(|(i, item)| match &item.value {
                Value::Table(table) => Ok(Section::new(
                    self.file,
                    format!("{}[{i}]", self.path_of(key)),
                    Some(&item.origin),
                    table,
                    self.defaults,
                )),
                _ => Err(self.wrong_type(key, item, wanted)),
            })
            .collect()
    }

    /// Rejects unknown keys.
    pub(crate) fn finish(&self) -> Result<(), SceneError> {
        let asked = self.asked.borrow();
        match self.table.keys().find(|key| !asked.contains(key)) {
            None => Ok(()),
            Some(key) => Err(self.key_error(
                key,
                format!(
                    "there is no such key here: {}",
                    one_of(asked.iter().map(String::as_str), key)
                ),
            )),
        }
    }

    fn ask(&self, key: &str) -> Option<&'a Node> {
        let mut asked = self.asked.borrow_mut();
        if !asked.iter().any(|k| k == key) {
            asked.push(key.to_owned());
        }
        self.table.get(key)
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.path)
        }
    }

    fn missing(&self, key: &str, wanted: &str) -> SceneError {
        self.key_error(key, format!("this key is missing: {wanted}"))
    }

    fn wrong_type(&self, key: &str, node: &Node, wanted: &str) -> SceneError {
        let found = match &node.value {
            Value::Text(text) => format!("the text \"{text}\""),
            Value::Number(x) => format!("the number {}", Plain(*x)),
            Value::Flag(_) => "a boolean".to_owned(),
            Value::List(_) => "a list".to_owned(),
            Value::Table(_) => "a table".to_owned(),
            Value::Other(kind) => format!("a {kind}"),
        };
        SceneError {
            origin: Some(node.origin.clone()),
            ..self.key_error(key, format!("{wanted} is wanted, this is {found}"))
        }
    }
}

/// "allowed are a, b and c", with the nearest to `given` pointed out.
fn one_of<'n>(names: impl Iterator<Item = &'n str> + Clone, given: &str) -> String {
    let list: Vec<&str> = names.clone().collect();
    let list = match list.as_slice() {
        [] => return "nothing is allowed".to_owned(),
        [only] => format!("allowed is {only}"),
        [first @ .., last] => format!("allowed are {} and {last}", first.join(", ")),
    };
    let nearest = similar(names, given).filter(|name| *name != given);
    format!("{list}{}", question(nearest))
}
