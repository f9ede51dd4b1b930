//! Escaping of text from files, devices and the command line: control
//! characters are shown, and long input is truncated.

use std::borrow::Cow;

/// The longest word or quotation that is repeated whole, and what is kept of a longer one,
/// characters.
const LONGEST: (usize, usize) = (80, 60);

/// Both lengths of paths and of commands to type, of which a part is of no use.
const LONGEST_PATH: (usize, usize) = (200, 150);

/// Escapes control characters, except newlines and tabs, and characters that
/// change the direction of text.
pub(crate) fn visible(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_hidden) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        if is_hidden(c) {
            safe.extend(c.escape_unicode());
        } else {
            safe.push(c);
        }
    }
    Cow::Owned(safe)
}

fn is_hidden(c: char) -> bool {
    let turns = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || (c.is_control() && !matches!(c, '\n' | '\t'))
}

/// A message for a terminal: [`visible`], with long words, quotations and
/// arguments of this program truncated.
pub(crate) fn message(text: &str) -> String {
    let arguments = std::env::args_os().map(|argument| argument.to_string_lossy().into_owned());
    brief(text, arguments)
}

fn brief(text: &str, arguments: impl Iterator<Item = String>) -> String {
    let mut text = text.to_owned();
    for argument in arguments {
        for part in argument.split('=').chain([argument.as_str()]) {
            let part = part.trim();
            let short = one_line(&cut(part));
            if short != part {
                text = text.replace(part, &short);
            }
        }
    }
    let mut brief = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some(first) = rest.chars().next() {
        let (part, more) = match first {
            '"' | '`' => {
                let behind = rest.get(1..).unwrap_or_default();
                let end = behind.find(first).map_or(rest.len(), |at| at + 2);
                rest.split_at(end)
            }
            c if c.is_whitespace() => rest.split_at(c.len_utf8()),
            _ => {
                let stop = |c: char| c.is_whitespace() || matches!(c, '"' | '`');
                rest.split_at(rest.find(stop).unwrap_or(rest.len()))
            }
        };
        let is_quoted = part.len() > 1 && matches!(first, '"' | '`') && part.ends_with(first);
        let part = cut(part);
        if is_quoted {
            brief.push_str(&one_line(&part));
        } else {
            brief.push_str(&part);
        }
        rest = more;
    }
    visible(&brief).into_owned()
}

/// Escapes line breaks: what was typed, or is quoted, is no line of its own.
fn one_line(text: &str) -> String {
    text.replace('\n', "\\n")
}

fn cut(part: &str) -> Cow<'_, str> {
    let count = part.chars().count();
    let is_long = part.contains(['/', '\\']) || part.starts_with("`crepitus ");
    let (longest, kept) = if is_long { LONGEST_PATH } else { LONGEST };
    if count <= longest {
        return Cow::Borrowed(part);
    }
    let kept: String = part.chars().take(kept).collect();
    Cow::Owned(format!("{kept}… ({count} characters)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown() {
        assert_eq!(visible("a\u{1b}[31mb\u{7}"), "a\\u{1b}[31mb\\u{7}");
        assert_eq!(visible("over\u{202e}txt.moc"), "over\\u{202e}txt.moc");
        assert_eq!(visible("\u{9b}1A"), "\\u{9b}1A");
        assert!(matches!(visible("über\tzwei\nZeilen"), Cow::Borrowed(_)));
    }

    #[test]
    fn long_input_is_truncated() {
        let long = "x".repeat(100_000);
        let text = message(&format!("there is no scene {long}: look"));
        assert!(text.len() < 250, "{}", text.len());
        assert!(text.ends_with("… (100001 characters) look"), "{text}");
        let words = "many words ".repeat(100);
        for quote in ['"', '`'] {
            let text = message(&format!("key {quote}{words}{quote} is not allowed"));
            assert!(text.len() < 250, "{text}");
            assert!(text.ends_with("characters) is not allowed"), "{text}");
        }
        // A path needs no quotation marks.
        let text = brief(
            &format!("{words}: cannot be read"),
            [words.clone(), format!("--set=a.{words}")].into_iter(),
        );
        assert!(
            text.len() < 250 && text.ends_with("cannot be read"),
            "{text}"
        );
        // What was typed forges no line.
        let forged = "1\nerror: forged";
        for text in [format!("a, --step {forged}: no"), format!("{forged:}: no")] {
            let text = brief(&text, [forged.to_owned()].into_iter());
            assert!(text.ends_with("1\\nerror: forged: no"), "{text}");
        }
        let quoted = brief(&format!("unknown name \"{forged}\""), std::iter::empty());
        assert!(!quoted.contains('\n'), "{quoted}");
        // A path is of no use without its end.
        let path = "some-folder/".repeat(15);
        assert_eq!(message(&path), path);
        // An open quotation is one up to the end.
        assert!(message(&format!("\"{words}")).len() < 250);
        let short = "scene.toml, line 4: `device`: \"reference\" has no step";
        assert_eq!(message(short), short);
    }
}
