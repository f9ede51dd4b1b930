//! Room that a text takes, without asking a font: an upper bound for the
//! sans-serif fonts in use, of which DejaVu Sans and Verdana are the widest.

/// Size of the text of charts, CSS pixels.
pub const SIZE: f64 = 15.0;

/// Distance from one line of text to the next, CSS pixels.
pub const LINE: f64 = 18.0;

/// Most that a text is wide, CSS pixels.
pub fn width(text: &str, size: f64) -> f64 {
    size * text.chars().map(em).sum::<f64>()
}

/// Width of a letter, as a share of the size.
fn em(letter: char) -> f64 {
    match letter {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | '·' | ' '
        | '\u{202F}' => 0.36,
        't' | 'f' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' => 0.42,
        '⁰'..='⁹' | '¹' | '²' | '³' | '⁻' => 0.54,
        'm' | 'M' | 'W' | 'w' | '@' | '%' => 1.0,
        'A'..='Z' | 'Ω' | '−' | '=' | '+' | '<' | '>' | '≤' | '≥' | '×' | '±' | '→' => {
            0.85
        }
        _ => 0.65,
    }
}

/// The text in one line, or in two if it is too long for this room.
pub(crate) fn lines(text: &str, room: f64) -> Vec<&str> {
    if width(text, SIZE) > room {
        // The unit goes to the second line.
        if let Some((first, _)) = text.split_once(" (").or_else(|| text.rsplit_once(' ')) {
            return vec![first, text[first.len()..].trim_start()];
        }
    }
    vec![text]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_title_breaks_before_its_unit() {
        assert_eq!(lines("Torque (N·m)", 168.0), ["Torque (N·m)"]);
        assert_eq!(
            lines("Torque less trend (N·m)", 168.0),
            ["Torque less trend", "(N·m)"]
        );
        assert_eq!(lines("word", 1.0), ["word"]);
    }

    #[test]
    fn widths_are_no_less_than_those_of_dejavu_sans() {
        // Measured at 100 px.
        for (word, dejavu) in [
            ("Torque (N·m)", 640.0),
            ("−12.5", 269.0),
            ("Frequency", 502.0),
            ("10⁻¹⁵", 207.0),
        ] {
            assert!(
                width(word, 100.0) >= dejavu,
                "{word}: {}",
                width(word, 100.0)
            );
        }
    }
}
