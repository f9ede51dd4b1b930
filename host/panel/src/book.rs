//! A fault's pages of the book, for the panel: `docs/generated/faults.md` and `docs/faults.md`, embedded.

use serde_json::{Value, json};

const TABLES: &str = include_str!("../../../docs/generated/faults.md");
const TEXTS: &str = include_str!("../../../docs/faults.md");

/// The title and the lines of a fault's section of a page.
fn section(page: &'static str, code: u8) -> Option<(&'static str, Vec<&'static str>)> {
    let begin = format!("### {code} ");
    let mut lines = page.lines();
    let title = lines.by_ref().find_map(|line| line.strip_prefix(&begin))?;
    Some((
        title,
        lines.take_while(|line| !line.starts_with('#')).collect(),
    ))
}

/// The section of a fault: rows of its table, and paragraphs; none if there is no such
/// fault.
pub(crate) fn fault(code: u8) -> Option<Value> {
    let (title, table) = section(TABLES, code)?;
    let mut rows = Vec::new();
    for line in table {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        if let ["", key, value, ""] = cells[..]
            && !key.is_empty()
            && !key.starts_with('-')
        {
            rows.push(json!([key, plain(value)]));
        }
    }
    let (_, text) = section(TEXTS, code)?;
    // Not the link to the table.
    let text: Vec<_> = text
        .iter()
        .copied()
        .filter(|line| !line.starts_with('['))
        .collect();
    let paragraphs: Vec<_> = (text.split(|line| line.trim().is_empty()))
        .filter(|lines| !lines.is_empty())
        .map(|lines| plain(&lines.join(" ")))
        .collect();
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
