//! Modules as one script: each becomes a function that is called once and returns its exports.
//!
//! ```text
//! import { a, b as c } from "./x.js";          const { a, b: c } = $0;
//! export const d = a + c;               ──>    const d = a + c;
//!                                              return { d };
//! ```
//!
//! A module comes behind those that it imports. Imports and exports stand at the beginning of a line, in
//! the forms that this project uses; any other form is an error.

use super::PageError;
use std::collections::BTreeMap;

/// Finds a module by its path below `assets`.
pub(super) type Find<'f> = &'f dyn Fn(&str) -> Option<&'static str>;

/// Words that are imports or exports at the beginning of a statement.
const WORDS: [&str; 2] = ["import", "export"];

/// Forms of an import that is not at the beginning of a statement.
const INNER: [&str; 2] = ["import(", "import.meta"];

/// A module, without its imports and the word `export`.
#[derive(Default)]
struct Module {
    imports: Vec<Import>,
    exports: Vec<String>,
    body: String,
}

/// Names of another module, each with its name in this one.
struct Import {
    path: String,
    names: Vec<(String, String)>,
}

/// The script of a module and of all that it needs.
///
/// # Errors
/// [`PageError`] if a file has a mistake.
pub(super) fn script(entry: &str, find: Find<'_>) -> Result<String, PageError> {
    let mut order = Order {
        find,
        modules: Vec::new(),
        numbers: BTreeMap::new(),
        open: Vec::new(),
    };
    order.add(entry, entry)?;
    let mut script = "\"use strict\";\n".to_owned();
    for (number, module) in order.modules.iter().enumerate() {
        script += &order.wrapped(number, module);
    }
    Ok(script)
}

/// Modules in the order in which they run.
struct Order<'f> {
    find: Find<'f>,
    modules: Vec<Module>,
    numbers: BTreeMap<String, usize>,
    /// Modules whose imports are being added.
    open: Vec<String>,
}

impl Order<'_> {
    /// Adds a module behind those that it imports, unless it is there.
    fn add(&mut self, path: &str, importer: &str) -> Result<(), PageError> {
        if self.numbers.contains_key(path) {
            return Ok(());
        }
        if self.open.iter().any(|open| open == path) {
            return Err(PageError::Circle {
                file: path.to_owned(),
            });
        }
        let text = (self.find)(path).ok_or_else(|| PageError::Missing {
            file: importer.to_owned(),
            import: path.to_owned(),
        })?;
        let module = parse(path, text)?;
        self.open.push(path.to_owned());
        for import in &module.imports {
            self.add(&import.path, path)?;
            self.check(import, path)?;
        }
        self.open.pop();
        self.numbers.insert(path.to_owned(), self.modules.len());
        self.modules.push(module);
        Ok(())
    }

    /// Checks that the other module exports these names.
    fn check(&self, import: &Import, path: &str) -> Result<(), PageError> {
        let number = self.numbers.get(&import.path);
        let other = number.and_then(|number| self.modules.get(*number));
        let exports = other.map_or(&[][..], |module| module.exports.as_slice());
        let is_missing = |(name, _): &&(String, String)| !exports.contains(name);
        match import.names.iter().find(is_missing) {
            None => Ok(()),
            Some((name, _)) => Err(PageError::NotExported {
                file: path.to_owned(),
                import: import.path.clone(),
                name: name.clone(),
            }),
        }
    }

    /// The function of a module.
    fn wrapped(&self, number: usize, module: &Module) -> String {
        let imports: Vec<_> = (module.imports.iter())
            .map(|import| {
                let other = self.numbers.get(&import.path).copied().unwrap_or_default();
                let names: Vec<_> = (import.names.iter())
                    .map(|(name, own)| {
                        if name == own {
                            own.clone()
                        } else {
                            format!("{name}: {own}")
                        }
                    })
                    .collect();
                format!("const {{ {} }} = ${other};\n", names.join(", "))
            })
            .collect();
        let imports = imports.concat();
        let exports = module.exports.join(", ");
        let body = &module.body;
        format!("const ${number} = (() => {{\n{imports}{body}return {{ {exports} }};\n}})();\n")
    }
}

/// Reads a module.
fn parse(path: &str, text: &str) -> Result<Module, PageError> {
    let unknown = |line: &str| PageError::Form {
        file: path.to_owned(),
        line: line.to_owned(),
    };
    let mut module = Module::default();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let first = first_word(line.trim_start());
        let is_ordinary = !WORDS.contains(&first) && !INNER.iter().any(|form| line.contains(form));
        if is_ordinary {
            module.body += line;
        } else if let Some(rest) = line.strip_prefix("export ") {
            let name = exported(rest).ok_or_else(|| unknown(line))?;
            module.exports.push(name.to_owned());
            module.body += rest;
        } else {
            let mut whole = line.to_owned();
            while !whole.ends_with(';') {
                whole += lines.next().ok_or_else(|| unknown(line))?;
            }
            let import = imported(path, &whole).ok_or_else(|| unknown(line))?;
            module.imports.push(import);
            continue;
        }
        module.body.push('\n');
    }
    Ok(module)
}

fn is_of_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_' || c == '$'
}

/// The word at the beginning of a text; empty if there is none.
fn first_word(text: &str) -> &str {
    let end = text.find(|c| !is_of_name(c)).unwrap_or(text.len());
    text.get(..end).unwrap_or_default()
}

/// The name that a line declares behind `export`.
fn exported(line: &str) -> Option<&str> {
    let line = line.strip_prefix("async ").unwrap_or(line);
    let kinds = ["const ", "function ", "class "];
    let declared = kinds.iter().find_map(|kind| line.strip_prefix(kind))?;
    Some(first_word(declared)).filter(|name| !name.is_empty())
}

/// The import of a line of the module at `path`.
fn imported(path: &str, line: &str) -> Option<Import> {
    let (names, from) = line.strip_prefix("import {")?.split_once('}')?;
    let from = from.strip_prefix(" from \"")?.strip_suffix("\";")?;
    let names = names.split(',').map(str::trim);
    let names: Option<Vec<_>> = names.filter(|name| !name.is_empty()).map(renamed).collect();
    Some(Import {
        path: resolved(path, from)?,
        names: names?,
    })
}

/// A name of another module, and that here: `a` or `a as b`.
fn renamed(name: &str) -> Option<(String, String)> {
    let (name, own) = name.split_once(" as ").unwrap_or((name, name));
    let are_names = first_word(name) == name && first_word(own) == own;
    are_names.then(|| (name.to_owned(), own.to_owned()))
}

/// The path of what the module at `path` imports.
fn resolved(path: &str, import: &str) -> Option<String> {
    if !import.starts_with('.') {
        return None;
    }
    let mut parts: Vec<_> = path.split('/').collect();
    parts.pop();
    for part in import.split('/') {
        match part {
            "." => {}
            ".." => {
                parts.pop()?;
            }
            other => parts.push(other),
        }
    }
    Some(parts.join("/"))
}

#[cfg(test)]
mod tests;
