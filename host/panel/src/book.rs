//! A fault's page of the book, for the panel: `docs/faults.md`, embedded.

use serde_json::{Value, json};

const FAULTS: &str = include_str!("../../../docs/faults.md");

/// The section of a fault: rows of its table, and paragraphs; none if there is no such
/// fault.
pub(crate) fn fault(code: u8) -> Option<Value> {
    let begin = format!("### {code} ");
    let mut lines = FAULTS.lines();
    let title = lines.by_ref().find_map(|line| line.strip_prefix(&begin))?;
    let section = lines.take_while(|line| !line.starts_with('#'));
    let mut rows = Vec::new();
    let mut paragraphs: Vec<String> = Vec::new();
    let mut is_open = false;
    for line in section.filter(|line| !line.starts_with("<!--")) {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        match cells.as_slice() {
            ["", key, value, ""] => {
                let is_rule = key.is_empty() || key.starts_with('-');
                if !is_rule {
                    rows.push(json!([key, plain(value)]));
                }
            }
            _ if line.trim().is_empty() => is_open = false,
            _ => {
                if !is_open {
                    paragraphs.push(String::new());
                }
                is_open = true;
                if let Some(paragraph) = paragraphs.last_mut() {
                    if !paragraph.is_empty() {
                        paragraph.push(' ');
                    }
                    paragraph.push_str(&plain(line));
                }
            }
        }
    }
    Some(json!({ "title": title, "rows": rows, "paragraphs": paragraphs }))
}

/// Returns the text without the marks of emphasis and code.
fn plain(text: &str) -> String {
    text.replace("**", "").replace('`', "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::fault::FAULTS as TABLE;

    #[test]
    fn every_fault_has_its_section() {
        for spec in TABLE {
            let code = spec.fault as u8;
            let section = fault(code).unwrap();
            assert_eq!(section["title"], spec.name);
            let rows = section["rows"].as_array().unwrap();
            assert!(rows.iter().any(|row| row[0] == "cause"), "{}", spec.name);
            let paragraphs = section["paragraphs"].as_array().unwrap();
            assert!(!paragraphs.is_empty(), "{}", spec.name);
            for text in paragraphs {
                let text = text.as_str().unwrap();
                assert!(
                    !text.contains("<!--") && !text.contains('`') && !text.contains('|'),
                    "{text}"
                );
            }
        }
        assert_eq!(fault(0), None);
        assert_eq!(fault(255), None);
    }
}
