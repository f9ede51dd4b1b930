//! Doc comments of the source, by item, so that book and code agree.

use std::collections::BTreeMap;

const SOURCES: [&str; 13] = [
    include_str!("../../src/chirp.rs"),
    include_str!("../../src/counters.rs"),
    include_str!("../../src/crash.rs"),
    include_str!("../../src/host.rs"),
    include_str!("../../src/link.rs"),
    include_str!("../../src/measured.rs"),
    include_str!("../../src/parameters.rs"),
    include_str!("../../src/pieces.rs"),
    include_str!("../../src/revision.rs"),
    include_str!("../../src/settings.rs"),
    include_str!("../../src/state.rs"),
    include_str!("../../src/task_times.rs"),
    include_str!("../../src/telemetry.rs"),
];

/// The comment of every type, `Type`, and of its fields and variants,
/// `Type.name` or `Type.Variant.name`.
pub(crate) fn meanings() -> BTreeMap<String, String> {
    let mut meanings = BTreeMap::new();
    for source in SOURCES {
        read(source, &mut meanings);
    }
    meanings
}

/// Reads what rustfmt has laid out: an item's depth is its indentation.
fn read(source: &str, meanings: &mut BTreeMap<String, String>) {
    let mut comment = String::new();
    let mut names: Vec<String> = Vec::new();
    let mut in_attribute = false;
    // An enumeration with names stands in a macro.
    let mut in_macro = 0;
    for line in source.lines() {
        if line.ends_with("named! {") {
            in_macro = 1;
            continue;
        }
        if line == "}" && in_macro == 1 {
            in_macro = 0;
            continue;
        }
        let text = line.trim_start();
        if in_attribute {
            in_attribute = !text.starts_with(")]");
            continue;
        }
        if text.starts_with("#[") {
            in_attribute = !text.ends_with(']');
            continue;
        }
        let depth = ((line.len() - text.len()) / 4).saturating_sub(in_macro);
        if let Some(more) = text.strip_prefix("///") {
            if !comment.is_empty() && !comment.ends_with(' ') {
                comment.push(' ');
            }
            comment.push_str(more.trim_start());
            continue;
        }
        let item = ["pub struct ", "pub enum "]
            .iter()
            .find_map(|key| text.strip_prefix(key));
        if depth == 0 && item.is_none() && !text.starts_with('}') {
            // A function, a constant, an `impl`: not in the tables.
            names.clear();
        } else if depth <= names.len() && (depth > 0 || item.is_some()) {
            let text = item.unwrap_or(text);
            let text = text.strip_prefix("pub ").unwrap_or(text);
            let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_'));
            let name = &text[..end.unwrap_or(text.len())];
            if !name.is_empty() {
                names.truncate(depth);
                names.push(name.to_owned());
                meanings
                    .entry(names.join("."))
                    .or_insert_with(|| plain(&comment));
            }
        }
        comment.clear();
    }
}

/// Removes intra-doc links, which do not work in the book.
fn plain(comment: &str) -> String {
    let mut text = String::new();
    let mut rest = comment;
    while let Some((before, after)) = rest.split_once("[`") {
        let (code, after) = after.split_once("`]").unwrap_or((after, ""));
        text.push_str(before);
        text.push('`');
        text.push_str(code.rsplit("Self::").next().unwrap_or(code));
        text.push('`');
        rest = match after
            .strip_prefix('(')
            .and_then(|link| link.split_once(')'))
        {
            Some((_, after)) => after,
            None => after,
        };
    }
    text + rest
}

#[test]
fn comments_are_found() {
    let meanings = meanings();
    for (name, meaning) in [
        ("Status.zeroed", "Whether the angle's zero was set."),
        ("Operation.Commit.values", "All values."),
        ("DriveRefusal.NoLease", "No lease, or an expired one."),
        ("Sample.torque_nm", "Torque setpoint of the motor, N·m."),
        ("Operation.Status", "Reads the status. → `Answer::Status`"),
    ] {
        assert_eq!(
            meanings.get(name).map(String::as_str),
            Some(meaning),
            "{name}"
        );
    }
}
