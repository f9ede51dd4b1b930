//! Names that a file can have on every system.

use std::iter::once;

/// Names that Windows keeps for devices, in any case and with any extension; those of `NUMBERED` have a digit behind
/// them.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];
const NUMBERED: [&str; 2] = ["com", "lpt"];

/// Returns whether Windows has no file of this name, but a device.
#[must_use]
pub fn is_reserved(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or_default().trim_end();
    let stem = stem.to_lowercase();
    let is_numbered = |word: &str| {
        let mut rest = stem.strip_prefix(word).unwrap_or_default().chars();
        // Windows takes the superscripts of Latin-1 for digits.
        let is_digit = |c: char| matches!(c, '1'..='9' | '¹' | '²' | '³');
        rest.next().is_some_and(is_digit) && rest.next().is_none()
    };
    DEVICES.contains(&stem.as_str()) || NUMBERED.into_iter().any(is_numbered)
}

/// Returns a name for a file of any text: small letters, digits and hyphens, up to `most` characters. Empty where the
/// text has no Latin letter and no digit.
#[must_use]
pub fn plain(text: &str, most: usize) -> String {
    let mut name = String::new();
    for c in text.to_lowercase().chars() {
        match spelled(c) {
            Some(letters) => name += letters,
            None if c.is_ascii_alphanumeric() => name.push(c),
            None if name.ends_with('-') || name.is_empty() => {}
            None => name.push('-'),
        }
    }
    name.truncate(most);
    name.truncate(name.trim_end_matches('-').len());
    name
}

/// Spelling of a letter with a mark, in the letters of ASCII; that of a mark by itself is empty.
fn spelled(c: char) -> Option<&'static str> {
    Some(match c {
        'ä' | 'æ' => "ae",
        'ö' | 'œ' => "oe",
        'ü' => "ue",
        'ß' => "ss",
        'à' | 'á' | 'â' | 'ã' | 'å' => "a",
        'ç' => "c",
        'è' | 'é' | 'ê' | 'ë' => "e",
        'ì' | 'í' | 'î' | 'ï' => "i",
        'ñ' => "n",
        'ò' | 'ó' | 'ô' | 'õ' | 'ø' => "o",
        'ù' | 'ú' | 'û' => "u",
        'ý' | 'ÿ' => "y",
        '\u{300}'..='\u{36f}' => "",
        _ => return None,
    })
}

/// Returns the first of `name`, `name-2`, `name-3` and so on that is not taken and that every system has a file of.
#[must_use]
pub fn free(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let numbered = (2_u64..).map(|number| format!("{name}-{number}"));
    let mut names = once(name.to_owned()).chain(numbered);
    let found = names.find(|name| !is_reserved(name) && !is_taken(name));
    found.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_device_of_windows_is_no_file() {
        for reserved in [
            "NUL",
            "Aux.toml",
            "nul.tar.gz",
            "com1",
            "LPT9.csv",
            "com²",
            "prn ",
        ] {
            assert!(is_reserved(reserved), "{reserved}");
        }
        for free in ["", "console", "com", "com0", "com10", "my con"] {
            assert!(!is_reserved(free), "{free}");
        }
    }

    #[test]
    fn any_text_makes_a_name() {
        for (text, name) in [
            ("Steifes Knie", "steifes-knie"),
            ("Übung für Größe 2", "uebung-fuer-groesse-2"),
            ("Knee of José (left)!", "knee-of-jose-left"),
            // Decomposed, as files of macOS are.
            ("Jose\u{301}", "jose"),
            ("--a--", "a"),
            ("膝", ""),
        ] {
            assert_eq!(plain(text, 40), name, "{text}");
        }
        assert_eq!(plain("abcdefghi jkl", 10), "abcdefghi");
        assert_eq!(plain("aä", 2), "aa");
    }

    #[test]
    fn a_name_that_is_taken_gets_a_number() {
        let is_taken = |name: &str| ["knee", "knee-2"].contains(&name);
        for (name, expected) in [("leg", "leg"), ("knee", "knee-3"), ("con", "con-2")] {
            assert_eq!(free(name, is_taken), expected);
        }
    }
}
