//! Characters that look like others, by name: what a word processor, a spreadsheet or a page made of
//! the ones that a program reads.

/// Name of a character that only looks like another, and what to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LookAlike {
    /// The character.
    pub found: char,
    /// Name of the character with its code point, such as `U+2212 (minus sign)`.
    pub name: &'static str,
    /// The character to write.
    pub write: &'static str,
}

const ALL: [LookAlike; 24] = {
    const fn one(found: char, name: &'static str, write: &'static str) -> LookAlike {
        LookAlike { found, name, write }
    }
    [
        one('\u{a0}', "U+00A0 (no-break space)", "a plain space"),
        one('\u{2007}', "U+2007 (figure space)", "a plain space"),
        one('\u{2009}', "U+2009 (thin space)", "a plain space"),
        one(
            '\u{202f}',
            "U+202F (narrow no-break space)",
            "a plain space",
        ),
        one('\u{3000}', "U+3000 (ideographic space)", "a plain space"),
        one('\u{200b}', "U+200B (zero width space)", "nothing"),
        one('\u{ad}', "U+00AD (soft hyphen)", "nothing, or -"),
        one('\u{2010}', "U+2010 (hyphen)", "-"),
        one('\u{2011}', "U+2011 (no-break hyphen)", "-"),
        one('\u{2012}', "U+2012 (figure dash)", "-"),
        one('\u{2013}', "U+2013 (en dash)", "-"),
        one('\u{2014}', "U+2014 (em dash)", "-"),
        one('\u{2212}', "U+2212 (minus sign)", "-"),
        one('\u{feff}', "U+FEFF (byte order mark)", "nothing"),
        one('\u{201c}', "U+201C (left double quotation mark)", "\""),
        one('\u{201d}', "U+201D (right double quotation mark)", "\""),
        one('\u{201e}', "U+201E (low double quotation mark)", "\""),
        one('\u{ab}', "U+00AB (left guillemet)", "\""),
        one('\u{bb}', "U+00BB (right guillemet)", "\""),
        one('\u{2018}', "U+2018 (left single quotation mark)", "'"),
        one('\u{2019}', "U+2019 (right single quotation mark)", "'"),
        one('\u{b4}', "U+00B4 (acute accent)", "'"),
        one('\u{ff0c}', "U+FF0C (fullwidth comma)", ","),
        one('\u{ff1d}', "U+FF1D (fullwidth equals sign)", "="),
    ]
};

/// Returns what is known of a character that only looks like another.
pub fn look_alike(found: char) -> Option<LookAlike> {
    ALL.into_iter().find(|one| one.found == found)
}

/// Returns the first such character in a text, and its column, from 1.
pub fn first_look_alike(text: &str) -> Option<(usize, LookAlike)> {
    text.chars()
        .enumerate()
        .find_map(|(at, found)| Some((at + 1, look_alike(found)?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_named_by_its_own_code_point() {
        for one in ALL {
            let code = format!("U+{:04X} (", u32::from(one.found));
            assert!(one.name.starts_with(&code), "{one:?}");
            assert!(!one.write.contains(one.found), "{one:?}");
        }
        assert_eq!(look_alike('-'), None);
        let (column, minus) = first_look_alike("1\u{2212}2").unwrap();
        assert_eq!((column, minus.write), (2, "-"));
    }
}
