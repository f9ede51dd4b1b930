//! Text that comes from files, devices and the command line, made safe for a
//! terminal: control characters are shown, not sent, and what is repeated of an
//! input is never long.

use std::borrow::Cow;

/// The most that is repeated of one word, or one quotation, characters.
const LONGEST: usize = 200;

/// Characters kept of a longer one.
const KEPT: usize = 150;

/// With control characters escaped, but for ends of lines and tabs; and those
/// that turn the direction of what follows.
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

/// A message: [`visible`], with long words and quotations cut, and what this
/// program was called with.
pub(crate) fn message(text: &str) -> String {
    let arguments = std::env::args_os().map(|argument| argument.to_string_lossy().into_owned());
    brief(text, arguments)
}

fn brief(text: &str, arguments: impl Iterator<Item = String>) -> String {
    let mut text = text.to_owned();
    for argument in arguments {
        for part in argument.split('=').chain([argument.as_str()]) {
            let part = part.trim();
            if part.chars().count() > LONGEST {
                text = text.replace(part, &cut(part));
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
        brief.push_str(&cut(part));
        rest = more;
    }
    visible(&brief).into_owned()
}

fn cut(part: &str) -> Cow<'_, str> {
    let count = part.chars().count();
    if count <= LONGEST {
        return Cow::Borrowed(part);
    }
    let kept: String = part.chars().take(KEPT).collect();
    Cow::Owned(format!("{kept}… ({count} characters)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_shown() {
        assert_eq!(visible("a\u{1b}[31mb\u{7}"), "a\\u{1b}[31mb\\u{7}");
        assert_eq!(visible("over\u{202e}txt.moc"), "over\\u{202e}txt.moc");
        assert_eq!(visible("\u{9b}1A"), "\\u{9b}1A");
        assert!(matches!(visible("über\tzwei\nZeilen"), Cow::Borrowed(_)));
    }

    #[test]
    fn no_input_is_repeated_at_length() {
        let long = "x".repeat(100_000);
        let told = message(&format!("there is no scene {long}: look"));
        assert!(told.len() < 250, "{}", told.len());
        assert!(told.ends_with("… (100001 characters) look"), "{told}");
        let words = "many words ".repeat(100);
        for quote in ['"', '`'] {
            let told = message(&format!("key {quote}{words}{quote} is not allowed"));
            assert!(told.len() < 250, "{told}");
            assert!(told.ends_with("characters) is not allowed"), "{told}");
        }
        // A path needs no quotation marks.
        let told = brief(
            &format!("{words}: cannot be read"),
            [words.clone(), format!("--set=a.{words}")].into_iter(),
        );
        assert!(
            told.len() < 250 && told.ends_with("cannot be read"),
            "{told}"
        );
        // An open quotation is one up to the end.
        assert!(message(&format!("\"{words}")).len() < 250);
        let short = "scene.toml, line 4: `device`: \"reference\" has no step";
        assert_eq!(message(short), short);
    }
}
