//! A document as TOML text that reads back to the same values, to the bit.

use super::{Node, Value};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The text of a document: values first, then tables.
pub(super) fn text(root: &BTreeMap<String, Node>) -> String {
    let mut text = String::new();
    table(&mut text, "", root);
    text
}

fn table(text: &mut String, path: &str, nodes: &BTreeMap<String, Node>) {
    let is_table = |node: &&Node| matches!(node.value, Value::Table(_));
    let has_values = nodes.values().any(|node| !is_table(&node));
    if !path.is_empty() && (has_values || nodes.is_empty()) {
        let _ = writeln!(text, "\n[{path}]");
    }
    for (name, node) in nodes.iter().filter(|(_, node)| !is_table(node)) {
        let _ = writeln!(text, "{} = {}", key(name), value(&node.value));
    }
    for (name, node) in nodes {
        if let Value::Table(inner) = &node.value {
            let path = if path.is_empty() {
                key(name)
            } else {
                format!("{path}.{}", key(name))
            };
            table(text, &path, inner);
        }
    }
}

fn value(value: &Value) -> String {
    match value {
        Value::Text(text) => quoted(text),
        // The shortest decimal that reads back; always with a point or a power.
        Value::Number(x) => format!("{x:?}"),
        Value::Flag(flag) => flag.to_string(),
        Value::List(items) => {
            let items: Vec<_> = items.iter().map(|item| self::value(&item.value)).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Table(nodes) => {
            let entries: Vec<_> = nodes
                .iter()
                .map(|(name, node)| format!("{} = {}", key(name), self::value(&node.value)))
                .collect();
            format!("{{ {} }}", entries.join(", "))
        }
        // No key of a scene takes it, so no scene that was read has it.
        Value::Other(kind) => quoted(kind),
    }
}

/// A bare key where that is allowed.
fn key(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if !name.is_empty() && name.chars().all(is_bare) {
        name.to_owned()
    } else {
        quoted(name)
    }
}

/// A text as TOML.
pub(crate) fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            c if c.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted + "\""
}

#[cfg(test)]
mod tests {
    use crate::document::Document;
    use std::path::Path;

    #[test]
    fn what_is_written_reads_back() {
        let toml = r#"
title = "a \"quoted\" \\ line\nand \u0001 é"
n = 0.1
big = 1e300
small = 5e-324
whole = 3
flag = true
list = [1.5, 2]

[motion]
knots = [{ t_s = 0.0, omega_rad_s = -1.25 }, { t_s = 1, "odd key" = "x" }]

[effects.crepitus]
[effects.encoder]
lines = 512
"#;
        let document = Document::parse(Path::new("a.toml"), toml).unwrap();
        let text = document.resolved();
        let again = Document::parse(Path::new("a.toml"), &text).unwrap();
        assert_eq!(again.resolved(), text);
        let values = |document: &Document| {
            let debug = format!("{:?}", document.root);
            // But for where they stood.
            let mut parts: Vec<_> = debug.split("origin: Line(").collect();
            parts.iter_mut().skip(1).for_each(|part| {
                *part = part.split_once(')').map_or(*part, |(_, rest)| rest);
            });
            parts.concat()
        };
        assert_eq!(values(&again), values(&document));
    }
}
